// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <map>
#include <optional>
#include <vector>

/** Copies of skinned meshes. Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * The joints of a node that shows the skinned mesh of another node. glTF ignores the transform of a node with a skin,
 * so the joints of the other node are copied below this one: they move this mesh as they move the other, at its own
 * place.
 */
struct SkinCopy {
  /** Index of the skin in Scene::skins. */
  int skin = 0;
  /** The nearest ancestor of the other node and of all joints; an invalid handle: world space. */
  scene::Handle<scene::Node> base{};
  /** Matrix of the child of the node that stands for `base`. */
  glm::dmat4 node_from_base{1.0};
  /** The nodes below `base` that are joints or have joints below them, parents before their children. */
  std::vector<scene::Handle<scene::Node>> nodes{};
  /** Index in the file of the child; those of the copies of `nodes` follow. */
  int first_index = 0;

  /** Index in the file of the node that represents \a node; empty if it is not copied. */
  [[nodiscard]] std::optional<int> index_of(scene::Handle<scene::Node> node) const;
};

/** Empty if the matrix of the node of \a deformed has no inverse. \pre \a deformed has a skin and a node */
[[nodiscard]] std::optional<SkinCopy> skin_copy(const scene::Scene &scene, const scene::DeformedMesh &deformed);

}  // namespace gnomon::gltf
