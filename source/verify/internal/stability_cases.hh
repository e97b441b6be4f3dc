// SPDX-License-Identifier: MIT
#pragma once

#include "shared_functions.hh"
#include "verify_stability.hh"

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

/** Helpers for stability cases, and the lists of function cases by group. */
namespace gnomon::verify {

/** Float's epsilon, 2^-23. The relative error of one rounding is at most half of it. */
inline constexpr double float_epsilon = std::numeric_limits<float>::epsilon();

/** \a count values from \a low to \a high inclusive, with equal ratios. \pre low above 0 */
[[nodiscard]] std::vector<double> log_steps(double low, double high, int count);
/** 0, followed by log_steps. */
[[nodiscard]] std::vector<double> zero_and_log_steps(double low, double high, int count);
/** \a count values from \a low to \a high inclusive, with equal differences. */
[[nodiscard]] std::vector<double> even_steps(double low, double high, int count);

/** A StabilityCase::run that evaluates \a error_at for each of \a parameters. */
[[nodiscard]] std::function<std::vector<StabilitySample>()> swept(std::vector<double> parameters,
                                                                  std::function<double(double parameter)> error_at);

/** The error of a condition: 0 if it holds, 1 if not. Its unit is violation_unit and its bound is 0. */
[[nodiscard]] inline double violated(bool is_kept)
{
  return is_kept ? 0.0 : 1.0;
}
inline constexpr const char *violation_unit = "violations";

/** Unit of errors in float epsilons of the rounded numbers. */
inline constexpr const char *epsilon_unit = "epsilons";

/**
 * A case of a shared function along one parameter: the float build against the closed form of the function's sweep,
 * within that sweep's bound.
 */
struct SharedFunctionCase {
  std::string group;
  std::string name;
  /** Name of the sweep's function. */
  std::string function;
  std::string quantity;
  std::string parameter;
  std::vector<double> steps;
  std::function<Arguments<float>(double parameter)> arguments;
  /** Replaces the sweep's bound if the errors at these arguments are smaller. */
  std::optional<double> bound{};
};
[[nodiscard]] StabilityCase case_of(SharedFunctionCase one);

void add_esm_cases(std::vector<StabilityCase> &cases);
void add_depth_cases(std::vector<StabilityCase> &cases);
void add_octahedral_cases(std::vector<StabilityCase> &cases);
void add_lamp_cases(std::vector<StabilityCase> &cases);
void add_area_cases(std::vector<StabilityCase> &cases);
void add_bsdf_cases(std::vector<StabilityCase> &cases);
void add_space_cases(std::vector<StabilityCase> &cases);
void add_sun_cases(std::vector<StabilityCase> &cases);
void add_picture_cases(std::vector<StabilityCase> &cases);
void add_reference_cases(std::vector<StabilityCase> &cases);

}  // namespace gnomon::verify
