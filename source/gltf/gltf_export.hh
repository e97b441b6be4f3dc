// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <filesystem>
#include <stdexcept>
#include <string>

namespace gnomon::gltf {

/** Thrown if a scene cannot be written. The message names the file and the reason. */
struct ExportError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/**
 * Writes a scene as one glTF 2.0 file with all buffers and images embedded: JSON if \a path ends in ".gltf", binary if
 * it ends in ".glb". The same scene gives the same bytes.
 *
 * import_gltf reads the same scene: node tree, matrices, meshes, materials, textures, images, lamps, cameras, flags,
 * the world, skins, morph targets and animations. The pose is the current one. Properties that glTF lacks are written
 * as extras (`gnomon_*`, see `doc/conventions.md`), beside those of other programs: Node::extras and others; those of
 * an area lamp with those of its nodes. The picture of a world that was read from a file stays there, and the written
 * file refers to it (ImportOptions::read_picture).
 *
 * A node that shows the deformed mesh of another node is read with joints of its own below it, because glTF ignores the
 * transform of a node with a skin. A mesh that does not fit its rest shape (scene::fault_of), or whose node was
 * removed, is written in its current shape.
 *
 * Not written: things that no node uses, meshes without triangles, references to removed things, and the camera and
 * lamp that the importer added to a file without one, unless they were edited; the studio of
 * scene::Scene::default_world; animations of properties of area lamps; shear of nodes that an animation moves. A lamp
 * or camera of several nodes is read as one for each node.
 *
 * An existing file is replaced only after the new one is complete.
 *
 * \throws ExportError if a number is not finite, a name is not UTF-8 or has more than 1024 bytes, an image cannot be
 * encoded, extras are neither empty nor a JSON object, or the file cannot be written.
 */
void export_gltf(const scene::Scene &scene, const std::filesystem::path &path);

/**
 * Variants of materials and extras of the file at \a path that a scene which is read from it cannot keep, such as
 * "2 variants of materials" and "extra 'price' of accessor 3 and 4 others". Reads the file again. Empty: none, or the
 * file is missing or not glTF. Extras go unnamed if their thing is not written at all: nodes of other scenes, and
 * materials, meshes, cameras and lamps that no node uses. Those that a file shares among things, so that a scene has
 * too many, are an import warning instead.
 */
[[nodiscard]] std::string left_out_of_export(const std::filesystem::path &path);

}  // namespace gnomon::gltf
