// SPDX-License-Identifier: MIT
#pragma once

#include "reference_tracer.hh"

#include <glm/vec2.hpp>

namespace gnomon::reference {

/** A point of a lamp and its light at a receiver. */
struct LampSample {
  LightPoint point;
  /** Unit vector from the receiver to the point; zero for a receiver at the point itself. */
  glm::dvec3 to_light_ws{0.0};
  /**
   * W/m² on a surface that faces the point, if the whole lamp were at the point; without the lamp's colour. The mean of
   * this value times the cosine, over the unit square, is the irradiance of the lamp. Finite and never negative.
   */
  double irradiance = 0.0;
};

/** Whether a lamp has a size: a radius, an angle or an area. */
[[nodiscard]] bool has_size(const scene::Lamp &lamp);

/**
 * The point of a lamp for \a u in [0, 1]². An even distribution of \a u gives an even distribution over
 * - the disk of a point or spot lamp, with the lamp's radius and turned to the receiver. Its radiance is intensity /
 *   (π radius²), which gives intensity / (d² + radius²) on the axis. `doc/conventions.md` defines cone and range;
 * - the cone of a sun, by solid angle. Its radiance gives the sun's intensity on a surface that faces it;
 * - the rectangle or ellipse of an area lamp, which emits to one side. Its radiance is power / (4 area).
 * A lamp without size is one point for every \a u. \pre the lamp is not a hemi lamp, which has no single direction.
 */
[[nodiscard]] LampSample sample_lamp(const scene::PlacedLamp &lamp, const glm::dvec3 &position_ws, const glm::dvec2 &u);

/** false for hemi lamps, and for lamps whose shadow setting is None. */
[[nodiscard]] bool casts_shadow(const scene::Lamp &lamp);

/** The centre of a lamp. */
[[nodiscard]] LightPoint lamp_center(const scene::PlacedLamp &lamp);

}  // namespace gnomon::reference
