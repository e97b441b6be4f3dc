// SPDX-License-Identifier: MIT
#pragma once

#include "view_transform_operation.hh"

#include "overlay.hh"

namespace gnomon::view {

/** Handles at a node that move, turn or scale it along an axis when they are dragged. */
struct Gizmo {
  glm::dmat4 world_from_node{1.0};
  TransformKind kind = TransformKind::Move;
  Orientation orientation = Orientation::World;

  /** On top of the scene, with the same size on the screen at every distance. \a pointed: highlighted, if any. */
  [[nodiscard]] std::vector<overlay::Line> lines(const PictureMap &map, std::optional<TransformAxis> pointed) const;
  /** The handle within a few pixels of \a pixel. */
  [[nodiscard]] std::optional<TransformAxis> handle_at(const PictureMap &map, const glm::dvec2 &pixel) const;
};

/** The axis that \a operation keeps to, through where its node was; nothing: it keeps to none. */
[[nodiscard]] std::vector<overlay::Line> axis_lines(const TransformOperation &operation, const PictureMap &map);

}  // namespace gnomon::view
