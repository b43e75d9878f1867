#pragma once

#include "dem/dynamics.h"

namespace benchmarks
{
  /** What every DEM code of the comparison is given, beside the packing; tests/benchmarks/systems.py says the same. */
  struct Protocol
  {
    double time_step = 1.2e-8; ///< [s]
    double strain_rate = 20.;  ///< of compression along z [1/s]
    std::size_t n_steps = 1000;
    double warm_up = 1.; ///< of the same work on copies, before the time is taken [s]
    unsigned int n_threads = 1;
    bool is_single = false;       ///< single precision
    bool is_rough = false;        ///< three-stage contacts of the default material; false: plain Hertz-Mindlin
    bool is_rotation_free = true; ///< false: grains cannot turn
  };

  /** What one run of the protocol took and gave. */
  struct Timing
  {
    std::size_t n_grains = 0;
    std::size_t n_contacts = 0; ///< touching pairs at the start
    double seconds = 0.;        ///< of the steps alone, reading and set-up left out [s]
    double cpu_seconds = 0.;    ///< of all threads, likewise [s]
    double time_step = 0.;      ///< used [s]: the protocol's, or at most 0.6 of the critical one where that is less
    double stress_before = 0.;  ///< mean normal stress at the places of the packing [Pa], compression-positive
    double stress_after = 0.;   ///< after the last step [Pa], compression-positive
  };

  /** The material of the comparison: Table 1 of the time-to-fracture paper, smooth or rough. */
  dem::GrainMaterial make_material(bool is_rough);

  /** True masses, no damping, and the time step of the protocol for this packing. */
  dem::DynamicsRule make_rule(const dem::RevState &state, const dem::ContactLaw &law, const Protocol &protocol);

  /** L dt of one step: compression along z alone. */
  dem::Matrix compute_strain_increment(const Protocol &protocol, double time_step);

  /** Strains a packing as the protocol says and takes the time of its steps. */
  Timing run_protocol(dem::RevState state, const Protocol &protocol);
} // namespace benchmarks
