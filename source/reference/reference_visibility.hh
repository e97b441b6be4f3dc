// SPDX-License-Identifier: MIT
#pragma once

#include "reference_lamp.hh"

#include <cstdint>

namespace gnomon::reference {

/** A point on a surface that receives light. World space, metres. */
struct Receiver {
  glm::dvec3 position_ws{0.0};
  /** Normal of the triangle on the lit side, unit vector. */
  glm::dvec3 normal_ws{0.0, 0.0, 1.0};
  /** Largest possible distance of the position from the surface. */
  double error_m = 0.0;
};

/** A receiver at a position that was computed in double. \a normal_ws: of any length. */
[[nodiscard]] Receiver receiver_at(const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws);

/**
 * The receiver for a position that an engine computed in float: the nearest surface along the normal, within the
 * rounding of 16 float operations on the scene's largest coordinate. Its normal is that of the triangle, on the side of
 * \a normal_ws. Empty if there is no surface within that distance. \a normal_ws: unit vector.
 */
[[nodiscard]] std::optional<Receiver> find_receiver(const Tracer &tracer, const glm::dvec3 &position_ws,
                                                    const glm::dvec3 &normal_ws);

/**
 * The part of the light of a point of a lamp that reaches \a receiver, in [0, 1]: 0 if the point is below the
 * receiver's plane. \see Tracer::transmission. Both sides of a triangle cast shadows, as in a shadow map that draws all
 * faces.
 */
[[nodiscard]] double visible_part(const Tracer &tracer, const Receiver &receiver, const LightPoint &light);

/**
 * Whether any of its light does: no opaque triangle is between them.
 */
[[nodiscard]] bool is_visible(const Tracer &tracer, const Receiver &receiver, const LightPoint &light);

/**
 * The same for the centre of \a lamp. For a lamp without size, this is exact visibility. A hemi lamp casts no shadow
 * and is visible from everywhere.
 */
[[nodiscard]] bool is_visible(const Tracer &tracer, const Receiver &receiver, const scene::PlacedLamp &lamp);

/** Whether the centre of \a lamp is above the receiver's plane. Always true for hemi lamps. */
[[nodiscard]] bool is_facing(const Receiver &receiver, const scene::PlacedLamp &lamp);

/** A sampled quantity. */
struct Estimate {
  double mean = 0.0;
  /**
   * Standard error of the mean; 0 for exact values. An upper estimate: it assumes independent samples, while the
   * samples are distributed evenly.
   */
  double standard_error = 0.0;
};

/**
 * Visible fraction of a lamp's surface (sun: of its solid angle), in [0, 1]. Exact for a lamp without size.
 * \pre sample_count > 0.
 */
[[nodiscard]] Estimate visibility(const Tracer &tracer, const Receiver &receiver, const scene::PlacedLamp &lamp,
                                  int sample_count, std::uint64_t seed);

/** Irradiance at \a receiver from one lamp, W/m², without the lamp's colour. \pre sample_count > 0. */
[[nodiscard]] Estimate irradiance(const Tracer &tracer, const Receiver &receiver, const scene::PlacedLamp &lamp,
                                  int sample_count, std::uint64_t seed);

}  // namespace gnomon::reference
