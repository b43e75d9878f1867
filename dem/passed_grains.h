#pragma once

#include "dem/contact_network.h"

namespace dem
{
  /**
   * Copies of the grains that pairs of another thread's blocks reach, kept behind all grains in the arrays of their
   * rows: pairs find them there as they find grains.
   *
   * A core that reads what another one writes takes it out of that one's cache, and the owner has to fetch it back to
   * go on with its own pairs and to move the grain. Between distant cores of a processor this costs more than those
   * pairs do. Of a copy the owner knows nothing but its writing.
   */
  class PassedGrains
  {
  public:
    /** Lists these grains for a network just built, and tells the pairs that reach them where the copies lie. */
    void list(ContactNetwork &network, Team &team);

    /** Of grains, behind which the copies are. @pre list */
    std::size_t size() const { return first_.back(); }

    /** Copies those of block k once they have moved. @param rows  of all grains, and room for copies behind them */
    template <typename R>
    void copy(const std::size_t k, R *const rows) const
    {
      R *to = rows + n_grains_ + first_[k];
      for (const std::uint32_t grain : grains_[k])
        *to++ = rows[grain];
    }

    /** Copies those of all blocks. */
    template <typename R>
    void copy_all(R *const rows) const
    {
      for (std::size_t k = 0; k < grains_.size(); ++k)
        copy(k, rows);
    }

    std::size_t count_bytes() const; ///< memory that it holds

  private:
    void list_block(const ContactNetwork &network, std::size_t k, std::size_t share_begin, std::size_t share_end);
    void redirect(ContactNetwork &network, std::size_t k) const;

    std::size_t n_grains_ = 0;
    std::vector<std::vector<std::uint32_t>> grains_; // of each block, in their order
    std::vector<std::size_t> first_ = {0};           // copy of each block, and their number
  };
} // namespace dem
