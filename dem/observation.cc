#include "dem/observation.h"

#include "dem/wall_contacts.h"

namespace dem
{
  Observation observe(const RevState &state, const RevModel &model)
  {
    Observation observation;
    const auto contacts = list_contacts(state, make_contact_law(model.material));
    observation.time = state.time;
    observation.counters = state.counters;
    observation.strain = compute_logarithmic_strain(state.cell.deformation);
    observation.stress = 0.5 * (state.stress + state.stress.transpose());
    observation.wall_stress = compute_wall_stress(state.cell, contacts);
    observation.void_ratio = compute_void_ratio(state);
    observation.void_ratio_with_fines = compute_void_ratio_with_fines(state);
    observation.coordination =
        compute_coordination(contacts, state.grains.size(), model.dynamics.motion.is_rotation_free).all;
    observation.unbalanced_ratio = state.unbalanced_ratio;
    observation.n_grains = state.grains.size();
    return observation;
  }

  const char *describe(const ObservationKind kind)
  {
    switch (kind)
      {
      case ObservationKind::load:
        return "load";
      case ObservationKind::dynamic:
        return "dynamic";
      case ObservationKind::ageing:
        return "ageing";
      case ObservationKind::relaxed:
        return "relaxed";
      case ObservationKind::rupture:
        return "rupture";
      }
    return "unknown";
  }
} // namespace dem
