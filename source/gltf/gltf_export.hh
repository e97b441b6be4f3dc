// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <filesystem>
#include <stdexcept>

namespace gnomon::gltf {

/** A scene that cannot be written. The message names the file and the reason. */
struct ExportError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/**
 * Write a scene as glTF 2.0: one file that holds everything, as text where \a path ends in ".gltf", and binary where it
 * ends in ".glb". The same scene gives the same bytes.
 *
 * import_gltf reads the same scene back: node tree, matrices, meshes, materials, textures, images, lamps, cameras and
 * flags. What glTF has no property for is in extras (`gnomon_*`, see `doc/conventions.md`).
 *
 * Not written are things that no node uses, meshes without triangles, references to removed things, and the camera and
 * the lamp that the importer added to a file without one. A lamp or a camera of several nodes is read back as one for
 * each node.
 *
 * A file of that name is replaced only when the new one is complete.
 *
 * \throws ExportError where a number is not finite, a name is not UTF-8 or has more than 1024 bytes, an image cannot be
 * encoded, or the file cannot be written.
 */
void export_gltf(const scene::Scene &scene, const std::filesystem::path &path);

}  // namespace gnomon::gltf
