// SPDX-License-Identifier: MIT
#include "draw_viewport.hh"

namespace gnomon::draw {

Viewport::Viewport(gpu::Device &device, glm::ivec2 size_px)
    : device_(device),
      size_px_(size_px),
      depth_texture_(device.create_texture(
          {.name = "depth", .format = gpu::Format::Depth32F, .width = size_px.x, .height = size_px.y}))
{
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
  objects_.upload(device_);
}

void Viewport::draw(std::span<Engine *const> engines, const View &view)
{
  for (Engine *engine : engines) {
    engine->draw_scene(*this, view);
  }
}

}  // namespace gnomon::draw
