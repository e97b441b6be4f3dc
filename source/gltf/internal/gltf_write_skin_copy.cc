// SPDX-License-Identifier: MIT
#include "internal/gltf_write_skin_copy.hh"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::gltf {

using scene::Handle;
using scene::Node;
using scene::Scene;

namespace {

/** The node, its parent and so on up to a root. */
std::vector<Handle<Node>> path_up(const Scene &scene, Handle<Node> node)
{
  std::vector<Handle<Node>> path;
  for (; node; node = scene.parent(node)) {
    path.push_back(node);
  }
  return path;
}

}  // namespace

std::optional<int> SkinCopy::index_of(Handle<Node> node) const
{
  if (node == base) {
    return first_index;
  }
  const auto found = std::ranges::find(nodes, node);
  return found == nodes.end() ? std::nullopt : std::optional(first_index + 1 + int(found - nodes.begin()));
}

std::optional<SkinCopy> skin_copy(const Scene &scene, const scene::DeformedMesh &deformed)
{
  std::vector<std::vector<Handle<Node>>> joint_paths;
  for (const Handle<Node> joint : scene.skins[std::size_t(deformed.skin)].joints) {
    if (scene.nodes().is_live(joint)) {
      joint_paths.push_back(path_up(scene, joint));
    }
  }
  const std::vector<Handle<Node>> node_path = path_up(scene, deformed.node);
  const auto is_above_all = [&](Handle<Node> ancestor) {
    return std::ranges::all_of(joint_paths, [&](const std::vector<Handle<Node>> &path) {
      return std::ranges::find(path, ancestor) != path.end();
    });
  };
  const auto base = std::ranges::find_if(node_path, is_above_all);
  SkinCopy copy{.skin = deformed.skin, .base = base == node_path.end() ? Handle<Node>() : *base};
  glm::dmat4 base_from_node(1.0);
  for (auto node = node_path.begin(); node != base; ++node) {
    base_from_node = scene.nodes()[*node].parent_from_node * base_from_node;
  }
  if (!(std::abs(glm::determinant(base_from_node)) > 0.0)) {
    return std::nullopt;
  }
  copy.node_from_base = glm::inverse(base_from_node);
  for (const std::vector<Handle<Node>> &path : joint_paths) {
    // From the base down.
    for (auto node = std::ranges::find(path, copy.base); node != path.begin();) {
      --node;
      if (std::ranges::find(copy.nodes, *node) == copy.nodes.end()) {
        copy.nodes.push_back(*node);
      }
    }
  }
  return copy;
}

}  // namespace gnomon::gltf
