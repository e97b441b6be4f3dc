// SPDX-License-Identifier: MIT
#include "shadow_casters.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

namespace gnomon::eevee {

std::uint64_t fingerprint_of(std::span<const std::byte> bytes)
{
  return std::hash<std::string_view>{}({reinterpret_cast<const char *>(bytes.data()), bytes.size()});
}

std::vector<scene::Bounds> changed_bounds(const std::vector<Caster> &before, const std::vector<Caster> &after)
{
  // Only the range between equal beginnings and equal ends is sorted. After most edits, it is short or empty.
  std::span<const Caster> old_casters(before);
  std::span<const Caster> new_casters(after);
  const auto first = std::ranges::mismatch(old_casters, new_casters, {}, &Caster::fingerprint, &Caster::fingerprint);
  old_casters = {first.in1, old_casters.end()};
  new_casters = {first.in2, new_casters.end()};
  while (!old_casters.empty() && !new_casters.empty() &&
         old_casters.back().fingerprint == new_casters.back().fingerprint) {
    old_casters = old_casters.first(old_casters.size() - 1);
    new_casters = new_casters.first(new_casters.size() - 1);
  }
  using Entry = std::pair<std::uint64_t, const Caster *>;
  const auto entries_of = [](std::span<const Caster> casters, bool is_sorted) {
    std::vector<Entry> entries;
    entries.reserve(casters.size());
    for (const Caster &caster : casters) {
      entries.emplace_back(caster.fingerprint, &caster);
    }
    if (is_sorted) {
      std::ranges::sort(entries, {}, &Entry::first);
    }
    return entries;
  };
  // All of the only list have changed.
  const bool is_sorted = !old_casters.empty() && !new_casters.empty();
  std::vector<Entry> changed;
  std::ranges::set_symmetric_difference(entries_of(old_casters, is_sorted), entries_of(new_casters, is_sorted),
                                        std::back_inserter(changed), {}, &Entry::first, &Entry::first);
  std::vector<scene::Bounds> bounds;
  bounds.reserve(changed.size());
  for (const auto &[fingerprint, caster] : changed) {
    bounds.push_back(caster->bounds_ws);
  }
  return bounds;
}

float distance_to(const scene::Bounds &box, const glm::vec3 &position_ws)
{
  return glm::distance(position_ws, glm::clamp(position_ws, box.min, box.max));
}

/** Distance from \a p to a triangle: to its plane if \a p projects into the triangle, otherwise to its edges. */
static double distance_to_triangle(const glm::dvec3 &p, const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c)
{
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const auto is_inside = [&](const glm::dvec3 &from, const glm::dvec3 &to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= 0.0;
  };
  const double area_sq = glm::dot(normal, normal);
  if (area_sq > 0.0 && is_inside(a, b) && is_inside(b, c) && is_inside(c, a)) {
    return std::abs(glm::dot(p - a, normal)) / std::sqrt(area_sq);
  }
  const auto to_edge = [&](const glm::dvec3 &from, const glm::dvec3 &to) {
    const glm::dvec3 edge = to - from;
    const double length_sq = glm::dot(edge, edge);
    const double along = length_sq > 0.0 ? std::clamp(glm::dot(p - from, edge) / length_sq, 0.0, 1.0) : 0.0;
    return glm::distance(p, from + along * edge);
  };
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

float distance_to(const Caster &caster, const glm::vec3 &position_ws)
{
  const float to_box = distance_to(caster.bounds_ws, position_ws);
  if (to_box > 0.0F || !caster.mesh) {
    return to_box;
  }
  const scene::Mesh &mesh = *caster.mesh;
  const glm::dmat4 world_from_object(*caster.world_from_object);
  const auto corner = [&](std::size_t i) {
    return glm::dvec3(world_from_object * glm::dvec4(mesh.positions[mesh.indices[i]], 1.0));
  };
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    nearest = std::min(nearest, distance_to_triangle(glm::dvec3(position_ws), corner(i), corner(i + 1), corner(i + 2)));
  }
  return float(nearest);
}

float CasterDistances::distance(const Caster &caster, const glm::vec3 &position_ws)
{
  const float to_box = distance_to(caster.bounds_ws, position_ws);
  if (to_box > 0.0F || !caster.mesh) {
    return to_box;
  }
  const auto [found, is_new] = distances_.try_emplace({std::bit_cast<Position>(position_ws), caster.fingerprint});
  if (is_new) {
    found->second = distance_to(caster, position_ws);
    triangles_visited_ += caster.mesh->indices.size() / 3;
  }
  return found->second;
}

void CasterDistances::keep_only(std::span<const glm::vec3> positions_ws, const std::vector<Caster> &casters)
{
  if (distances_.empty()) {
    return;
  }
  std::vector<Position> positions;
  for (const glm::vec3 &position : positions_ws) {
    positions.push_back(std::bit_cast<Position>(position));
  }
  std::vector<std::uint64_t> fingerprints;
  for (const Caster &caster : casters) {
    fingerprints.push_back(caster.fingerprint);
  }
  std::ranges::sort(positions);
  std::ranges::sort(fingerprints);
  std::erase_if(distances_, [&](const auto &entry) {
    return !std::ranges::binary_search(positions, entry.first.first) ||
           !std::ranges::binary_search(fingerprints, entry.first.second);
  });
}

float lamp_near(const glm::vec3 &position_ws, float range, const std::vector<Caster> &casters,
                CasterDistances *distances)
{
  constexpr float near_min = 1e-6F;
  float near = 0.5F * range;
  for (const Caster &caster : casters) {
    const float distance = distances ? distances->distance(caster, position_ws) : distance_to(caster, position_ws);
    // A point at this distance may be nearer along a face's axis, by a factor of up to the square root of 3.
    near = std::min(near, std::max(0.5F * distance, 1e-4F * caster.bounds_ws.radius()));
  }
  near = std::isinf(near) ? near_min : std::max(near, near_min);
  return std::exp2(0.0625F * std::floor(16.0F * std::log2(near)));
}

void ShadowCasters::begin()
{
  if (std::exchange(is_finished_, false)) {
    // Both lists keep their memory.
    std::swap(before_, casters_);
  }
  casters_.clear();
  volumes_.clear();
  calls_.clear();
  blended_.clear();
  changed_.clear();
}

void ShadowCasters::finish()
{
  is_finished_ = true;
  bounds_ws_ = {};
  volumes_.clear();
  volumes_.reserve(casters_.size());
  calls_.clear();
  blended_.clear();
  for (std::size_t i = 0; i < casters_.size(); i++) {
    const Caster &caster = casters_[i];
    if (caster.is_blended) {
      blended_.push_back(i);
    }
    bounds_ws_.extend(caster.bounds_ws);
    volumes_.add({caster.bounds_ws.center(), caster.bounds_ws.radius()});
    // Most casters follow others of their mesh.
    if (calls_.empty() || calls_.back() != caster.instances) {
      calls_.push_back(caster.instances);
    }
  }
  std::ranges::sort(calls_);
  calls_.erase(std::unique(calls_.begin(), calls_.end()), calls_.end());
  changed_ = changed_bounds(before_, casters_);
  before_.clear();
}

void ShadowCasters::forget_meshes()
{
  for (Caster &caster : casters_) {
    caster.mesh = nullptr;
    caster.world_from_object = nullptr;
  }
}

}  // namespace gnomon::eevee
