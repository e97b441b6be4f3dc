// SPDX-License-Identifier: MIT
#pragma once

#include "reference_visibility.hh"

#include <functional>
#include <span>
#include <vector>

namespace gnomon::reference {

/** Points that an engine lit by one lamp, with the engine's visibility of the lamp. Each span has one entry for each
 * point. */
struct ShadedReceivers {
  std::span<const glm::dvec3> positions_ws;
  /** Normals of the triangles, on the shaded side, of any length. */
  std::span<const glm::vec3> normals_ws;
  /** In [0, 1]. Values strictly between 0 and 1 belong to an edge. */
  std::span<const float> visibility;
};

struct CompareSettings {
  /** Width of a shadow map texel at a position, across the light's direction, metres. 0: no map covers the position. */
  std::function<double(const glm::dvec3 &position_ws)> texel_size_m{};
  /** Rays for each receiver, for lamps that have a size. */
  int sample_count = 64;
  std::uint64_t seed = 0;
  /** 0: one thread for each processor. */
  unsigned thread_count = 0;
};

/** Error of an engine's visibility of one lamp, over the receivers whose triangle faces the lamp. */
struct VisibilityError {
  std::size_t receiver_count = 0;
  /** Receivers without a triangle at their position. They are not compared. */
  std::size_t off_surface_count = 0;
  /** Compared receivers: the triangle faces the lamp, and the engine's visibility is finite. */
  std::size_t facing_count = 0;
  std::size_t non_finite_count = 0;
  /** The engine's visibility and the exact one lie on different sides of one half. */
  std::size_t wrong_count = 0;
  /** Wrong receivers without an edge of the exact shadow within the widest ring. Leak: lit in the dark. Acne: dark in
   * the light. */
  std::size_t leak_count = 0;
  std::size_t acne_count = 0;
  /** Receivers with an engine's visibility strictly between 0 and 1. */
  std::size_t edge_count = 0;
  /** wrong_count / facing_count, or 0. */
  double wrong_fraction = 0.0;
  /** Mean of |engine - exact|. */
  double mean_absolute_error = 0.0;
  /**
   * Over the wrong receivers near an edge: the radius of the ring on which the exact visibility agrees with the engine,
   * in texels. 0 if there are none.
   */
  double edge_offset_median = 0.0;
  double edge_offset_p95 = 0.0;
  double edge_offset_max = 0.0;
};

/** Radii, in texels, at which an edge of the exact shadow is searched around a wrong receiver. */
[[nodiscard]] std::span<const double> edge_rings();

/**
 * Compares an engine's shadows of one lamp with exact visibility, in parallel. The result does not depend on the number
 * of threads.
 *
 * The edge offset of a wrong receiver is the distance, in texels, by which the shadow map would have to be moved to
 * make the receiver right. To find it, the receiver is moved across the light by the radius of a ring, in 16
 * directions, and then along the light back onto its surface. The offset is the radius of the first ring that contains
 * a position whose exact visibility agrees with the engine. The surface is the nearest triangle along the light, if its
 * distance from the receiver's plane is at most the radius of the ring, and otherwise the plane itself. A lit position
 * does not count if a surface separates it from the receiver: light through the joint of a floor and a wall is a leak.
 *
 * \throws std::invalid_argument if the spans differ in length.
 */
[[nodiscard]] VisibilityError compare_visibility(const Tracer &tracer, const scene::PlacedLamp &lamp,
                                                 const ShadedReceivers &shaded, const CompareSettings &settings);

}  // namespace gnomon::reference
