// SPDX-License-Identifier: MIT
#pragma once

#include "view_picture_map.hh"

#include "scene.hh"

#include <optional>
#include <string>

namespace gnomon::view {

enum class TransformKind { Move, Rotate, Scale };

/**
 * Constraint of a transform. All: move in the picture's plane, rotate around the line of sight, or scale along all
 * axes.
 */
enum class TransformAxis { All, X, Y, Z };

/** The axes of a transform: those of the world, or of the node. */
enum class Orientation { World, Local };

/**
 * \a matrix with the last row 0 0 0 1 exactly, as scene::Scene requires it. Rounding in the inverse of an affine matrix
 * may change that row.
 */
[[nodiscard]] glm::dmat4 affine(glm::dmat4 matrix);
/** Whether an affine matrix has an inverse, apart from rounding: its axes are not of length 0, nor in one plane. */
[[nodiscard]] bool has_inverse(const glm::dmat4 &matrix);

struct Transform {
  TransformKind kind = TransformKind::Move;
  TransformAxis axis = TransformAxis::All;
  Orientation orientation = Orientation::World;

  bool operator==(const Transform &) const = default;
};

/**
 * Cosine of the angle between an axis and the line of sight. Above it, the axis is too short on the screen to drag
 * along.
 */
inline constexpr double along_sight = 0.97;

/** Unit vector of an axis of the node. All stands for X. The world's axis replaces a node's axis of length 0. */
[[nodiscard]] glm::dvec3 axis_ws(const glm::dmat4 &world_from_node, TransformAxis axis, Orientation orientation);
/** \a world_from_node, rotated around an axis through its position; radians. */
[[nodiscard]] glm::dmat4 rotated(const glm::dmat4 &world_from_node, const glm::dvec3 &axis_ws, double angle);
/**
 * \a world_from_node, scaled about its position along the axis of \a transform. Scaling along a world axis may shear
 * it.
 */
[[nodiscard]] glm::dmat4 scaled(const glm::dmat4 &world_from_node, const Transform &transform, double factor);

/**
 * A running transform of a node by the pointer or a typed number. It does not edit the scene; parent_from_node and
 * change_ws are the current result.
 */
class TransformOperation {
 public:
  /**
   * \a map: the picture in which the \a pointer moves, which must stay the same.
   * \throws std::runtime_error if the matrix of the node's parent has no inverse; scene::StaleHandle
   */
  TransformOperation(const scene::Scene &scene, scene::Handle<scene::Node> node, const Transform &transform,
                     const PictureMap &map, const glm::dvec2 &pointer);

  [[nodiscard]] scene::Handle<scene::Node> node() const
  {
    return node_;
  }
  [[nodiscard]] const Transform &transform() const
  {
    return transform_;
  }
  /** The node's matrix at the start. */
  [[nodiscard]] const glm::dmat4 &start_ws() const
  {
    return start_ws_;
  }
  /**
   * Constrain the transform to an axis. The second call with the same axis selects the other orientation, the third
   * removes the constraint.
   */
  void toggle_axis(TransformAxis axis);
  void point(const glm::dvec2 &pointer);
  /**
   * A digit or '.' is appended to the number, '-' changes its sign, '\b' removes the last character. The number is used
   * instead of the pointer: metres along the axis (All: along X), degrees, or a factor.
   * \return false for another character; nothing changes then
   */
  bool type(char character);

  /** The transform of the node after the operation. */
  [[nodiscard]] glm::dmat4 parent_from_node() const;
  /**
   * The same change for other nodes, in world space: the product of it and a node's matrix at the start is the matrix
   * after the operation. The identity if the node is scaled along its own axes and its matrix has no inverse.
   */
  [[nodiscard]] glm::dmat4 change_ws() const;
  /** Text for the user, such as "Move along X: 1.5 m". */
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] glm::dvec3 position_ws() const
  {
    return glm::dvec3(start_ws_[3]);
  }
  [[nodiscard]] std::optional<double> typed() const;
  [[nodiscard]] glm::dvec3 way_ws() const;
  /** Radians. */
  [[nodiscard]] double angle() const;
  [[nodiscard]] double factor() const;
  [[nodiscard]] glm::dvec3 rotation_axis_ws() const;

  scene::Handle<scene::Node> node_;
  Transform transform_;
  Orientation first_orientation_;
  PictureMap map_;
  glm::dmat4 parent_from_world_{1.0};
  glm::dmat4 start_ws_{1.0};
  glm::dvec2 start_pointer_;
  glm::dvec2 pointer_;
  /** The pointer's angle around the node, radians, counter-clockwise on the screen; more than a turn where it goes
   * around.
   */
  double pointer_angle_ = 0.0;
  std::string typed_;
};

}  // namespace gnomon::view
