// SPDX-License-Identifier: MIT
#pragma once

#include "measure_technique_run.hh"

#include "eevee_scene_renderer.hh"

namespace gnomon::measure {

/** Renders pictures with one technique, and draws all shadows again for each picture. */
class TechniqueRenderer {
 public:
  /** All references must outlive the renderer. \a has_multiscatter: see eevee::Settings. */
  TechniqueRenderer(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera,
                    const Technique &technique, glm::ivec2 size_px, bool has_multiscatter);

  /**
   * Creates all resources of a picture and draws one. Call it first. \a has_probe: whether lamp_errors will be called.
   */
  void warm_up(bool has_probe);
  /** \see TechniqueTimes */
  [[nodiscard]] std::map<std::string, double> step_seconds();
  [[nodiscard]] double picture_seconds(int sample_count);
  /** The last picture. */
  [[nodiscard]] std::vector<glm::vec4> picture();
  [[nodiscard]] std::vector<LampError> lamp_errors(const reference::Tracer &tracer);
  [[nodiscard]] eevee::Report report()
  {
    return renderer_.inspect().report();
  }

 private:
  void set(int sample_count, bool is_timed);
  void draw();

  scene::PlacedCamera camera_;
  eevee::Settings settings_;
  eevee::SceneRenderer renderer_;
};

}  // namespace gnomon::measure
