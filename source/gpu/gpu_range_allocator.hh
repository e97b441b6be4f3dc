// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>

namespace gnomon::gpu {

/** Allocates ranges of a growing array: first fit, adjacent free ranges merged. */
class RangeAllocator {
 public:
  /** Elements that the array can have. */
  static constexpr std::uint32_t capacity_max = 1U << 31U;

  /**
   * Start of \a count free elements. Where there are none, capacity() grows to a power of two.
   * \throws Error where that would exceed capacity_max; nothing changes then.
   */
  [[nodiscard]] std::uint32_t allocate(std::uint32_t count);
  /** \pre allocate returned \a first for \a count. */
  void free(std::uint32_t first, std::uint32_t count);
  /** Reduce capacity() to \a capacity, or to the end of the last range in use if that is higher. */
  void shrink(std::uint32_t capacity);
  /** Whether all of the \a count elements from \a first on are in use. */
  [[nodiscard]] bool is_allocated(std::uint32_t first, std::uint32_t count) const;
  [[nodiscard]] std::uint32_t capacity() const
  {
    return capacity_;
  }

 private:
  /** Free ranges: first element to count. No two are adjacent. */
  std::map<std::uint32_t, std::uint32_t> free_;
  std::uint32_t capacity_ = 0;
};

}  // namespace gnomon::gpu
