#include "coupling/initial_state.h"

#include "dem/packing_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace coupling
{
  namespace
  {
    dem::RevState make_packing(const PackingSource &source, const dem::RevModel &model, const unsigned int number)
    {
      if (!source.file.empty())
        return dem::read_packing(source.file);
      dem::PackingRule rule = source.rule;
      rule.number = number;
      const dem::Packing packing = dem::generate_packing(rule, model.material, model.dynamics);
      if (packing.report.status != dem::RestStatus::at_rest)
        throw std::runtime_error(
            fmt::format("packing {}: {}", number, std::string(dem::describe(packing.report.status))));
      if (!packing.report.is_found && rule.friction < 0.) // a friction that is given says what is wanted
        throw std::runtime_error(
            fmt::format("packing {}: void ratio {:.4g} [-] wanted within {:g}, {:.4g} reached in {} "
                        "attempts",
                        number, rule.void_ratio, rule.tolerance, packing.report.void_ratio, packing.report.n_tried));
      return packing.state;
    }

    std::vector<std::byte> broadcast(std::vector<std::byte> bytes, const unsigned int root, MPI_Comm communicator)
    {
      std::uint64_t n_bytes = bytes.size();
      MPI_Bcast(&n_bytes, 1, MPI_UINT64_T, static_cast<int>(root), communicator);
      bytes.resize(n_bytes);
      MPI_Bcast(bytes.data(), static_cast<int>(n_bytes), MPI_BYTE, static_cast<int>(root), communicator);
      return bytes;
    }

    void set_all(dem::CellControl &control, const dem::Matrix &stress)
    {
      control.is_stress_controlled.fill(true);
      control.target_stress = stress;
    }

    void require_rest(const dem::RestReport &report, const dem::Rev &rev)
    {
      if (report.status != dem::RestStatus::at_rest)
        throw std::runtime_error(fmt::format("REV {}: no equilibrium at its initial stress: {}",
                                             rev.get_model().identity.rev, std::string(dem::describe(report.status))));
    }

    /** Holds the stress, splits what it overstresses, and holds it again until nothing is. */
    void hold(dem::Rev &rev, const dem::CellControl &control, const ConsolidationRule &rule)
    {
      for (unsigned int round = 0; round < rule.round_cap; ++round)
        {
          require_rest(rev.control(control), rev);
          rev.accept();
          if (rev.split_overstressed() == 0)
            return;
          require_rest(rev.relax(), rev);
        }
      throw std::runtime_error(
          fmt::format("REV {}: its grains break without end at its initial stress", rev.get_model().identity.rev));
    }

    /** Brings a REV to a stress in increments; its strain, time and rotation count from there.
     *  @param may_break  what is overstressed splits; else nothing does */
    dem::Rev bring_to(dem::Rev rev, const dem::Matrix &stress, const ConsolidationRule &rule, const bool may_break)
    {
      const dem::RevModel model = rev.get_model();
      if (rule.stress_tolerance > 0.)
        {
          dem::RevModel stricter = model;
          stricter.equilibrium.stress_tolerance = rule.stress_tolerance;
          rev = dem::Rev(stricter, rev.get_committed());
        }
      const dem::Matrix start = rev.get_committed().stress;
      const double first = std::max(std::abs(start.trace()), 1e-3 * std::abs(stress.trace()));
      const double growth = std::abs(stress.trace()) / first;
      const int n_increments =
          std::max(1, static_cast<int>(std::ceil(std::abs(std::log(growth) / std::log(rule.stress_ratio)))));
      for (int i = 1; i <= n_increments; ++i)
        {
          // Equal ratios of the mean stress; the tensor goes straight from the packing's to the wanted one.
          const double share = std::abs(growth - 1.) < 1e-6
                                   ? static_cast<double>(i) / n_increments
                                   : (std::pow(growth, static_cast<double>(i) / n_increments) - 1.) / (growth - 1.);
          dem::CellControl control;
          set_all(control, i == n_increments ? stress : dem::Matrix(start + share * (stress - start)));
          if (may_break)
            hold(rev, control, rule);
          else
            {
              require_rest(rev.control(control), rev);
              rev.accept();
            }
        }
      dem::RevState state = rev.get_baseline();
      state.cell.deformation = dem::Matrix::Identity();
      state.rotation = dem::Matrix::Identity();
      state.time = 0.;
      return dem::Rev(model, state);
    }
  } // namespace

  std::vector<dem::RevState> distribute_packings(const RevPool &pool, const PackingSource &source,
                                                 const dem::RevModel &model)
  {
    const std::size_t n_points = pool.get_points().size();
    const bool is_own = source.file.empty() && (source.n_packings == 0 || source.n_packings >= n_points);
    const auto get_number = [&](const fem::PointId id) {
      return static_cast<unsigned int>(is_own                ? pool.get_index(id)
                                       : source.file.empty() ? pool.get_index(id) % source.n_packings
                                                             : 0);
    };
    // A packing is made on the rank where its first point lives; only one that several points share is sent around.
    std::map<unsigned int, std::vector<std::byte>> packings;
    const auto makes = [&](const fem::PointId id) { return is_own || pool.get_index(id) == get_number(id); };
    for (const fem::PointId id : pool.get_local_points())
      if (makes(id))
        packings[get_number(id)] = {};
    pool.for_each_local([&](const fem::PointId id) {
      if (makes(id))
        packings.at(get_number(id)) = dem::serialise(make_packing(source, model, get_number(id)));
    });
    if (!is_own)
      for (unsigned int number = 0; number < (source.file.empty() ? source.n_packings : 1u); ++number)
        packings[number] = broadcast(packings[number], number % pool.get_n_ranks(), pool.get_communicator());
    std::vector<dem::RevState> states;
    for (const fem::PointId id : pool.get_local_points())
      states.push_back(dem::deserialise(packings.at(get_number(id))));
    return states;
  }

  std::vector<dem::Matrix> choose_levels(std::vector<dem::Matrix> stresses, const unsigned int n)
  {
    const auto is_less = [](const dem::Matrix &one, const dem::Matrix &other) { // in mean pressure, else by components
      if (one.trace() != other.trace())
        return one.trace() > other.trace();
      return std::lexicographical_compare(one.data(), one.data() + 9, other.data(), other.data() + 9);
    };
    std::sort(stresses.begin(), stresses.end(), is_less);
    const double first = stresses.front().trace(), ratio = stresses.back().trace() / first;
    std::vector<dem::Matrix> levels;
    for (unsigned int i = 0; i < n; ++i)
      {
        const double wanted = first * std::pow(ratio, n > 1 ? static_cast<double>(i) / (n - 1) : 0.5);
        const auto nearest =
            std::min_element(stresses.begin(), stresses.end(), [&](const auto &one, const auto &other) {
              return std::abs(std::log(one.trace() / wanted)) < std::abs(std::log(other.trace() / wanted));
            });
        if (levels.empty() || levels.back() != *nearest)
          levels.push_back(*nearest);
      }
    return levels;
  }

  std::size_t find_nearest_level(const std::vector<dem::Matrix> &levels, const dem::Matrix &stress)
  {
    const auto nearest = std::min_element(levels.begin(), levels.end(), [&](const auto &one, const auto &other) {
      return (one - stress).norm() < (other - stress).norm();
    });
    return static_cast<std::size_t>(nearest - levels.begin());
  }

  std::vector<dem::RevState> distribute_library(const RevPool &pool, const PackingSource &source,
                                                const dem::RevModel &model, const ConsolidationRule &rule,
                                                const std::vector<dem::Matrix> &stresses)
  {
    std::vector<double> rows;
    for (const dem::Matrix &stress : stresses)
      rows.insert(rows.end(), stress.data(), stress.data() + 9);
    rows = gather_rows(rows, pool.get_communicator());
    std::vector<dem::Matrix> all;
    for (std::size_t at = 0; at < rows.size(); at += 9)
      all.emplace_back(Eigen::Map<const dem::Matrix>(rows.data() + at));
    const std::vector<dem::Matrix> levels = choose_levels(all, source.n_levels);

    std::vector<std::vector<std::vector<std::byte>>> library(source.n_packings); // by packing and level
    pool.agree([&]() {
      for (unsigned int number = pool.get_rank(); number < source.n_packings; number += pool.get_n_ranks())
        {
          dem::Rev rev(model, make_packing(source, model, number));
          for (const dem::Matrix &level : levels)
            {
              rev = bring_to(rev, level, rule, false);
              library[number].push_back(dem::serialise(rev.get_committed()));
            }
        }
    });
    for (unsigned int number = 0; number < source.n_packings; ++number)
      {
        library[number].resize(levels.size());
        for (auto &bytes : library[number])
          bytes = broadcast(bytes, number % pool.get_n_ranks(), pool.get_communicator());
      }
    std::vector<dem::RevState> states;
    for (std::size_t i = 0; i < stresses.size(); ++i)
      states.push_back(dem::deserialise(library[pool.get_index(pool.get_local_points()[i]) % source.n_packings]
                                               [find_nearest_level(levels, stresses[i])]));
    return states;
  }

  dem::Rev consolidate(dem::Rev rev, const dem::Matrix &stress, const ConsolidationRule &rule)
  {
    return bring_to(std::move(rev), stress, rule, true);
  }
} // namespace coupling
