// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_accessor.hh"
#include "internal/gltf_triangles.hh"
#include "scene_types.hh"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Converts one primitive to a Mesh. */
class PrimitiveReader {
 public:
  PrimitiveReader(const File &file, const Model::Primitive &primitive, std::string what, Warnings &warnings);

  [[nodiscard]] std::uint64_t element_count() const;

  /** Reads positions, normals, indices and bounds. The mesh is empty if no triangle can be kept. */
  scene::Mesh read();

  /** Texture coordinates for the mesh of read(). All 0 if the primitive has none that can be read. */
  std::vector<glm::vec2> read_uvs(int set);

  /** Tangents for the mesh of read(). Empty if the primitive has none that can be read. */
  std::vector<glm::vec4> read_tangents();

  /** Vertex colours for the mesh of read(). Empty if the primitive has none that can be read. */
  std::vector<glm::vec4> read_colors();

  [[nodiscard]] bool has_normals() const
  {
    return normals_.has_value();
  }
  /** The vertex of the file for each vertex of the mesh that read() has given. */
  [[nodiscard]] const std::vector<std::uint32_t> &file_vertices() const
  {
    return file_vertices_;
  }

 private:
  static constexpr Model::ElementType vec3_type = Model::ElementType::Vec3;
  const File &file_;
  const Model::Primitive &primitive_;
  std::string what_;
  Warnings &warnings_;
  AccessorReader positions_;
  std::optional<AccessorReader> normals_;
  /** Empty for a primitive without indices. */
  std::optional<AccessorReader> indices_;
  Losses losses_;
  std::vector<std::uint32_t> file_vertices_;

  [[nodiscard]] int position_accessor() const;

  /** Normals that cannot be read are replaced, and the surface is kept. */
  void open_normals(const File &file);

  /** The triangles that can be drawn, as vertex indices. */
  std::vector<Triangle> kept_triangles();

  bool is_left_out(const Triangle &triangle);

  /** Keeps the file's vertices in their order, except for unused ones. */
  void share_vertices(const std::vector<Triangle> &triangles, scene::Mesh &mesh);

  /** glTF requires flat normals if a file has none, so triangles cannot share vertices. */
  void unshare_vertices(const std::vector<Triangle> &triangles, scene::Mesh &mesh);

  static glm::vec3 unit_or_zero(const glm::vec3 &normal);

  void replace_zero_normals(scene::Mesh &mesh);
};

}  // namespace gnomon::gltf
