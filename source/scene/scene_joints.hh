// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

namespace gnomon::scene {

/**
 * Splits triangles at vertices of other triangles that lie on their edges (T joints), of the same mesh or of another
 * one, so that rasterisation leaves no crack there. A crack is up to a step of the rasteriser's coordinates wide: a
 * sample of a picture or a texel of a shadow map may see through it. Surfaces and the values of vertices do not change
 * beyond rounding.
 *
 * Only where one of the two edges belongs to a single triangle: bodies that are closed have no cracks. Opaque meshes of
 * triangles that are not deformed, in the present pose, whose vertices lie on the edge within two units in the last
 * place of their coordinates. Wider gaps stay. Meshes without such joints are not edited.
 *
 * So that the time is bounded, it does nothing in scenes with more than 2^15 edges of a single triangle, or with many
 * of them in one place.
 */
void close_joints(Scene &scene);

}  // namespace gnomon::scene
