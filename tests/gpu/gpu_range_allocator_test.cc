// SPDX-License-Identifier: MIT
#include "gpu_range_allocator.hh"
#include "gpu_error.hh"

#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <vector>

namespace gnomon::gpu {
namespace {

/** Owner of each element; 0: free. */
class Model {
 public:
  /** First fit, as the allocator promises; empty if none fits below \a capacity. */
  [[nodiscard]] std::int64_t first_fit(std::uint32_t count, std::uint32_t capacity) const
  {
    std::uint32_t run = 0;
    for (std::uint32_t i = 0; i < capacity; i++) {
      run = owner(i) == 0 ? run + 1 : 0;
      if (run == count) {
        return std::int64_t(i) + 1 - count;
      }
    }
    return -1;
  }
  void set(std::uint32_t first, std::uint32_t count, int who)
  {
    owners_.resize(std::max<std::size_t>(owners_.size(), first + count));
    std::fill_n(owners_.begin() + first, count, who);
  }
  [[nodiscard]] int owner(std::uint32_t i) const
  {
    return i < owners_.size() ? owners_[i] : 0;
  }

 private:
  std::vector<int> owners_;
};

TEST(RangeAllocator, RandomSequenceFollowsAFirstFitModel)
{
  struct Range {
    std::uint32_t first;
    std::uint32_t count;
  };
  for (unsigned seed = 0; seed < 8; seed++) {
    std::mt19937 random(seed);
    RangeAllocator allocator;
    Model model;
    std::vector<Range> live;
    for (int step = 1; step <= 1500; step++) {
      const bool is_allocation = live.empty() || random() % 100 < (step < 900 ? 60U : 40U);
      if (is_allocation) {
        const auto count = std::uint32_t(1 + random() % (random() % 10 == 0 ? 600 : 40));
        const std::uint32_t capacity_before = allocator.capacity();
        const std::int64_t expected = model.first_fit(count, capacity_before);
        const std::uint32_t first = allocator.allocate(count);
        for (std::uint32_t i = first; i < first + count; i++) {
          ASSERT_EQ(model.owner(i), 0) << "element " << i << " has two owners, step " << step << ", seed " << seed;
        }
        if (expected >= 0) {
          ASSERT_EQ(first, expected) << "step " << step << ", seed " << seed;
          ASSERT_EQ(allocator.capacity(), capacity_before) << "grown although there was room";
        }
        else {
          ASSERT_GT(allocator.capacity(), capacity_before);
          ASSERT_TRUE(std::has_single_bit(allocator.capacity()));
        }
        ASSERT_LE(first + count, allocator.capacity());
        model.set(first, count, step);
        live.push_back({first, count});
      }
      else {
        const std::size_t i = random() % live.size();
        allocator.free(live[i].first, live[i].count);
        model.set(live[i].first, live[i].count, 0);
        live.erase(live.begin() + std::ptrdiff_t(i));
      }
    }
    // After freeing all in any order there is one range again.
    const std::uint32_t capacity = allocator.capacity();
    std::shuffle(live.begin(), live.end(), random);
    for (const Range &range : live) {
      allocator.free(range.first, range.count);
    }
    EXPECT_EQ(allocator.allocate(capacity), 0U);
    EXPECT_EQ(allocator.capacity(), capacity);
  }
}

TEST(RangeAllocator, FreeRangeBetweenTwoFreeOnesJoinsThem)
{
  RangeAllocator allocator;
  const std::uint32_t a = allocator.allocate(300);
  const std::uint32_t b = allocator.allocate(300);
  const std::uint32_t c = allocator.allocate(300);
  static_cast<void>(allocator.allocate(124));
  ASSERT_EQ(allocator.capacity(), 1024U);
  allocator.free(a, 300);
  allocator.free(c, 300);
  allocator.free(b, 300);
  EXPECT_EQ(allocator.allocate(900), a);
  EXPECT_EQ(allocator.capacity(), 1024U);
}

TEST(RangeAllocator, GrowthExtendsAFreeTailAndKeepsWhatStands)
{
  RangeAllocator allocator;
  EXPECT_EQ(allocator.capacity(), 0U);
  const std::uint32_t first = allocator.allocate(1000);
  EXPECT_EQ(first, 0U);
  // 24 are free at the end: the new range begins there.
  EXPECT_EQ(allocator.allocate(100), 1000U);
  EXPECT_EQ(allocator.capacity(), 2048U);
  EXPECT_EQ(allocator.allocate(3000), 1100U);
  EXPECT_EQ(allocator.capacity(), 8192U);
}

TEST(RangeAllocator, EmptyRangeTakesNothing)
{
  RangeAllocator allocator;
  const std::uint32_t empty = allocator.allocate(0);
  const std::uint32_t all = allocator.allocate(1024);
  EXPECT_EQ(all, 0U);
  EXPECT_LE(empty, allocator.capacity());
  static_cast<void>(allocator.allocate(0));
  EXPECT_EQ(allocator.capacity(), 1024U);
  allocator.free(empty, 0);
  allocator.free(all, 1024);
  EXPECT_EQ(allocator.allocate(1024), 0U);
  EXPECT_EQ(allocator.capacity(), 1024U);
}

TEST(RangeAllocator, RefusesWhatExceedsItsLargestCapacity)
{
  RangeAllocator allocator;
  constexpr std::uint32_t half = 1U << 30U;
  EXPECT_EQ(allocator.allocate(half), 0U);
  EXPECT_EQ(allocator.allocate(half - 1), half);
  EXPECT_EQ(allocator.capacity(), RangeAllocator::capacity_max);
  EXPECT_THROW(static_cast<void>(allocator.allocate(2)), Error);
  EXPECT_THROW(static_cast<void>(allocator.allocate(~0U)), Error);
  EXPECT_EQ(allocator.capacity(), RangeAllocator::capacity_max);
  EXPECT_EQ(allocator.allocate(1), 2 * half - 1);
  allocator.free(0, half);
  EXPECT_EQ(allocator.allocate(half), 0U);
}

TEST(RangeAllocator, ShrinksToItsLastRange)
{
  RangeAllocator allocator;
  ASSERT_EQ(allocator.allocate(600), 0U);
  ASSERT_EQ(allocator.allocate(3000), 600U);
  EXPECT_EQ(allocator.capacity(), 4096U);
  allocator.shrink(1024);
  EXPECT_EQ(allocator.capacity(), 3600U) << "elements in use stay";
  allocator.free(600, 3000);
  allocator.shrink(1024);
  EXPECT_EQ(allocator.capacity(), 1024U);
  EXPECT_EQ(allocator.allocate(424), 600U);
  EXPECT_EQ(allocator.capacity(), 1024U);
  allocator.shrink(0);
  EXPECT_EQ(allocator.capacity(), 1024U);
}

TEST(RangeAllocator, CountsTheUsedElements)
{
  RangeAllocator allocator;
  EXPECT_FALSE(allocator.is_allocated(0, 1));
  ASSERT_EQ(allocator.allocate(10), 0U);
  ASSERT_EQ(allocator.allocate(10), 10U);
  EXPECT_TRUE(allocator.is_allocated(0, 20));
  EXPECT_FALSE(allocator.is_allocated(0, 21));
  EXPECT_FALSE(allocator.is_allocated(19, ~0U));
  allocator.free(0, 10);
  EXPECT_TRUE(allocator.is_allocated(10, 10));
  EXPECT_FALSE(allocator.is_allocated(9, 2));
  EXPECT_FALSE(allocator.is_allocated(5, 1));
  EXPECT_FALSE(allocator.is_allocated(20, 1));
}

}  // namespace
}  // namespace gnomon::gpu
