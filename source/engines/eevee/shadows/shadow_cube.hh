// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"
#include "scene.hh"

#include <array>

namespace gnomon::eevee {

class ShadowTechnique;

/** Rotations from world space to the view space of each face, in OpenGL's order: +X, -X, +Y, -Y, +Z, -Z. */
extern const std::array<glm::mat4, 6> cubefacemat;
/** The axis of each face, away from the lamp. */
inline constexpr std::array<const char *, 6> cube_face_names = {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};

/**
 * The six views of a cube around \a position_ws, each with a border of CUBE_BORDER_TEXELS. \a near: distance of the
 * near plane, metres. \a size_px: edge of a face, texels.
 */
[[nodiscard]] std::array<draw::View, 6> shadow_cube_views(const glm::vec3 &position_ws, float near, int size_px);

/**
 * Whether hard and percentage-closer shadows of a lamp are in a cube: those of points, areas, and spots wider than
 * spot_map_angle_max. \a spot_outer_angle: see ShadowLamp.
 */
[[nodiscard]] bool has_cube(scene::LampKind kind, float spot_outer_angle);

/** Cube shadow maps of point lamps, area lamps, and spots wider than spot_map_angle_max. */
[[nodiscard]] const ShadowTechnique &shadow_cube_technique();

}  // namespace gnomon::eevee
