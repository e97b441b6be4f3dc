// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <span>
#include <string>
#include <unordered_map>

namespace gnomon::view {

/** An entry of the menu Add: a mesh, a lamp or a camera at a new node. */
struct Addition {
  /** Name in scripts. */
  const char *name;
  /** Label in menus, and name of the new node. */
  const char *label;
  /** Add the content and attach it to \a node. */
  void (*fill)(scene::Scene &scene, scene::Node &node);
  /** True: placed as the view looks, as cameras are. False: upright; a lamp shines down. */
  bool is_placed_as_view = false;
  bool is_lamp = false;
};

/** All additions in the order of the menu: objects, lamps, camera. */
[[nodiscard]] std::span<const Addition> additions();

/** The names of a scene's nodes, to name new ones. */
class NodeNames {
 public:
  explicit NodeNames(const scene::Scene &scene);
  /** \a name, or "NAME.001" and so on if a node already has that name. The next call does not return it again. */
  [[nodiscard]] std::string take(const std::string &name);

 private:
  /** By name: the last number that take() appended to it; 0: none yet. */
  std::unordered_map<std::string, int> last_numbers_;
};

/** Add a root node with \a addition's content. \a world_from_view: the camera's frame. */
scene::Handle<scene::Node> add(scene::Scene &scene, const Addition &addition, const glm::dvec3 &position_ws,
                               const glm::dmat4 &world_from_view);
/**
 * Add a copy of \a root and its descendants to the same parent. Lamps and cameras are copied; meshes and materials are
 * shared. \a names: those of \a scene; the names of the copies are added.
 */
scene::Handle<scene::Node> duplicate(scene::Scene &scene, scene::Handle<scene::Node> root, NodeNames &names);

}  // namespace gnomon::view
