// SPDX-License-Identifier: MIT
#pragma once

#include "measure_choice.hh"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <string>

namespace gnomon::cli {

/** `--max-error`, `--max-time` and `--report`. */
struct ChoiceOptions {
  /** RMSE; 0: not asked for. */
  double error_max = 0.0;
  /** 0: not asked for. */
  double milliseconds_max = 0.0;
  /** Folder of `gnomon report`; empty: none. */
  std::string report_folder;

  [[nodiscard]] bool is_asked() const
  {
    return error_max > 0.0 || milliseconds_max > 0.0;
  }
};

/** The choice of a picture's settings, from what is known of its scene to what came of it. */
class Chooser {
 public:
  /**
   * From the report, where it has the scene at that size, and else from a pilot on \a device. All of them must outlive
   * it. \throws std::runtime_error naming the report where it cannot be read.
   */
  Chooser(const ChoiceOptions &options, gpu::Device &device, const scene::Scene &scene,
          const scene::PlacedCamera &camera, glm::ivec2 size_px);

  [[nodiscard]] const measure::Choice &choice() const
  {
    return choice_;
  }
  /** Compare the picture with exact rays, at other pixels than the pilot's. \a seconds: what the first one took. */
  void measure(std::span<const glm::vec4> picture, double seconds);
  /** What was missed, if anything, by name. */
  [[nodiscard]] std::vector<std::string> limits() const;

  /** What was chosen, and why. */
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
  reference::Tracer tracer_;
  measure::Requirement requirement_;
  /** Where the choice is from. */
  std::string source_;
  measure::Choice choice_;
  measure::SampledError measured_;
  double measured_seconds_ = 0.0;
};

}  // namespace gnomon::cli
