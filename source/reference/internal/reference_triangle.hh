// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <optional>

namespace gnomon::reference {

/** Half the distance from 1 to the next double: the relative error of one rounded operation. */
inline constexpr double double_rounding = 0x1p-53;

/**
 * A ray made ready for the test against many triangles: Woop, Benthin and Wald 2013, "Watertight Ray/Triangle
 * Intersection", in double. An edge that two triangles share is judged by the same numbers for both, so
 * that no ray slips between them.
 */
struct ShearedRay {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0};
  /** Axis along which the direction is longest, and the two others. */
  int z = 2;
  int x = 0;
  int y = 1;
  double shear_x = 0.0;
  double shear_y = 0.0;

  /** \pre \a direction_ is finite and not zero. */
  ShearedRay(const glm::dvec3 &origin_, const glm::dvec3 &direction_);
};

using Corners = std::array<glm::dvec3, 3>;

/** Weights of the corners where the ray's line, either way, meets the triangle; an edge belongs to it. */
[[nodiscard]] std::optional<glm::dvec3> line_triangle(const ShearedRay &ray, const Corners &corners);

/** The plane of a triangle, and how far rounding may have moved it. */
struct TrianglePlane {
  /** Not of unit length: twice the area. */
  glm::dvec3 normal{0.0};
  double normal_length = 0.0;
  glm::dvec3 point{0.0};
  /** Product of the two edges' lengths that the normal was made of. */
  double edge_product = 0.0;

  explicit TrianglePlane(const Corners &corners);
  /** Distance of \a p times the normal's length. */
  [[nodiscard]] double height(const glm::dvec3 &p) const;
  /**
   * Below it, a height of \a p is 0 as far as anyone can tell. \a error_m: how far \a p and the triangle's corners
   * may be from where they should, in all.
   */
  [[nodiscard]] double height_error(const glm::dvec3 &p, double error_m) const;
};

}  // namespace gnomon::reference
