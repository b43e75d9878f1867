#include "dem/dynamics.h"

#include "dem/memory.h"
#include "dem/single_dynamics.h"
#include "dem/stopwatch.h"
#include "dem/wall_contacts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

namespace dem
{
  namespace
  {
    double compute_mean_radius(const Grains &grains)
    {
      double sum = 0.;
      for (const Row &place : grains.place)
        sum += place.w;
      return sum / static_cast<double>(std::max<std::size_t>(1, grains.size()));
    }

    /** Chooses the basis of the lattice that is closest to upright; the grains stay where they are. */
    void reduce_lattice(RevState &state)
    {
      const Matrix change = compute_reduction(state.cell);
      if (change == Matrix::Identity())
        return;
      state.cell.edges = (state.cell.edges * change).eval();
      const Matrix inverse = change.inverse().array().round().matrix();
      for (Row &place : state.grains.place)
        {
          const Vector fraction = inverse * to_vector(place);
          place = {fraction.x(), fraction.y(), fraction.z(), place.w};
        }
    }

    void take_velocities_away(Grains &grains)
    {
      for (Row &velocity : grains.velocity)
        velocity.x = velocity.y = velocity.z = 0.;
      for (Row &spin : grains.spin)
        spin.x = spin.y = spin.z = 0.;
    }
  } // namespace

  Dynamics::Dynamics(RevState &state, const ContactLaw &law, const DynamicsRule &rule)
      : state_(state), law_(law), rule_(rule), team_(rule.n_threads)
  {
    motion_.is_rotation_free = rule.motion.is_rotation_free;
    motion_.has_contact_stress = rule.has_contact_stress;
    if (rule.precision == Precision::single)
      {
        if (state.cell.has_walls())
          throw std::invalid_argument("a REV between rigid walls moves in double precision only");
        single_ = std::make_unique<SingleDynamics>();
      }
    if (!rule.motion.has_true_masses)
      take_velocities_away(state_.grains);
    rebuild();
  }

  Dynamics::~Dynamics() = default;

  void Dynamics::rebuild()
  {
    motion_.time_step = 0.;
    motion_.strain_increment.setZero();
    has_masses_ = false;
    // Crushing leaves siblings at the end of the store. A REV of one block lies in the nearest cache in any order.
    if (state_.grains.size() > undivided_grains)
      {
        const Stopwatch watch(profile_[Part::search]);
        sort_in_space(state_);
      }
    skins_.set_alike(state_.grains, rule_.skin_share * compute_mean_radius(state_.grains));
    build_network();
  }

  void Dynamics::build_network()
  {
    const Stopwatch watch(profile_[Part::search]);
    reduce_lattice(state_);
    if (single_)
      round_places(state_.grains);
    is_wide_enough_ = dem::is_wide_enough(state_.cell, compute_reach(state_.grains, skins_.get_usual()));
    if (!is_wide_enough_)
      {
        passed_ = PassedGrains(); // of other grains
        return;
      }
    builder_.build(state_, skins_.get_values(), team_, network_);
    skins_.begin(network_);
    passed_.list(network_, team_);
    state_.reserve_grains(state_.grains.size() + passed_.size());
    pass_grains();
    if (single_)
      single_->load(state_, network_, team_, passed_);
  }

  void Dynamics::pass_grains()
  {
    passed_.copy_all(state_.grains.place.data());
    passed_.copy_all(state_.grains.velocity.data());
    passed_.copy_all(state_.grains.spin.data());
  }

  void Dynamics::update_network()
  {
    if (!is_wide_enough_ || !is_network_due())
      return;
    if (single_)
      single_->write_grains(network_, state_.grains);
    skins_.adapt(network_, state_.cell, state_.grains);
    store_contacts();
    build_network();
  }

  /** Bounds are cheap; grains are looked at only where those say that it might matter. Where places are no numbers
   *  nothing is looked for: is_finite() tells. */
  bool Dynamics::is_network_due()
  {
    bool is_due = false;
    for (std::size_t k = 0; k < network_.blocks.size(); ++k)
      if (skins_.is_in_doubt(k))
        {
          if (single_)
            single_->write_block(network_, network_.blocks[k], state_.grains);
          is_due |= skins_.look(k, network_, state_.cell, state_.grains);
        }
    return is_due;
  }

  void Dynamics::compute_forces()
  {
    update_network();
    if (!is_wide_enough_)
      return;
    const Stopwatch watch(profile_[Part::forces]);
    const ForceTask task{state_, law_, motion_};
    if (single_)
      {
        sums_ = single_->compute_forces(task, network_, forces_, team_);
        single_->write_forces(forces_);
        single_->write_grains(network_, state_.grains);
      }
    else
      sums_ = compute_contact_forces(task, network_, forces_, team_);
    if (state_.cell.has_walls())
      add_wall_forces(task, network_, forces_, sums_);
    if (!has_masses_)
      refresh_masses();
  }

  void Dynamics::refresh_masses()
  {
    update_kinetics(kinetics_, rule_.motion, state_.grains, forces_, sums_);
    has_masses_ = true;
  }

  void Dynamics::move_block(const std::size_t k, const ForceRows &rows)
  {
    const GrainBlock &block = network_.blocks[k];
    block_steps_[k] =
        advance_grains(state_.grains, block.grain_begin, block.grain_end, {state_.cell, rows, kinetics_, rule_.motion});
    passed_.copy(k, state_.grains.place.data());
    passed_.copy(k, state_.grains.velocity.data());
    if (rule_.motion.is_rotation_free)
      passed_.copy(k, state_.grains.spin.data());
  }

  void Dynamics::move_block(const std::size_t k, const TwinRow *const forces)
  {
    block_steps_[k] = single_->move(network_.blocks[k], {state_.cell, forces, kinetics_, rule_.motion});
    single_->copy(passed_, k);
  }

  void Dynamics::move()
  {
    const Stopwatch watch(profile_[Part::motion]);
    block_steps_.resize(network_.blocks.size());
    team_.run(network_.blocks.size(), [this](const std::size_t k) {
      single_ ? move_block(k, single_->get_forces()) : move_block(k, forces_.on_grains.get_rows());
    });
  }

  void Dynamics::compute_forces_and_move(const bool has_stress)
  {
    if (!has_masses_ || state_.cell.has_walls()) // walls add their forces once those of all pairs are known
      {
        compute_forces();
        if (is_wide_enough_)
          move();
        return;
      }
    update_network();
    if (!is_wide_enough_)
      return;
    block_steps_.resize(network_.blocks.size());
    motion_.has_sums = has_stress;
    const ForceTask task{state_, law_, motion_};
    const auto move = [this](const std::size_t k, const auto &rows) { move_block(k, rows); };
    sums_ = single_ ? single_->compute_forces(task, network_, forces_, team_, move)
                    : compute_contact_forces(task, network_, forces_, team_, move);
    motion_.has_sums = true;
  }

  void Dynamics::strain(const Matrix &increment)
  {
    skins_.add_cycle(network_, block_steps_, increment.norm());
    assert(!state_.cell.has_walls() || increment.isDiagonal(0.));
    if (!increment.isZero(0.))
      state_.cell.deform(Matrix::Identity() + increment);
    motion_.time_step = kinetics_.time_step;
    motion_.strain_increment = increment;
    ++n_cycles_;
  }

  void Dynamics::store_contacts()
  {
    if (single_)
      single_->write_shear(network_);
    store_memories(network_, team_, state_);
  }

  void Dynamics::store()
  {
    store_contacts();
    if (single_)
      single_->write_grains(network_, state_.grains);
    state_.stress = compute_stress();
    state_.unbalanced_ratio = compute_unbalanced_ratio();
    state_.counters.cycles += n_cycles_;
    n_cycles_ = 0;
    if (!rule_.motion.has_true_masses)
      take_velocities_away(state_.grains);
    if (!state_.cell.has_walls())            // without images a place has one name alone
      for (Row &place : state_.grains.place) // the same grains, but fractions keep their precision
        {
          place.x -= std::floor(place.x);
          place.y -= std::floor(place.y);
          place.z -= std::floor(place.z);
        }
    pass_grains();
  }

  bool Dynamics::is_finite() const
  {
    double sum = state_.cell.edges.sum();
    for (const Row &place : state_.grains.place)
      sum += place.x + place.y + place.z;
    for (const Row &velocity : state_.grains.velocity) // whole counts are always numbers
      sum += velocity.x + velocity.y + velocity.z;
    return std::isfinite(sum);
  }

  std::size_t Dynamics::count_bytes() const
  {
    return network_.count_bytes() + builder_.count_bytes() + passed_.count_bytes() + skins_.count_bytes() +
           (single_ ? single_->count_bytes() : 0) + forces_.count_bytes();
  }

  Matrix Dynamics::compute_stress() const
  {
    return sums_.force_times_branch / state_.cell.compute_volume();
  }

  Matrix Dynamics::compute_servo_stress() const
  {
    Matrix stress = compute_stress();
    if (state_.cell.has_walls())
      stress.diagonal() = compute_wall_stress(state_.cell, sums_.wall_force);
    return stress;
  }

  double Dynamics::compute_unbalanced_ratio() const
  {
    if (sums_.n_touching == 0)
      return 0.;
    return compute_mean_resultant(forces_) / (sums_.normal_force / static_cast<double>(sums_.n_touching));
  }

  double Dynamics::compute_stiffness() const
  {
    return sums_.stiffness_moment / (3. * state_.cell.compute_volume());
  }
} // namespace dem
