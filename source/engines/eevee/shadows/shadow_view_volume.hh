// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"
#include "scene.hh"

#include <vector>

namespace gnomon::eevee {

/**
 * Corners of the part of \a bounds that \a view sees: the box cut by the frustum. World space.
 * Nothing where they do not meet, or \a bounds is empty. \a memory: for the result; its content is lost.
 */
[[nodiscard]] std::vector<glm::dvec3> visible_corners(const draw::View &view, const scene::Bounds &bounds,
                                                      std::vector<glm::dvec3> memory = {});

}  // namespace gnomon::eevee
