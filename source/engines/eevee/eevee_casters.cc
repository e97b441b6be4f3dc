// SPDX-License-Identifier: MIT
#include "eevee_casters.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace gnomon::eevee {

std::uint64_t fingerprint_of(std::span<const std::byte> bytes)
{
  return std::hash<std::string_view>{}({reinterpret_cast<const char *>(bytes.data()), bytes.size()});
}

std::vector<scene::Bounds> changed_bounds(const std::vector<Caster> &before, const std::vector<Caster> &after)
{
  const auto sorted = [](const std::vector<Caster> &casters) {
    std::vector<const Caster *> pointers;
    pointers.reserve(casters.size());
    for (const Caster &caster : casters) {
      pointers.push_back(&caster);
    }
    std::ranges::sort(pointers, {}, &Caster::fingerprint);
    return pointers;
  };
  std::vector<const Caster *> changed;
  std::ranges::set_symmetric_difference(sorted(before), sorted(after), std::back_inserter(changed), {},
                                        &Caster::fingerprint, &Caster::fingerprint);
  std::vector<scene::Bounds> bounds;
  bounds.reserve(changed.size());
  for (const Caster *caster : changed) {
    bounds.push_back(caster->bounds_ws);
  }
  return bounds;
}

float distance_to(const scene::Bounds &box, const glm::vec3 &position_ws)
{
  return glm::distance(position_ws, glm::clamp(position_ws, box.min, box.max));
}

float lamp_near(const glm::vec3 &position_ws, float range, const std::vector<Caster> &casters)
{
  constexpr float near_min = 1e-6F;
  float nearest = range;
  float smallest_around = std::numeric_limits<float>::max();
  for (const Caster &caster : casters) {
    const float distance = distance_to(caster.bounds_ws, position_ws);
    nearest = std::min(nearest, distance);
    if (distance == 0.0F) {
      smallest_around = std::min(smallest_around, caster.bounds_ws.radius());
    }
  }
  if (std::isinf(nearest)) {
    return near_min;
  }
  // Along a face's axis what is at this distance is nearer, by up to the square root of 3.
  return std::max(nearest > 0.0F ? 0.5F * nearest : 1e-2F * smallest_around, near_min);
}

}  // namespace gnomon::eevee
