// SPDX-License-Identifier: MIT
#include "gpu_range_allocator.hh"

#include "gpu_error.hh"

#include <algorithm>
#include <bit>
#include <iterator>

namespace gnomon::gpu {

std::uint32_t RangeAllocator::allocate(std::uint32_t count)
{
  auto range = std::find_if(free_.begin(), free_.end(), [&](const auto &entry) { return entry.second >= count; });
  if (range == free_.end()) {
    // Extend a free range at the end, so that the array grows only by the missing elements.
    const bool has_tail = !free_.empty() && free_.rbegin()->first + free_.rbegin()->second == capacity_;
    const std::uint32_t first = has_tail ? free_.rbegin()->first : capacity_;
    const std::uint64_t end = std::uint64_t(first) + count;
    if (end > capacity_max) {
      throw Error("{} elements do not fit behind the first {} of at most {}", count, first, capacity_max);
    }
    const std::uint32_t capacity = std::bit_ceil(std::max(std::uint32_t(end), 1024U));
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

void RangeAllocator::shrink(std::uint32_t capacity)
{
  if (capacity_ <= capacity || free_.empty()) {
    return;
  }
  const auto last = std::prev(free_.end());
  const auto [first, count] = *last;
  if (first + count != capacity_) {
    return;
  }
  capacity_ = std::max(first, capacity);
  free_.erase(last);
  if (capacity_ > first) {
    free_[first] = capacity_ - first;
  }
}

bool RangeAllocator::is_allocated(std::uint32_t first, std::uint32_t count) const
{
  if (std::uint64_t(first) + count > capacity_) {
    return false;
  }
  const auto next = free_.lower_bound(first);
  if (next != free_.end() && next->first < first + count) {
    return false;
  }
  return next == free_.begin() || std::prev(next)->first + std::prev(next)->second <= first;
}

}  // namespace gnomon::gpu
