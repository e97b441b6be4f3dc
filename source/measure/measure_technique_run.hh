// SPDX-License-Identifier: MIT
#pragma once

#include "measure_technique.hh"

#include "gpu_device.hh"
#include "reference_compare.hh"
#include "scene.hh"

#include <map>
#include <string>
#include <vector>

namespace gnomon::measure {

/** Times of one measurement of a technique, seconds. \see eevee::StepTime for the names of steps. */
struct TechniqueTimes {
  /** Device time of each step of a picture with one sample, including all shadows. */
  std::map<std::string, double> step_seconds;
  /**
   * Wall time of each entry of Technique::sample_counts, from the first draw to the last pixel, including all shadows.
   */
  std::vector<double> picture_seconds;
};

/** Error of one lamp's shadows. */
struct LampError {
  std::string lamp;
  reference::VisibilityError error;
};

/** Results that are the same in each round. */
struct TechniqueResult {
  /** One for each lamp that emits light. */
  std::vector<LampError> lamps;
  /** Scene-linear, rows from the bottom; one for each entry of Technique::sample_counts. */
  std::vector<std::vector<glm::vec4>> pictures;
  /** Device memory of textures, buffers and meshes. */
  std::size_t memory_bytes = 0;
  std::vector<std::string> warnings;
  std::vector<std::string> limits;
  /** \see eevee::Report */
  int lost_shadow_count = 0;
};

/** Removes per-lamp shadow settings, except `None`, so that the technique's settings apply to all lamps. */
void remove_shadow_settings(scene::Scene &scene);

/**
 * Renders pictures of \a scene with a technique, through its first camera, and measures their times. A picture is drawn
 * before, so that nothing is compiled during the measurement. \a tracer: the reference, of the same scene. If it is
 * null, only times are measured and \a result is unchanged. \a has_multiscatter: see eevee::Settings.
 */
[[nodiscard]] TechniqueTimes measure_technique(gpu::Device &device, const scene::Scene &scene,
                                               const Technique &technique, glm::ivec2 size_px,
                                               const reference::Tracer *tracer, TechniqueResult &result,
                                               bool has_multiscatter = false);

}  // namespace gnomon::measure
