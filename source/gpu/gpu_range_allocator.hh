// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>

namespace gnomon::gpu {

/** Allocates ranges of a growing array. It uses the first free range that fits and merges adjacent free ranges. */
class RangeAllocator {
 public:
  /** Maximum number of elements of the array. */
  static constexpr std::uint32_t capacity_max = 1U << 31U;

  /**
   * Allocate \a count elements and return the index of the first. If no free range is large enough, capacity() grows to
   * a power of two. \throws Error if the capacity would exceed capacity_max; nothing changes then
   */
  [[nodiscard]] std::uint32_t allocate(std::uint32_t count);
  /** Free a range. \pre allocate(count) returned \a first */
  void free(std::uint32_t first, std::uint32_t count);
  /** Reduce capacity() to \a capacity, or to the end of the last allocated range if that is higher. */
  void shrink(std::uint32_t capacity);
  /** Whether all \a count elements from \a first on are allocated. */
  [[nodiscard]] bool is_allocated(std::uint32_t first, std::uint32_t count) const;
  [[nodiscard]] std::uint32_t capacity() const
  {
    return capacity_;
  }

 private:
  /** Maps the first element of each free range to its count. No two ranges are adjacent. */
  std::map<std::uint32_t, std::uint32_t> free_;
  std::uint32_t capacity_ = 0;
};

}  // namespace gnomon::gpu
