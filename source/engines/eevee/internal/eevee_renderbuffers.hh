// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view_shared.h"
#include "draw_viewport.hh"
#include "scene_types.hh"

namespace gnomon::eevee {

struct ResourceReport;
struct Settings;

/** Textures and framebuffers of one sample, which all modules of a viewport share. Internal to the engine. */
struct RenderBuffers {
  /** Light of the sample, with the guard band. With deferred lighting, it holds the G-buffer before. */
  gpu::Texture radiance;
  /** The viewport's depth alone, and with `radiance`. */
  gpu::Framebuffer depth_fb;
  gpu::Framebuffer main_fb;
  gpu::Buffer view_block;
  gpu::Sampler nearest;

  /** Create the targets that do not exist yet. */
  void make(draw::Viewport &viewport);
  /** Destroy the targets that depend on the size of the picture. */
  void resized();
  void report(draw::Viewport &viewport, ResourceReport &report) const;
};

/** Edge of a pixel, metres: at a distance of 1 m for perspective views, at any distance for orthographic views. */
[[nodiscard]] float pixel_size(const draw::View &view, const draw::Viewport &viewport);

/** The view of the \a index-th sample of the picture. \a drawn_view: of the picture and its guard band. */
[[nodiscard]] draw::View view_of_sample(const draw::View &drawn_view, const draw::Viewport &viewport,
                                        const Settings &settings, int index);

/** The content of `view_block`. \a bounds_ws: of the scene. */
[[nodiscard]] shared::ViewData view_data(const draw::View &view, const draw::Viewport &viewport,
                                         const Settings &settings, int sample_index, const scene::Bounds &bounds_ws);

}  // namespace gnomon::eevee
