// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>

namespace gnomon::gpu {

/** Hands out ranges of a growing array: first fit, free neighbours merged. */
class RangeAllocator {
 public:
  /** Start of \a count free elements; grows capacity() to a power of two where none are free. */
  [[nodiscard]] std::uint32_t allocate(std::uint32_t count);
  /** \pre allocate gave (first, count). */
  void free(std::uint32_t first, std::uint32_t count);
  [[nodiscard]] std::uint32_t capacity() const
  {
    return capacity_;
  }

 private:
  /** First → count, no two adjacent. */
  std::map<std::uint32_t, std::uint32_t> free_;
  std::uint32_t capacity_ = 0;
};

}  // namespace gnomon::gpu
