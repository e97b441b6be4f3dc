// SPDX-License-Identifier: MIT
#pragma once

#include "render_camera.hh"

#include <glm/vec2.hpp>

#include <cstdint>

namespace gnomon::eevee {

using render_scene::view_of;

/**
 * \a view with its samples moved from the pixel centres by \a offset_px: pixels, positive to the right and up.
 * \a size_px: size of the picture that \a view shows.
 */
[[nodiscard]] draw::View with_sample_offset(const draw::View &view, glm::vec2 offset_px, glm::ivec2 size_px);

/** The point of \a lens at \a place of the unit square, which it maps evenly: metres along +X and +Y of view space. */
[[nodiscard]] glm::vec2 lens_point(const draw::Lens &lens, glm::vec2 place);
/**
 * The view of a pinhole at the point of the lens of \a view through which sample \a index sees. The plane in focus
 * stays where it is in the picture. \a count: samples of the picture; with one, the point is the centre. 0: unlimited.
 */
[[nodiscard]] draw::View view_through_lens(const draw::View &view, int index, int count, std::uint32_t seed);
/** The view of a pinhole that contains all that \a view sees through all points of its lens. */
[[nodiscard]] draw::View view_around_lens(const draw::View &view);

}  // namespace gnomon::eevee
