#pragma once

#include "dem/laboratory.h"
#include "dem/packing.h"
#include "dem/rev.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace dem::cases
{
  inline constexpr double radius = 0.1e-3; ///< of hand-made grains [m]

  /** Small enough for seconds, wide enough for the grading's largest grain after compression. */
  inline constexpr std::size_t n_grains = 80;

  inline PackingRule make_packing_rule()
  {
    PackingRule rule;
    rule.n_grains = n_grains;
    rule.friction = 0.08;
    rule.seed = 3;
    return rule;
  }

  /** A packing at 100 kPa, made once per program. */
  inline const Packing &get_packing()
  {
    static const Packing packing = generate_packing(make_packing_rule(), GrainMaterial{}, DynamicsRule{});
    return packing;
  }

  /** 200 grains between walls at 100 kPa, made once per program. */
  inline const Packing &get_walled_packing()
  {
    static const Packing packing = [] {
      PackingRule rule = make_packing_rule();
      rule.n_grains = 200;
      rule.cell_kind = CellKind::rigid;
      return generate_packing(rule, GrainMaterial{}, DynamicsRule{});
    }();
    return packing;
  }

  inline RestRule make_rest_rule(const RevModel &model = RevModel{})
  {
    return {make_contact_law(model.material), model.dynamics, model.equilibrium};
  }

  /** zz held at a stress, compression-positive [Pa], no lateral strain. */
  inline CellControl make_oedometer(const double axial_stress)
  {
    CellControl control;
    control.is_stress_controlled[2] = true;
    control.target_stress(2, 2) = -axial_stress;
    return control;
  }

  /** The packing in an oedometer at 10 MPa with nothing broken: the first grains to break would be a few. */
  inline const RevState &get_loaded_state()
  {
    static const RevState state = [] {
      Rev rev = make_rev(RevModel{}, get_packing().state);
      for (const double stress : {0.3e6, 1e6, 3e6, 10e6})
        {
          rev.control(make_oedometer(stress));
          rev.accept();
        }
      return rev.get_baseline();
    }();
    return state;
  }

  /** The same bytes, hence the same bits of all that the future depends on. */
  inline bool are_equal_bits(const RevState &first, const RevState &second)
  {
    return serialise(first) == serialise(second);
  }

  /** Grains of one radius at given places [m] of a cube, true masses set, at rest. */
  inline RevState make_state(const std::vector<Vector> &places, const double edge)
  {
    RevState state;
    state.cell.edges = edge * Matrix::Identity();
    state.resize_grains(places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
      {
        state.grains.place[i] = {places[i].x() / edge, places[i].y() / edge, places[i].z() / edge, radius};
        state.grains.id[i] = state.grains.parent[i] = i;
      }
    state.counters.next_id = places.size();
    state.initial_solid_volume = compute_solid_volume(state.grains);
    update_true_masses(state.grains, 2650.);
    return state;
  }

  /** Two grains that overlap by d [m] along a unit vector, in the middle of a wide cube. */
  inline RevState make_pair(const double overlap, const Vector &direction)
  {
    const double edge = 16. * radius;
    const Vector middle = Vector::Constant(0.5 * edge);
    const Vector half = (radius - 0.5 * overlap) * direction;
    return make_state({middle - half, middle + half}, edge);
  }

  /** Three grains in a periodic column along z, each contact overlapping by d [m]. */
  inline RevState make_column(const double overlap)
  {
    const double height = 3. * (2. * radius - overlap);
    RevState state = make_state({Vector::Zero(), Vector::Zero(), Vector::Zero()}, 6. * radius);
    state.cell.edges(2, 2) = height;
    for (int i = 0; i < 3; ++i)
      state.grains.place[i] = {0.5, 0.5, (i + 0.5) / 3., radius};
    return state;
  }
} // namespace dem::cases
