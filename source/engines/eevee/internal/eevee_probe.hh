// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_depth.hh"
#include "internal/eevee_transmission.hh"

namespace gnomon::eevee {

/** Passes and textures of Inspection: properties of the surfaces of a view, and the visibility of a lamp. Internal. */
class SurfaceProbe {
 public:
  SurfaceProbe(draw::ObjectBuffer &objects, const RenderBuffers &buffers, const DepthPasses &depth,
               const Transmission &transmission);
  /** Create the textures that \a settings ask for. */
  void make(draw::Viewport &viewport, const Settings &settings);
  void resized();
  /** Remove all calls. */
  void clear();
  void bind_light(draw::ShadingGroup &group) const
  {
    group.constant_ref("probed_light", &light_);
  }
  /** Draw the surfaces of \a view, and the visibility of the light in \a entry of `light_block`. */
  void draw_visibility(const draw::View &view, int entry, gpu::CommandList &list);
  void draw_surfaces(const draw::View &view, gpu::CommandList &list) const;

  void report(ResourceReport &report) const;
  [[nodiscard]] draw::Pass &visibility_pass()
  {
    return visibility_pass_;
  }
  [[nodiscard]] draw::Pass &surfaces_pass()
  {
    return surfaces_pass_;
  }
  /** \see draw::Pass::is_current */
  [[nodiscard]] bool is_current(const gpu::Device &device) const
  {
    return visibility_pass_.is_current(device) && surfaces_pass_.is_current(device);
  }
  [[nodiscard]] std::array<const draw::Pass *, 2> passes() const
  {
    return {&visibility_pass_, &surfaces_pass_};
  }
  /** Textures of the members of Probe and Surfaces, in their order. Empty unless they were asked for. */
  [[nodiscard]] const std::array<gpu::Texture, 2> &visibility() const
  {
    return visibility_;
  }
  [[nodiscard]] const std::array<gpu::Texture, 3> &surfaces() const
  {
    return surfaces_;
  }

 private:
  /** Append passes that draw the depths of \a view, and \a pass where they are equal. */
  void draw(const draw::View &view, const char *name, const draw::Pass &pass, const gpu::Framebuffer &framebuffer,
            gpu::CommandList &list) const;

  const RenderBuffers &buffers_;
  const DepthPasses &depth_;
  const Transmission &transmission_;
  std::array<gpu::Texture, 2> visibility_;
  std::array<gpu::Texture, 3> surfaces_;
  gpu::Framebuffer visibility_fb_;
  gpu::Framebuffer surfaces_fb_;
  draw::Pass visibility_pass_;
  draw::Pass surfaces_pass_;
  /** The program reads it by reference. */
  int light_ = 0;
};

}  // namespace gnomon::eevee
