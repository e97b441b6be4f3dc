// SPDX-License-Identifier: MIT
#pragma once

#include "measure_technique_run.hh"

#include "eevee_scene_renderer.hh"

namespace gnomon::measure {

/** Renders pictures with the same settings, and draws all shadows again for each picture. */
class TechniqueRenderer {
 public:
  /** \a device and \a scene must outlive the renderer. */
  TechniqueRenderer(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera,
                    const eevee::Settings &settings, glm::ivec2 size_px);

  /**
   * Creates all resources of a picture and draws one. Call it first. \a has_probe: whether lamp_errors will be called.
   */
  void warm_up(bool has_probe);
  /** \see TechniqueTimes */
  [[nodiscard]] std::map<std::string, double> step_seconds();
  /** \a progress: called after each sample, and may throw to end the picture. \see eevee::DrawLimits */
  [[nodiscard]] double picture_seconds(int sample_count, const std::function<bool(int samples_drawn)> &progress = {});
  /** The last picture. */
  [[nodiscard]] std::vector<glm::vec4> picture();
  [[nodiscard]] std::vector<LampError> lamp_errors(const reference::Tracer &tracer);
  [[nodiscard]] eevee::Report report()
  {
    return renderer_.inspect().report();
  }

 private:
  void set(int sample_count, bool is_timed);
  void draw(const eevee::DrawLimits &limits = {});

  scene::PlacedCamera camera_;
  eevee::Settings settings_;
  eevee::SceneRenderer renderer_;
};

}  // namespace gnomon::measure
