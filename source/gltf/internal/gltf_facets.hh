// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <cstddef>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * Gives each triangle of a flat-shaded, non-planar polygon its own normal.
 *
 * Exporters write such a polygon as triangles that share the polygon's normal, the mean of the triangles' normals.
 * Other renderers shade a flat polygon by the orientation of each triangle. Shared normals that differ from the mean
 * are intentional and remain. See doc/decisions/0004. Vertices that are unused afterwards are removed.
 *
 * \return the number of triangles with a new normal.
 */
std::size_t flatten_facets(scene::Mesh &mesh);

}  // namespace gnomon::gltf
