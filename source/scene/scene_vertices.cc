// SPDX-License-Identifier: MIT
// Edits of some vertices of a mesh, and which vertices they have changed.
#include "scene.hh"

#include "internal/scene_changes.hh"
#include "internal/scene_values.hh"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace gnomon::scene {

namespace {

void check(const Mesh &mesh, const VertexValues &values)
{
  const auto refuse = [&](const std::string &reason) {
    throw InvalidEdit(fmt::format("mesh '{}': {}", mesh.name, reason));
  };
  const std::size_t count = mesh.positions.size();
  const auto beyond = std::ranges::find_if(values.vertices, [&](std::uint32_t vertex) { return vertex >= count; });
  if (beyond != values.vertices.end()) {
    refuse(fmt::format("vertex {} is beyond its {} positions", *beyond, count));
  }
  for_each_stream_member([&](auto stream, auto new_values, std::string_view name) {
    const auto &set = values.*new_values;
    if (!set.empty() && set.size() != values.vertices.size()) {
      refuse(fmt::format("{} {}s for {} vertices", set.size(), name, values.vertices.size()));
    }
    if (!set.empty() && (mesh.*stream).empty()) {
      refuse(fmt::format("it has no {}s", name));
    }
    if (const auto index = first_infinite(set)) {
      refuse(fmt::format("{} {} is not finite", name, values.vertices[*index]));
    }
  });
  if (const auto index = first_beyond_one(values.colors)) {
    refuse(fmt::format("colour {} is not from 0 to 1", values.vertices[*index]));
  }
}

/** Sets the values of one of `values.vertices`. \return whether one was another before */
bool set_vertex(Mesh &mesh, const VertexValues &values, std::size_t i)
{
  bool is_changed = false;
  for_each_stream_member([&](auto stream, auto new_values, std::string_view /*name*/) {
    const auto &set = values.*new_values;
    if (!set.empty() && !same_bytes((mesh.*stream)[values.vertices[i]], set[i])) {
      (mesh.*stream)[values.vertices[i]] = set[i];
      is_changed = true;
    }
  });
  return is_changed;
}

}  // namespace

void Scene::set_vertices(Handle<Mesh> handle, const VertexValues &values)
{
  check(meshes_[handle], values);
  if (std::ranges::find(deformed_meshes, handle, &DeformedMesh::mesh) != deformed_meshes.end()) {
    edit(handle, [&](Mesh &mesh) {
      for (std::size_t i = 0; i < values.vertices.size(); i++) {
        set_vertex(mesh, values, i);
      }
    });
    return;
  }
  Mesh &mesh = meshes_.writable(handle);
  const auto bounds_of = [&](std::size_t block) {
    const auto positions = std::span(mesh.positions).subspan(block * vertex_block_size);
    Bounds bounds;
    for (const glm::vec3 &position : positions.first(std::min(positions.size(), vertex_block_size))) {
      bounds.extend(position);
    }
    return bounds;
  };
  const auto [found, is_new] = vertex_blocks_.try_emplace(handle);
  auto &[shape, blocks] = found->second;
  if (is_new) {
    shape = meshes_.revision(handle, Mesh::Aspect::Shape);
    blocks.resize((mesh.positions.size() + vertex_block_size - 1) / vertex_block_size);
    for (std::size_t i = 0; i < blocks.size(); i++) {
      blocks[i].bounds = bounds_of(i);
    }
  }
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < values.vertices.size(); i++) {
    const std::size_t block = values.vertices[i] / vertex_block_size;
    if (set_vertex(mesh, values, i) && (changed.empty() || changed.back() != block)) {
      changed.push_back(block);
    }
  }
  if (changed.empty()) {
    return;
  }
  const Revision revision = edited();
  for (const std::size_t block : changed) {
    if (blocks[block].revision != revision) {
      blocks[block] = {values.positions.empty() ? blocks[block].bounds : bounds_of(block), revision};
    }
  }
  mesh.bounds = {};
  for (const VertexBlock &block : blocks) {
    mesh.bounds.extend(block.bounds);
  }
  meshes_.touch(handle, Mesh::Aspect::Shape, revision);
}

std::vector<VertexRange> Scene::changed_vertices(Handle<Mesh> handle, Revision since) const
{
  const auto count = std::uint32_t(meshes_[handle].positions.size());
  const auto found = vertex_blocks_.find(handle);
  if (found == vertex_blocks_.end() || since < meshes_.first_revision_.or_later(found->second.shape)) {
    return {{0, count}};
  }
  std::vector<VertexRange> ranges;
  const std::vector<VertexBlock> &blocks = found->second.blocks;
  for (std::size_t i = 0; i < blocks.size(); i++) {
    if (blocks[i].revision <= since) {
      continue;
    }
    const auto first = std::uint32_t(i * vertex_block_size);
    const std::uint32_t size = std::min(std::uint32_t(vertex_block_size), count - first);
    if (!ranges.empty() && ranges.back().first + ranges.back().count == first) {
      ranges.back().count += size;
    }
    else {
      ranges.push_back({first, size});
    }
  }
  return ranges;
}

}  // namespace gnomon::scene
