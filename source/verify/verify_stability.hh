// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

/** Stability cases: errors of functions, inputs and pictures over ranges of parameters. */
namespace gnomon::verify {

/** A value of a case's parameter, and the error there. */
struct StabilitySample {
  double parameter = 0.0;
  /** In the case's unit, at least 0. NaN or infinity stands for an unexpected NaN or infinity in the result. */
  double error = 0.0;
};

/** One quantity over a range of one parameter, with its reference and error bound. */
struct StabilityCase {
  /** Cases of a group are reported together, for example "esm" or "depth". */
  std::string group;
  /** Short name, unique in its group. */
  std::string name;
  /** The computed quantity, for example "prefilter of 32 taps, 80/m". */
  std::string quantity;
  /** The parameter with its unit, for example "spread of distances, m". */
  std::string parameter;
  /** Source of the exact values: "long double", "closed form", "exact rays", … */
  std::string reference;
  /** Unit of the error: "m", "relative", "fraction of pixels", … */
  std::string unit;
  /** Largest error that passes. */
  double bound = 0.0;
  /**
   * Whether the case tests a form that the engine does not use, to show that the case detects its failure (see
   * `doc/testing.md`). Such a case passes if its error is above the bound or not finite.
   */
  bool is_baseline = false;
  /**
   * Returns at least one sample, in order of the parameter. An exception fails the case, with its message as the
   * reason.
   */
  std::function<std::vector<StabilitySample>()> run{};
};

/** Result of a case. */
struct StabilityResult {
  std::vector<StabilitySample> samples;
  /** Largest error and its parameter. Infinite if an error is not finite. */
  double worst_error = 0.0;
  double worst_parameter = 0.0;
  /** Number of samples whose error is not finite. */
  std::size_t non_finite_count = 0;
  /** worst_error is at most the bound; for a baseline, above it. */
  bool is_passed = false;
  /** Message of the exception that the case threw; empty if it threw none. */
  std::string failure;
};

[[nodiscard]] StabilityResult run(const StabilityCase &one);

/** Cases of functions that the engine calls or shares with its shaders. They need no device. */
[[nodiscard]] std::vector<StabilityCase> function_stability_cases();

/** Cases of external input: files, settings, the host's calls. They need no device. */
[[nodiscard]] std::vector<StabilityCase> input_stability_cases();

/** Prefix of the groups of image_stability_cases(). */
inline constexpr std::string_view image_group_prefix = "rendered ";

/** Cases of pictures that the engine renders on \a device, which must outlive the cases. */
[[nodiscard]] std::vector<StabilityCase> image_stability_cases(gpu::Device &device);

}  // namespace gnomon::verify
