// SPDX-License-Identifier: MIT
#pragma once

#include "render_camera.hh"

#include <glm/vec2.hpp>

namespace gnomon::eevee {

using render_scene::view_of;

/** \a view with its samples moved from the middle of the pixels to \a offset_px from it, right and up. */
[[nodiscard]] draw::View with_sample_offset(const draw::View &view, glm::vec2 offset_px, glm::ivec2 size_px);

}  // namespace gnomon::eevee
