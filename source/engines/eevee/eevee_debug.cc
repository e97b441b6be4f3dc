// SPDX-License-Identifier: MIT
#include "eevee_debug.hh"

#include "eevee_shaders.hh"
#include "eevee_shadow_layers.hh"

#include "draw_pass.hh"

#include <algorithm>

namespace gnomon::eevee {

void ShadowPicture::fit_target(gpu::Device &device, glm::ivec2 size_px)
{
  if (texture_ && framebuffer_.size_px() == size_px) {
    return;
  }
  framebuffer_ = {};
  texture_ = {};
  texture_ = device.create_texture(
      {.name = "shadow_picture", .format = gpu::Format::RGBA32F, .width = size_px.x, .height = size_px.y});
  framebuffer_ = device.create_framebuffer({.name = "shadow_picture_fb", .colors = {{&texture_}}, .depth = {}});
  if (!sampler_) {
    sampler_ = device.create_sampler({.name = "shadow_picture_sampler"});
  }
}

const gpu::Texture &ShadowPicture::draw(gpu::Device &device, ShaderCache &shaders, const ShadowLayers &layers,
                                        std::optional<int> layer)
{
  GNOMON_ASSERT(layers.count > 0 && layer.value_or(0) >= 0 && layer.value_or(0) < layers.count,
                "layer {} of a shadow that has {}", layer.value_or(0), layers.count);
  const bool is_cross = layers.is_cube && !layer;
  const glm::ivec2 cells = is_cross ? glm::ivec2(4, 3) : glm::ivec2(layer ? 1 : layers.count, 1);
  const int cell_px = std::max(std::min(layers.size_px, shadow_picture_edge_max_px / std::max(cells.x, cells.y)), 1);
  fit_target(device, cells * cell_px);

  glm::vec4 near(0.0F);
  glm::vec4 far(0.0F);
  for (int i = 0; i < std::min(int(layers.near_far.size()), 4); i++) {
    near[i] = layers.near_far[std::size_t(i)].x;
    far[i] = layers.near_far[std::size_t(i)].y;
  }
  glm::vec4 tilt_x(0.0F);
  glm::vec4 tilt_y(0.0F);
  for (int i = 0; i < std::min(int(layers.tilts.size()), 4); i++) {
    tilt_x[i] = layers.tilts[std::size_t(i)].x;
    tilt_y[i] = layers.tilts[std::size_t(i)].y;
  }
  draw::Pass pass("shadow_picture", gpu::State::WriteColor);
  draw::ShadingGroup &group = pass.group(shaders.get(device, ShaderId::DebugShadow));
  group.bind_texture("shadow_layers", *layers.texture, sampler_);
  group.constant("near", near);
  group.constant("far", far);
  group.constant("tilt_x", tilt_x);
  group.constant("tilt_y", tilt_y);
  group.constant("shown", layers.shown);
  group.constant("projection", layers.projection);
  group.constant("esm_format", layers.esm_format);
  group.constant("first_layer", layers.first_layer);
  group.constant("placed", int(layers.placed));
  group.constant("drawn", int(layers.drawn));
  group.constant("size_px", layers.size_px);
  group.constant("border", layers.border);
  group.constant("cell_px", cell_px);
  group.constant("first_shown", layer.value_or(0));
  group.constant("is_cube", int(layers.is_cube));
  group.constant("is_cross", int(is_cross));
  group.call_procedural();

  gpu::CommandList list;
  list.begin_pass("shadow_picture", framebuffer_, {.color_load = gpu::LoadAction::DontCare});
  pass.record({}, list);
  list.end_pass();
  device.submit(list);
  return texture_;
}

}  // namespace gnomon::eevee
