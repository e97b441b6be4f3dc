// SPDX-License-Identifier: MIT
#pragma once

#include "shared_functions.hh"
#include "verify_stability.hh"

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

/** What the lists of cases are written with, and the lists of functions by group. */
namespace gnomon::verify {

/** Of float, 2^-23: a rounding is half of it at most. */
inline constexpr double float_epsilon = std::numeric_limits<float>::epsilon();

/** \a count values from \a low to \a high, both among them; one ratio from each to the next. \pre low above 0 */
[[nodiscard]] std::vector<double> log_steps(double low, double high, int count);
/** The same, after 0. */
[[nodiscard]] std::vector<double> zero_and_log_steps(double low, double high, int count);
/** As log_steps; one difference. */
[[nodiscard]] std::vector<double> even_steps(double low, double high, int count);

/** For StabilityCase::run. */
[[nodiscard]] std::function<std::vector<StabilitySample>()> swept(std::vector<double> parameters,
                                                                  std::function<double(double parameter)> error_at);

/** The error of what either holds or does not; its unit, and 0 is its bound. */
[[nodiscard]] inline double violated(bool is_kept)
{
  return is_kept ? 0.0 : 1.0;
}
inline constexpr const char *violation_unit = "violations";

/** Unit of errors that are counted in float epsilons of the numbers that were rounded. */
inline constexpr const char *epsilon_unit = "epsilons";

/**
 * A shared function along one parameter: what its float build gives, against the closed form of its sweep and within
 * the bound of that.
 */
struct SharedFunctionCase {
  std::string group;
  std::string name;
  /** Of the sweep. */
  std::string function;
  std::string quantity;
  std::string parameter;
  std::vector<double> steps;
  std::function<Arguments<float>(double parameter)> arguments;
  /** In place of the sweep's, where these arguments are kinder than its; with the reason beside it. */
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
