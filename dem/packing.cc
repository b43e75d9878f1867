#include "dem/packing.h"

#include <algorithm>
#include <cmath>

namespace dem
{
  namespace
  {
    constexpr double loose_void_ratio = 1.0;   // frictionless or not, no packing of spheres is jammed at it
    constexpr double first_radius_share = 0.5; // grains start this small
    constexpr double growth = 1.02;            // a step
    constexpr int cycles_per_growth = 20;
    constexpr double closing_strain = 5e-5; // of an edge in one cycle
    // Share of the stress error that one cycle takes away: a brisker servo makes other packings, not faster ones alone.
    constexpr double closing_gain = 0.02;

    /** Takes grains so far from the walls that they grow to their radii without touching them. */
    void draw_away_from_walls(RevState &state)
    {
      for (Row &place : state.grains.place)
        {
          const double share = place.w / state.cell.edges(0, 0);
          for (double *const fraction : {&place.x, &place.y, &place.z})
            *fraction = share + (1. - 2. * share) * *fraction;
        }
    }

    /** Grains of the grading at random places of a loose cubic cell, radii still small. */
    RevState scatter_grains(const PackingRule &rule, const std::uint64_t positions)
    {
      const std::uint64_t number = rule.number * 1000 + positions; // positions_cap is far below 1000
      const auto diameters =
          sample_diameters(rule.grading, rule.n_grains, {rule.seed, rule.number, 0, Purpose::diameter});
      RevState state;
      state.resize_grains(rule.n_grains);
      for (std::size_t i = 0; i < rule.n_grains; ++i)
        {
          RandomStream stream({rule.seed, number, i, Purpose::position});
          const double x = stream.draw_uniform(), y = stream.draw_uniform(), z = stream.draw_uniform();
          state.grains.place[i] = {x, y, z, 0.5 * diameters[i]};
        }
      const double edge = std::cbrt((1. + loose_void_ratio) * compute_solid_volume(state.grains));
      state.cell.kind = rule.cell_kind;
      state.cell.edges = edge * Matrix::Identity();
      if (state.cell.has_walls())
        draw_away_from_walls(state);
      sort_in_space(state);
      for (std::size_t i = 0; i < rule.n_grains; ++i)
        state.grains.id[i] = state.grains.parent[i] = i;
      for (Row &place : state.grains.place)
        place.w *= first_radius_share;
      return state;
    }

    void grow_grains(RevState &state, RestRule rule)
    {
      rule.equilibrium.fixed_cycles = cycles_per_growth;
      const int n_steps = static_cast<int>(std::ceil(-std::log(first_radius_share) / std::log(growth)));
      const double factor = std::pow(1. / first_radius_share, 1. / n_steps);
      for (int step = 0; step < n_steps; ++step)
        {
          for (Row &place : state.grains.place)
            place.w *= factor;
          bring_to_rest(state, rule, CellControl{});
        }
    }

    RestReport close_in(RevState &state, RestRule rule, const double pressure)
    {
      rule.equilibrium.strain_per_cycle = closing_strain;
      rule.equilibrium.servo_gain = closing_gain;
      CellControl control;
      control.target_stress = -pressure * Matrix::Identity();
      for (int m = 0; m < 3; ++m)
        control.is_stress_controlled[m] = true;
      return bring_to_rest(state, rule, control);
    }

    Packing make_packing(const PackingRule &rule, GrainMaterial material, const DynamicsRule &dynamics,
                         const std::uint64_t positions)
    {
      const RestRule rest{make_contact_law(material), dynamics, EquilibriumRule{}};
      Packing packing;
      RevState &state = packing.state;
      state = scatter_grains(rule, positions);
      grow_grains(state, rest);
      packing.report.status = close_in(state, rest, rule.pressure).status;
      packing.report.friction = material.friction;
      packing.report.void_ratio = state.cell.compute_volume() / compute_solid_volume(state.grains) - 1.;
      packing.report.n_cycles = state.counters.cycles;
      packing.report.is_found = packing.report.status == RestStatus::at_rest &&
                                std::abs(packing.report.void_ratio - rule.void_ratio) <= rule.tolerance;
      state.initial_solid_volume = compute_solid_volume(state.grains);
      return packing;
    }

    /** Halves the interval of friction until the void ratio is met; the void ratio of one set of positions jumps. */
    Packing search_friction(const PackingRule &rule, const GrainMaterial &material, const DynamicsRule &dynamics,
                            const std::uint64_t positions)
    {
      GrainMaterial trial = material;
      double lower = 0., upper = 0.5;
      trial.friction = 0.08;
      Packing best;
      std::size_t n_cycles = 0;
      unsigned int n_tried = 0;
      while (n_tried < rule.search_cap)
        {
          Packing packing = make_packing(rule, trial, dynamics, positions);
          n_cycles += packing.report.n_cycles;
          ++n_tried;
          const double error = packing.report.void_ratio - rule.void_ratio;
          if (n_tried == 1 || std::abs(error) < std::abs(best.report.void_ratio - rule.void_ratio))
            best = packing;
          if (best.report.is_found)
            break;
          (error > 0. ? upper : lower) = trial.friction;
          trial.friction = 0.5 * (lower + upper);
        }
      best.report.n_tried = n_tried;
      best.report.n_cycles = n_cycles;
      return best;
    }
  } // namespace

  Packing generate_packing(const PackingRule &rule, const GrainMaterial &material, const DynamicsRule &dynamics)
  {
    DynamicsRule generation = dynamics;
    generation.precision = Precision::full; // whatever follows starts from the same packing
    generation.motion.has_true_masses = false;
    if (rule.friction >= 0.)
      {
        GrainMaterial trial = material;
        trial.friction = rule.friction;
        Packing packing = make_packing(rule, trial, generation, 0);
        packing.report.n_tried = 1;
        return packing;
      }
    Packing best;
    for (unsigned int positions = 0; positions < rule.positions_cap; ++positions)
      {
        Packing packing = search_friction(rule, material, generation, positions);
        const unsigned int n_tried = best.report.n_tried + packing.report.n_tried;
        const std::size_t n_cycles = best.report.n_cycles + packing.report.n_cycles;
        if (positions == 0 ||
            std::abs(packing.report.void_ratio - rule.void_ratio) < std::abs(best.report.void_ratio - rule.void_ratio))
          best = packing;
        best.report.n_tried = n_tried;
        best.report.n_cycles = n_cycles;
        if (best.report.is_found)
          break;
      }
    return best;
  }
} // namespace dem
