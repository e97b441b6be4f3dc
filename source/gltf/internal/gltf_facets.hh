// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <cstddef>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * Give each triangle of a flat-shaded polygon that is not plane its own normal.
 *
 * An exporter writes such a polygon as triangles that all carry the polygon's normal, the mean of theirs. What is meant
 * is a flat face, and a renderer that is given the polygon shades each of its triangles by where it lies. Where the
 * shared normal is anything but that mean it was made so on purpose, and stays. See doc/decisions/0004. Vertices that
 * no triangle uses afterwards are removed.
 *
 * \return how many triangles got another normal.
 */
std::size_t flatten_facets(scene::Mesh &mesh);

}  // namespace gnomon::gltf
