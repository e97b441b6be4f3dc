// SPDX-License-Identifier: MIT
#include "draw_viewport.hh"

#include <glm/matrix.hpp>

#include <cmath>

namespace gnomon::draw {

Viewport::Viewport(gpu::Device &device, glm::ivec2 size_px) : device_(device), size_px_(size_px)
{
  const int most = device.limits().texture_size_max;
  if (size_px.x < 1 || size_px.y < 1 || size_px.x > most || size_px.y > most) {
    throw gpu::Error("viewport: {}x{} pixels are not from 1x1 to {}x{}", size_px.x, size_px.y, most, most);
  }
}

const gpu::Texture &Viewport::depth_texture()
{
  if (!depth_texture_) {
    depth_texture_ = device_.create_texture(
        {.name = "depth", .format = gpu::Format::Depth32F, .width = size_px_.x, .height = size_px_.y});
  }
  return depth_texture_;
}

static bool is_finite(const glm::mat4 &matrix)
{
  for (int column = 0; column < 4; column++) {
    for (int row = 0; row < 4; row++) {
      if (!std::isfinite(matrix[column][row])) {
        return false;
      }
    }
  }
  return true;
}

void Viewport::sync(std::span<Engine *const> engines, std::span<const ObjectRef> objects)
{
  for (const ObjectRef &object : objects) {
    if (!is_finite(object.world_from_object)) {
      throw gpu::Error("object {}: its matrix is not finite", object.index);
    }
    const glm::vec3 &center = object.volume.center_ws;
    if (std::isnan(center.x + center.y + center.z + object.volume.radius)) {
      throw gpu::Error("object {}: its culling volume is not a number", object.index);
    }
  }
  objects_.clear();
  for (Engine *engine : engines) {
    engine->init(*this);
    engine->cache_init(*this);
  }
  for (const ObjectRef &object : objects) {
    for (Engine *engine : engines) {
      engine->cache_populate(*this, object);
    }
  }
  for (Engine *engine : engines) {
    engine->cache_finish(*this);
  }
  // The identity alone is not worth a buffer.
  if (objects_.size() > 1) {
    objects_.upload(device_);
  }
}

void Viewport::draw(std::span<Engine *const> engines, const View &view)
{
  if (!is_finite(view.clip_from_world()) || !is_finite(glm::mat4(glm::inverse(glm::dmat4(view.view_from_world()))))) {
    throw gpu::Error("the view's matrix, or its inverse, is not finite");
  }
  for (Engine *engine : engines) {
    engine->draw_scene(*this, view);
  }
}

}  // namespace gnomon::draw
