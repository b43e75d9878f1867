#include "dem/packing_file.h"

#include "dem/contact_network.h"
#include "dem/walls.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <stdexcept>

namespace dem
{
  namespace
  {
    [[noreturn]] void fail(const std::string &file, const std::size_t line, const std::string &what)
    {
      throw std::runtime_error(file + ":" + std::to_string(line) + ": " + what);
    }

    bool has_more(std::istringstream &words)
    {
      std::string rest;
      return static_cast<bool>(words >> rest);
    }

    /** True when the line gives the cell; then its edges are set. */
    bool read_cell(const std::string &file, const std::size_t line, const std::string &text, Cell &cell)
    {
      std::istringstream words(text.substr(1));
      std::string name;
      if (!(words >> name) || name != "cell")
        return false;
      Vector edges;
      if (!(words >> edges.x() >> edges.y() >> edges.z()))
        fail(file, line, "expected \"# cell Lx Ly Lz\" with three lengths [m]");
      if (!(edges.minCoeff() > 0.) || !edges.allFinite())
        fail(file, line, "the edges of the cell must be positive [m]");
      cell.edges = edges.asDiagonal();
      return true;
    }

    Row read_grain(const std::string &file, const std::size_t line, const std::string &text, const Cell &cell)
    {
      std::istringstream words(text);
      Row row;
      if (!(words >> row.x >> row.y >> row.z >> row.w) || has_more(words))
        fail(file, line, "expected \"x y z radius\", four numbers [m], not \"" + text + "\"");
      if (!(row.w > 0.))
        fail(file, line, "radius = " + std::to_string(row.w) + " m; it must be positive");
      return {row.x / cell.edges(0, 0), row.y / cell.edges(1, 1), row.z / cell.edges(2, 2), row.w};
    }

    void check_walls(const std::string &file, const std::vector<std::size_t> &lines, const RevState &state)
    {
      for (std::size_t i = 0; i < lines.size(); ++i)
        for (std::uint32_t wall = 0; wall < n_walls; ++wall)
          {
            const Row &place = state.grains.place[i];
            const double overlap = place.w - compute_distance_to_wall(state.cell, place, wall);
            if (overlap <= 0.5 * place.w)
              continue;
            std::ostringstream message;
            message << "grain reaches " << overlap << " m beyond wall " << to_number(to_partner(wall))
                    << "; at most half its radius, " << 0.5 * place.w << " m, is allowed";
            fail(file, lines[i], message.str());
          }
    }

    void check_overlaps(const std::string &file, const std::vector<std::size_t> &lines, const RevState &state)
    {
      const ContactNetwork network = build_contact_network(state, 0.);
      for (std::size_t k = 0; k < network.size(); ++k)
        {
          if (!network.is_pair(k))
            continue;
          const Row &a = state.grains.place[network.a[k]], &b = state.grains.place[network.b[k]];
          const double overlap = a.w + b.w - compute_branch(state.cell, a, b).norm();
          if (overlap > 0.5 * std::min(a.w, b.w))
            {
              std::ostringstream message;
              message << "grain overlaps the one of line " << lines[network.a[k]] << " by " << overlap
                      << " m; at most half the smaller radius, " << 0.5 * std::min(a.w, b.w) << " m, is allowed";
              fail(file, lines[network.b[k]], message.str());
            }
        }
    }

    /** The grains of a file, and the line of each; the edges of the cell are set. */
    std::vector<Row> read_grains(const std::string &file, Cell &cell, std::vector<std::size_t> &lines)
    {
      std::ifstream input(file);
      if (!input)
        throw std::runtime_error(file + ": " + std::strerror(errno));
      std::vector<Row> grains;
      std::string text;
      bool has_cell = false;
      for (std::size_t line = 1; std::getline(input, text); ++line)
        {
          if (text.find_first_not_of(" \t\r") == std::string::npos)
            continue;
          if (text[0] == '#')
            {
              has_cell = read_cell(file, line, text, cell) || has_cell;
              continue;
            }
          if (!has_cell)
            fail(file, line, "expected \"# cell Lx Ly Lz\" [m] before the first grain");
          grains.push_back(read_grain(file, line, text, cell));
          lines.push_back(line);
        }
      if (lines.empty())
        throw std::runtime_error(file + ": no grains");
      return grains;
    }
  } // namespace

  RevState read_packing(const std::string &file, const CellKind kind)
  {
    RevState state;
    state.cell.kind = kind;
    std::vector<std::size_t> lines;
    const std::vector<Row> places = read_grains(file, state.cell, lines);
    state.resize_grains(places.size());
    std::copy(places.begin(), places.end(), state.grains.place.begin());
    for (std::size_t i = 0; i < lines.size(); ++i)
      state.grains.id[i] = state.grains.parent[i] = i;
    state.counters.next_id = lines.size();
    state.initial_solid_volume = compute_solid_volume(state.grains);
    if (!is_wide_enough(state.cell, compute_reach(state.grains, 0.)))
      throw std::runtime_error(file + ": the cell is narrower than two largest diameters");
    if (state.cell.has_walls())
      check_walls(file, lines, state);
    check_overlaps(file, lines, state);
    return state;
  }

  void write_packing(const std::string &file, const RevState &state)
  {
    std::ofstream output(file);
    const Vector edges = state.cell.edges.diagonal();
    output << std::setprecision(17) << "# cell " << edges.x() << ' ' << edges.y() << ' ' << edges.z() << '\n';
    for (const Row &place : state.grains.place)
      {
        const Vector position = state.cell.edges * to_vector(place);
        output << position.x() << ' ' << position.y() << ' ' << position.z() << ' ' << place.w << '\n';
      }
    output.flush();
    if (!output)
      throw std::runtime_error(file + ": " + std::strerror(errno));
  }
} // namespace dem
