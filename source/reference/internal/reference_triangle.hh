// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <optional>

namespace gnomon::reference {

/** Half the spacing of doubles at 1: the largest relative error of one rounded operation. */
inline constexpr double double_rounding = 0x1p-53;

/**
 * A ray prepared for intersection with many triangles: Woop, Benthin and Wald 2013, "Watertight Ray/Triangle
 * Intersection", in double. An edge that two triangles share is evaluated with the same numbers for both, so that no
 * ray passes between them.
 */
struct ShearedRay {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0};
  /** Axis of the largest component of the direction (z), and the two other axes. */
  int z = 2;
  int x = 0;
  int y = 1;
  double shear_x = 0.0;
  double shear_y = 0.0;

  /** \pre \a direction_ is finite and not zero. */
  ShearedRay(const glm::dvec3 &origin_, const glm::dvec3 &direction_);
};

using Corners = std::array<glm::dvec3, 3>;

/**
 * Barycentric weights of the intersection of the ray's line, in both directions, with a triangle. Edges belong to the
 * triangle. Empty if there is no intersection.
 */
[[nodiscard]] std::optional<glm::dvec3> line_triangle(const ShearedRay &ray, const Corners &corners);

/** The plane of a triangle, with the error of its position due to rounding. */
struct TrianglePlane {
  /** Its length is twice the area. */
  glm::dvec3 normal{0.0};
  double normal_length = 0.0;
  glm::dvec3 point{0.0};
  /** Product of the lengths of the two edges that the normal was computed from. */
  double edge_product = 0.0;

  explicit TrianglePlane(const Corners &corners);
  /** Signed distance of \a p from the plane, times the length of the normal. */
  [[nodiscard]] double height(const glm::dvec3 &p) const;
  /**
   * Error bound of height(). A height of \a p below it is indistinguishable from 0. \a error_m: sum of the largest
   * errors of \a p and of the triangle's corners, metres.
   */
  [[nodiscard]] double height_error(const glm::dvec3 &p, double error_m) const;
};

}  // namespace gnomon::reference
