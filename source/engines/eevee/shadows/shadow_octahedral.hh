// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_octahedral_store.hh"
#include "shadow_technique.hh"

namespace gnomon::eevee {

/**
 * Exponential shadow maps of point, spot and area lamps: one octahedral layer of filtered distances for each lamp. It
 * is made from a temporary cube that all these lamps share.
 */
[[nodiscard]] const ShadowTechnique &shadow_octahedral_technique();

/**
 * The range of a lamp's exponential shadow, metres: the distance of the farthest corner of \a bounds_ws (bounds of the
 * scene), limited by the range of the lamp. The distance is rounded up to a power of 2^(1/4), so that moving objects
 * seldom change the exponent that is derived from the range.
 */
[[nodiscard]] float esm_range(const ShadowLamp &lamp, const scene::Bounds &bounds_ws);

/** The request of a lamp to the octahedral store. \a bounds_ws: bounds of the scene. */
[[nodiscard]] EsmLamp esm_lamp(const ShadowLamp &lamp, const ShadowPlace &place, const scene::Bounds &bounds_ws,
                               const ShadowSettings &settings);

}  // namespace gnomon::eevee
