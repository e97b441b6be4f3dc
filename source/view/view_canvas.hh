// SPDX-License-Identifier: MIT
#pragma once

#include "draw_target.hh"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::view {

/** A texture of the window's context that a viewport draws into and the user interface shows. */
class Canvas {
 public:
  Canvas() = default;
  Canvas(const Canvas &) = delete;
  Canvas &operator=(const Canvas &) = delete;
  ~Canvas();

  /** Delete the texture. The size is 0 afterwards. */
  void free();
  /** Set the size. The content is lost if the size changes. \pre size_px is at least 1x1 */
  void resize(glm::ivec2 size_px);
  void clear(const glm::vec4 &color);
  /** Replace size and content. \a rgba: rows from the bottom, four bytes for each pixel. */
  void upload(glm::ivec2 size_px, std::span<const std::uint8_t> rgba);

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
  unsigned texture_ = 0;
  unsigned framebuffer_ = 0;
};

}  // namespace gnomon::view
