// SPDX-License-Identifier: MIT
#pragma once

#include "render_camera.hh"

#include <glm/vec2.hpp>

namespace gnomon::eevee {

using render_scene::view_of;

/**
 * \a view with its samples moved from the pixel centres by \a offset_px: pixels, positive to the right and up.
 * \a size_px: size of the picture that \a view shows.
 */
[[nodiscard]] draw::View with_sample_offset(const draw::View &view, glm::vec2 offset_px, glm::ivec2 size_px);

}  // namespace gnomon::eevee
