// SPDX-License-Identifier: MIT
#include "gpu_range_allocator.hh"

#include <algorithm>
#include <bit>
#include <iterator>

namespace gnomon::gpu {

std::uint32_t RangeAllocator::allocate(std::uint32_t count)
{
  auto range = std::find_if(free_.begin(), free_.end(), [&](const auto &entry) { return entry.second >= count; });
  if (range == free_.end()) {
    // A free tail is extended, so the array grows only by what is missing.
    const bool has_tail = !free_.empty() && free_.rbegin()->first + free_.rbegin()->second == capacity_;
    const std::uint32_t first = has_tail ? free_.rbegin()->first : capacity_;
    const std::uint32_t capacity = std::bit_ceil(std::max(first + count, 1024U));
    free_[first] = capacity - first;
    capacity_ = capacity;
    range = std::prev(free_.end());
  }
  const auto [first, available] = *range;
  free_.erase(range);
  if (available > count) {
    free_[first + count] = available - count;
  }
  return first;
}

void RangeAllocator::free(std::uint32_t first, std::uint32_t count)
{
  if (count == 0) {
    return;
  }
  auto next = free_.lower_bound(first);
  if (next != free_.end() && first + count == next->first) {
    count += next->second;
    next = free_.erase(next);
  }
  if (next != free_.begin()) {
    const auto previous = std::prev(next);
    if (previous->first + previous->second == first) {
      previous->second += count;
      return;
    }
  }
  free_[first] = count;
}

}  // namespace gnomon::gpu
