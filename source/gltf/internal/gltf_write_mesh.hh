// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_write_buffer.hh"
#include "internal/gltf_write_json.hh"
#include "scene.hh"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** A power of two, by which emission above 1 is divided without rounding; 1 for other emission. */
[[nodiscard]] float emissive_strength(const glm::vec3 &emissive);

/**
 * Collects meshes and the materials, textures and images that they use, each at its first use. All members throw Fault.
 */
class MeshWriter {
 public:
  /** All references must outlive the writer. \a folder: of the written file. */
  MeshWriter(const scene::Scene &scene, WrittenBuffer &buffer, std::filesystem::path folder);

  /**
   * Index of the glTF mesh whose primitives are \a meshes; -1 if none of them has triangles. \a is_deformed: deformed
   * meshes are written with their rest shapes, otherwise as they stand.
   */
  [[nodiscard]] int index_of(const std::vector<scene::Handle<scene::Mesh>> &meshes, bool is_deformed);

  /**
   * The rest shape of the first of \a node_meshes that is deformed; nullptr if none is. A rest shape that does not fit
   * its mesh, or whose node was removed, does not count.
   */
  [[nodiscard]] const scene::DeformedMesh *deformed_of(
      const std::vector<scene::Handle<scene::Mesh>> &node_meshes) const;
  /** Indices of the materials that were added. */
  [[nodiscard]] const std::map<scene::Handle<scene::Material>, int> &material_indices() const
  {
    return material_of_;
  }

  JsonText meshes;
  JsonText materials;
  JsonText textures;
  JsonText samplers;
  JsonText images;
  /** Names of the extensions that materials use. */
  std::set<std::string> extensions;

 private:
  const scene::Scene &scene_;
  WrittenBuffer &buffer_;
  std::filesystem::path folder_;
  std::map<scene::Handle<scene::Mesh>, const scene::DeformedMesh *> deformed_of_;
  /** By the meshes and whether they are deformed. */
  std::map<std::pair<std::vector<scene::Handle<scene::Mesh>>, bool>, int> mesh_of_;
  /** Members of a primitive, without its name; by its mesh and whether that is deformed. */
  std::map<std::pair<scene::Handle<scene::Mesh>, bool>, JsonText> primitive_of_;
  std::map<scene::Handle<scene::Material>, int> material_of_;
  std::map<scene::Handle<scene::Texture>, int> texture_of_;
  std::map<scene::Handle<scene::Image>, int> image_of_;
  std::map<std::string, int> sampler_of_;

  const JsonText &primitive(scene::Handle<scene::Mesh> handle, bool is_deformed);
  void add_positions(std::string_view key, const std::vector<glm::vec3> &positions, const std::string &what,
                     JsonText &attributes);
  /** Adds joints, weights and morph targets. */
  void add_deformation(const scene::DeformedMesh &deformed, const std::string &what, JsonText &attributes,
                       JsonText &primitive);
  int material(scene::Handle<scene::Material> handle);
  /** Adds the members of the slot to \a json, if it has a texture. \return whether it has. */
  bool add_slot(JsonText &json, const scene::TextureSlot &slot, const std::string &what);
  /** A URI of the function's file, relative to the folder; of its text, if there is no such file. */
  [[nodiscard]] std::string surface_uri(const scene::SurfaceFunction &function) const;
  int texture(scene::Handle<scene::Texture> handle);
  int image(scene::Handle<scene::Image> handle);
  int sampler(const scene::Texture &texture);
};

}  // namespace gnomon::gltf
