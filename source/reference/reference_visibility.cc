// SPDX-License-Identifier: MIT
#include "reference_visibility.hh"

#include "internal/reference_random.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::reference {

namespace {

/** Mean of \a value over \a count points of the unit square. */
template <typename Value>
Estimate mean_over_square(int count, std::uint64_t seed, const Value &value)
{
  // Welford's algorithm does not cancel if all values are almost equal.
  double mean = 0.0;
  double squares = 0.0;
  for (int i = 0; i < count; i++) {
    const double x = value(even_point(i, mixed(seed)));
    const double from_mean = x - mean;
    mean += from_mean / double(i + 1);
    squares += from_mean * (x - mean);
  }
  // The error of a single sample is unknown; its magnitude is used instead.
  const double error = count > 1 ? std::sqrt(squares / (double(count) * double(count - 1))) : std::abs(mean);
  return {mean, error};
}

/** Positive if \a light is above the receiver's plane. Not normalised. */
double cos_to(const Receiver &receiver, const LightPoint &light)
{
  return glm::dot(receiver.normal_ws, light.is_direction ? light.vector_ws : light.vector_ws - receiver.position_ws);
}

}  // namespace

Receiver receiver_at(const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws)
{
  return {position_ws, glm::normalize(normal_ws), position_error(position_ws)};
}

std::optional<Receiver> find_receiver(const Tracer &tracer, const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws)
{
  constexpr double float_rounding = 0x1p-24;
  const double reach_m = 16.0 * float_rounding * tracer.largest_coordinate();
  std::optional<Hit> nearest;
  for (const double side : {1.0, -1.0}) {
    const std::optional<Hit> hit = tracer.closest({position_ws, side * normal_ws, 0.0, reach_m}, Faces::All);
    if (hit && (!nearest || hit->t < nearest->t)) {
      nearest = hit;
    }
  }
  if (!nearest) {
    return std::nullopt;
  }
  const Surface surface = tracer.surface_at(*nearest);
  const bool is_front = glm::dot(surface.geometric_normal_ws, normal_ws) >= 0.0;
  return Receiver{surface.position_ws, is_front ? surface.geometric_normal_ws : -surface.geometric_normal_ws,
                  surface.error_m};
}

double visible_part(const Tracer &tracer, const Receiver &receiver, const LightPoint &light)
{
  return cos_to(receiver, light) > 0.0 ? tracer.transmission(receiver.position_ws, receiver.error_m, light) : 0.0;
}

bool is_visible(const Tracer &tracer, const Receiver &receiver, const LightPoint &light)
{
  return visible_part(tracer, receiver, light) > 0.0;
}

bool is_visible(const Tracer &tracer, const Receiver &receiver, const scene::PlacedLamp &lamp)
{
  return !casts_shadow(lamp) || is_visible(tracer, receiver, lamp_center(lamp));
}

bool is_facing(const Receiver &receiver, const scene::PlacedLamp &lamp)
{
  return lamp.kind == scene::LampKind::Hemi || cos_to(receiver, lamp_center(lamp)) > 0.0;
}

Estimate visibility(const Tracer &tracer, const Receiver &receiver, const scene::PlacedLamp &lamp, int sample_count,
                    std::uint64_t seed)
{
  if (!casts_shadow(lamp)) {
    return {1.0, 0.0};
  }
  if (!has_size(lamp)) {
    return {visible_part(tracer, receiver, lamp_center(lamp)), 0.0};
  }
  return mean_over_square(sample_count, seed, [&](const glm::dvec2 &u) {
    return visible_part(tracer, receiver, sample_lamp(lamp, receiver.position_ws, u).point);
  });
}

Estimate irradiance(const Tracer &tracer, const Receiver &receiver, const scene::PlacedLamp &lamp, int sample_count,
                    std::uint64_t seed)
{
  if (lamp.kind == scene::LampKind::Hemi) {
    const double cosine = glm::dot(receiver.normal_ws, lamp_center(lamp).vector_ws);
    return {double(lamp.intensity) * std::clamp(0.5 + 0.5 * cosine, 0.0, 1.0), 0.0};
  }
  const auto value = [&](const glm::dvec2 &u) {
    const LampSample sample = sample_lamp(lamp, receiver.position_ws, u);
    const double cosine = glm::dot(receiver.normal_ws, sample.to_light_ws);
    if (!(cosine > 0.0)) {
      return 0.0;
    }
    return sample.irradiance * cosine * (casts_shadow(lamp) ? visible_part(tracer, receiver, sample.point) : 1.0);
  };
  if (!has_size(lamp)) {
    return {value({0.5, 0.5}), 0.0};
  }
  return mean_over_square(sample_count, seed, value);
}

}  // namespace gnomon::reference
