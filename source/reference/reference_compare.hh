// SPDX-License-Identifier: MIT
#pragma once

#include "reference_visibility.hh"

#include <functional>
#include <span>
#include <vector>

namespace gnomon::reference {

/** Points that an engine lit by one lamp, and how much of the lamp it thought they see. One entry a point in each. */
struct ShadedReceivers {
  std::span<const glm::vec3> positions_ws;
  /** Of the triangle, on the side that was shaded; of any length. */
  std::span<const glm::vec3> normals_ws;
  /** In [0, 1]; what is strictly between is an edge. */
  std::span<const float> visibility;
};

struct CompareSettings {
  /** Width of a texel of the lamp's shadow map at a place, across the light's direction, metres. 0: it has none there.
   */
  std::function<double(const glm::dvec3 &position_ws)> texel_size_m{};
  /** Rays a receiver for a lamp with a size. */
  int sample_count = 64;
  std::uint64_t seed = 0;
  /** 0: one a processor. */
  unsigned thread_count = 0;
};

/** How an engine's visibility of one lamp differs from the truth, over the receivers whose triangle faces the lamp. */
struct VisibilityError {
  std::size_t receiver_count = 0;
  /** Receivers at which no triangle is: they are not judged. */
  std::size_t off_surface_count = 0;
  /** Judged: the triangle faces the lamp, and the engine's visibility is finite. */
  std::size_t facing_count = 0;
  std::size_t non_finite_count = 0;
  /** Engine and truth are on different sides of one half. */
  std::size_t wrong_count = 0;
  /** Wrong, with no edge of the true shadow within the widest ring. Leak: lit in the dark. Acne: dark in the light. */
  std::size_t leak_count = 0;
  std::size_t acne_count = 0;
  /** Engine's visibility strictly between 0 and 1. */
  std::size_t edge_count = 0;
  /** wrong_count / facing_count, or 0. */
  double wrong_fraction = 0.0;
  /** Mean of |engine - truth|. */
  double mean_absolute_error = 0.0;
  /** Of the wrong receivers that are near an edge: the ring at which the truth agrees with the engine, in texels. 0
   * without any. */
  double edge_offset_median = 0.0;
  double edge_offset_p95 = 0.0;
  double edge_offset_max = 0.0;
};

/** Radii, in texels, at which an edge of the true shadow is looked for around a wrong receiver. */
[[nodiscard]] std::span<const double> edge_rings();

/**
 * Judge an engine's shadows of one lamp, in parallel; the result does not depend on the threads.
 *
 * A wrong receiver's edge offset says by how many texels the shadow map would have to be moved for it to be right: the
 * receiver is moved across the light by a ring's radius, in 16 directions, and along the light back onto its surface;
 * the first ring with a place at which the truth is what the engine said is the offset. "Its surface" is the triangle
 * that is nearest there along the light, if that is no further from the receiver's plane than the ring is wide, and
 * else the plane itself.
 *
 * \throws std::invalid_argument where the spans differ in length.
 */
[[nodiscard]] VisibilityError compare_visibility(const Tracer &tracer, const scene::PlacedLamp &lamp,
                                                 const ShadedReceivers &shaded, const CompareSettings &settings);

}  // namespace gnomon::reference
