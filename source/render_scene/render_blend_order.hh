// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/vec4.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::render_scene {

/** More boxes than this are ordered by distance alone, because the exact order takes time by the square of their
 * number. */
inline constexpr std::size_t blend_order_exact_max = 1024;

/**
 * Indices of \a boxes in an order in which what they hold can be blended: the farthest first.
 *
 * Two boxes that a plane across a coordinate axis separates are in their true order, whatever their size: no ray from
 * the eye meets the box beyond the plane first. For the others, and where boxes are behind each other in a circle, the
 * distance of the middle decides.
 *
 * \a eye_ws: w = 1: its position. w = 0: the direction towards the viewer of a parallel view.
 */
[[nodiscard]] std::vector<std::uint32_t> back_to_front(std::span<const scene::Bounds> boxes, const glm::vec4 &eye_ws);

}  // namespace gnomon::render_scene
