// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_technique.hh"

#include <array>

namespace gnomon::eevee {

/** Rotations that turn a cube face's axis to -Z, in OpenGL's order: +X, -X, +Y, -Y, +Z, -Z. */
extern const std::array<glm::mat4, 6> cubefacemat;

/** The six views of a cube around \a position_ws, each with a border of CUBE_BORDER_TEXELS. \a near: metres. */
[[nodiscard]] std::array<draw::View, 6> shadow_cube_views(const glm::vec3 &position_ws, float near, int size_px);

/** Six faces of depths: point lamps, and spots wider than spot_map_angle_max. */
[[nodiscard]] const ShadowTechnique &shadow_cube_technique();

}  // namespace gnomon::eevee
