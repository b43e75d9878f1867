#include "fem/gmsh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace fem
{
  namespace
  {
    /** An element of the file: its line, its physical number and the numbers of its nodes. */
    struct Element
    {
      std::string line;
      int type = 0;
      unsigned int name = 0;
      std::vector<int> nodes;
    };

    using Face = std::vector<int>; // numbers of its corners, ascending

    constexpr int type_of_line = 1, type_of_quadrilateral = 3, type_of_hexahedron = 5; // in gmsh's files

    /** Corners of each face of a cell, as gmsh numbers them. */
    const std::vector<std::vector<int>> faces_of_quadrilateral = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
    const std::vector<std::vector<int>> faces_of_hexahedron = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                                               {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

    Face make_face(const std::vector<int> &nodes, const std::vector<int> &corners)
    {
      Face face;
      for (const int corner : corners)
        face.push_back(nodes.at(corner));
      std::sort(face.begin(), face.end());
      return face;
    }

    Element parse_element(const std::string &line)
    {
      Element element{line, 0, 0, {}};
      std::istringstream words(line);
      int number = 0, n_tags = 0, ignored = 0, node = 0;
      words >> number >> element.type >> n_tags >> element.name;
      for (int i = 1; i < n_tags; ++i)
        words >> ignored;
      while (words >> node)
        element.nodes.push_back(node);
      return element;
    }

    /** A file of format 2.2 in its parts: what stands before the elements and after them stays text. */
    struct Parts
    {
      std::string head, tail;
      std::map<int, std::array<double, 3>> nodes;
      std::vector<Element> elements;
      bool is_legacy = false; ///< format 2.2
    };

    void take_line(const std::string &section, const std::string &line, Parts &parts)
    {
      std::istringstream words(line);
      double version = 0.;
      int number = 0;
      std::array<double, 3> place{};
      if (section == "$MeshFormat" && words >> version)
        parts.is_legacy = version < 3.;
      else if (section == "$Nodes" && words >> number >> place[0] >> place[1] >> place[2])
        parts.nodes[number] = place;
    }

    Parts split_file(const std::string &file)
    {
      std::ifstream stream(file);
      Parts parts;
      std::string section;
      for (std::string line; std::getline(stream, line);)
        {
          if (line.starts_with("$"))
            section = line.starts_with("$End") ? "" : line;
          if (section == "$Elements" && parts.is_legacy && !line.starts_with("$"))
            {
              if (const Element element = parse_element(line); !element.nodes.empty()) // not their count
                parts.elements.push_back(element);
              continue;
            }
          take_line(section, line, parts);
          const bool is_head = parts.elements.empty();
          if (!(parts.is_legacy && line.starts_with("$Elements")))
            (is_head ? parts.head : parts.tail) += line + "\n";
        }
      return parts;
    }

    std::map<Face, unsigned int> count_cells(const std::vector<Element> &elements, int dimension)
    {
      const int type = dimension == 2 ? type_of_quadrilateral : type_of_hexahedron;
      std::map<Face, unsigned int> n_cells;
      for (const Element &element : elements)
        if (element.type == type)
          for (const auto &corners : dimension == 2 ? faces_of_quadrilateral : faces_of_hexahedron)
            ++n_cells[make_face(element.nodes, corners)];
      return n_cells;
    }

    std::array<double, 3> compute_centre(const std::string &file, const Parts &parts, const Element &element)
    {
      std::array<double, 3> centre{};
      for (const int node : element.nodes)
        {
          const auto place = parts.nodes.find(node);
          if (place == parts.nodes.end())
            throw std::runtime_error(fmt::format("{}: node {} of element '{}' is missing", file, node, element.line));
          for (int axis = 0; axis < 3; ++axis)
            centre[axis] += place->second[axis] / static_cast<double>(element.nodes.size());
        }
      return centre;
    }
  } // namespace

  NamedInterfaces read_interfaces(const std::string &file, int dimension)
  {
    const Parts parts = split_file(file);
    NamedInterfaces found;
    const auto n_cells = count_cells(parts.elements, dimension);
    const int face_type = dimension == 2 ? type_of_line : type_of_quadrilateral;
    std::string kept;
    std::size_t n_kept = 0;
    for (const Element &element : parts.elements)
      {
        Face face = element.nodes;
        std::sort(face.begin(), face.end());
        const auto count = n_cells.find(face);
        if (element.type == face_type && count != n_cells.end() && count->second == 2)
          {
            found.centres[element.name].push_back(compute_centre(file, parts, element));
            continue;
          }
        kept += element.line + "\n";
        ++n_kept;
      }
    found.text = parts.head;
    if (parts.is_legacy)
      found.text += fmt::format("$Elements\n{}\n{}", n_kept, kept);
    found.text += parts.tail;
    return found;
  }

  std::map<std::string, unsigned int> read_physical_names(const std::string &file, int dimension)
  {
    std::ifstream stream(file);
    if (!stream)
      throw std::runtime_error(fmt::format("{}: cannot be opened", file));
    std::map<std::string, unsigned int> names;
    std::string line;
    bool is_inside = false;
    for (unsigned int number = 1; std::getline(stream, line); ++number)
      {
        if (line.starts_with("$PhysicalNames"))
          {
            is_inside = true;
            std::getline(stream, line); // their count
            ++number;
          }
        else if (line.starts_with("$EndPhysicalNames"))
          return names;
        else if (is_inside)
          {
            int entity = 0, id = 0;
            const std::size_t first = line.find('"'), last = line.rfind('"');
            if (!(std::istringstream(line) >> entity >> id) || first == last)
              throw std::runtime_error(fmt::format("{}:{}: expected: dimension number \"name\"", file, number));
            if (entity == dimension)
              names[line.substr(first + 1, last - first - 1)] = id;
          }
      }
    if (is_inside)
      throw std::runtime_error(fmt::format("{}: ends inside $PhysicalNames", file));
    return names;
  }
} // namespace fem
