// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <filesystem>
#include <stdexcept>

namespace gnomon::gltf {

/** A file that cannot be made a scene. The message names the file and the reason. */
struct ImportError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/**
 * Read glTF 2.0: `.gltf` with files or data URIs beside it, or `.glb`.
 *
 * The default scene's node tree is flattened: an object for each mesh primitive of each node. Units and node
 * extras (`gnomon_*`) are those of `doc/conventions.md`. What cannot be represented, while the rest can, is left
 * out with an entry in Scene::warnings; a camera and a lamp are made up where the file has none.
 *
 * \throws ImportError for a file that is missing, unreadable, malformed, or that holds nothing which can be kept.
 */
[[nodiscard]] scene::Scene import_gltf(const std::filesystem::path &path);

}  // namespace gnomon::gltf
