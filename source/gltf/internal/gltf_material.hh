// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "internal/gltf_slots.hh"
#include "internal/gltf_texture.hh"
#include "scene.hh"

#include <map>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Appends materials to a scene, each at its first use: what nothing wears is neither kept nor warned about. */
class MaterialImporter {
 public:
  /** Keeps references. */
  MaterialImporter(const File &file, Warnings &warnings, scene::Scene &scene);

  /** The scene's material for a material of the file; -1 is glTF's default material. */
  [[nodiscard]] scene::Handle<scene::Material> handle_of(int gltf_material);

  /**
   * The n of TEXCOORD_n of a material that handle_of returned: TextureSlot::uv_set is an index in it. At most two.
   */
  [[nodiscard]] const std::vector<int> &uv_sets(scene::Handle<scene::Material> material) const
  {
    return uv_sets_.at(material);
  }

  /** Decode the images; call it once, at the end. Materials of damaged ones get a stand-in. */
  void finish();

 private:
  const File &file_;
  Warnings &warnings_;
  scene::Scene &scene_;
  TextureImporter textures_;
  StandIns stand_ins_;
  std::map<scene::Handle<scene::Material>, std::vector<int>> uv_sets_;
  std::map<int, scene::Handle<scene::Material>> handle_of_;
};

}  // namespace gnomon::gltf
