// SPDX-License-Identifier: MIT
#include "memory_pages.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace gnomon::memory {

TEST(LargePages, TheAdviceChangesNoContent)
{
  // Begins and ends inside a page, and within memory that has been written.
  std::vector<unsigned char> bytes((std::size_t(5) << 20U) + 3, 7);
  prefer_large_pages(bytes.data() + 1, bytes.size() - 2);
  EXPECT_EQ(std::ranges::count(bytes, 7), std::ptrdiff_t(bytes.size()));
  prefer_large_pages(bytes.data(), 1);
  prefer_large_pages(nullptr, 0);
  EXPECT_EQ(std::ranges::count(bytes, 7), std::ptrdiff_t(bytes.size()));
}

}  // namespace gnomon::memory
