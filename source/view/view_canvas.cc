// SPDX-License-Identifier: MIT
#include "view_canvas.hh"

#include <epoxy/gl.h>
#include <imgui.h>

namespace gnomon::view {

Canvas::~Canvas()
{
  free();
}

void Canvas::free()
{
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &texture_);
  framebuffer_ = 0;
  texture_ = 0;
  size_px_ = glm::ivec2(0);
}

void Canvas::resize(glm::ivec2 size_px)
{
  if (size_px == size_px_) {
    return;
  }
  if (framebuffer_ == 0) {
    glCreateFramebuffers(1, &framebuffer_);
  }
  glDeleteTextures(1, &texture_);
  glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
  glTextureStorage2D(texture_, 1, GL_RGBA8, size_px.x, size_px.y);
  glTextureParameteri(texture_, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(texture_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture_, 0);
  size_px_ = size_px;
}

void Canvas::clear(const glm::vec4 &color)
{
  glClearNamedFramebufferfv(framebuffer_, GL_COLOR, 0, &color.x);
}

void Canvas::upload(glm::ivec2 size_px, std::span<const std::uint8_t> rgba)
{
  resize(size_px);
  glTextureSubImage2D(texture_, 0, 0, 0, size_px.x, size_px.y, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
}

std::vector<std::uint8_t> Canvas::read() const
{
  std::vector<std::uint8_t> rgba(4 * std::size_t(size_px_.x) * std::size_t(size_px_.y));
  glGetTextureImage(texture_, 0, GL_RGBA, GL_UNSIGNED_BYTE, GLsizei(rgba.size()), rgba.data());
  return rgba;
}

draw::Target Canvas::target() const
{
  return {.framebuffer = gpu::HostFramebuffer{framebuffer_, size_px_}};
}

void Canvas::show(glm::vec2 size) const
{
  const glm::vec2 shown = size == glm::vec2(0.0F) ? glm::vec2(size_px_) : size;
  ImGui::Image(reinterpret_cast<ImTextureID>(std::uintptr_t(texture_)), {shown.x, shown.y}, {0, 1}, {1, 0});
}

}  // namespace gnomon::view
