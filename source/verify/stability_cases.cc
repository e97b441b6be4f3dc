// SPDX-License-Identifier: MIT
#include "internal/stability_cases.hh"

#include <algorithm>
#include <cmath>

namespace gnomon::verify {

std::vector<double> log_steps(double low, double high, int count)
{
  std::vector<double> steps;
  for (int i = 0; i < count; i++) {
    steps.push_back(i == count - 1 ? high : low * std::pow(high / low, double(i) / (count - 1)));
  }
  return steps;
}

std::vector<double> zero_and_log_steps(double low, double high, int count)
{
  std::vector<double> steps = log_steps(low, high, count);
  steps.insert(steps.begin(), 0.0);
  return steps;
}

std::vector<double> even_steps(double low, double high, int count)
{
  std::vector<double> steps;
  for (int i = 0; i < count; i++) {
    steps.push_back(i == count - 1 ? high : low + (high - low) * i / (count - 1));
  }
  return steps;
}

std::function<std::vector<StabilitySample>()> swept(std::vector<double> parameters,
                                                    std::function<double(double parameter)> error_at)
{
  return [parameters = std::move(parameters), error_at = std::move(error_at)] {
    std::vector<StabilitySample> samples;
    for (const double parameter : parameters) {
      samples.push_back({parameter, error_at(parameter)});
    }
    return samples;
  };
}

StabilityCase case_of(SharedFunctionCase one)
{
  const Sweep &sweep = *std::ranges::find(sweeps(), one.function, &Sweep::name);
  return {.group = std::move(one.group),
          .name = std::move(one.name),
          .quantity = std::move(one.quantity),
          .parameter = std::move(one.parameter),
          .reference = "closed form in double",
          .unit = epsilon_unit,
          .bound = one.bound.value_or(sweep.float_epsilons),
          .run = swept(std::move(one.steps), [&sweep, arguments = std::move(one.arguments)](double parameter) {
            return float_epsilons(sweep, arguments(parameter));
          })};
}

std::vector<StabilityCase> function_stability_cases()
{
  std::vector<StabilityCase> cases;
  add_esm_cases(cases);
  add_depth_cases(cases);
  add_octahedral_cases(cases);
  add_lamp_cases(cases);
  add_area_cases(cases);
  add_bsdf_cases(cases);
  add_space_cases(cases);
  add_sun_cases(cases);
  add_picture_cases(cases);
  add_reference_cases(cases);
  return cases;
}

}  // namespace gnomon::verify
