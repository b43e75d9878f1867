#include "dem/contact_forces.h"

#include "dem/block_shares.h"
#include "dem/fracture.h"
#include "dem/incoming.h"
#include "dem/memory.h"
#include "dem/pair_loop.h"

#include <algorithm>
#include <limits>

namespace dem
{
  namespace
  {
    /** The far pairs of a block, which come first, or its near ones. */
    template <bool is_rough, bool is_rotation_free>
    ContactSums compute_pairs(const ForceTask &task, const GrainBlock &block, ContactNetwork &network, Forces &forces,
                              const ForceRows &rows, const bool is_far)
    {
      PairLoop<is_rough, is_rotation_free> loop(task, network, forces, rows);
      if (!is_far)
        loop.run_near(block);
      else
        {
          auto *const actions = rows.get<is_rotation_free>();
          std::fill(actions + block.grain_begin, actions + block.grain_end, ActionOf<is_rotation_free>{});
          loop.run_far(block);
        }
      return loop.finish();
    }

    /** Sum of the fourth numbers, grain by grain: it must not depend on which pairs share a vector. */
    template <typename GetRow>
    double sum_stiffness(const GrainBlock &block, const GetRow &get_row)
    {
      RowLanes even{}, odd{};
      std::size_t i = block.grain_begin;
      for (; i + 1 < block.grain_end; i += 2)
        {
          even += load_row(get_row(i));
          odd += load_row(get_row(i + 1));
        }
      if (i < block.grain_end)
        even += load_row(get_row(i));
      return even[3] + odd[3];
    }

    /** What is to be done with the blocks of a network, in an order that threads agree upon. */
    class BlockRun
    {
    public:
      BlockRun(const ForceTask &task, ContactNetwork &network, Forces &forces, const BlockHook &is_complete)
          : task_(task), network_(network), forces_(forces), is_complete_(is_complete)
      {}

      void compute_far(const std::size_t k) const { compute_far(k, forces_.on_grains.get_rows()); }

      /** The pairs of block k, and all of it once all that reach into it have been computed. */
      void compute(const std::size_t k, const std::size_t thread, const bool has_far, const bool is_complete) const
      {
        const bool is_passing = is_complete && !has_far && is_complete_;
        const ForceRows rows = is_passing ? get_passing_rows(k, thread) : forces_.on_grains.get_rows();
        if (!has_far)
          compute_far(k, rows);
        add_to(forces_.block_sums[k], compute_(task_, network_.blocks[k], network_, forces_, rows, false));
        if (is_complete)
          finish(k, rows);
      }

      /** @pre all pairs that reach into block k have been computed */
      void complete(const std::size_t k) const { finish(k, forces_.on_grains.get_rows()); }

    private:
      using Compute = ContactSums (*)(const ForceTask &, const GrainBlock &, ContactNetwork &, Forces &,
                                      const ForceRows &, bool);

      static Compute choose(const bool is_rough, const bool is_rotation_free)
      {
        if (is_rough)
          return is_rotation_free ? compute_pairs<true, true> : compute_pairs<true, false>;
        return is_rotation_free ? compute_pairs<false, true> : compute_pairs<false, false>;
      }

      void compute_far(const std::size_t k, const ForceRows &rows) const
      {
        forces_.block_sums[k] = compute_(task_, network_.blocks[k], network_, forces_, rows, true);
      }

      ForceRows get_passing_rows(const std::size_t k, const std::size_t thread) const
      {
        return forces_.passing.get_rows(thread * count_largest_block(network_), network_.blocks[k].grain_begin);
      }

      /** Block k has all that its own and other blocks' pairs do to it. */
      void finish(const std::size_t k, const ForceRows &rows) const
      {
        const GrainBlock &block = network_.blocks[k];
        const ForceRows of_far = forces_.of_far.get_rows();
        task_.motion.is_rotation_free ? take_incoming(network_, block, of_far.get<true>(), rows.get<true>())
                                      : take_incoming(network_, block, of_far.get<false>(), rows.get<false>());
        if (task_.motion.has_sums)
          {
            forces_.block_sums[k].stiffness =
                sum_stiffness(block, [&](const std::size_t i) -> Row & { return rows.force(i); });
            if (task_.motion.is_rotation_free)
              forces_.block_sums[k].turning_stiffness =
                  sum_stiffness(block, [&](const std::size_t i) -> Row & { return rows.torque(i); });
          }
        if (is_complete_)
          is_complete_(k, rows);
      }

      const ForceTask &task_;
      ContactNetwork &network_;
      Forces &forces_;
      const BlockHook &is_complete_;
      const Compute compute_ = choose(task_.law.roughness > 0., task_.motion.is_rotation_free);
    };

    void make_room(const ForceTask &task, const ContactNetwork &network, const std::size_t n_threads, Forces &forces)
    {
      forces.on_grains.resize(task.state.grains.size(), task.motion.is_rotation_free);
      forces.of_far.resize(network.n_far, task.motion.is_rotation_free);
      forces.passing.resize(n_threads * count_largest_block(network), task.motion.is_rotation_free);
      if (task.motion.has_contact_stress)
        {
          forces.normal_force.resize(network.size());
          forces.overlap.resize(network.size());
        }
      forces.block_sums.resize(network.blocks.size());
    }
  } // namespace

  std::size_t Forces::count_bytes() const
  {
    return on_grains.count_bytes() + of_far.count_bytes() + passing.count_bytes() +
           dem::count_bytes(largest_stress, normal_force, overlap, block_sums);
  }

  ContactSums get_unknown_sums()
  {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    ContactSums sums;
    sums.force_times_branch.setConstant(unknown);
    sums.normal_force = sums.stiffness = sums.turning_stiffness = sums.stiffness_moment = unknown;
    return sums;
  }

  void add_to(ContactSums &sums, const ContactSums &part)
  {
    sums.force_times_branch += part.force_times_branch;
    sums.normal_force += part.normal_force;
    sums.stiffness += part.stiffness;
    sums.turning_stiffness += part.turning_stiffness;
    sums.stiffness_moment += part.stiffness_moment;
    sums.n_touching += part.n_touching;
  }

  ContactSums add_up(const std::vector<ContactSums> &parts)
  {
    ContactSums sums;
    for (const ContactSums &part : parts)
      add_to(sums, part);
    return sums;
  }

  void update_largest_stress(const ContactNetwork &network, const Grains &grains, Forces &forces)
  {
    forces.largest_stress.assign(grains.size(), 0.);
    for (std::size_t k = 0; k < network.size(); ++k)
      if (network.status[k] != PairStatus::is_apart)
        {
          const std::uint32_t a = network.a[k], b = network.b[k];
          const double radius = compute_effective_radius(grains.place[a].w, grains.place[b].w);
          const double stress = compute_contact_stress(forces.normal_force[k], radius, forces.overlap[k]);
          forces.largest_stress[a] = std::max(forces.largest_stress[a], stress);
          forces.largest_stress[b] = std::max(forces.largest_stress[b], stress);
        }
  }

  ContactSums compute_contact_forces(const ForceTask &task, ContactNetwork &network, Forces &forces, Team &team,
                                     const BlockHook &is_complete)
  {
    make_room(task, network, team.size(), forces);
    const BlockRun run(task, network, forces, is_complete);
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

  ContactSums compute_contact_forces(const RevState &state, const ContactLaw &law, const Motion &motion,
                                     ContactNetwork &network, Forces &forces)
  {
    Team alone(1);
    return compute_contact_forces({state, law, motion}, network, forces, alone);
  }
} // namespace dem
