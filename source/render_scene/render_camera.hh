// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"
#include "scene.hh"

#include <glm/vec2.hpp>

namespace gnomon::render_scene {

/**
 * What \a camera sees in an image of \a size_px, in coordinates relative to \a origin_ws. Where the image's aspect
 * differs from the camera's own, the camera's frame is in the middle and wholly visible.
 */
[[nodiscard]] draw::View view_of(const scene::PlacedCamera &camera, glm::ivec2 size_px,
                                 const glm::dvec3 &origin_ws = glm::dvec3(0.0));

}  // namespace gnomon::render_scene
