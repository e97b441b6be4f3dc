// SPDX-License-Identifier: MIT
#pragma once

#include "draw_target.hh"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::view {

/** A texture that a viewport draws into and the user interface shows. */
class Canvas {
 public:
  /** Delete the texture. The size is 0 afterwards. */
  void free();
  /**
   * Set the size. The content is lost if the size changes. \a device must outlive the texture. \pre size_px is at least
   * 1x1 \throws gpu::Error
   */
  void resize(gpu::Device &device, glm::ivec2 size_px);
  /** \pre the size is not 0, here and in read() and target() */
  void clear(const glm::vec4 &color);
  /** Replace size and content. \a rgba: rows from the bottom, four bytes for each pixel. */
  void upload(gpu::Device &device, glm::ivec2 size_px, std::span<const std::uint8_t> rgba);

  /** The content: rows from the bottom, four bytes for each pixel. */
  [[nodiscard]] std::vector<std::uint8_t> read() const;

  [[nodiscard]] draw::Target target() const;
  [[nodiscard]] glm::ivec2 size_px() const
  {
    return size_px_;
  }
  /** Draw the texture upright as an item of the current ImGui window. \a size: on the screen, pixels; 0: size_px. */
  void show(glm::vec2 size = glm::vec2(0.0F)) const;

 private:
  glm::ivec2 size_px_{0};
  /** The device of texture_. */
  gpu::Device *device_ = nullptr;
  std::optional<draw::TargetTexture> texture_;
};

}  // namespace gnomon::view
