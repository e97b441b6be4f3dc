// SPDX-License-Identifier: MIT
#pragma once

#include "reference_lamp.hh"

#include <cstdint>

namespace gnomon::reference {

/** A point of a surface that light may reach. World space, metres. */
struct Receiver {
  glm::dvec3 position_ws{0.0};
  /** Of the triangle; unit vector, on the side that is lit. */
  glm::dvec3 normal_ws{0.0, 0.0, 1.0};
  /** How far the position may be from the surface, at most. */
  double error_m = 0.0;
};

/** A receiver at a position that was computed in double. */
[[nodiscard]] Receiver receiver_at(const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws);

/**
 * The receiver that an engine meant, which has its position in float: the surface that is nearest along the normal,
 * within the roundings of 16 float operations on the scene's largest coordinate. Its normal is the triangle's, on \a
 * normal_ws's side. Nothing where there is none.
 */
[[nodiscard]] std::optional<Receiver> find_receiver(const Tracer &tracer, const glm::dvec3 &position_ws,
                                                    const glm::dvec3 &normal_ws);

/**
 * Whether a point of a lamp is seen from \a receiver: it is above the receiver's plane, and nothing is between. Every
 * triangle casts its shadow from both of its sides, as in a shadow map that draws all faces.
 */
[[nodiscard]] bool is_visible(const Tracer &tracer, const Receiver &receiver, const LightPoint &light);

/** The same for the middle of \a lamp: all of it, where it has no size. A hemi lamp casts no shadow and is seen from
 * anywhere. */
[[nodiscard]] bool is_visible(const Tracer &tracer, const Receiver &receiver, const scene::PlacedLamp &lamp);

/** Whether the middle of \a lamp is above the receiver's plane. Any place is above a hemi lamp's. */
[[nodiscard]] bool is_facing(const Receiver &receiver, const scene::PlacedLamp &lamp);

/** A sampled quantity. */
struct Estimate {
  double mean = 0.0;
  /** Of the mean; 0 for what is exact. At most too large: it takes the samples for independent, and they are spread
   * evenly. */
  double standard_error = 0.0;
};

/** Share of a lamp's surface (sun: of its solid angle) that is seen, in [0, 1]; exact for a lamp without size. \pre
 * sample_count > 0. */
[[nodiscard]] Estimate visibility(const Tracer &tracer, const Receiver &receiver, const scene::PlacedLamp &lamp,
                                  int sample_count, std::uint64_t seed);

/** W/m² at \a receiver from one lamp, lamp colour left out. \pre sample_count > 0. */
[[nodiscard]] Estimate irradiance(const Tracer &tracer, const Receiver &receiver, const scene::PlacedLamp &lamp,
                                  int sample_count, std::uint64_t seed);

}  // namespace gnomon::reference
