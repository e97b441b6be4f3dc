// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"
#include "scene.hh"

#include <vector>

namespace gnomon::eevee {

/**
 * Corners of the intersection of \a bounds and the frustum of \a view, world space. Empty if they do not intersect or
 * if \a bounds is empty. A corner may occur several times. \a memory: its capacity is reused for the result; its
 * content is discarded.
 */
[[nodiscard]] std::vector<glm::dvec3> visible_corners(const draw::View &view, const scene::Bounds &bounds,
                                                      std::vector<glm::dvec3> memory = {});

}  // namespace gnomon::eevee
