// SPDX-License-Identifier: MIT
#include "shared_functions.hh"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace gnomon::verify {
namespace {

class SharedFunction : public testing::TestWithParam<std::size_t> {
 protected:
  template <typename T>
  void expect_truth(std::span<const CompiledFunction<T>> functions, double epsilons)
  {
    const auto function = std::ranges::find(functions, sweep().name, &CompiledFunction<T>::name);
    ASSERT_NE(function, functions.end());
    std::vector<glm::dvec4> results;
    for (const Arguments<float> &arguments : sweep().arguments) {
      results.emplace_back(function->call({arguments.a, arguments.b, arguments.c}));
    }
    const Deviation worst = deviation(sweep(), results);
    RecordProperty("epsilons", fmt::format("{:.3g}", worst.epsilons));
    EXPECT_LE(worst.epsilons, epsilons) << worst.where;
  }

  const Sweep &sweep() const
  {
    return sweeps()[GetParam()];
  }
};

TEST_P(SharedFunction, EqualsItsClosedFormInDouble)
{
  expect_truth(functions_in_double(), sweep().double_epsilons);
}

TEST_P(SharedFunction, EqualsItsClosedFormInFloat)
{
  expect_truth(functions_in_float(), sweep().float_epsilons);
}

INSTANTIATE_TEST_SUITE_P(Each, SharedFunction, testing::Range(std::size_t(0), sweeps().size()),
                         [](const auto &test) { return std::string(sweeps()[test.param].name); });

}  // namespace
}  // namespace gnomon::verify
