// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_foreign_extras.hh"
#include "internal/gltf_material.hh"
#include "internal/gltf_progress.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

class PrimitiveReader;

/** Adds meshes to a scene, one for each glTF primitive, at its first use. */
class MeshImporter {
 public:
  /** All references must outlive the importer. */
  MeshImporter(const File &file, const ImportOptions &options, Progress &progress, ForeignExtras &extras,
               Warnings &warnings, scene::Scene &scene);

  /** The scene's meshes for the primitives of a mesh of the file, without those that cannot be drawn. */
  [[nodiscard]] const std::vector<scene::Handle<scene::Mesh>> &meshes_of(int gltf_mesh);

  /**
   * The same for a node whose mesh is deformed: meshes of its own, with their rest shapes in Scene::deformed_meshes.
   * Set DeformedMesh::node of those that were appended. \param skin: of the file; -1: none.
   */
  [[nodiscard]] std::vector<scene::Handle<scene::Mesh>> deformed_meshes_of(int gltf_mesh, int skin);

  /** The scene's material for each material of the file that a mesh has. */
  [[nodiscard]] const std::map<int, scene::Handle<scene::Material>> &materials() const
  {
    return materials_.handles();
  }

  /** Decodes the images of materials. Call it once, at the end. */
  void finish()
  {
    materials_.finish(progress_);
  }
  /** Images that finish() decodes. */
  [[nodiscard]] std::size_t image_count() const
  {
    return materials_.image_count();
  }

  /** Number of primitives that were read, drawable or not. */
  [[nodiscard]] std::size_t primitive_count() const
  {
    return primitive_count_;
  }

 private:
  const File &file_;
  Progress &progress_;
  ForeignExtras &extras_;
  Warnings &warnings_;
  scene::Scene &scene_;
  std::uint64_t element_count_max_;
  MaterialImporter materials_;
  std::map<int, std::vector<scene::Handle<scene::Mesh>>> meshes_of_;
  /**
   * Primitives with the same key become one mesh: name, attributes, indices, material, mode, and the mesh of the file
   * if that has extras, otherwise -1.
   */
  using PrimitiveKey = std::tuple<std::string, std::map<std::string, int, std::less<>>, int, int, int, int>;
  /** Invalid handles for primitives that were left out. */
  std::map<PrimitiveKey, scene::Handle<scene::Mesh>> mesh_of_;
  std::size_t primitive_count_ = 0;
  /** Vertices and indices read so far. */
  std::uint64_t element_count_ = 0;

  void import_primitive(int gltf_mesh, std::size_t primitive_index, std::vector<scene::Handle<scene::Mesh>> &meshes);
  /** An empty deform: of a mesh that is not deformed. \return a handle that names nothing where it is left out. */
  [[nodiscard]] scene::Handle<scene::Mesh> read_primitive(int gltf_mesh, std::size_t primitive_index,
                                                          std::optional<int> deforming_skin);
  /**
   * Reads the material of a mesh and the streams that it needs, but for tangents that are made. \return whether the uvs
   * are for such tangents alone
   */
  [[nodiscard]] bool read_for_material(const Model::Primitive &primitive, PrimitiveReader &reader, scene::Mesh &mesh);
  /** The slot whose uvs the tangents follow, which may have no texture; nullptr if the material needs no tangents. */
  [[nodiscard]] const scene::TextureSlot *tangent_slot(scene::Handle<scene::Material> handle) const;
  /** \a drops_uvs: no texture reads the uvs, so that they are removed afterwards. */
  void make_missing_tangents(scene::Mesh &mesh, bool drops_uvs, const std::string &what);
  void spend(std::uint64_t element_count);
};

}  // namespace gnomon::gltf
