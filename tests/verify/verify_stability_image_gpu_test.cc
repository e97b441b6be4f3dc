// SPDX-License-Identifier: MIT
#include "gpu_device_fixture.hh"
#include "verify_stability.hh"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace gnomon::verify {
namespace {

class StabilityImages : public test::SharedDeviceTest {};

TEST_F(StabilityImages, HaveUniqueNames)
{
  const std::vector<StabilityCase> cases = image_stability_cases(*device);
  EXPECT_GE(cases.size(), 60U);
  std::set<std::string> names;
  for (const StabilityCase &one : cases) {
    EXPECT_TRUE(names.insert(one.group + ", " + one.name).second) << one.group << ", " << one.name;
  }
}

// `gnomon stability` runs all cases. The tests run three of each group, and those that failed in the past.
TEST_F(StabilityImages, TheFirstTheMiddleAndTheLastOfEachGroupPass)
{
  const std::set<std::string> once_failed = {"range, esm", "blend 1"};
  std::map<std::string, std::vector<StabilityCase>> groups;
  for (StabilityCase &one : image_stability_cases(*device)) {
    groups[one.group].push_back(std::move(one));
  }
  for (const auto &[group, cases] : groups) {
    std::set<std::size_t> chosen = {0, cases.size() / 2, cases.size() - 1};
    for (std::size_t i = 0; i < cases.size(); i++) {
      if (once_failed.contains(cases[i].name)) {
        chosen.insert(i);
      }
    }
    for (const std::size_t i : chosen) {
      const StabilityResult result = run(cases[i]);
      EXPECT_TRUE(result.is_passed) << group << ", " << cases[i].name << ": " << result.worst_error << " "
                                    << cases[i].unit << " at " << result.worst_parameter << " " << result.failure;
    }
  }
}

}  // namespace
}  // namespace gnomon::verify
