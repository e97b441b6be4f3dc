// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_depth_feedback.hh"
#include "internal/eevee_frame.hh"
#include "internal/eevee_renderbuffers.hh"

namespace gnomon::eevee {

class Shadows;

/**
 * The depths of opaque objects, the G-buffer of those with deferred lighting, and that lighting: decision 0030.
 * Internal to the engine.
 */
class DepthPasses {
 public:
  DepthPasses(draw::ObjectBuffer &objects, const RenderBuffers &buffers, const Shadows &shadows);

  /** Remove all calls of objects, and decide whether the scene has deferred lighting. \a features: of the frame. */
  void clear(const scene::Scene &scene, Feature features);
  /** Whether the G-buffer can hold the object. It must also receive shadows, as all others there do. */
  [[nodiscard]] bool is_deferred(const scene::Scene &scene, const render_scene::RenderObject &object) const;
  /** The pass of objects that are not deferred. */
  [[nodiscard]] draw::Pass &depth_pass(bool is_double_sided)
  {
    return is_double_sided ? depth_pass_ : depth_pass_cull_;
  }
  /** The objects of deferred lighting, in one pass with their depths. */
  [[nodiscard]] draw::Pass &gbuffer_pass()
  {
    return gbuffer_pass_;
  }
  /** Record the lighting of the G-buffer anew. It is empty if that has no objects. \a bind: binds what programs with
   * lighting read. */
  void record_lighting(gpu::Device &device, ShaderCache &shaders, Feature features, const BindLit &bind);

  [[nodiscard]] bool has_gbuffer() const
  {
    return !gbuffer_pass_.is_empty();
  }
  /** Passes that draw the depths of all opaque objects: one-sided and two-sided ones, and the G-buffer. */
  [[nodiscard]] std::vector<FramePass> passes() const;
  [[nodiscard]] DepthFeedback &feedback()
  {
    return feedback_;
  }
  [[nodiscard]] const DepthFeedback &feedback() const
  {
    return feedback_;
  }
  /** Whether suns are fitted to depths and the host does not have the depths of \a view yet. */
  [[nodiscard]] bool awaits(const draw::View &view) const;

  /** Depths and G-buffer of plain objects. */
  [[nodiscard]] FrameStep gbuffer_step();
  /** Depths of the others, before shadows are fitted to them; or, without a G-buffer, of all. */
  [[nodiscard]] FrameStep prepass_step();
  [[nodiscard]] FrameStep lighting_step();
  /** Depths of the others after deferred lighting, unless the prepass has drawn them. */
  [[nodiscard]] FrameStep forward_step();
  [[nodiscard]] Need need_forward(const FrameState &state) const;

 private:
  [[nodiscard]] Need need_gbuffer(const FrameState &state) const;
  [[nodiscard]] Need need_prepass(const FrameState &state) const;

  const RenderBuffers &buffers_;
  const Shadows &shadows_;
  draw::Pass depth_pass_;
  draw::Pass depth_pass_cull_;
  draw::Pass gbuffer_pass_;
  draw::Pass lighting_pass_ = draw::Pass("deferred_lit_pass", gpu::State::WriteColor | gpu::State::DepthFurther);
  DepthFeedback feedback_;
  bool is_scene_deferred_ = false;
};

}  // namespace gnomon::eevee
