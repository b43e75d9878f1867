#include "dem/contact_forces.h"

#include "dem/fracture.h"
#include "dem/pair_loop.h"

#include <algorithm>

namespace dem
{
  namespace
  {
    template <bool is_rough, bool is_rotation_free>
    ContactSums compute_block(const ForceTask &task, const GrainBlock &block, ContactNetwork &network, Forces &forces)
    {
      std::fill(forces.force.begin() + block.grain_begin, forces.force.begin() + block.grain_end, Row{});
      if constexpr (is_rotation_free)
        std::fill(forces.torque.begin() + block.grain_begin, forces.torque.begin() + block.grain_end, Row{});
      PairLoop<is_rough, is_rotation_free> loop(task, network, forces);
      loop.run_near(block);
      loop.run_far(block);
      return loop.finish();
    }

    void take_incoming(const GrainBlock &block, const ContactNetwork &network, const std::vector<Row> &far,
                       std::vector<Row> &rows)
    {
      for (std::size_t k = block.incoming_begin; k < block.incoming_end; ++k)
        {
          Row &row = rows[network.incoming_grain[k]];
          store_row(row, load_row(row) + load_row(far[network.incoming_far[k]]));
        }
    }

    /** Sum of the fourth numbers, grain by grain: it must not depend on which pairs share a vector. */
    double sum_stiffness(const std::vector<Row> &rows, const GrainBlock &block)
    {
      RowLanes even{}, odd{};
      std::size_t i = block.grain_begin;
      for (; i + 1 < block.grain_end; i += 2)
        {
          even += load_row(rows[i]);
          odd += load_row(rows[i + 1]);
        }
      if (i < block.grain_end)
        even += load_row(rows[i]);
      return even[3] + odd[3];
    }

    /** What is to be done with the blocks of a network, in an order that threads agree upon. */
    class BlockRun
    {
    public:
      BlockRun(const ForceTask &task, ContactNetwork &network, Forces &forces, const BlockHook &is_complete)
          : task_(task), network_(network), forces_(forces), is_complete_(is_complete)
      {}

      /** The pairs of block k. */
      void compute(const std::size_t k) const
      {
        forces_.block_sums[k] = compute_(task_, network_.blocks[k], network_, forces_);
      }

      /** Gives the grains of block k what far pairs of other blocks do to them. @pre those have been computed */
      void finish(const std::size_t k) const
      {
        const GrainBlock &block = network_.blocks[k];
        take_incoming(block, network_, forces_.far_force, forces_.force);
        forces_.block_sums[k].stiffness = sum_stiffness(forces_.force, block);
        if (task_.motion.is_rotation_free)
          {
            take_incoming(block, network_, forces_.far_torque, forces_.torque);
            forces_.block_sums[k].turning_stiffness = sum_stiffness(forces_.torque, block);
          }
        if (is_complete_)
          is_complete_(k);
      }

    private:
      using Compute = ContactSums (*)(const ForceTask &, const GrainBlock &, ContactNetwork &, Forces &);

      static Compute choose(const bool is_rough, const bool is_rotation_free)
      {
        if (is_rough)
          return is_rotation_free ? compute_block<true, true> : compute_block<true, false>;
        return is_rotation_free ? compute_block<false, true> : compute_block<false, false>;
      }

      const ForceTask &task_;
      ContactNetwork &network_;
      Forces &forces_;
      const BlockHook &is_complete_;
      const Compute compute_ = choose(task_.law.roughness > 0., task_.motion.is_rotation_free);
    };

    ContactSums add_up(const std::vector<ContactSums> &parts)
    {
      ContactSums sums;
      for (const ContactSums &part : parts)
        {
          sums.force_times_branch += part.force_times_branch;
          sums.normal_force += part.normal_force;
          sums.stiffness += part.stiffness;
          sums.turning_stiffness += part.turning_stiffness;
          sums.stiffness_moment += part.stiffness_moment;
          sums.n_touching += part.n_touching;
        }
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

    void make_room(const ForceTask &task, const ContactNetwork &network, Forces &forces)
    {
      const std::size_t n_grains = task.state.grains.size(), n_far = network.n_far;
      forces.force.resize(n_grains);
      forces.far_force.resize(n_far);
      if (task.motion.is_rotation_free)
        {
          forces.torque.resize(n_grains);
          forces.far_torque.resize(n_far);
        }
      if (task.motion.has_contact_stress)
        {
          forces.normal_force.resize(network.size());
          forces.overlap.resize(network.size());
        }
      forces.block_sums.resize(network.blocks.size());
    }
  } // namespace

  ContactSums compute_contact_forces(const ForceTask &task, ContactNetwork &network, Forces &forces, Team &team,
                                     const BlockHook &is_complete)
  {
    make_room(task, network, forces);
    BlockRun run(task, network, forces, is_complete);
    const std::size_t n_blocks = network.blocks.size(), n_threads = team.size();
    const auto begin = [&](const std::size_t number) { return n_blocks * number / n_threads; };
    // Pairs reach forwards only: a block is complete after its own pairs, unless another thread's reach into it.
    team.run(n_threads, [&](const std::size_t number) {
      for (std::size_t k = begin(number); k < begin(number + 1); ++k)
        {
          run.compute(k);
          if (network.blocks[k].first_source >= begin(number))
            run.finish(k);
        }
    });
    if (n_threads > 1)
      team.run(n_threads, [&](const std::size_t number) {
        for (std::size_t k = begin(number); k < begin(number + 1); ++k)
          if (network.blocks[k].first_source < begin(number))
            run.finish(k);
      });
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
