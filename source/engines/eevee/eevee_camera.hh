// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"
#include "scene.hh"

#include <glm/vec2.hpp>

namespace gnomon::eevee {

/**
 * What \a camera sees in an image of \a size_px. Where the image's aspect differs from the camera's own, the camera's
 * frame is in the middle and wholly visible.
 *
 * \a offset_px moves the image by a part of a pixel, right and up, for antialiasing.
 */
[[nodiscard]] draw::View view_of(const scene::Camera &camera, glm::ivec2 size_px, glm::vec2 offset_px = {});

}  // namespace gnomon::eevee
