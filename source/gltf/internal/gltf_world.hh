// SPDX-License-Identifier: MIT
#pragma once

#include "gltf_import.hh"
#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <string_view>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Whether the extra is one of a world's. Both the scene and its nodes may have them. */
[[nodiscard]] bool is_world_extra(std::string_view key);

/**
 * Sets the world of \a scene: that of the extras of the file's default scene, of the first of \a nodes that has such
 * extras, or of EXT_lights_image_based. Without any of them there is none. There is none either if its picture cannot
 * be used, which a warning says.
 *
 * \param nodes indices of visible nodes
 * \throws Fault for an extra of a wrong type or out of range
 */
void import_world(const File &file, const std::vector<int> &nodes, const ReadPicture &read_picture, Warnings &warnings,
                  scene::Scene &scene);

}  // namespace gnomon::gltf
