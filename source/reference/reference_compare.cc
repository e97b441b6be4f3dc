// SPDX-License-Identifier: MIT
#include "reference_compare.hh"

#include "internal/reference_random.hh"
#include "scene_parallel.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace gnomon::reference {

namespace {

constexpr std::array<double, 9> rings_texels = {0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0};
constexpr int ring_directions = 16;
/** Farther than every ring. */
constexpr double no_edge = std::numeric_limits<double>::infinity();

/** Result of the comparison at one receiver. */
enum class Outcome : unsigned char { OffSurface, NotFacing, NonFinite, Right, Wrong };

struct ReceiverResult {
  Outcome outcome = Outcome::OffSurface;
  bool is_lit_by_engine = false;
  double error = 0.0;
  /** For wrong receivers: the radius of a ring, texels, or no_edge. */
  double edge_offset = no_edge;
};

/** Compares an engine's visibility of one lamp with the exact one. */
struct ReceiverComparer {
  const Tracer &tracer;
  const scene::PlacedLamp &lamp;
  const CompareSettings &settings;
  LightPoint light;

  [[nodiscard]] double exact_visibility(const Receiver &receiver, std::uint64_t key) const
  {
    return visibility(tracer, receiver, lamp, settings.sample_count, mixed(settings.seed) ^ key).mean;
  }
  [[nodiscard]] std::optional<Receiver> moved(const Receiver &receiver, const glm::dvec3 &across) const;
  [[nodiscard]] bool is_open_between(const Receiver &receiver, const Receiver &there) const;
  [[nodiscard]] double edge_offset(const Receiver &receiver, bool is_lit, std::uint64_t key) const;
  [[nodiscard]] ReceiverResult compare(const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws, double engine,
                                       std::uint64_t key) const;
};

/** The receiver moved by \a across, perpendicular to the light, and then along the light back onto its surface. */
std::optional<Receiver> ReceiverComparer::moved(const Receiver &receiver, const glm::dvec3 &across) const
{
  const glm::dvec3 start = receiver.position_ws + across;
  const glm::dvec3 to_light = glm::normalize(light.is_direction ? light.vector_ws : light.vector_ws - start);
  const double rise = glm::dot(receiver.normal_ws, to_light);
  const double along = -glm::dot(receiver.normal_ws, across) / rise;
  // At this distance the line along the light does not meet the plane, or meets it behind the lamp.
  if (!(rise > 0.0) || !std::isfinite(along) ||
      (!light.is_direction && along >= glm::distance(light.vector_ws, start))) {
    return std::nullopt;
  }
  const glm::dvec3 on_plane = start + along * to_light;
  const double width = glm::length(across);
  // A step of this length along the light moves away from the plane by the radius of the ring.
  const double reach = width / rise;
  std::optional<Hit> nearest;
  for (const double side : {1.0, -1.0}) {
    const std::optional<Hit> hit = tracer.closest({on_plane, side * to_light, 0.0, reach}, Faces::All);
    if (hit && (!nearest || hit->t < nearest->t)) {
      nearest = hit;
    }
  }
  if (!nearest) {
    Receiver on_its_plane = receiver_at(on_plane, receiver.normal_ws);
    on_its_plane.error_m += receiver.error_m;
    return on_its_plane;
  }
  const Surface surface = tracer.surface_at(*nearest);
  const bool is_front = glm::dot(surface.geometric_normal_ws, receiver.normal_ws) >= 0.0;
  return Receiver{surface.position_ws, is_front ? surface.geometric_normal_ws : -surface.geometric_normal_ws,
                  surface.error_m};
}

/**
 * Whether no surface is between two receivers, on their shaded sides. Light beyond a wall that stands on the receiver's
 * surface is not beside the receiver, however near it is.
 */
bool ReceiverComparer::is_open_between(const Receiver &receiver, const Receiver &there) const
{
  const double width = glm::distance(receiver.position_ws, there.position_ws);
  const double above = std::max(1e-3 * width, 4.0 * (receiver.error_m + there.error_m));
  const glm::dvec3 from = receiver.position_ws + above * receiver.normal_ws;
  const glm::dvec3 to = there.position_ws + above * there.normal_ws;
  return !tracer.closest({from, to - from, 0.0, 1.0}, Faces::All);
}

double ReceiverComparer::edge_offset(const Receiver &receiver, bool is_lit, std::uint64_t key) const
{
  const double texel_m = settings.texel_size_m ? settings.texel_size_m(receiver.position_ws) : 0.0;
  if (!(texel_m > 0.0) || !std::isfinite(texel_m)) {
    return no_edge;
  }
  const glm::dvec3 to_light =
      glm::normalize(light.is_direction ? light.vector_ws : light.vector_ws - receiver.position_ws);
  const glm::dvec3 helper = std::abs(to_light.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(1.0, 0.0, 0.0);
  const glm::dvec3 right = glm::normalize(glm::cross(to_light, helper));
  const glm::dvec3 up = glm::cross(right, to_light);
  for (const double ring : rings_texels) {
    for (int i = 0; i < ring_directions; i++) {
      const double angle = 2.0 * std::numbers::pi * double(i) / ring_directions;
      const glm::dvec3 across = ring * texel_m * (std::cos(angle) * right + std::sin(angle) * up);
      const std::optional<Receiver> there = moved(receiver, across);
      if (there && (exact_visibility(*there, key) > 0.5) == is_lit && (!is_lit || is_open_between(receiver, *there))) {
        return ring;
      }
    }
  }
  return no_edge;
}

ReceiverResult ReceiverComparer::compare(const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws, double engine,
                                         std::uint64_t key) const
{
  ReceiverResult result;
  const double length = glm::length(normal_ws);
  const std::optional<Receiver> receiver =
      length > 0.0 ? find_receiver(tracer, position_ws, normal_ws / length) : std::nullopt;
  if (!receiver) {
    return result;
  }
  if (!is_facing(*receiver, lamp)) {
    result.outcome = Outcome::NotFacing;
    return result;
  }
  if (!std::isfinite(engine)) {
    result.outcome = Outcome::NonFinite;
    return result;
  }
  const double exact = exact_visibility(*receiver, key);
  result.is_lit_by_engine = engine > 0.5;
  result.error = std::abs(engine - exact);
  result.outcome = result.is_lit_by_engine == (exact > 0.5) ? Outcome::Right : Outcome::Wrong;
  if (result.outcome == Outcome::Wrong) {
    result.edge_offset = edge_offset(*receiver, result.is_lit_by_engine, key);
  }
  return result;
}

/** The smallest of the sorted \a values that a fraction \a share of them does not exceed. 0 if there are none. */
double percentile(const std::vector<double> &values, double share)
{
  if (values.empty()) {
    return 0.0;
  }
  const double rank = std::ceil(share * double(values.size()));
  return values[std::size_t(std::max(rank, 1.0)) - 1];
}

}  // namespace

std::span<const double> edge_rings()
{
  return rings_texels;
}

VisibilityError compare_visibility(const Tracer &tracer, const scene::PlacedLamp &lamp, const ShadedReceivers &shaded,
                                   const CompareSettings &settings)
{
  const std::size_t count = shaded.positions_ws.size();
  if (shaded.normals_ws.size() != count || shaded.visibility.size() != count) {
    throw std::invalid_argument(fmt::format("lamp '{}': {} positions, {} normals and {} visibilities do not match",
                                            lamp.name, count, shaded.normals_ws.size(), shaded.visibility.size()));
  }
  const ReceiverComparer comparer{tracer, lamp, settings, lamp_center(lamp)};
  std::vector<ReceiverResult> results(count);
  constexpr std::size_t chunk = 1024;
  scene::parallel_for((count + chunk - 1) / chunk, settings.thread_count, [&](std::size_t part) {
    for (std::size_t i = part * chunk; i < std::min((part + 1) * chunk, count); i++) {
      results[i] =
          comparer.compare(shaded.positions_ws[i], glm::dvec3(shaded.normals_ws[i]), double(shaded.visibility[i]), i);
    }
  });

  VisibilityError result;
  result.receiver_count = count;
  std::vector<double> offsets;
  double error_sum = 0.0;
  for (std::size_t i = 0; i < count; i++) {
    const ReceiverResult &receiver = results[i];
    switch (receiver.outcome) {
      case Outcome::OffSurface: result.off_surface_count++; continue;
      case Outcome::NotFacing: continue;
      case Outcome::NonFinite: result.non_finite_count++; continue;
      case Outcome::Right:
      case Outcome::Wrong: break;
    }
    result.facing_count++;
    error_sum += receiver.error;
    result.edge_count += shaded.visibility[i] > 0.0F && shaded.visibility[i] < 1.0F;
    if (receiver.outcome == Outcome::Right) {
      continue;
    }
    result.wrong_count++;
    if (receiver.edge_offset < no_edge) {
      offsets.push_back(receiver.edge_offset);
    }
    else {
      (receiver.is_lit_by_engine ? result.leak_count : result.acne_count)++;
    }
  }
  if (result.facing_count > 0) {
    result.wrong_fraction = double(result.wrong_count) / double(result.facing_count);
    result.mean_absolute_error = error_sum / double(result.facing_count);
  }
  std::ranges::sort(offsets);
  result.edge_offset_median = percentile(offsets, 0.5);
  result.edge_offset_p95 = percentile(offsets, 0.95);
  result.edge_offset_max = offsets.empty() ? 0.0 : offsets.back();
  return result;
}

}  // namespace gnomon::reference
