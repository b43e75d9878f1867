#pragma once

#include "dem/passed_grains.h"
#include "dem/single_motion.h"

namespace dem
{
  /**
   * The part of a cycle that Dynamics leaves to single precision: grains, pairs and forces as floats, from one network
   * to the next. Of each thing one copy is in force: this one, until `write` tells the double arrays.
   */
  class SingleDynamics
  {
  public:
    /** Takes grains and pairs of a network just built. @pre places are whole counts (round_places) */
    void load(const RevState &state, const ContactNetwork &network, Team &team, const PassedGrains &passed = {});

    /** Called with the number of a block and the forces on its grains once they are complete. */
    using Hook = std::function<void(std::size_t, const TwinRow *)>;

    /** compute_contact_forces in single precision; forces stay here, and with a hook they are not kept. */
    ContactSums compute_forces(const ForceTask &task, ContactNetwork &network, Forces &forces, Team &team,
                               const Hook &is_complete = {});

    /** Moves the grains of a block. @return bound on the way of any of them [m] */
    double move(const GrainBlock &block, const SingleMotionTask &task);

    /** Copies those of a block that have moved. */
    void copy(const PassedGrains &passed, const std::size_t k)
    {
      passed.copy(k, grains_.counts.data());
      passed.copy(k, grains_.motion.data());
    }

    const TwinRow *get_forces() const { return force_.data(); }

    void write_grains(const ContactNetwork &network, Grains &grains) const
    {
      grains_.write(network, 0, grains.size(), grains);
    }
    void write_block(const ContactNetwork &network, const GrainBlock &block, Grains &grains) const
    {
      grains_.write(network, block.grain_begin, block.grain_end, grains);
    }
    void write_forces(Forces &forces) const;
    void write_shear(ContactNetwork &network) const { dem::write_shear(packs_, network); }

    std::size_t count_bytes() const;

  private:
    class Run;

    SingleGrains grains_;
    std::vector<SinglePack> packs_;
    std::vector<TwinRow> force_, far_force_, passing_force_;
  };
} // namespace dem
