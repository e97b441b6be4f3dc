// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_technique.hh"

namespace gnomon::eevee {

/**
 * One octahedral layer of filtered distances, made from the faces of a cube that all such lamps share: exponential
 * shadows of point lamps and spots.
 */
[[nodiscard]] const ShadowTechnique &shadow_octahedral_technique();

/**
 * How far a lamp's exponential shadow has to reach in a scene of \a bounds_ws, metres: to the scene's end, where the
 * lamp's range is not nearer. In steps of a quarter of a power of 2, so that an object that moves seldom changes the
 * exponents derived from it.
 */
[[nodiscard]] float esm_range(const ShadowLamp &lamp, const scene::Bounds &bounds_ws);

/** What a lamp with a place asks of the octahedral store. \a bounds_ws: of the scene. */
[[nodiscard]] EsmLamp esm_lamp(const ShadowLamp &lamp, const ShadowPlace &place, const scene::Bounds &bounds_ws,
                               const ShadowSettings &settings);

}  // namespace gnomon::eevee
