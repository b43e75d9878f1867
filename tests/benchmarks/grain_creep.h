#pragma once

#include "tests/benchmarks/grain_loop.h"

#include "dem/ageing.h"
#include "dem/breakage.h"
#include "dem/equilibrium.h"

#include <map>
#include <optional>
#include <stdexcept>
#include <string>

namespace benchmarks
{
  struct CreepRule
  {
    dem::ContactLaw law;
    double pressure = 21.7e6;  ///< isotropic, held [Pa], compression-positive
    double skin = 0.;          ///< of the network [m]
    double duration = 1e4;     ///< [s]
    dem::EquilibriumRule rest; ///< when the next batch may be chosen
  };

  /** The stress servo of dem::bring_to_rest on three axes, on the loop of these places. */
  template <typename Places>
  dem::RevState relax(dem::RevState state, const CreepRule &rule)
  {
    std::optional<GrainLoop<Places>> loop;
    for (std::size_t cycle = 0; cycle <= rule.rest.cycle_cap; ++cycle)
      {
        const bool is_checked = cycle % 10 == 0;
        if (!loop || (is_checked && loop->compute_used_share_of_skin() > 0.5))
          {
            if (loop)
              state = loop->store();
            loop.emplace(state, rule.law, dem::MotionRule{}, rule.skin, 1.);
          }
        loop->compute_forces();
        const dem::Vector error = -loop->compute_stress().diagonal().array() - rule.pressure;
        if (is_checked && loop->compute_unbalanced_ratio() < rule.rest.unbalanced_ratio &&
            error.cwiseAbs().maxCoeff() <= rule.rest.stress_tolerance * rule.pressure)
          return loop->store();
        const double bound = rule.rest.strain_per_cycle;
        const dem::Vector strain = rule.rest.servo_gain / loop->compute_stiffness() * error;
        loop->advance(strain.cwiseMax(-bound).cwiseMin(bound).asDiagonal());
      }
    throw std::runtime_error(std::string("creep: ") + dem::describe(dem::RestStatus::cap_reached));
  }

  /** Splits what is overstressed; if nothing is, the grains whose time comes first. @return time that passes [s] */
  inline double split_next(dem::RevState &state, const CreepRule &rule, const dem::RevIdentity &identity,
                           const double longest)
  {
    const dem::FractureRule fracture;
    const std::vector<dem::Contact> contacts = dem::list_contacts(state, rule.law);
    const std::size_t limit = dem::compute_batch_limit(fracture, state.grains.size());
    dem::update_crack_velocities(state.grains, contacts, fracture);
    std::vector<std::size_t> places = dem::list_overstressed(state.grains, fracture);
    double passed = 0.;
    if (places.empty())
      {
        passed = std::min(longest, dem::compute_time_to_batch(state.grains, limit));
        places = dem::advance_cracks(state.grains, passed);
      }
    places.resize(std::min(places.size(), limit));
    dem::split_grains(state, places, contacts, fracture, identity);
    return passed;
  }

  /**
   * Creep at a held isotropic pressure: the next batch splits, the grains come to rest, and so on.
   *
   * @return volumetric compression [-] over time [s], after each batch
   */
  template <typename Places>
  std::map<double, double> creep(dem::RevState state, const CreepRule &rule, const dem::RevIdentity &identity)
  {
    dem::draw_strengths(state.grains, dem::FractureRule{}, identity);
    state.cell.deformation.setIdentity();
    std::map<double, double> strain;
    double time = 0.;
    while (time < rule.duration)
      {
        state = relax<Places>(state, rule);
        strain[time] = -std::log(state.cell.deformation.determinant());
        time += split_next(state, rule, identity, rule.duration - time);
      }
    return strain;
  }
} // namespace benchmarks
