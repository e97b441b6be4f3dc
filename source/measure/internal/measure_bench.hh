// SPDX-License-Identifier: MIT
#pragma once

#include "measure_visit.hh"

#include "draw_viewport.hh"
#include "eevee_camera.hh"
#include "eevee_engine.hh"

#include <array>

namespace gnomon::measure {

/** An engine and its viewport, for pictures by one technique; each with its shadows drawn anew. */
class Bench {
 public:
  /** All of them must outlive it. */
  Bench(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera, const Technique &technique,
        glm::ivec2 size_px);

  /** Make all that a picture needs, and draw one. First of all; \a has_probe: judge will be asked. */
  void warm_up(bool has_probe);
  /** \see VisitTimes */
  [[nodiscard]] std::map<std::string, double> step_seconds();
  [[nodiscard]] double picture_seconds(int sample_count);
  /** The last. */
  [[nodiscard]] std::vector<glm::vec4> picture();
  [[nodiscard]] std::vector<LampError> judge(const reference::Tracer &tracer);
  [[nodiscard]] eevee::Report report()
  {
    return engine_.report(viewport_);
  }

 private:
  void set(int sample_count, bool is_timed);
  void draw(int sample_count);

  eevee::Settings settings_;
  render_scene::RenderScene render_scene_;
  eevee::Engine engine_;
  draw::Viewport viewport_;
  draw::View view_;
  std::array<draw::Engine *, 1> engines_ = {&engine_};
};

}  // namespace gnomon::measure
