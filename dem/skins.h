#pragma once

#include "dem/contact_network.h"

#include <span>

namespace dem
{
  /** How much of its skin the grain has used up that has used up most of it. */
  struct SkinUse
  {
    double share = 0.; ///< of its own skin [-]; a pair outside the network may touch once this exceeds one
    double rest = 0.;  ///< smallest that any of the grains has left [m], negative once it is used up
  };

  /** Of grains `begin` to `end`: their way since the network was built, and that of a uniform strain. */
  SkinUse compute_skin_use(const ContactNetwork &network, const Cell &cell, const Grains &grains, std::size_t begin,
                           std::size_t end);

  /**
   * How far each grain may move before the contact network must be built anew, and whether it has.
   *
   * A few grains, siblings of a split that nobody holds mostly, move a thousand times as fast as the others. They are
   * given larger skins of their own, or they would have the network built every ten cycles.
   */
  class Skins
  {
  public:
    /** The same for all. @param skin  of a pair [m]: each grain has half of it */
    void set_alike(const Grains &grains, double skin);

    double get_usual() const { return 2. * usual_; } ///< skin of a pair of grains that are not fast [m]

    /** Lets grains that were fast since the network was built keep the next one longer. No grain reaches farther than
     *  the largest one: boxes of the search, and how wide the cell must be, stay as they are. */
    void adapt(const ContactNetwork &network, const Cell &cell, const Grains &grains);

    std::span<const double> get_values() const { return skins_; } ///< of each grain [m]

    /** Takes up a network built with these skins. */
    void begin(const ContactNetwork &network);

    /** One cycle. @param block_steps  largest step of a grain in each block [m] @param strain  its norm [-] */
    void add_cycle(const ContactNetwork &network, std::span<const double> block_steps, double strain);

    /** True when the bound on what the grains of block k have used calls for a look (a NaN does not). */
    bool is_in_doubt(const std::size_t k) const { return rests_[k] < 0.; }

    /** Looks at the grains of block k, whose places must be known. @return true when a new network is due */
    bool look(std::size_t k, const ContactNetwork &network, const Cell &cell, const Grains &grains);

    std::size_t count_bytes() const; ///< memory that it holds

  private:
    double usual_ = 0.;         ///< skin of grains that are not fast [m]
    std::vector<double> skins_; ///< of each grain [m]
    std::vector<double> ways_;  ///< of each grain with the last network [m], twice: in their order and in another
    std::vector<double> rests_; ///< of each block: bound on what each of its grains has left [m]
    std::size_t n_cycles_ = 0;  ///< with this network
  };
} // namespace dem
