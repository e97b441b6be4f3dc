// SPDX-License-Identifier: MIT
#pragma once

#include "measure_choice.hh"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <string>

namespace gnomon::cli {

/** `--max-error`, `--max-time` and `--report`. */
struct ChoiceOptions {
  /** Required RMSE; 0: none. */
  double error_max = 0.0;
  /** Required time; 0: none. */
  double milliseconds_max = 0.0;
  /** Folder of `gnomon report`; empty: none. */
  std::string report_folder;

  [[nodiscard]] bool is_asked() const
  {
    return error_max > 0.0 || milliseconds_max > 0.0;
  }
};

/** Chooses a picture's settings for a required error or time, and verifies the choice. */
class Chooser {
 public:
  /**
   * Chooses from the report, if it contains the scene at that size, and otherwise from a pilot on \a device. All
   * references must outlive the chooser. \a has_multiscatter: see eevee::Settings. \throws std::runtime_error naming
   * the report if it cannot be read.
   */
  Chooser(const ChoiceOptions &options, gpu::Device &device, const scene::Scene &scene,
          const scene::PlacedCamera &camera, glm::ivec2 size_px, bool has_multiscatter);

  [[nodiscard]] const measure::Choice &choice() const
  {
    return choice_;
  }
  /** Compares the picture with ray tracing at other pixels than the pilot's. \a seconds: time of the first picture. */
  void measure(std::span<const glm::vec4> picture, double seconds);
  /** Requirements that were not met. */
  [[nodiscard]] std::vector<std::string> limits() const;

  /** Prints the choice and its source. */
  void print_choice() const;
  void print_measured() const;
  [[nodiscard]] nlohmann::json to_json() const;

 private:
  [[nodiscard]] std::vector<measure::Model> models_of_report(const gpu::Device &device) const;
  [[nodiscard]] std::string requirement_text() const;

  ChoiceOptions options_;
  const scene::Scene &scene_;
  const scene::PlacedCamera &camera_;
  glm::ivec2 size_px_;
  bool has_multiscatter_;
  reference::Tracer tracer_;
  measure::Requirement requirement_;
  /** Source of the choice: a report or a pilot. */
  std::string source_;
  measure::Choice choice_;
  measure::SampledError measured_;
  double measured_seconds_ = 0.0;
};

}  // namespace gnomon::cli
