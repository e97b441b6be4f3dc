// SPDX-License-Identifier: MIT
#include "view_canvas.hh"

#include "gpu_read.hh"

#include <imgui.h>

namespace gnomon::view {

void Canvas::free()
{
  texture_.reset();
  device_ = nullptr;
  size_px_ = glm::ivec2(0);
}

void Canvas::resize(gpu::Device &device, glm::ivec2 size_px)
{
  if (size_px == size_px_) {
    return;
  }
  free();
  texture_.emplace(device, "canvas", gpu::Format::RGBA8, size_px);
  device_ = &device;
  size_px_ = size_px;
}

void Canvas::clear(const glm::vec4 &color)
{
  gpu::CommandList list;
  draw::begin_pass(list, "canvas", target(), size_px_, {{0, 0}, size_px_}, {.clear_color = color});
  list.end_pass();
  device_->submit(list);
}

void Canvas::upload(gpu::Device &device, glm::ivec2 size_px, std::span<const std::uint8_t> rgba)
{
  resize(device, size_px);
  device_->upload(texture_->texture(), 0, std::as_bytes(rgba));
}

std::vector<std::uint8_t> Canvas::read() const
{
  return gpu::read_as<std::uint8_t>(*device_, texture_->texture());
}

draw::Target Canvas::target() const
{
  return texture_->target();
}

void Canvas::show(glm::vec2 size) const
{
  const glm::vec2 shown = size == glm::vec2(0.0F) ? glm::vec2(size_px_) : size;
  const gpu::ResourceId texture = texture_ ? texture_->texture().id() : 0;
  ImGui::Image(reinterpret_cast<ImTextureID>(std::uintptr_t(texture)), {shown.x, shown.y}, {0, 1}, {1, 0});
}

}  // namespace gnomon::view
