// SPDX-License-Identifier: MIT
#include "reference_compare.hh"

#include "internal/reference_parallel.hh"
#include "internal/reference_random.hh"

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
/** Further than any ring. */
constexpr double no_edge = std::numeric_limits<double>::infinity();

enum class Verdict : unsigned char { OffSurface, NotFacing, NonFinite, Right, Wrong };

struct Judgement {
  Verdict verdict = Verdict::OffSurface;
  bool is_lit_by_engine = false;
  double error = 0.0;
  /** Wrong only: a ring, or no_edge. */
  double edge_offset = no_edge;
};

/** Judges receivers of one lamp. */
struct Judge {
  const Tracer &tracer;
  const scene::PlacedLamp &lamp;
  const CompareSettings &settings;
  LightPoint light;

  [[nodiscard]] double truth(const Receiver &receiver, std::uint64_t key) const
  {
    return visibility(tracer, receiver, lamp, settings.sample_count, mixed(settings.seed) ^ key).mean;
  }
  [[nodiscard]] std::optional<Receiver> moved(const Receiver &receiver, const glm::dvec3 &across) const;
  [[nodiscard]] double edge_offset(const Receiver &receiver, bool is_lit, std::uint64_t key) const;
  [[nodiscard]] Judgement judge(const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws, double engine,
                                std::uint64_t key) const;
};

/** The receiver moved by \a across, at right angles to the light, and back onto its surface along the light. */
std::optional<Receiver> Judge::moved(const Receiver &receiver, const glm::dvec3 &across) const
{
  const glm::dvec3 start = receiver.position_ws + across;
  const glm::dvec3 to_light = glm::normalize(light.is_direction ? light.vector_ws : light.vector_ws - start);
  const double rise = glm::dot(receiver.normal_ws, to_light);
  const double along = -glm::dot(receiver.normal_ws, across) / rise;
  // Moved so far that the light no longer meets the plane, or only behind the lamp.
  if (!(rise > 0.0) || !std::isfinite(along) ||
      (!light.is_direction && along >= glm::distance(light.vector_ws, start))) {
    return std::nullopt;
  }
  const glm::dvec3 on_plane = start + along * to_light;
  const double width = glm::length(across);
  // Along the light, a step of this length leaves the plane by the ring's width.
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

double Judge::edge_offset(const Receiver &receiver, bool is_lit, std::uint64_t key) const
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
      if (there && (truth(*there, key) > 0.5) == is_lit) {
        return ring;
      }
    }
  }
  return no_edge;
}

Judgement Judge::judge(const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws, double engine,
                       std::uint64_t key) const
{
  Judgement result;
  const double length = glm::length(normal_ws);
  const std::optional<Receiver> receiver =
      length > 0.0 ? find_receiver(tracer, position_ws, normal_ws / length) : std::nullopt;
  if (!receiver) {
    return result;
  }
  if (!is_facing(*receiver, lamp)) {
    result.verdict = Verdict::NotFacing;
    return result;
  }
  if (!std::isfinite(engine)) {
    result.verdict = Verdict::NonFinite;
    return result;
  }
  const double exact = truth(*receiver, key);
  result.is_lit_by_engine = engine > 0.5;
  result.error = std::abs(engine - exact);
  result.verdict = result.is_lit_by_engine == (exact > 0.5) ? Verdict::Right : Verdict::Wrong;
  if (result.verdict == Verdict::Wrong) {
    result.edge_offset = edge_offset(*receiver, result.is_lit_by_engine, key);
  }
  return result;
}

/** The least value that \a share of the sorted \a values do not exceed. */
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
  const Judge judge{tracer, lamp, settings, lamp_center(lamp)};
  std::vector<Judgement> judgements(count);
  constexpr std::size_t chunk = 1024;
  parallel_for((count + chunk - 1) / chunk, settings.thread_count, [&](std::size_t part) {
    for (std::size_t i = part * chunk; i < std::min((part + 1) * chunk, count); i++) {
      judgements[i] = judge.judge(glm::dvec3(shaded.positions_ws[i]), glm::dvec3(shaded.normals_ws[i]),
                                  double(shaded.visibility[i]), i);
    }
  });

  VisibilityError result;
  result.receiver_count = count;
  std::vector<double> offsets;
  double error_sum = 0.0;
  for (std::size_t i = 0; i < count; i++) {
    const Judgement &judgement = judgements[i];
    switch (judgement.verdict) {
      case Verdict::OffSurface: result.off_surface_count++; continue;
      case Verdict::NotFacing: continue;
      case Verdict::NonFinite: result.non_finite_count++; continue;
      case Verdict::Right:
      case Verdict::Wrong: break;
    }
    result.facing_count++;
    error_sum += judgement.error;
    result.edge_count += shaded.visibility[i] > 0.0F && shaded.visibility[i] < 1.0F;
    if (judgement.verdict == Verdict::Right) {
      continue;
    }
    result.wrong_count++;
    if (judgement.edge_offset < no_edge) {
      offsets.push_back(judgement.edge_offset);
    }
    else {
      (judgement.is_lit_by_engine ? result.leak_count : result.acne_count)++;
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
