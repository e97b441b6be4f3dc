// SPDX-License-Identifier: MIT
#include "draw_viewport.hh"

namespace gnomon::draw {

Viewport::Viewport(gpu::Device &device, glm::ivec2 size_px) : device_(device), size_px_(size_px) {}

const gpu::Texture &Viewport::depth_texture()
{
  if (!depth_texture_) {
    depth_texture_ = device_.create_texture(
        {.name = "depth", .format = gpu::Format::Depth32F, .width = size_px_.x, .height = size_px_.y});
  }
  return depth_texture_;
}

void Viewport::sync(std::span<Engine *const> engines, std::span<const ObjectRef> objects)
{
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
  for (Engine *engine : engines) {
    engine->draw_scene(*this, view);
  }
}

}  // namespace gnomon::draw
