#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace dem
{
  /** An array within a block of memory that somebody else owns and lays out (dem/rev_arrays.h): where it begins and how
   * long it is. Not to be copied: two of the same place would be a trap; to copy, copy what owns the block. */
  template <typename T>
  class Column
  {
  public:
    using value_type = T;

    Column() = default;
    Column(const Column &) = delete;
    Column &operator=(const Column &) = delete;

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    T *data() { return data_; }
    const T *data() const { return data_; }
    T *begin() { return data_; }
    T *end() { return data_ + size_; }
    const T *begin() const { return data_; }
    const T *end() const { return data_ + size_; }
    T &operator[](const std::size_t i) { return data_[i]; }
    const T &operator[](const std::size_t i) const { return data_[i]; }
    const T &back() const { return data_[size_ - 1]; }

    /** Keeps the first n. */
    void shrink(const std::size_t n)
    {
      assert(n <= size_);
      size_ = n;
    }

    /** Keeps those that are not out, in their order. */
    template <typename Predicate>
    void erase_if(const Predicate &is_out)
    {
      size_ = static_cast<std::size_t>(std::remove_if(begin(), end(), is_out) - begin());
    }

    /** For the owner of the block. */
    void place(T *const first, const std::size_t size)
    {
      data_ = first;
      size_ = size;
    }

    friend bool operator==(const Column &first, const Column &second)
    {
      return std::equal(first.begin(), first.end(), second.begin(), second.end());
    }

  private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
  };
} // namespace dem
