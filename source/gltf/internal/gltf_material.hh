// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "internal/gltf_texture.hh"
#include "scene.hh"

#include <glm/vec2.hpp>

#include <cstdint>
#include <map>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Where a material looks its base colour up: a set of texture coordinates of the mesh, and what is done to them. */
struct TextureCoordinates {
  /** n of TEXCOORD_n. */
  int set = 0;
  glm::dvec2 offset{0.0};
  /** Radians, counter-clockwise to who looks at the image. */
  double rotation = 0.0;
  glm::dvec2 scale{1.0};

  /** Scaled, turned, then moved, as KHR_texture_transform says. */
  [[nodiscard]] glm::vec2 transformed(const glm::vec2 &uv) const;
};

/** Appends materials to a scene, each at its first use: what nothing wears is neither kept nor warned about. */
class MaterialImporter {
 public:
  /** Keeps references. */
  MaterialImporter(const File &file, Warnings &warnings, scene::Scene &scene);

  /** The scene's material for a material of the file; -1 is glTF's default material. */
  [[nodiscard]] scene::Handle<scene::Material> handle_of(int gltf_material);

  /** Of a material that handle_of returned. */
  [[nodiscard]] const TextureCoordinates &texture_coordinates(scene::Handle<scene::Material> material) const
  {
    return texture_coordinates_.at(material);
  }

 private:
  const File &file_;
  Warnings &warnings_;
  scene::Scene &scene_;
  TextureImporter textures_;
  std::map<scene::Handle<scene::Material>, TextureCoordinates> texture_coordinates_;
  std::map<int, scene::Handle<scene::Material>> handle_of_;
};

}  // namespace gnomon::gltf
