#include "dem/dynamic_computation.h"

#include <cmath>

namespace dem
{
  namespace
  {
    /** Grows the cracks over the time step just passed and replaces the grains whose limit is reached. */
    class Cracking
    {
    public:
      Cracking(RevState &state, const ContactLaw &law, const CrackingRule &rule)
          : state_(state), law_(law), rule_(rule), end_(state.time + rule.clock.interval)
      {}

      CycleVerdict act(Dynamics &dynamics)
      {
        const double step = rule_.clock.scale * dynamics.get_last_step(), left = end_ - state_.time;
        const bool is_over = !(step < left);
        grow(dynamics, is_over ? left : step);
        if (is_over)
          state_.time = end_; // to the last bit, whatever the sum of steps rounds to
        if (std::isinf(rule_.clock.interval))
          return CycleVerdict::may_rest;
        if (!is_over)
          return CycleVerdict::goes_on;
        return rule_.clock.waits_for_rest ? CycleVerdict::may_rest : CycleVerdict::ends;
      }

    private:
      void grow(Dynamics &dynamics, const double dt)
      {
        state_.time += dt;
        const auto broken = grow_cracks(dynamics.get_largest_contact_stress(), dt);
        if (broken.empty())
          return;
        dynamics.store_contacts();
        split_grains(state_, broken, list_contacts_of(state_, broken, law_), rule_.fracture, rule_.identity);
        dynamics.rebuild();
        dynamics.compute_forces();
      }

      std::vector<std::size_t> grow_cracks(const std::vector<double> &contact_stress, const double dt)
      {
        std::vector<std::size_t> broken;
        Grains &grains = state_.grains;
        for (std::size_t i = 0; i < grains.size(); ++i)
          {
            if (!rule_.fracture.is_active || 2. * grains.place[i].w < rule_.fracture.comminution_diameter)
              continue;
            const bool is_instant = contact_stress[i] > grains.strength[i];
            grains.crack_half_length[i] +=
                dt * compute_crack_velocity(rule_.fracture.crack, contact_stress[i], grains.strength[i]);
            const bool is_delayed = grains.crack_half_length[i] > grains.place[i].w;
            if (is_instant || is_delayed)
              {
                broken.push_back(i);
                record_fracture(state_, i, is_instant ? BreakageCause::instant : BreakageCause::delayed);
              }
          }
        return broken;
      }

      RevState &state_;
      const ContactLaw &law_;
      const CrackingRule &rule_;
      const double end_; // of the interval [s]
    };
  } // namespace

  RestReport run_dynamic_computation(RevState &state, const RestRule &rule, const CrackingRule &cracking,
                                     const CellControl &control)
  {
    const double start = state.time;
    Cracking cracks(state, rule.law, cracking);
    RestRule watching = rule;
    watching.dynamics.has_contact_stress = true; // cracks may grow in every cycle
    RestReport report =
        bring_to_rest(state, watching, control, [&](Dynamics &dynamics) { return cracks.act(dynamics); });
    report.duration = state.time - start;
    return report;
  }
} // namespace dem
