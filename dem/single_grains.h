#pragma once

#include "dem/contact_forces.h"
#include "dem/single_pairs.h"

namespace dem
{
  struct SingleMatrix
  {
    float xx, xy, xz, yx, yy, yz, zx, zy, zz;

    explicit SingleMatrix(const Matrix &m);
  };

  /** What forces in single precision follow from, beside grains and pairs. */
  struct SingleTask
  {
    LaneLaw<float> law;
    SingleMatrix edges;  ///< E [m per count]
    SingleMatrix growth; ///< G = (E - E0) E0^-1, what the cell has been strained since the network was built [-]
    SingleMatrix strain; ///< L dt [-]
    bool is_upright;     ///< these three are diagonal: the edges lie along the axes, and stay there
    float time_step;     ///< [s], or 1 cycle
    bool has_contact_stress, has_sums; ///< as in Motion
  };

  SingleTask make_single_task(const ForceTask &task, const ContactNetwork &network);

  /**
   * The grains as the single precision loop has them. A place is a whole number of 2^-32 of an edge: the one when the
   * network was built, which the network keeps, and what has come to it since, which is small.
   */
  struct SingleGrains
  {
    std::vector<CountRow> counts;
    std::vector<TwinRow> motion; ///< linear: velocity [m/s], radius [m]; angular: spin [1/s], moment of inertia [kg m2]

    /** Takes grains whose network has just been built. @param n_copies  room behind them */
    void load(const Grains &grains, std::size_t n_copies = 0);

    /** Tells the double arrays where grains `begin` to `end` are and how they move. */
    void write(const ContactNetwork &network, std::size_t begin, std::size_t end, Grains &grains) const;
  };

  /** Moves grains to the nearest whole count: from then on single precision loses nothing of where they are. */
  void round_places(Grains &grains);
} // namespace dem
