// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <span>
#include <string>

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

/** \a name, or "NAME.001" and so on if a node already has that name. */
[[nodiscard]] std::string free_name(const scene::Scene &scene, const std::string &name);

/** Add a root node with \a addition's content. \a world_from_view: the camera's frame. */
scene::Handle<scene::Node> add(scene::Scene &scene, const Addition &addition, const glm::dvec3 &position_ws,
                               const glm::dmat4 &world_from_view);
/**
 * Add a copy of \a root and its descendants to the same parent. Lamps and cameras are copied; meshes and materials are
 * shared.
 */
scene::Handle<scene::Node> duplicate(scene::Scene &scene, scene::Handle<scene::Node> root);

}  // namespace gnomon::view
