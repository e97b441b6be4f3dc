// SPDX-License-Identifier: MIT
#pragma once

#include "view_transform_operation.hh"

#include "overlay.hh"

namespace gnomon::view {

/** Handles at a node. Dragging a handle moves, rotates or scales the node along an axis. */
struct Gizmo {
  glm::dmat4 world_from_node{1.0};
  TransformKind kind = TransformKind::Move;
  Orientation orientation = Orientation::World;

  /**
   * Lines of the handles, on top of the scene, with a constant size on the screen. \a pointed: axis to highlight, if
   * any.
   */
  [[nodiscard]] std::vector<overlay::Line> lines(const PictureMap &map, std::optional<TransformAxis> pointed) const;
  /** The handle within a few pixels of \a pixel. */
  [[nodiscard]] std::optional<TransformAxis> handle_at(const PictureMap &map, const glm::dvec2 &pixel) const;
};

/** Line of the axis that constrains \a operation, through the node's start position. No lines without a constraint. */
[[nodiscard]] std::vector<overlay::Line> axis_lines(const TransformOperation &operation, const PictureMap &map);

}  // namespace gnomon::view
