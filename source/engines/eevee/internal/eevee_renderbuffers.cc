// SPDX-License-Identifier: MIT
#include "internal/eevee_renderbuffers.hh"
#include "internal/eevee_resource_report.hh"

#include "eevee_camera.hh"
#include "eevee_pixel_filter.hh"
#include "eevee_sequence_shared.h"
#include "internal/eevee_frame.hh"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::eevee {

void RenderBuffers::make(draw::Viewport &viewport)
{
  if (radiance) {
    return;
  }
  gpu::Device &device = viewport.device();
  const gpu::Texture &depth = viewport.depth_texture();
  radiance = create_target(device, "radiance", gpu::Format::RGBA32F, viewport.drawn_size_px());
  depth_fb = device.create_framebuffer({.name = "depth_fb", .colors = {}, .depth = {&depth}});
  main_fb = device.create_framebuffer({.name = "main_fb", .colors = {{&radiance}}, .depth = {&depth}});
  view_block = device.create_buffer({"view_block", gpu::BufferKind::Uniform, sizeof(shared::ViewData)});
  nearest = device.create_sampler({.name = "nearest"});
}

void RenderBuffers::resized()
{
  depth_fb = {};
  main_fb = {};
  radiance = {};
}

float pixel_size(const draw::View &view, const draw::Viewport &viewport)
{
  return 2.0F / (std::abs(view.clip_from_view()[1][1]) * float(viewport.drawn_size_px().y));
}

draw::View view_of_sample(const draw::View &drawn_view, const draw::Viewport &viewport, const Settings &settings,
                          int index)
{
  return with_sample_offset(view_through_lens(drawn_view, index, settings.sample_count, settings.seed),
                            film_offset_px(index, settings.sample_count, settings.seed), viewport.drawn_size_px());
}

/** Set the members of \a data from which positions in the G-buffer follow. \a bounds_ws: of the scene. */
static void set_places(shared::ViewData &data, const draw::View &view, glm::ivec2 size_px,
                       const glm::dmat4 &world_from_view, const scene::Bounds &bounds_ws)
{
  const glm::dmat4 projection(view.clip_from_view());
  const glm::dvec3 eye(world_from_view[3]);
  const glm::dvec3 back = glm::normalize(glm::dvec3(world_from_view[2]));
  double origin = 0.0;
  if (!bounds_ws.is_empty()) {
    // The near side of the scene, or the eye if the scene begins behind it. In double precision, as Bounds::radius
    // overflows for bounds above 1e19 m.
    const glm::dvec3 half_size = 0.5 * (glm::dvec3(bounds_ws.max) - glm::dvec3(bounds_ws.min));
    origin = glm::dot(eye - glm::dvec3(bounds_ws.center()), back) - glm::length(half_size);
    origin = view.is_perspective() ? std::max(origin, 0.0) : origin;
  }
  data.depth_origin_ws = glm::vec3(eye - back * origin);
  data.depth_origin = view.is_perspective() ? float(origin) : 0.0F;
  // View space: a perspective projection divides by the distance from the eye, an orthographic one adds its offset.
  const glm::dvec2 scale = 1.0 / glm::dvec2(projection[0][0], projection[1][1]);
  const glm::dvec2 offset = view.is_perspective() ? glm::dvec2(projection[2]) : -glm::dvec2(projection[3]);
  const glm::dvec3 right = glm::dvec3(world_from_view[0]) * scale.x;
  const glm::dvec3 up = glm::dvec3(world_from_view[1]) * scale.y;
  data.place_middle = glm::vec3(right * offset.x + up * offset.y);
  data.place_right = glm::vec4(glm::vec3(right), 2.0F / float(size_px.x));
  data.place_up = glm::vec4(glm::vec3(up), 2.0F / float(size_px.y));
}

shared::ViewData view_data(const draw::View &view, const draw::Viewport &viewport, const Settings &settings,
                           int sample_index, const scene::Bounds &bounds_ws)
{
  const glm::dmat4 world_from_view = glm::inverse(glm::dmat4(view.view_from_world()));
  shared::ViewData data{};
  data.clip_from_world = view.clip_from_world();
  data.position_ws = glm::vec3(world_from_view[3]);
  data.is_perspective = view.is_perspective() ? 1 : 0;
  data.back_ws = glm::normalize(glm::vec3(world_from_view[2]));
  set_places(data, view, viewport.drawn_size_px(), world_from_view, bounds_ws);
  // With n samples for each pixel, a sample covers 1/n of the pixel's area, so that the samples are n^-1/2 pixels
  // apart.
  const int sample_count = settings.sample_count == 0 ? sample_index + 1 : settings.sample_count;
  data.mask_shift = shared::to_unit(shared::scrambled_van_der_corput(std::uint32_t(sample_index), settings.seed));
  draw::set_clip_planes(data, view, {{0, 0}, viewport.drawn_size_px()});
  data.texture_lod_bias = -0.5F * std::log2(float(sample_count));
  return data;
}

void RenderBuffers::report(draw::Viewport &viewport, ResourceReport &report) const
{
  static const gpu::Texture none;
  report.add_target(viewport.has_depth_texture() ? viewport.depth_texture() : none, "depth", "each pixel is lit once",
                    nothing_seen);
  report.add_target(radiance, "radiance", "one sample, before the pixel filter", nothing_seen);
  report.add_block(view_block, "view_block", "whatever is drawn", nothing_seen);
}

}  // namespace gnomon::eevee
