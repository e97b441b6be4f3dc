// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_material.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * No coordinate may be larger, in metres: ten times the way to the outermost planet. Its square and its cube are
 * finite in float, so that lengths, areas and volumes of whatever is imported are.
 */
constexpr double coordinate_max = 1e12;

/** Appends meshes to a scene, each glTF primitive once, at its first use. */
class MeshImporter {
 public:
  /** Keeps references. */
  MeshImporter(const File &file, Warnings &warnings, scene::Scene &scene);

  /** The scene's meshes for the primitives of a mesh of the file, without those that cannot be drawn. */
  [[nodiscard]] const std::vector<scene::Handle<scene::Mesh>> &meshes_of(int gltf_mesh);

  /** Decode the images of materials; call it once, at the end. */
  void finish()
  {
    materials_.finish();
  }

  /** Primitives that were looked at, drawable or not. */
  [[nodiscard]] std::size_t primitive_count() const
  {
    return primitive_count_;
  }

 private:
  const File &file_;
  Warnings &warnings_;
  scene::Scene &scene_;
  MaterialImporter materials_;
  std::map<int, std::vector<scene::Handle<scene::Mesh>>> meshes_of_;
  /** What makes two primitives the same mesh of the scene: name, attributes, indices, material and mode. */
  using PrimitiveKey = std::tuple<std::string, std::map<std::string, int, std::less<>>, int, int, int>;
  /** Names nothing where the primitive was left out. */
  std::map<PrimitiveKey, scene::Handle<scene::Mesh>> mesh_of_;
  std::size_t primitive_count_ = 0;
  /** Vertices and indices read so far. */
  std::uint64_t element_count_ = 0;

  void import_primitive(int gltf_mesh, std::size_t primitive_index, std::vector<scene::Handle<scene::Mesh>> &meshes);
  void spend(std::uint64_t element_count);
};

}  // namespace gnomon::gltf
