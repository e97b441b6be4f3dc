// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_picture_depths.hh"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <vector>

namespace gnomon::eevee {

/** Number of ranges of the distance. \see VisibleCluster::range */
inline constexpr int distance_range_count = 32;

/** The surfaces that a small square of pixels shows in one range of the distance. */
struct VisibleCluster {
  /** Corners of a part of the frustum that contains the surfaces, world space, metres. */
  std::array<glm::dvec3, 8> corners_ws;
  /**
   * Index of the range, from near to far, 0 to distance_range_count - 1. The ranges divide the distances of all visible
   * surfaces: evenly in their logarithm for perspective views, evenly for orthographic views.
   */
  int range = 0;
  /** Column and row of the square of pixels, from the lower left. */
  glm::ivec2 square{0};
  /** Mean distance along the view direction, metres. */
  double distance = 0.0;
  /** Number of pixels that show the surfaces. */
  int pixel_count = 0;
};

/**
 * The surfaces in  picture. Each cluster contains all of its pixels, and is deeper by 1 % of the distance on each
 * side, so that it contains what samples at other positions in the pixels see of the same surfaces. Surfaces that
 * another sample sees between those pixels may be outside of all clusters.  memory: its capacity is reused for the
 * result; its content is discarded.
 */
[[nodiscard]] std::vector<VisibleCluster> visible_clusters(const PictureDepths &picture,
                                                           std::vector<VisibleCluster> memory = {});

}  // namespace gnomon::eevee
