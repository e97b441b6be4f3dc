// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <map>
#include <vector>

/** Animations of nodes, and of materials, lamps and cameras by KHR_animation_pointer. Internal to source/gltf. */
namespace gnomon::gltf {

/** The things of the scene for those of the file. A lamp or camera of the file is one of the scene for each node. */
struct ImportedThings {
  std::map<int, scene::Handle<scene::Node>> nodes;
  std::map<int, std::vector<scene::Handle<scene::Lamp>>> lamps;
  std::map<int, std::vector<scene::Handle<scene::Camera>>> cameras;
  std::map<int, scene::Handle<scene::Material>> materials;
};

/** Appends the file's animations to \a scene. Channels that cannot be played are left out with a warning. */
void import_animations(const File &file, const ImportedThings &things, Warnings &warnings, scene::Scene &scene);

}  // namespace gnomon::gltf
