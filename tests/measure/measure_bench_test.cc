// SPDX-License-Identifier: MIT
#include "measure_bench.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace gnomon::measure {
namespace {

TEST(Growth, IsThatOfASumOfAFixedTimeAndAPower)
{
  const std::vector<double> counts = {10, 100, 1000, 10000, 100000};
  for (const double exponent : {0.3, 0.5, 1.0, 1.05, 2.0}) {
    for (const double fixed : {0.0, 1e-5, 1e-2}) {
      std::vector<double> seconds;
      for (const double count : counts) {
        seconds.push_back(fixed + 3e-7 * std::pow(count, exponent));
      }
      // Where the fixed time hides the rest, the fit would need digits that times do not have.
      if (seconds.back() > 2.0 * fixed) {
        const Growth growth = growth_of(counts, seconds);
        EXPECT_NEAR(growth.exponent, exponent, 0.011) << fixed;
        EXPECT_NEAR(growth.fixed, fixed, 0.05 * fixed + 0.02 * seconds.front()) << exponent;
      }
    }
  }
}

TEST(Growth, OfNoisyTimesIsClose)
{
  const std::vector<double> counts = {10, 100, 1000, 10000, 100000};
  std::vector<double> seconds;
  for (const double count : counts) {
    const double noise = seconds.size() % 2 == 0 ? 1.1 : 0.9;
    seconds.push_back(noise * (1e-4 + 1e-7 * count));
  }
  EXPECT_NEAR(growth_of(counts, seconds).exponent, 1.0, 0.1);
}

TEST(Growth, HasNoNegativeFixedTime)
{
  const std::vector<double> counts = {1, 2, 4, 8};
  const std::vector<double> seconds = {1, 4, 16, 64};
  EXPECT_NEAR(growth_of(counts, seconds).exponent, 2.0, 0.011);
  const std::vector<double> falling = {4, 3, 2, 1};
  EXPECT_GE(growth_of(counts, falling).fixed, 0.0);
  EXPECT_TRUE(std::isfinite(growth_of(counts, falling).exponent));
}

}  // namespace
}  // namespace gnomon::measure
