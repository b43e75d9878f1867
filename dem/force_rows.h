#pragma once

#include "dem/large_pages.h"
#include "dem/memory.h"
#include "dem/vector.h"

#include <cstdint>
#include <type_traits>

namespace dem
{
  /** What acts on a grain that may turn, in one line of the cache. */
  struct alignas(cache_line) Action
  {
    Row force, torque;
  };

  /** Force and torque, or the force alone of a grain that cannot turn. */
  template <bool is_rotation_free>
  using ActionOf = std::conditional_t<is_rotation_free, Action, Row>;

  /** Rows from `first` on as if they belonged to the grains from `grain` on. */
  template <typename R>
  R *shift_rows(R *const first, const std::size_t grain)
  {
    return reinterpret_cast<R *>(reinterpret_cast<std::uintptr_t>(first) - grain * sizeof(R));
  }

  /** Where the forces and torques on grains lie, found by the number of a grain; of one block alone, or of all. */
  struct ForceRows
  {
    Row *first;         ///< that of grain 0, by which others are counted
    std::size_t n_rows; ///< of a grain: 1, its force; or 2, with its torque behind it

    Row &force(const std::size_t i) const { return first[n_rows * i]; }
    Row &torque(const std::size_t i) const { return first[n_rows * i + 1]; } ///< @pre n_rows == 2

    /** @pre n_rows is that of the kind */
    template <bool is_rotation_free>
    ActionOf<is_rotation_free> *get() const
    {
      return reinterpret_cast<ActionOf<is_rotation_free> *>(first);
    }
  };

  /** Forces on grains or from far pairs, number by number, with torques or without. */
  class ForceTable
  {
  public:
    /** Values are not kept. */
    void resize(const std::size_t n, const bool has_torques)
    {
      n_rows_ = has_torques ? 2 : 1;
      rows_.resize(n_rows_ * n);
    }

    std::size_t size() const { return rows_.size() / n_rows_; }

    ForceRows get_rows() { return {rows_.data(), n_rows_}; }

    /** From the `first` one on, as if they belonged to the grains from `grain` on. */
    ForceRows get_rows(const std::size_t first, const std::size_t grain)
    {
      return {shift_rows(rows_.data() + n_rows_ * first, n_rows_ * grain), n_rows_};
    }

    Row &force(const std::size_t i) { return rows_[n_rows_ * i]; }
    Row &torque(const std::size_t i) { return rows_[n_rows_ * i + 1]; } ///< @pre resized with torques
    const Row &force(const std::size_t i) const { return rows_[n_rows_ * i]; }
    const Row &torque(const std::size_t i) const { return rows_[n_rows_ * i + 1]; }

    std::size_t count_bytes() const { return dem::count_bytes(rows_); } ///< memory that it holds

  private:
    LongArray<Row> rows_;
    std::size_t n_rows_ = 1;
  };
} // namespace dem
