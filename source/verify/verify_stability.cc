// SPDX-License-Identifier: MIT
#include "verify_stability.hh"

#include <cmath>
#include <exception>
#include <limits>

namespace gnomon::verify {

StabilityResult run(const StabilityCase &one)
{
  StabilityResult result;
  try {
    result.samples = one.run();
    if (result.samples.empty()) {
      result.failure = "nothing was measured";
    }
  }
  catch (const std::exception &error) {
    result.failure = error.what();
  }
  for (const StabilitySample &sample : result.samples) {
    const double error = std::isfinite(sample.error) ? sample.error : std::numeric_limits<double>::infinity();
    result.non_finite_count += std::isfinite(sample.error) ? 0 : 1;
    // >=, so that a case without error also reports a parameter.
    if (error >= result.worst_error) {
      result.worst_error = error;
      result.worst_parameter = sample.parameter;
    }
  }
  const bool is_within = result.non_finite_count == 0 && result.worst_error <= one.bound;
  result.is_passed = result.failure.empty() && is_within != one.is_baseline;
  return result;
}

}  // namespace gnomon::verify
