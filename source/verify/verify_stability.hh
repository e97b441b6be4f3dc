// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

/** What the program's measuring commands are made of: error against run time, and stability. */
namespace gnomon::verify {

/** A value of the parameter that a case sweeps, and how wrong the quantity is there. */
struct StabilitySample {
  double parameter = 0.0;
  /** In the case's unit, at least 0. NaN or infinite: the result was, where it should not be. */
  double error = 0.0;
};

/** One quantity over one range of one parameter, what it is compared with, and what is asked of it. */
struct StabilityCase {
  /** Cases of a group are shown together: "esm", "depth". */
  std::string group;
  /** Unique in its group, and short. */
  std::string name;
  /** What is computed, from what: "prefilter of 32 taps, 80/m". */
  std::string quantity;
  /** What is swept, with its unit: "spread of distances, m". */
  std::string parameter;
  /** "long double", "closed form", "exact rays". */
  std::string reference;
  /** Of the error: "m", "relative", "fraction of pixels". */
  std::string unit;
  /** Largest error that passes. */
  double bound = 0.0;
  /**
   * A form that the engine does not use, kept to be seen to fail where `doc/testing.md` says that such forms do: it
   * passes where its error is above the bound or not finite.
   */
  bool is_baseline = false;
  /** In order of the parameter; at least one. What it throws fails the case with that reason. */
  std::function<std::vector<StabilitySample>()> run{};
};

/** What came of a case. */
struct StabilityResult {
  std::vector<StabilitySample> samples;
  /** Largest error, and where; infinite where any is not finite. */
  double worst_error = 0.0;
  double worst_parameter = 0.0;
  /** Samples of which the error is not finite. */
  std::size_t non_finite_count = 0;
  /** As the case asks: below the bound, or above for a baseline. */
  bool is_passed = false;
  /** What the case threw; empty where nothing. */
  std::string failure;
};

[[nodiscard]] StabilityResult run(const StabilityCase &one);

/** Of functions that the engine calls or that its shaders share with C++. They need no device. */
[[nodiscard]] std::vector<StabilityCase> function_stability_cases();

/** Cases of inputs from outside: files, settings, the host's calls. They need no device. */
[[nodiscard]] std::vector<StabilityCase> input_stability_cases();

/** What the groups of image_stability_cases() begin with. */
inline constexpr std::string_view image_group_prefix = "rendered ";

/** Of pictures that the engine renders on \a device, which must outlive the cases. */
[[nodiscard]] std::vector<StabilityCase> image_stability_cases(gpu::Device &device);

}  // namespace gnomon::verify
