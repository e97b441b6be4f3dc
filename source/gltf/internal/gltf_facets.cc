// SPDX-License-Identifier: MIT
#include "internal/gltf_facets.hh"

#include <glm/geometric.hpp>

#include <limits>
#include <numeric>

namespace gnomon::gltf {

using scene::Mesh;

namespace {

/** Cosine of 1e-3 rad. Directions within this angle are equal to the precision of float coordinates. */
constexpr double same_direction = 1.0 - 0.5e-6;

/** Root of \a vertex in the forest of connected vertices. Shortens the path for later calls. */
std::uint32_t root_of(std::vector<std::uint32_t> &parent, std::uint32_t vertex)
{
  while (parent[vertex] != vertex) {
    parent[vertex] = parent[parent[vertex]];
    vertex = parent[vertex];
  }
  return vertex;
}

/** Normal of a triangle, with the length of twice its area. */
glm::dvec3 area_vector(const Mesh &mesh, std::size_t first)
{
  const glm::dvec3 a(mesh.positions[mesh.indices[first]]);
  const glm::dvec3 b(mesh.positions[mesh.indices[first + 1]]);
  const glm::dvec3 c(mesh.positions[mesh.indices[first + 2]]);
  return glm::cross(b - a, c - a);
}

bool is_flat(const Mesh &mesh, std::size_t first)
{
  const glm::vec3 &normal = mesh.normals[mesh.indices[first]];
  return mesh.normals[mesh.indices[first + 1]] == normal && mesh.normals[mesh.indices[first + 2]] == normal;
}

/** Removes unused vertices and keeps the order of the others. */
void drop_unused_vertices(Mesh &mesh)
{
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> new_index(mesh.positions.size(), unused);
  for (const std::uint32_t index : mesh.indices) {
    new_index[index] = 0;
  }
  std::uint32_t kept = 0;
  for (std::size_t vertex = 0; vertex < new_index.size(); vertex++) {
    if (new_index[vertex] == unused) {
      continue;
    }
    scene::for_each_stream(mesh, [&](auto &stream) { stream[kept] = stream[vertex]; });
    new_index[vertex] = kept++;
  }
  scene::for_each_stream(mesh, [&](auto &stream) { stream.resize(kept); });
  for (std::uint32_t &index : mesh.indices) {
    index = new_index[index];
  }
}

bool is_along(const glm::dvec3 &vector, const glm::dvec3 &direction)
{
  return glm::dot(vector, direction) >= same_direction * glm::length(vector) * glm::length(direction);
}

}  // namespace

std::size_t flatten_facets(Mesh &mesh)
{
  const std::size_t vertex_count = mesh.positions.size();
  std::vector<std::uint32_t> parent(vertex_count);
  std::iota(parent.begin(), parent.end(), 0U);
  for (std::size_t first = 0; first < mesh.indices.size(); first += 3) {
    if (is_flat(mesh, first)) {
      const std::uint32_t root = root_of(parent, mesh.indices[first]);
      parent[root_of(parent, mesh.indices[first + 1])] = root;
      parent[root_of(parent, mesh.indices[first + 2])] = root;
    }
  }
  std::vector<glm::dvec3> sums(vertex_count, glm::dvec3(0.0));
  for (std::size_t first = 0; first < mesh.indices.size(); first += 3) {
    if (is_flat(mesh, first)) {
      sums[root_of(parent, mesh.indices[first])] += area_vector(mesh, first);
    }
  }

  std::size_t changed = 0;
  for (std::size_t first = 0; first < mesh.indices.size(); first += 3) {
    const glm::dvec3 shared(mesh.normals[mesh.indices[first]]);
    const glm::dvec3 area = area_vector(mesh, first);
    if (!is_flat(mesh, first) || !is_along(sums[root_of(parent, mesh.indices[first])], shared) ||
        is_along(area, shared) || glm::dot(area, area) == 0.0) {
      continue;
    }
    changed++;
    // New vertices for this triangle; other triangles may still use the old ones.
    for (std::size_t i = first; i < first + 3; i++) {
      const std::uint32_t vertex = mesh.indices[i];
      mesh.indices[i] = std::uint32_t(mesh.positions.size());
      scene::for_each_stream(mesh, [vertex](auto &stream) { stream.push_back(stream[vertex]); });
      mesh.normals.back() = glm::vec3(glm::normalize(area));
      parent.push_back(std::uint32_t(parent.size()));
    }
  }
  if (changed > 0) {
    drop_unused_vertices(mesh);
  }
  return changed;
}

}  // namespace gnomon::gltf
