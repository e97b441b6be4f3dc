// SPDX-License-Identifier: MIT
#pragma once

#include "overlay.hh"

namespace gnomon::overlay {

/**
 * The triangle of \a mesh that a pixel shows, and its point there. \a direction_ws: from the eye, of any length.
 * \a position_ws: a point of the ray through the pixel, on the surface up to the errors of depth; it becomes that of
 * the triangle. Empty: the mesh has no triangle on the CPU that is seen from there.
 */
[[nodiscard]] std::optional<TrianglePoint> triangle_at(const scene::Mesh &mesh, const glm::dmat4 &world_from_mesh,
                                                       bool is_double_sided, const glm::dvec3 &direction_ws,
                                                       glm::dvec3 &position_ws);

}  // namespace gnomon::overlay
