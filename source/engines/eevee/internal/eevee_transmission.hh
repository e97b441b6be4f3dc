// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_blend.hh"
#include "internal/eevee_bodies.hh"
#include "internal/eevee_frame.hh"
#include "internal/eevee_renderbuffers.hh"

namespace gnomon::eevee {

/**
 * Surfaces that transmit light. They trace rays through each other, and read a copy of the picture without them:
 * decisions 0019 and 0040. Internal to the engine.
 */
class Transmission {
 public:
  Transmission(draw::ObjectBuffer &objects, const RenderBuffers &buffers);
  /** Create the copies, with mip levels if a surface \a is_rough. */
  void make(draw::Viewport &viewport, bool is_rough);
  /** Take the surfaces through which others are seen, and the background. Does nothing before make(). */
  void update(const render_scene::RenderScene &scene, std::span<const TransmissiveObject> objects,
              const Settings &settings, const SceneWorld &world);
  /** Destroy the copies and the surfaces. */
  void free();
  /** Remove all calls. */
  void clear();
  void bind(draw::ShadingGroup &group) const;

  void report(ResourceReport &report) const;
  [[nodiscard]] const Bodies &bodies() const
  {
    return bodies_;
  }
  /** Objects that the view leaves out, for the next update(). */
  void set_hidden(const draw::ObjectSet &hidden)
  {
    hidden_ = hidden;
  }
  [[nodiscard]] const draw::ObjectSet &hidden() const
  {
    return hidden_;
  }
  /** Copy of the radiance before these surfaces are drawn. Empty until one is seen: then nothing reads it. */
  [[nodiscard]] const gpu::Texture &behind() const
  {
    return behind_;
  }
  [[nodiscard]] draw::Pass &depth_pass()
  {
    return depth_pass_;
  }
  [[nodiscard]] draw::Pass &pass()
  {
    return pass_;
  }
  /** The pass of their depths, for other steps. */
  [[nodiscard]] FramePass depths() const;

  /** The copy, with the means of rough surfaces. */
  [[nodiscard]] FrameStep copy_step();
  /** The surfaces and their depth. */
  [[nodiscard]] FrameStep step();

 private:
  const RenderBuffers &buffers_;
  gpu::Texture behind_;
  gpu::Texture behind_depth_;
  Bodies bodies_;
  draw::ObjectSet hidden_;
  gpu::Sampler sampler_;
  draw::Pass depth_pass_;
  draw::Pass pass_;
};

/** The need of a step that is needed if \a is_needed and something in the view transmits light. */
[[nodiscard]] Need need_of_transmission(const FrameState &state, bool is_needed, std::string_view why,
                                        std::string_view why_not);

}  // namespace gnomon::eevee
