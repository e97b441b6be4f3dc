// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_visible_clusters.hh"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace gnomon::eevee {

/** A rectangle across the light of a sun, around the visible surfaces of some ranges of the distance. */
struct SunSlice {
  /** Angle from the axes of the lamp to those of the rectangle, around the lamp's z axis, radians. */
  double turn = 0.0;
  /** Limits along the rectangle's axes, metres. */
  glm::dvec2 min{0.0};
  glm::dvec2 max{0.0};
};

/** Slices from near to far, and the remaining error. */
struct SunSlices {
  std::vector<SunSlice> slices;
  /**
   * Mean over the visible surfaces of q². q: edge of the texels that a pixel looks up, in pixels (the
   * root mean square of both edges). The weight of a pixel is its edge on the surface, because it crosses as many edges
   * of shadows. 0 if no visible surface can be in shadow.
   */
  double error = 0.0;
};

/** The view and the maps that slices are chosen for. */
struct SliceConditions {
  glm::dmat3 lamp_from_world{1.0};
  /**
   * Limits across the light of the map behind all slices, in the lamp's axes, metres. They include its margin, in which
   * a texel may show a caster. Surfaces outside of the limits are lit.
   */
  glm::dvec2 whole_min{0.0};
  glm::dvec2 whole_max{0.0};
  /** Edges of the texels of that map, metres. */
  glm::dvec2 whole_texel{0.0};
  /** Texels across a slice. */
  double slice_px = 0.0;
  bool is_perspective = true;
  /** \see fit_sun */
  double pixel_size = 0.0;
};

/** The rotation of \a lamp_from_world to the axes of a slice. \see SunSlice::turn */
[[nodiscard]] glm::dmat3 turned(const glm::dmat3 &lamp_from_world, double turn);

/**
 * The slices with the least error: element i of the result has at most i slices. Surfaces in no slice look up the map
 * behind all slices. Slices are inside of that map, and their texels are smaller. \a count_max: maximum number of
 * slices; the result has count_max + 1 elements.
 *
 * Dynamic programming over the ranges of the distance: each slice has a run of ranges.
 */
[[nodiscard]] std::vector<SunSlices> sun_slices(std::span<const VisibleCluster> clusters,
                                                const SliceConditions &conditions, int count_max);

}  // namespace gnomon::eevee
