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
  /**
   * \a is_deformed: morph targets or joints move the vertices, so that triangles without area and lines without length
   * are kept.
   */
  PrimitiveReader(const File &file, const Model::Primitive &primitive, std::string what, Warnings &warnings,
                  bool is_deformed);

  [[nodiscard]] std::uint64_t element_count() const;

  /**
   * Reads positions, normals, indices, topology and bounds. The mesh is empty if no triangle, line or point can be
   * kept. Points and lines without normals get +Z: their material must be unlit.
   */
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
  bool is_deformed_;
  AccessorReader positions_;
  std::optional<AccessorReader> normals_;
  /** Empty for a primitive without indices. */
  std::optional<AccessorReader> indices_;
  scene::Topology topology_ = scene::Topology::Triangles;
  Losses losses_;
  std::vector<std::uint32_t> file_vertices_;

  [[nodiscard]] int position_accessor() const;

  /** Normals that cannot be read are replaced, and the surface is kept. */
  void open_normals(const File &file);

  /** Number of vertices of the primitive, with repetitions. */
  [[nodiscard]] std::uint32_t corner_count() const;

  /** Replaces places in the sequence of vertices by vertex indices, and removes elements that cannot be drawn. */
  template <typename Element>
  void keep_drawable(std::vector<Element> &elements);

  template <typename Element>
  bool is_left_out(const Element &element);

  /** Keeps the file's vertices in their order, except for unused ones. */
  template <typename Element>
  void share_vertices(const std::vector<Element> &elements, scene::Mesh &mesh);

  /** Adds those triangles, lines or points to \a mesh that can be drawn. */
  template <typename Element>
  void add_elements(std::vector<Element> elements, scene::Mesh &mesh);

  /** glTF requires flat normals if a file has none, so triangles cannot share vertices. */
  void unshare_vertices(const std::vector<Triangle> &triangles, scene::Mesh &mesh);

  static glm::vec3 unit_or_zero(const glm::vec3 &normal);

  void replace_zero_normals(scene::Mesh &mesh);
};

}  // namespace gnomon::gltf
