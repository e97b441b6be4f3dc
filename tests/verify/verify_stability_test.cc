// SPDX-License-Identifier: MIT
#include "verify_stability.hh"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace gnomon::verify {
namespace {

StabilityCase case_of(std::vector<StabilitySample> samples, double bound, bool is_baseline = false)
{
  StabilityCase one;
  one.bound = bound;
  one.is_baseline = is_baseline;
  one.run = [samples = std::move(samples)] { return samples; };
  return one;
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Stability, ReportsTheWorstErrorAndItsParameter)
{
  const StabilityResult result = run(case_of({{1.0, 0.25}, {2.0, 0.5}, {3.0, 0.125}}, 0.5));
  EXPECT_EQ(result.worst_error, 0.5);
  EXPECT_EQ(result.worst_parameter, 2.0);
  EXPECT_TRUE(result.is_passed);
  EXPECT_FALSE(run(case_of({{2.0, 0.5}}, 0.49)).is_passed);
}

TEST(Stability, NonFiniteFailsWhateverTheBound)
{
  const StabilityResult result = run(case_of({{1.0, nan}, {2.0, 0.0}}, std::numeric_limits<double>::infinity()));
  EXPECT_EQ(result.non_finite_count, 1U);
  EXPECT_EQ(result.worst_parameter, 1.0);
  EXPECT_FALSE(result.is_passed);
}

TEST(Stability, BaselineMustFail)
{
  EXPECT_TRUE(run(case_of({{1.0, nan}}, 1.0, true)).is_passed);
  EXPECT_TRUE(run(case_of({{1.0, 2.0}}, 1.0, true)).is_passed);
  EXPECT_FALSE(run(case_of({{1.0, 0.5}}, 1.0, true)).is_passed);
}

TEST(Stability, NothingMeasuredAndExceptionsFail)
{
  EXPECT_FALSE(run(case_of({}, 1.0)).is_passed);
  EXPECT_FALSE(run(case_of({}, 1.0, true)).is_passed);
  StabilityCase one = case_of({}, 1.0, true);
  one.run = []() -> std::vector<StabilitySample> { throw std::runtime_error("no lamp"); };
  const StabilityResult result = run(one);
  EXPECT_EQ(result.failure, "no lamp");
  EXPECT_FALSE(result.is_passed);
}

}  // namespace
}  // namespace gnomon::verify
