// SPDX-License-Identifier: MIT
#include "verify_stability.hh"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

namespace gnomon::verify {
namespace {

TEST(StabilityInputs, AreAcceptedReportedOrRejected)
{
  const std::vector<StabilityCase> cases = input_stability_cases();
  EXPECT_GE(cases.size(), 40U);
  std::set<std::string> names;
  for (const StabilityCase &one : cases) {
    EXPECT_TRUE(names.insert(one.group + ", " + one.name).second) << one.group << ", " << one.name << " is there twice";
    const StabilityResult result = run(one);
    EXPECT_TRUE(result.is_passed) << one.group << ", " << one.name << ": " << result.worst_error << " " << one.unit
                                  << " at " << result.worst_parameter << " " << result.failure;
    if (!result.is_passed) {
      for (const StabilitySample &sample : result.samples) {
        fmt::print("  {}: {}\n", sample.parameter, sample.error);
      }
    }
  }
}

}  // namespace
}  // namespace gnomon::verify
