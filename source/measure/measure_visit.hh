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

/** Wall times of a visit. Step: what the engine calls its steps; see eevee::StepTime. */
struct VisitTimes {
  /** The device's, of a picture of one sample, shadows drawn anew. */
  std::map<std::string, double> step_seconds;
  /** One an entry of Technique::sample_counts: from the first draw to the last pixel, shadows drawn anew. */
  std::vector<double> picture_seconds;
};

/** How wrong one lamp's shadows are. */
struct LampError {
  std::string lamp;
  reference::VisibilityError error;
};

/** What does not change from one visit to the next. */
struct VisitResult {
  /** Lamps that shine. */
  std::vector<LampError> lamps;
  /** Scene-linear, rows from the bottom; one an entry of Technique::sample_counts. */
  std::vector<std::vector<glm::vec4>> pictures;
  /** Textures, buffers and meshes on the device. */
  std::size_t memory_bytes = 0;
  std::vector<std::string> warnings;
  std::vector<std::string> limits;
  /** \see eevee::Report */
  int lost_shadow_count = 0;
};

/** Lamps' own wishes taken away, but for those that want no shadow: the technique decides. */
void leave_shadows_to_technique(scene::Scene &scene);

/**
 * Render pictures of \a scene by its first camera with a technique, and take the time. One picture is drawn before, so
 * that nothing is compiled while the clock runs. \a tracer, of the same scene, judges; without one nothing but time is
 * measured, and \a result stays as it is.
 */
[[nodiscard]] VisitTimes visit(gpu::Device &device, const scene::Scene &scene, const Technique &technique,
                               glm::ivec2 size_px, const reference::Tracer *tracer, VisitResult &result);

}  // namespace gnomon::measure
