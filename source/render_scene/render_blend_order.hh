// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"
#include "scene.hh"

#include <glm/vec4.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::render_scene {

/** More boxes than this are ordered by distance alone, because the exact order takes time by the square of their
 * number. */
inline constexpr std::size_t blend_order_exact_max = 1024;

/** The position of the eye, with w = 1; of a parallel view the direction towards the viewer, with w = 0. World space.
 */
[[nodiscard]] glm::vec4 eye_of(const draw::View &view);

/**
 * Indices of \a boxes in an order in which their content can be blended: the farthest first.
 *
 * Two boxes that a plane across a coordinate axis separates are in their true order, whatever their size: no ray from
 * the eye meets the box beyond the plane first. For the others, and where boxes are behind each other in a circle, the
 * distance of the middle decides.
 *
 * \a eye_ws: see eye_of. The length of a direction does not matter.
 */
[[nodiscard]] std::vector<std::uint32_t> back_to_front(std::span<const scene::Bounds> boxes, const glm::vec4 &eye_ws);

}  // namespace gnomon::render_scene
