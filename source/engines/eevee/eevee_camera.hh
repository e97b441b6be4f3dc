// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"
#include "scene.hh"

#include <glm/vec2.hpp>

namespace gnomon::eevee {

/**
 * What \a camera sees in an image of \a size_px, in coordinates relative to \a origin_ws. Where the image's aspect
 * differs from the camera's own, the camera's frame is in the middle and wholly visible.
 */
[[nodiscard]] draw::View view_of(const scene::PlacedCamera &camera, glm::ivec2 size_px,
                                 const glm::dvec3 &origin_ws = glm::dvec3(0.0));

/** \a view with its samples moved from the middle of the pixels to \a offset_px from it, right and up. */
[[nodiscard]] draw::View with_sample_offset(const draw::View &view, glm::vec2 offset_px, glm::ivec2 size_px);

}  // namespace gnomon::eevee
