// SPDX-License-Identifier: MIT
#pragma once

#include "draw_target.hh"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::view {

/** A texture of the window's context that viewports are drawn into, and that the user interface shows. */
class Canvas {
 public:
  Canvas() = default;
  Canvas(const Canvas &) = delete;
  Canvas &operator=(const Canvas &) = delete;
  ~Canvas();

  /** Delete the texture; the size is 0 then. */
  void free();
  /** The content is lost where the size changes. \pre size_px is at least 1x1 */
  void resize(glm::ivec2 size_px);
  void clear(const glm::vec4 &color);
  /** Rows from the bottom, four bytes each. Sets the size. */
  void upload(glm::ivec2 size_px, std::span<const std::uint8_t> rgba);

  /** Rows from the bottom, four bytes each. */
  [[nodiscard]] std::vector<std::uint8_t> read() const;

  [[nodiscard]] draw::Target target() const;
  [[nodiscard]] glm::ivec2 size_px() const
  {
    return size_px_;
  }
  /** Draw it as an item of the current window, upright. \a size: on the screen, 0: its own. */
  void show(glm::vec2 size = glm::vec2(0.0F)) const;

 private:
  glm::ivec2 size_px_{0};
  unsigned texture_ = 0;
  unsigned framebuffer_ = 0;
};

}  // namespace gnomon::view
