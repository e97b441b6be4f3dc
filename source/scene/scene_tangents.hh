// SPDX-License-Identifier: MIT
#pragma once

#include "scene_types.hh"

namespace gnomon::scene {

/**
 * Compute Mesh::tangents for a material whose normal texture is \a normal_texture, as MikkTSpace does: each corner of a
 * triangle adds its direction of u, weighted by its angle, to the vertices of the same position, normal and uv, apart
 * for mirrored images. A vertex with triangles of both kinds is split into two. \pre the mesh has the slot's uvs
 */
void make_tangents(Mesh &mesh, const TextureSlot &normal_texture);

}  // namespace gnomon::scene
