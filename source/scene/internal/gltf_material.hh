// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <cstdint>
#include <map>
#include <vector>

/** Internal to source/scene. */
namespace gnomon::scene::gltf {

/** Appends materials to a scene, each at its first use: what nothing wears is neither kept nor warned about. */
class MaterialImporter {
 public:
  /** Keeps references. */
  MaterialImporter(const File &file, Warnings &warnings, std::vector<Material> &materials);

  /** Index in the scene's materials for that of the file; -1 is glTF's default material. */
  [[nodiscard]] std::uint32_t index_of(int gltf_material);

 private:
  const File &file_;
  Warnings &warnings_;
  std::vector<Material> &materials_;
  std::map<int, std::uint32_t> index_of_;
};

}  // namespace gnomon::scene::gltf
