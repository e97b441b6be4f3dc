// SPDX-License-Identifier: MIT
#include "reference_lamp.hh"

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::reference {

namespace {

using std::numbers::pi;
/** Light does not increase below a distance of a micrometre and stays finite, as in `eevee_light_shared.h`. */
constexpr double distance_sq_min = 1e-12;

/** An axis of the lamp in world space, unit vector. */
glm::dvec3 axis(const scene::PlacedLamp &lamp, int column)
{
  return glm::normalize(glm::dvec3(lamp.world_from_lamp[column]));
}

/** Two unit vectors orthogonal to \a n and to each other (Duff et al. 2017). \a n: unit vector. */
void make_frame(const glm::dvec3 &n, glm::dvec3 &right, glm::dvec3 &up)
{
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  const double b = n.x * n.y * a;
  right = {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  up = {b, sign + n.y * n.y * a, -n.y};
}

/** Maps the unit square evenly to the unit disk. */
glm::dvec2 disk(const glm::dvec2 &u)
{
  const double radius = std::sqrt(u.x);
  return {radius * std::cos(2.0 * pi * u.y), radius * std::sin(2.0 * pi * u.y)};
}

/** 1 - cos of the angle between two unit vectors, without cancellation for small angles. */
double one_minus_cos(const glm::dvec3 &a, const glm::dvec3 &b)
{
  return 0.5 * glm::dot(a - b, a - b);
}

/** Transmission of the spot's cone, in [0, 1]. \a from_light: unit vector. */
double spot_transmission(const scene::PlacedLamp &lamp, const glm::dvec3 &from_light)
{
  const double sine = std::sin(0.5 * double(lamp.spot_outer_angle));
  const double edge = 2.0 * sine * sine;
  // An ellipse across the axis is a circle once each axis is divided by its width.
  const glm::dvec2 width_of = scene::spot_scale(lamp);
  const glm::dvec3 forward = -axis(lamp, 2);
  const glm::dvec3 narrowed =
      glm::normalize(glm::dvec3(glm::dot(from_light, axis(lamp, 0)) / width_of.x,
                                glm::dot(from_light, axis(lamp, 1)) / width_of.y, glm::dot(from_light, forward)));
  const double inside = edge - one_minus_cos(narrowed, {0.0, 0.0, 1.0});
  const double width = edge * double(lamp.spot_blend);
  if (inside <= 0.0) {
    return 0.0;
  }
  const double t = inside < width ? inside / width : 1.0;
  return t * t * (3.0 - 2.0 * t);
}

/** Window of KHR_lights_punctual for the range, in [0, 1]. */
double range_window(const scene::Lamp &lamp, double distance_sq)
{
  if (lamp.range <= 0.0F) {
    return 1.0;
  }
  const double ratio = distance_sq / (double(lamp.range) * double(lamp.range));
  return std::max(1.0 - ratio * ratio, 0.0);
}

LampSample sample_sun(const scene::PlacedLamp &lamp, const glm::dvec2 &u)
{
  const glm::dvec3 middle = axis(lamp, 2);
  LampSample sample;
  const double sine = std::sin(0.25 * double(lamp.angle));
  // Even in solid angle: 1 - cos is distributed evenly over [0, 1 - cos(angle / 2)].
  const double drop = 2.0 * sine * sine * u.x;
  const double across = std::sqrt(std::max(drop * (2.0 - drop), 0.0));
  glm::dvec3 right;
  glm::dvec3 up;
  make_frame(middle, right, up);
  const double turn = 2.0 * pi * u.y;
  sample.to_light_ws = glm::normalize(middle * (1.0 - drop) + across * (std::cos(turn) * right + std::sin(turn) * up));
  sample.point = {sample.to_light_ws, true};
  // Radiance E / (π sin²) times the solid angle 2π (1 - cos): 2 E / (1 + cos).
  sample.irradiance = double(lamp.intensity) / (1.0 - sine * sine);
  return sample;
}

/** A sample of a flat lamp at \a position that emits along \a forward, a unit vector. \a strength: radiance · area. */
LampSample sample_flat(const glm::dvec3 &position, const glm::dvec3 &forward, double strength,
                       const glm::dvec3 &receiver)
{
  LampSample sample;
  sample.point = {position, false};
  const glm::dvec3 to_light = position - receiver;
  const double distance_sq = glm::dot(to_light, to_light);
  if (!(distance_sq > 0.0)) {
    return sample;
  }
  sample.to_light_ws = to_light / std::sqrt(distance_sq);
  const double cos_lamp = std::max(-glm::dot(sample.to_light_ws, forward), 0.0);
  sample.irradiance = strength * cos_lamp / std::max(distance_sq, distance_sq_min);
  return sample;
}

LampSample sample_point(const scene::PlacedLamp &lamp, const glm::dvec3 &receiver, const glm::dvec2 &u)
{
  const glm::dvec3 center(lamp.world_from_lamp[3]);
  const glm::dvec3 from_light = receiver - center;
  const double distance_sq = glm::dot(from_light, from_light);
  if (!(distance_sq > 0.0)) {
    return {{center, false}, glm::dvec3(0.0), 0.0};
  }
  const glm::dvec3 forward = from_light / std::sqrt(distance_sq);
  glm::dvec3 right;
  glm::dvec3 up;
  make_frame(forward, right, up);
  const glm::dvec2 across = double(lamp.radius) * disk(u);
  LampSample sample = sample_flat(center + across.x * right + across.y * up, forward, double(lamp.intensity), receiver);
  sample.irradiance *= range_window(lamp, distance_sq);
  if (lamp.kind == scene::LampKind::Spot) {
    sample.irradiance *= spot_transmission(lamp, -sample.to_light_ws);
  }
  return sample;
}

LampSample sample_area(const scene::PlacedLamp &lamp, const glm::dvec3 &receiver, const glm::dvec2 &u)
{
  const glm::dvec2 half_size = scene::area_half_size(lamp);
  const glm::dvec2 at = half_size * (lamp.area_shape == scene::AreaShape::Ellipse ? disk(u) : 2.0 * u - 1.0);
  const glm::dvec3 position = glm::dvec3(lamp.world_from_lamp[3]) + at.x * axis(lamp, 0) + at.y * axis(lamp, 1);
  return sample_flat(position, -axis(lamp, 2), half_size.x > 0.0 ? 0.25 * double(lamp.intensity) : 0.0, receiver);
}

}  // namespace

bool has_size(const scene::Lamp &lamp)
{
  switch (lamp.kind) {
    case scene::LampKind::Point:
    case scene::LampKind::Spot: return lamp.radius > 0.0F;
    case scene::LampKind::Sun: return lamp.angle > 0.0F;
    case scene::LampKind::Area: return true;
    case scene::LampKind::Hemi: break;
  }
  return false;
}

LampSample sample_lamp(const scene::PlacedLamp &lamp, const glm::dvec3 &position_ws, const glm::dvec2 &u)
{
  switch (lamp.kind) {
    case scene::LampKind::Point:
    case scene::LampKind::Spot: return sample_point(lamp, position_ws, u);
    case scene::LampKind::Area: return sample_area(lamp, position_ws, u);
    case scene::LampKind::Sun:
    case scene::LampKind::Hemi: break;
  }
  return sample_sun(lamp, u);
}

bool casts_shadow(const scene::Lamp &lamp)
{
  return lamp.kind != scene::LampKind::Hemi && lamp.shadow.kind != scene::ShadowKind::None;
}

LightPoint lamp_center(const scene::PlacedLamp &lamp)
{
  if (lamp.kind == scene::LampKind::Sun || lamp.kind == scene::LampKind::Hemi) {
    return {axis(lamp, 2), true};
  }
  return {glm::dvec3(lamp.world_from_lamp[3]), false};
}

}  // namespace gnomon::reference
