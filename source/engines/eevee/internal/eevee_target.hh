// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_film.hh"
#include "internal/eevee_renderbuffers.hh"

#include "draw_target_pass.hh"

namespace gnomon::eevee {

/** Writes the film and the depth of the picture to the target of a draw. Internal to the engine. */
class TargetOutput {
 public:
  TargetOutput(const Film &film, const RenderBuffers &buffers) : film_(film), buffers_(buffers) {}
  void resized();
  /** Remove all calls. */
  void clear();
  void begin_picture()
  {
    has_picture_depth_ = false;
  }
  /** \a target: of the draw that begins. */
  void set(const draw::Target &target)
  {
    target_ = target;
  }
  /**
   * Record the pass for the current target. \a view: of the picture and its guard band. \a has_blended: \see
   * draw::TargetPass::Picture::has_blended
   */
  void record(draw::Viewport &viewport, const draw::View &view, ShaderCache &shaders, const Settings &settings,
              bool has_blended);

  void report(ResourceReport &report) const;
  /** The target of the current draw, or of the last one. */
  [[nodiscard]] const draw::Target &target() const
  {
    return target_;
  }
  [[nodiscard]] bool is_recorded() const
  {
    return !pass_.is_empty();
  }

  /** \a passes: that draw the depths of all objects that are not blended. */
  [[nodiscard]] FrameStep depth_step(std::vector<FramePass> passes);
  [[nodiscard]] FrameStep step();

 private:
  [[nodiscard]] Need need_depth(const FrameState &state) const;
  [[nodiscard]] Need need(const FrameState &state) const;
  void draw_depth(FrameSample &sample, gpu::CommandList &list);
  void draw(FrameSample &sample, gpu::CommandList &list) const;

  const Film &film_;
  const RenderBuffers &buffers_;
  draw::Target target_;
  /** Depth of the view without sample offsets. Created if a target has depth and a picture has several samples. */
  gpu::Texture picture_depth_;
  gpu::Framebuffer picture_depth_fb_;
  draw::Pass pass_ = draw::Pass("tonemap", gpu::State::WriteColor);
  draw::TargetPass target_pass_;
  /** `picture_depth_` holds the depth of the current picture. */
  bool has_picture_depth_ = false;
};

}  // namespace gnomon::eevee
