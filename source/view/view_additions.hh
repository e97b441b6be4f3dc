// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <span>
#include <string>

namespace gnomon::view {

/** Something that can be added to a scene: a mesh, a lamp or a camera at a node of its own. */
struct Addition {
  /** In scripts. */
  const char *name;
  /** In menus, and of the node. */
  const char *label;
  /** A new node's content. */
  void (*fill)(scene::Scene &scene, scene::Node &node);
  /** It is placed as the view looks: a camera; otherwise upright, and a lamp shines down. */
  bool is_placed_as_view = false;
  bool is_lamp = false;
};

/** In the order of the menu: objects, lamps, camera. */
[[nodiscard]] std::span<const Addition> additions();

/** \a name, or "NAME.001" and so on where a node has it. */
[[nodiscard]] std::string free_name(const scene::Scene &scene, const std::string &name);

/** Adds a node with \a addition's content as a root. \a world_from_view: the camera's frame. */
scene::Handle<scene::Node> add(scene::Scene &scene, const Addition &addition, const glm::dvec3 &position_ws,
                               const glm::dmat4 &world_from_view);
/**
 * Adds a copy of \a root and its descendants beside it. Lamps and cameras of the copies are their own; meshes and
 * materials are shared.
 */
scene::Handle<scene::Node> duplicate(scene::Scene &scene, scene::Handle<scene::Node> root);

}  // namespace gnomon::view
