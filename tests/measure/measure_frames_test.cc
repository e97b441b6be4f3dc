// SPDX-License-Identifier: MIT
#include "measure_frames.hh"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace gnomon::measure {
namespace {

TEST(Percentile, IsTheValueThatAShareDoesNotExceed)
{
  std::vector<double> values(100);
  std::iota(values.rbegin(), values.rend(), 1.0);
  EXPECT_EQ(percentile(values, 0.5), 50.0);
  EXPECT_EQ(percentile(values, 0.95), 95.0);
  EXPECT_EQ(percentile(values, 0.99), 99.0);
  EXPECT_EQ(percentile(values, 1.0), 100.0);
  EXPECT_EQ(percentile(values, 0.0), 1.0);
  EXPECT_EQ(percentile({7.0}, 0.5), 7.0);
}

}  // namespace
}  // namespace gnomon::measure
