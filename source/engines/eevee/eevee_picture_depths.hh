// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"

#include <glm/vec2.hpp>

#include <span>

namespace gnomon::eevee {

/** The depths of a picture that was drawn. */
struct PictureDepths {
  /** Reversed depths, row by row from the bottom; 0 without a surface. Empty if there are none. */
  std::span<const float> depths{};
  glm::ivec2 size_px{0};
  /** The view of the picture, without a sample's offset. */
  draw::View view{};
};

}  // namespace gnomon::eevee
