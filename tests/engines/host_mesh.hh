// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_batch.hh"
#include "scene_types.hh"

#include <epoxy/gl.h>

#include <array>
#include <span>
#include <vector>

namespace gnomon::test {

/** Buffers of the host with the shape of a mesh. */
class HostMesh {
 public:
  explicit HostMesh(const scene::Mesh &mesh)
  {
    glCreateBuffers(GLsizei(names_.size()), names_.data());
    write(mesh);
    const std::vector<std::uint16_t> indices(mesh.indices.begin(), mesh.indices.end());
    glNamedBufferData(names_[3], GLsizeiptr(indices.size() * 2), indices.data(), GL_STATIC_DRAW);
    batch = {.positions = {names_[0], 0, sizeof(glm::vec3)},
             .normals = {names_[1], 0, sizeof(glm::vec3)},
             .uvs = {mesh.uvs.empty() ? 0 : names_[2], 0, sizeof(glm::vec2)},
             .vertex_count = std::uint32_t(mesh.positions.size()),
             .index_buffer = names_[3],
             .index_count = std::uint32_t(indices.size()),
             .index_type = gpu::HostBatch::IndexType::Uint16};
  }
  ~HostMesh()
  {
    glDeleteBuffers(GLsizei(names_.size()), names_.data());
  }
  HostMesh(const HostMesh &) = delete;
  HostMesh &operator=(const HostMesh &) = delete;
  void write(const scene::Mesh &mesh) const
  {
    const auto data = [](GLuint name, const auto &values) {
      const auto bytes = std::as_bytes(std::span(values));
      glNamedBufferData(name, GLsizeiptr(bytes.size()), bytes.data(), GL_DYNAMIC_DRAW);
    };
    data(names_[0], mesh.positions);
    data(names_[1], mesh.normals);
    data(names_[2], mesh.uvs);
  }

  gpu::HostBatch batch;

 private:
  /** Positions, normals, uvs, indices. */
  std::array<GLuint, 4> names_{};
};

/** The mesh with its shape in buffers of the host. */
inline scene::Mesh without_vertices(const scene::Mesh &mesh)
{
  return {.name = mesh.name,
          .material = mesh.material,
          .host_shape = scene::HostShape{.bounds = mesh.bounds, .has_uvs = !mesh.uvs.empty()}};
}

}  // namespace gnomon::test
