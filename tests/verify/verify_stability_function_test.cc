// SPDX-License-Identifier: MIT
#include "verify_stability.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace gnomon::verify {
namespace {

/** Written out, because creating the list of cases takes too long for the start of the test program. */
const std::vector<std::string> groups = {"esm",  "depth", "octahedral", "cube", "lamps",   "shadow",
                                         "area", "bsdf",  "space",      "sun",  "picture", "reference"};

std::vector<StabilityCase> cases_of(const std::string &group)
{
  std::vector<StabilityCase> cases = function_stability_cases();
  std::erase_if(cases, [&](const StabilityCase &one) { return one.group != group; });
  return cases;
}

const StabilityCase &case_named(const std::vector<StabilityCase> &cases, std::string_view name)
{
  const auto found = std::ranges::find(cases, name, &StabilityCase::name);
  if (found == cases.end()) {
    throw std::runtime_error("no case '" + std::string(name) + "'");
  }
  return *found;
}

/** First parameter at which the error of \a one is above its bound or not finite; infinity if there is none. */
double first_failure(const StabilityCase &one)
{
  for (const StabilitySample &sample : one.run()) {
    if (!(sample.error <= one.bound)) {
      return sample.parameter;
    }
  }
  return std::numeric_limits<double>::infinity();
}

double first_non_finite(const StabilityCase &one)
{
  for (const StabilitySample &sample : one.run()) {
    if (!std::isfinite(sample.error)) {
      return sample.parameter;
    }
  }
  return std::numeric_limits<double>::infinity();
}

TEST(StabilityCases, HaveAllTexts)
{
  std::set<std::pair<std::string, std::string>> names;
  const std::vector<StabilityCase> cases = function_stability_cases();
  for (const StabilityCase &one : cases) {
    EXPECT_TRUE(names.emplace(one.group, one.name).second) << one.group << ", " << one.name << " is there twice";
    for (const std::string *text : {&one.group, &one.name, &one.quantity, &one.parameter, &one.reference, &one.unit}) {
      EXPECT_FALSE(text->empty()) << one.name;
    }
    EXPECT_NE(std::ranges::find(groups, one.group), groups.end()) << one.group;
    EXPECT_TRUE(std::isfinite(one.bound) && one.bound >= 0.0) << one.name;
  }
  EXPECT_GE(cases.size(), 170U);
  const auto baselines = std::ranges::count_if(cases, &StabilityCase::is_baseline);
  EXPECT_GE(baselines, 20);
  EXPECT_GE(std::ptrdiff_t(cases.size()) - baselines, 170);
}

class StabilityGroup : public testing::TestWithParam<std::string> {};

TEST_P(StabilityGroup, EachCasePassesInOrderOfItsParameter)
{
  const std::vector<StabilityCase> cases = cases_of(GetParam());
  EXPECT_FALSE(cases.empty());
  for (const StabilityCase &one : cases) {
    const StabilityResult result = run(one);
    EXPECT_TRUE(result.is_passed) << one.name << ": " << result.failure << " error " << result.worst_error << " "
                                  << one.unit << " at " << result.worst_parameter << ", bound " << one.bound;
    EXPECT_TRUE(std::ranges::is_sorted(result.samples, {}, &StabilitySample::parameter)) << one.name;
    EXPECT_TRUE(one.is_baseline || result.non_finite_count == 0) << one.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Each, StabilityGroup, testing::ValuesIn(groups), [](const auto &test) { return test.param; });

// hazards.md: exp(5 d) is infinite in floats beyond 17.74 m and in halves beyond 2.2 m; the filter in log space from 89
// m of spread on; squares of exp() at half the distance.
TEST(StabilityBaselines, OverflowAtTheLimitOfExp)
{
  const std::vector<StabilityCase> cases = cases_of("esm");
  const std::map<std::string, double> thresholds = {{"naive 32f 5/m, limit of exp(c z)", 88.72 / 5.0},
                                                    {"naive 32f 80/m, limit of exp(c z)", 88.72 / 80.0},
                                                    {"naive 32f 0.01/m, limit of exp(c z)", 88.72 / 0.01},
                                                    {"naive 16f 5/m, limit of exp(c z)", 11.09 / 5.0},
                                                    {"naive 16f 80/m, limit of exp(c z)", 11.09 / 80.0},
                                                    {"unsafe log 32f 1/m, limit of the spread", 88.72},
                                                    {"unsafe log 32f 80/m, limit of the spread", 88.72 / 80.0},
                                                    {"evsm naive 32f, limit of exp(2 c z) 5/m", 44.36 / 5.0}};
  for (const auto &[name, threshold] : thresholds) {
    // The samples are a hundredth of the threshold apart. The square of the mean overflows together with the squares.
    EXPECT_NEAR(first_non_finite(case_named(cases, name)) / threshold, 1.0, 0.0101) << name;
  }
}

// hazards.md: halves are too coarse for linear distances: half an ulp is 1.6 cm at 40 m.
TEST(StabilityBaselines, LinearHalvesFailWhereHalfAnUlpMatters)
{
  const std::vector<StabilityCase> cases = cases_of("esm");
  for (const auto &[name, exponent] : {std::pair("linear halves 16f 5/m", 5.0), {"linear halves 16f 80/m", 80.0}}) {
    // 1 - exp(-c·e) is above 0.02 from e = 0.0202 / c on; half an ulp is between 2^-12 and 2^-11 of the distance, and
    // the samples are a quarter apart.
    const double error = 0.0202 / exponent;
    const double first = first_failure(case_named(cases, name));
    EXPECT_GE(first, error * std::exp2(11.0) / 1.3) << name;
    EXPECT_LE(first, error * std::exp2(12.0) * 1.6) << name;
  }
}

// A depth near 1 has a rounding error of 2^-25. For a forward depth this is a distance error of distance² / near times
// as much.
TEST(StabilityBaselines, ForwardDepthsFailFromAFewNearPlanesOn)
{
  const std::vector<StabilityCase> cases = cases_of("depth");
  for (const std::string range : {"near 0.01 m, far/near 1e+06", "near 1 m, far/near 1e+06"}) {
    const StabilityCase &forward = case_named(cases, "forward, " + range);
    const double near = range.starts_with("near 1 ") ? 1.0 : 0.01;
    const double expected = forward.bound * 0x1p-23 / 0x1p-25 * near;
    // Half of it if the computation of the depth has the same rounding error, and one sample later if it happens to be
    // exact.
    const double first = first_failure(forward);
    EXPECT_GE(first, 0.25 * expected) << range;
    EXPECT_LE(first, 2.0 * expected) << range;
  }
}

}  // namespace
}  // namespace gnomon::verify
