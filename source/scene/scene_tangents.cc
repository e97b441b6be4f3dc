// SPDX-License-Identifier: MIT
#include "scene_tangents.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

namespace gnomon::scene {

namespace {

/** Vertices with equal keys are treated as one. */
struct WeldKey {
  glm::vec3 position;
  glm::vec3 normal;
  glm::vec2 uv;
};

/** For each vertex, the first of those with the same key. */
std::vector<std::uint32_t> welded(const Mesh &mesh, const std::vector<glm::vec2> &uvs)
{
  std::vector<WeldKey> keys(mesh.positions.size());
  for (std::size_t i = 0; i < keys.size(); i++) {
    // Adding 0 converts -0 to 0.
    keys[i] = {mesh.positions[i] + 0.0F, mesh.normals[i] + 0.0F, uvs[i] + 0.0F};
  }
  std::vector<std::uint32_t> order(keys.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    const int difference = std::memcmp(&keys[a], &keys[b], sizeof(WeldKey));
    return difference != 0 ? difference < 0 : a < b;
  });
  std::vector<std::uint32_t> first(keys.size());
  for (std::size_t i = 0; i < order.size(); i++) {
    const bool is_same = i > 0 && std::memcmp(&keys[order[i]], &keys[order[i - 1]], sizeof(WeldKey)) == 0;
    first[order[i]] = is_same ? first[order[i - 1]] : order[i];
  }
  return first;
}

/** The component of \a v orthogonal to \a normal, normalised; zero if there is none. */
glm::dvec3 in_plane(const glm::dvec3 &v, const glm::dvec3 &normal)
{
  const glm::dvec3 flat = v - normal * glm::dot(normal, v);
  const double length = glm::length(flat);
  return length > 0.0 ? flat / length : glm::dvec3(0.0);
}

glm::dvec3 any_tangent(const glm::dvec3 &normal)
{
  const glm::dvec3 axis = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return in_plane(axis, normal);
}

/** The directions along u of the triangles around each vertex. */
struct TangentSums {
  std::vector<std::uint32_t> weld;
  /** By whether the image is mirrored on the triangle, and by welded vertex. Weighted by angles. */
  std::array<std::vector<glm::dvec3>, 2> sums;
  /** By triangle. */
  std::vector<bool> is_mirrored;
};

TangentSums tangent_sums(const Mesh &mesh, const TextureSlot &normal_texture)
{
  const glm::dmat3x2 uv_from_mesh = normal_texture.uv_from_mesh();
  const std::vector<glm::vec2> &uvs = mesh.uv_set(normal_texture.uv_set);
  TangentSums result{welded(mesh, uvs), {}, std::vector<bool>(mesh.indices.size() / 3, false)};
  result.sums.fill(std::vector<glm::dvec3>(mesh.positions.size(), glm::dvec3(0.0)));
  for (std::size_t first = 0; first < mesh.indices.size(); first += 3) {
    const std::uint32_t *corner = &mesh.indices[first];
    const auto edge = [&](int to, int from) {
      return glm::dvec3(mesh.positions[corner[to]]) - glm::dvec3(mesh.positions[corner[from]]);
    };
    const auto uv_edge = [&](int to) {
      return uv_from_mesh * glm::dvec3(glm::dvec2(uvs[corner[to]]) - glm::dvec2(uvs[corner[0]]), 0.0);
    };
    const glm::dvec2 a = uv_edge(1);
    const glm::dvec2 b = uv_edge(2);
    // v points down the image.
    const double area = -(a.x * b.y - b.x * a.y);
    if (area == 0.0 || !std::isfinite(area)) {
      continue;
    }
    const bool mirrored = area < 0.0;
    result.is_mirrored[first / 3] = mirrored;
    const glm::dvec3 along_u = (edge(1, 0) * -b.y + edge(2, 0) * a.y) * (mirrored ? -1.0 : 1.0);
    for (int i = 0; i < 3; i++) {
      const glm::dvec3 normal(mesh.normals[corner[i]]);
      const glm::dvec3 next = in_plane(edge((i + 1) % 3, i), normal);
      const glm::dvec3 last = in_plane(edge((i + 2) % 3, i), normal);
      const double angle = std::acos(std::clamp(glm::dot(next, last), -1.0, 1.0));
      result.sums[mirrored ? 1 : 0][result.weld[corner[i]]] += angle * in_plane(along_u, normal);
    }
  }
  return result;
}

}  // namespace

void make_tangents(Mesh &mesh, const TextureSlot &normal_texture)
{
  const auto [weld, sums, is_mirrored] = tangent_sums(mesh, normal_texture);
  const std::size_t vertex_count = mesh.positions.size();
  mesh.tangents.assign(vertex_count, glm::vec4(0.0F));
  // For a vertex with triangles of both orientations, the vertex of the mirrored ones.
  std::vector<std::uint32_t> mirror(vertex_count, 0);
  for (std::size_t i = 0; i < mesh.indices.size(); i++) {
    std::uint32_t &index = mesh.indices[i];
    const std::uint32_t vertex = index;
    const float sign = is_mirrored[i / 3] ? -1.0F : 1.0F;
    if (mesh.tangents[vertex].w == -sign) {
      if (mirror[vertex] == 0) {
        mirror[vertex] = std::uint32_t(mesh.positions.size());
        for_each_stream(mesh, [vertex](auto &stream) { stream.push_back(stream[vertex]); });
        mesh.tangents.back().w = 0.0F;
      }
      index = mirror[vertex];
    }
    glm::vec4 &tangent = mesh.tangents[index];
    if (tangent.w == 0.0F) {
      const glm::dvec3 normal(mesh.normals[vertex]);
      const glm::dvec3 sum = in_plane(sums[is_mirrored[i / 3] ? 1 : 0][weld[vertex]], normal);
      tangent = glm::vec4(sum == glm::dvec3(0.0) ? any_tangent(normal) : sum, sign);
    }
  }
  // Vertices that no triangle uses.
  for (std::size_t i = 0; i < mesh.tangents.size(); i++) {
    if (mesh.tangents[i].w == 0.0F) {
      mesh.tangents[i] = glm::vec4(any_tangent(glm::dvec3(mesh.normals[i])), 1.0F);
    }
  }
}

}  // namespace gnomon::scene
