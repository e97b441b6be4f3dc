// SPDX-License-Identifier: MIT
#pragma once

#include "scene_types.hh"

namespace gnomon::scene {

/**
 * Computes Mesh::tangents for a material with \a normal_texture, or for another slot whose uvs and transform give the
 * directions, like MikkTSpace: each corner of a triangle adds its u
 * direction, weighted by its angle, to all vertices of the same position, normal and uv. Mirrored images are kept
 * apart: a vertex of triangles with both orientations is split in two. \pre the mesh has the slot's uvs
 */
void make_tangents(Mesh &mesh, const TextureSlot &normal_texture);

}  // namespace gnomon::scene
