// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_foreign_extras.hh"
#include "internal/gltf_progress.hh"
#include "internal/gltf_report.hh"
#include "internal/gltf_slots.hh"
#include "internal/gltf_texture.hh"
#include "scene.hh"

#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Adds materials to a scene at their first use. Unused materials are neither kept nor reported. */
class MaterialImporter {
 public:
  /** All references must outlive the importer. */
  MaterialImporter(const File &file, const ImportOptions &options, ForeignExtras &extras, Warnings &warnings,
                   scene::Scene &scene);

  /** The scene's material for a material of the file; -1 is glTF's default material. */
  [[nodiscard]] scene::Handle<scene::Material> handle_of(int gltf_material);

  /**
   * The same for points and lines, drawn as glTF asks: without normals they are unlit, as the sum of base colour and
   * emission; without tangents they have neither normal textures nor anisotropy.
   */
  [[nodiscard]] scene::Handle<scene::Material> handle_for_lines(int gltf_material, bool has_normals, bool has_tangents);

  /**
   * The numbers n of the attributes TEXCOORD_n of a material, at most two. TextureSlot::uv_set is an index into them.
   * \pre handle_of returned \a material
   */
  [[nodiscard]] const std::vector<int> &uv_sets(scene::Handle<scene::Material> material) const
  {
    return uv_sets_.at(material);
  }

  /** Whether meshes of \a material need tangents for its anisotropy, at rest or at some time of an animation. */
  [[nodiscard]] bool is_ever_anisotropic(scene::Handle<scene::Material> material) const
  {
    return scene_.materials()[material].has_anisotropy() || anisotropic_.contains(material);
  }

  [[nodiscard]] const std::map<int, scene::Handle<scene::Material>> &handles() const
  {
    return handle_of_;
  }

  /** Decodes the images. Call it once, at the end. Damaged images are replaced by stand-ins. */
  void finish(Progress &progress);
  /** Images that finish() decodes. */
  [[nodiscard]] std::size_t image_count() const
  {
    return textures_.image_count();
  }

 private:
  /** The surface function at a URI. Without a text, so that its stand-in is drawn, if it cannot be read. */
  scene::Handle<scene::SurfaceFunction> surface_function(const std::string &uri, const std::string &what);

  const File &file_;
  ForeignExtras &extras_;
  Warnings &warnings_;
  scene::Scene &scene_;
  TextureImporter textures_;
  StandIns stand_ins_;
  std::map<scene::Handle<scene::Material>, std::vector<int>> uv_sets_;
  std::map<int, scene::Handle<scene::Material>> handle_of_;
  /** By material of the file, and whether there are normals and tangents. */
  std::map<std::tuple<int, bool, bool>, scene::Handle<scene::Material>> handle_for_lines_;
  /** Paths that animations move, by material of the file. */
  std::map<int, std::set<std::string_view>> moved_;
  /** Materials that may become anisotropic. */
  std::set<scene::Handle<scene::Material>> anisotropic_;
  /** By URI. */
  std::map<std::string, scene::Handle<scene::SurfaceFunction>> surface_functions_;
  /** Roughness without the texture, of materials whose roughness texture contains the factor. */
  std::map<scene::Handle<scene::Material>, float> factor_roughness_;
};

}  // namespace gnomon::gltf
