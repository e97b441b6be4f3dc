// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_frame.hh"
#include "internal/eevee_renderbuffers.hh"
#include "internal/eevee_scene_world.hh"

namespace gnomon::eevee {

/** rgb: radiance of the background, or factor of the world's picture; alpha: 1. All 0 without a background. */
[[nodiscard]] glm::vec4 background_color(const Settings &settings, const render_scene::RenderScene &scene);

/** Draws the background behind the objects of a viewport. Internal to the engine. */
class BackgroundPass {
 public:
  BackgroundPass(const SceneWorld &world, const RenderBuffers &buffers) : world_(world), buffers_(buffers) {}
  /** Record the pass anew. It is empty without a background. */
  void record(ShaderCache &shaders, const render_scene::RenderScene &scene, const Settings &settings);
  [[nodiscard]] FrameStep step();

 private:
  void set_rays(const FrameSample &sample);

  const SceneWorld &world_;
  const RenderBuffers &buffers_;
  draw::Pass pass_ = draw::Pass("background_pass", gpu::State::WriteColor | gpu::State::DepthEqual);
  /** View rays of the current sample. The pass reads them by reference. \see eevee_background_frag.glsl */
  glm::vec4 corner_{0.0F};
  glm::vec4 across_{0.0F};
  glm::vec4 up_{0.0F};
};

}  // namespace gnomon::eevee
