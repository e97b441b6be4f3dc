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
 * An edge is split if a single triangle has it, or if the vertex is at the end of such an edge: closed bodies have no
 * cracks. The vertex must lie on the edge within two units in the last place of the coordinates; wider gaps stay. The
 * meshes must be opaque, of triangles and not deformed. Their places are those of the present pose. Meshes without such
 * joints are not edited.
 *
 * The function does nothing in scenes with more than 2^15 edges of a single triangle, or with many of them in one
 * place, so that its time is bounded.
 */
void close_joints(Scene &scene);

}  // namespace gnomon::scene
