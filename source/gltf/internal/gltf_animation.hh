// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <map>
#include <vector>

/**
 * Import of animations: of nodes, and with KHR_animation_pointer of materials, lamps and cameras. Internal to
 * source/gltf.
 */
namespace gnomon::gltf {

/**
 * Maps indices in the file to handles in the scene. A lamp or camera of the file becomes one lamp or camera of the
 * scene for each node that uses it.
 */
struct ImportedThings {
  /** Invalid for nodes that are not in the scene. */
  std::vector<scene::Handle<scene::Node>> nodes;
  /** The instances of nodes that have some, which have their meshes. */
  std::map<int, std::vector<scene::Handle<scene::Node>>> instances;
  std::map<int, std::vector<scene::Handle<scene::Lamp>>> lamps;
  std::map<int, std::vector<scene::Handle<scene::Camera>>> cameras;
  std::map<int, scene::Handle<scene::Material>> materials;
};

/** Append the file's animations to \a scene. Omits channels that are invalid or not supported, with a warning. */
void import_animations(const File &file, const ImportedThings &things, Warnings &warnings, scene::Scene &scene);

}  // namespace gnomon::gltf
