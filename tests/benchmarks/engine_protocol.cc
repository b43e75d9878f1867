#include "tests/benchmarks/engine_protocol.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <stdexcept>

namespace benchmarks
{
  namespace
  {
    double compute_pressure(const dem::Dynamics &dynamics)
    {
      return -dynamics.compute_stress().trace() / 3.;
    }

    std::size_t count_contacts(dem::RevState state, const dem::ContactLaw &law, const dem::DynamicsRule &rule)
    {
      dem::Dynamics dynamics(state, law, rule);
      dynamics.compute_forces();
      dynamics.store();
      return state.contacts.size();
    }
  } // namespace

  dem::GrainMaterial make_material(const bool is_rough)
  {
    dem::GrainMaterial material;
    if (!is_rough)
      material.roughness = 0.;
    return material;
  }

  dem::DynamicsRule make_rule(const dem::RevState &state, const dem::ContactLaw &law, const Protocol &protocol)
  {
    dem::DynamicsRule rule;
    rule.precision = protocol.is_single ? dem::Precision::single : dem::Precision::full;
    rule.motion.has_true_masses = true;
    rule.motion.is_rotation_free = protocol.is_rotation_free;
    // No code is damped: local damping (YADE) and viscous damping (LAMMPS, LIGGGHTS) have nothing in common but zero.
    rule.motion.local_damping = 0.;
    // The time step follows from the contacts' stiffness at the first forces, and stays.
    dem::RevState copy = state;
    dem::Dynamics dynamics(copy, law, rule);
    dynamics.compute_forces();
    const double share = rule.motion.time_step_share * protocol.time_step / dynamics.get_time_step();
    rule.motion.time_step_share = std::min(share, 0.6); // a bound: crushed packings need a smaller step than fresh ones
    rule.skin_share = 0.1;                              // each code has the skin that suits it
    rule.n_threads = protocol.n_threads;
    return rule;
  }

  dem::Matrix compute_strain_increment(const Protocol &protocol, const double time_step)
  {
    dem::Matrix increment = dem::Matrix::Zero();
    increment(2, 2) = -protocol.strain_rate * time_step;
    return increment;
  }

  /** The protocol untimed, on copies, for a while: a core that was idle comes to its full speed after some tenths of a
   * second only, where a virtual machine's host has to find it a place (docs/performance.md). */
  void warm_up(const dem::RevState &state, const dem::ContactLaw &law, const dem::DynamicsRule &rule,
               const Protocol &protocol)
  {
    const auto now = std::chrono::steady_clock::now;
    const auto end = now() + std::chrono::duration<double>(protocol.warm_up);
    while (now() < end)
      {
        dem::RevState copy = state;
        dem::Dynamics dynamics(copy, law, rule);
        for (std::size_t step = 0; step < protocol.n_steps && now() < end; ++step)
          {
            dynamics.compute_forces_and_move(false);
            dynamics.strain(compute_strain_increment(protocol, dynamics.get_time_step()));
          }
      }
  }

  Timing run_protocol(dem::RevState state, const Protocol &protocol)
  {
    const dem::ContactLaw law = dem::make_contact_law(make_material(protocol.is_rough));
    dem::update_true_masses(state.grains, dem::MotionRule{}.density);
    const dem::DynamicsRule rule = make_rule(state, law, protocol);

    Timing timing;
    timing.n_grains = state.grains.size();
    timing.n_contacts = count_contacts(state, law, rule);
    warm_up(state, law, rule, protocol);
    dem::Dynamics dynamics(state, law, rule);
    dynamics.compute_forces();
    timing.stress_before = compute_pressure(dynamics);
    timing.time_step = dynamics.get_time_step();
    const dem::Matrix increment = compute_strain_increment(protocol, timing.time_step);
    const std::clock_t cpu_start = std::clock();
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t step = 0; step < protocol.n_steps; ++step)
      {
        step == 0 ? dynamics.move() : dynamics.compute_forces_and_move(false);
        dynamics.strain(increment);
      }
    dynamics.compute_forces();
    timing.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    timing.cpu_seconds = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    timing.stress_after = compute_pressure(dynamics);
    return timing;
  }
} // namespace benchmarks
