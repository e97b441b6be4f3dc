// SPDX-License-Identifier: MIT
#pragma once

#include "reference_tracer.hh"

#include <glm/vec2.hpp>

namespace gnomon::reference {

/** One point of a lamp, as a receiver meets it. */
struct LampSample {
  LightPoint point;
  /** Unit vector; zero for a receiver at the lamp itself. */
  glm::dvec3 to_light_ws{0.0};
  /**
   * W/m² on a surface that faces the point, were all of the lamp there; lamp colour left out. The mean over the unit
   * square of this times the cosine is the lamp's irradiance. Finite, never negative.
   */
  double irradiance = 0.0;
};

/** Whether a lamp has points to choose from: a radius, an angle, an area. */
[[nodiscard]] bool has_size(const scene::Lamp &lamp);

/**
 * The point that \a u in [0, 1]² chooses, evenly over
 * - a point or spot lamp's disk of its radius, turned to the receiver, of radiance intensity / (π radius²). In the
 * middle of the light, this gives intensity / (d² + radius²). Cone and range are those of `doc/conventions.md`;
 * - a sun's cone, by solid angle, of the radiance that gives its intensity on a surface that faces it;
 * - an area lamp's rectangle or ellipse, of radiance power / (π area), which shines to one side.
 * A lamp without size is one point, whatever \a u. \pre not a hemi lamp, which has no direction.
 */
[[nodiscard]] LampSample sample_lamp(const scene::PlacedLamp &lamp, const glm::dvec3 &position_ws, const glm::dvec2 &u);

/** false for a hemi lamp, and for one that asks for no shadow. */
[[nodiscard]] bool casts_shadow(const scene::Lamp &lamp);

/** The middle of a lamp. */
[[nodiscard]] LightPoint lamp_center(const scene::PlacedLamp &lamp);

}  // namespace gnomon::reference
