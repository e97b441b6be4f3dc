// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"
#include "scene.hh"

#include <glm/vec2.hpp>

namespace gnomon::render_scene {

/** \throws gpu::Error that names the camera if its position is not finite, or its lens cannot be drawn */
void check(const scene::PlacedCamera &camera);

/**
 * The view of \a camera for an image of \a size_px, in coordinates relative to \a origin_ws. If the image's aspect
 * ratio differs from the camera's, the camera's frame is centred in the image and completely visible.
 * \throws gpu::Error as check()
 */
[[nodiscard]] draw::View view_of(const scene::PlacedCamera &camera, glm::ivec2 size_px,
                                 const glm::dvec3 &origin_ws = glm::dvec3(0.0));

}  // namespace gnomon::render_scene
