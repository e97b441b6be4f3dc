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
 * Largest accepted coordinate, metres. Its square and its cube are finite in float, and so are all lengths, areas and
 * volumes of an imported scene.
 */
constexpr double coordinate_max = 1e12;

/** Adds meshes to a scene, one for each glTF primitive, at its first use. */
class MeshImporter {
 public:
  /** All references must outlive the importer. */
  MeshImporter(const File &file, Warnings &warnings, scene::Scene &scene);

  /** The scene's meshes for the primitives of a mesh of the file, without those that cannot be drawn. */
  [[nodiscard]] const std::vector<scene::Handle<scene::Mesh>> &meshes_of(int gltf_mesh);

  /** Decodes the images of materials. Call it once, at the end. */
  void finish()
  {
    materials_.finish();
  }

  /** Number of primitives that were read, drawable or not. */
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
  /** Primitives with the same key become one mesh: name, attributes, indices, material and mode. */
  using PrimitiveKey = std::tuple<std::string, std::map<std::string, int, std::less<>>, int, int, int>;
  /** Invalid handles for primitives that were left out. */
  std::map<PrimitiveKey, scene::Handle<scene::Mesh>> mesh_of_;
  std::size_t primitive_count_ = 0;
  /** Vertices and indices read so far. */
  std::uint64_t element_count_ = 0;

  void import_primitive(int gltf_mesh, std::size_t primitive_index, std::vector<scene::Handle<scene::Mesh>> &meshes);
  void spend(std::uint64_t element_count);
};

}  // namespace gnomon::gltf
