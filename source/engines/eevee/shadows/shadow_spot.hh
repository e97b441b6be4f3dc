// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_technique.hh"

namespace gnomon::eevee {

/** From clip space to texture coordinates: xy from [-1, 1] to [0, 1]; the depth is in [0, 1] already. */
extern const glm::mat4 texcomat;

/**
 * Spots wider than this (half the opening, radians) have a cube: a plane would stretch too far, and at 60° a point's
 * distance along the axis is half of its distance from the lamp, which is where lamp_near puts the near plane.
 */
inline constexpr float spot_map_angle_max = 1.04F;

/**
 * The view of a spot, with a border for a filter's kernel around its cone. \a outer_angle: half the opening, radians,
 * at most spot_map_angle_max. \a near: metres.
 */
[[nodiscard]] draw::View shadow_spot_view(const glm::mat4 &world_from_lamp, float outer_angle, float near, int size_px);

/** One map of depths: spots. */
[[nodiscard]] const ShadowTechnique &shadow_spot_technique();

/** Write the entries of \a slot's maps, of a spot or a sun. */
void write_map_data(const ShadowSlot &slot, shared::ShadowBlock &block);
/** \see ShadowTechnique::texel_size; of the finest map that holds the place. */
[[nodiscard]] double map_texel_size(const ShadowSlot &slot, const shared::ShadowBlock &block,
                                    const glm::dvec3 &position_ws);

}  // namespace gnomon::eevee
