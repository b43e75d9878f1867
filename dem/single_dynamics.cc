#include "dem/single_dynamics.h"

#include "dem/block_shares.h"
#include "dem/incoming.h"
#include "dem/memory.h"
#include "dem/single_pair_loop.h"

#include <algorithm>

namespace dem
{
  namespace
  {
    /** The far pairs of a block, which come first, or its near ones. */
    template <bool is_rough, bool is_rotation_free, bool is_upright>
    ContactSums compute_pairs(const SingleTask &task, const GrainBlock &block, const SingleGrains &grains,
                              std::vector<SinglePack> &packs, const SinglePairResults &results, const bool is_far)
    {
      SinglePairLoop<is_rough, is_rotation_free, is_upright> loop(task, grains, packs, results);
      if (!is_far)
        loop.run_near(block);
      else
        {
          std::fill(results.forces + block.grain_begin, results.forces + block.grain_end, TwinRow{});
          loop.run_far(block);
        }
      return loop.finish();
    }

    using Compute = ContactSums (*)(const SingleTask &, const GrainBlock &, const SingleGrains &,
                                    std::vector<SinglePack> &, const SinglePairResults &, bool);

    /** The loop for what is known of it, question by question. */
    template <bool... answers, typename... Questions>
    Compute choose(const bool is_so, const Questions... others)
    {
      if constexpr (sizeof...(others) == 0)
        return is_so ? compute_pairs<answers..., true> : compute_pairs<answers..., false>;
      else
        return is_so ? choose<answers..., true>(others...) : choose<answers..., false>(others...);
    }

    Row to_double(const SingleRow &row)
    {
      return {row.x, row.y, row.z, row.w};
    }
  } // namespace

  /** What is to be done with the blocks of a network in one cycle. */
  class SingleDynamics::Run
  {
  public:
    Run(SingleDynamics &dynamics, const ForceTask &task, ContactNetwork &network, Forces &forces, const Hook &hook)
        : dynamics_(dynamics), task_(make_single_task(task, network)), network_(network), forces_(forces), hook_(hook),
          compute_(choose(task.law.roughness > 0., task.motion.is_rotation_free, task_.is_upright))
    {}

    void compute_far(const std::size_t k) const { compute_far(k, dynamics_.force_.data()); }

    /** The pairs of block k, and all of it once all that reach into it have been computed. */
    void compute(const std::size_t k, const std::size_t thread, const bool has_far, const bool is_complete) const
    {
      const bool is_passing = is_complete && !has_far && hook_;
      TwinRow *const rows = is_passing ? get_passing_rows(k, thread) : dynamics_.force_.data();
      if (!has_far)
        compute_far(k, rows);
      add_to(forces_.block_sums[k], compute_pairs(k, rows, false));
      if (is_complete)
        finish(k, rows);
    }

    /** @pre all pairs that reach into block k have been computed */
    void complete(const std::size_t k) const { finish(k, dynamics_.force_.data()); }

  private:
    ContactSums compute_pairs(const std::size_t k, TwinRow *const rows, const bool is_far) const
    {
      const SinglePairResults results{rows, dynamics_.far_force_.data(), network_.status.data(),
                                      forces_.normal_force.data(), forces_.overlap.data()};
      return compute_(task_, network_.blocks[k], dynamics_.grains_, dynamics_.packs_, results, is_far);
    }

    void compute_far(const std::size_t k, TwinRow *const rows) const
    {
      forces_.block_sums[k] = compute_pairs(k, rows, true);
    }

    TwinRow *get_passing_rows(const std::size_t k, const std::size_t thread) const
    {
      return shift_rows(dynamics_.passing_force_.data() + thread * count_largest_block(network_),
                        network_.blocks[k].grain_begin);
    }

    /** Gives the grains of block k what far pairs of other blocks do to them. */
    void finish(const std::size_t k, TwinRow *const rows) const
    {
      const GrainBlock &block = network_.blocks[k];
      take_incoming(network_, block, dynamics_.far_force_.data(), rows);
      if (task_.has_sums)
        sum_stiffness(block, rows, forces_.block_sums[k]);
      if (hook_)
        hook_(k, rows);
    }

    /** Grain by grain: the sums must not depend on which pairs share a vector. */
    static void sum_stiffness(const GrainBlock &block, const TwinRow *const rows, ContactSums &sums)
    {
      sums.stiffness = sums.turning_stiffness = 0.;
      for (std::size_t i = block.grain_begin; i < block.grain_end; ++i)
        {
          sums.stiffness += rows[i].linear.w;
          sums.turning_stiffness += rows[i].angular.w;
        }
    }

    SingleDynamics &dynamics_;
    const SingleTask task_;
    ContactNetwork &network_;
    Forces &forces_;
    const Hook &hook_;
    const Compute compute_;
  };

  void SingleDynamics::load(const RevState &state, const ContactNetwork &network, Team &team,
                            const PassedGrains &passed)
  {
    grains_.load(state.grains, passed.size());
    passed.copy_all(grains_.counts.data());
    passed.copy_all(grains_.motion.data());
    build_packs(network, state, team, packs_);
    force_.resize(state.grains.size());
    far_force_.resize(network.n_far);
  }

  ContactSums SingleDynamics::compute_forces(const ForceTask &task, ContactNetwork &network, Forces &forces, Team &team,
                                             const Hook &is_complete)
  {
    passing_force_.resize(team.size() * count_largest_block(network));
    forces.block_sums.resize(network.blocks.size());
    if (task.motion.has_contact_stress)
      {
        forces.normal_force.resize(network.size());
        forces.overlap.resize(network.size());
      }
    const Run run(*this, task, network, forces, is_complete);
    share_blocks(network, team,
                 {[&run](const std::size_t k) { run.compute_far(k); },
                  [&run](const std::size_t k, const std::size_t thread, const bool has_far, const bool is_all) {
                    run.compute(k, thread, has_far, is_all);
                  },
                  [&run](const std::size_t k) { run.complete(k); }});
    if (task.motion.has_contact_stress)
      update_largest_stress(network, task.state.grains, forces);
    return add_up(forces.block_sums);
  }

  double SingleDynamics::move(const GrainBlock &block, const SingleMotionTask &task)
  {
    return advance_singles(grains_, block.grain_begin, block.grain_end, task);
  }

  void SingleDynamics::write_forces(Forces &forces) const
  {
    forces.on_grains.resize(force_.size(), true);
    for (std::size_t i = 0; i < force_.size(); ++i)
      {
        forces.on_grains.force(i) = to_double(force_[i].linear);
        forces.on_grains.torque(i) = to_double(force_[i].angular);
      }
  }

  std::size_t SingleDynamics::count_bytes() const
  {
    return dem::count_bytes(grains_.counts, grains_.motion, packs_, force_, far_force_, passing_force_);
  }
} // namespace dem
