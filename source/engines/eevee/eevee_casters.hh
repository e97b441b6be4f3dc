// SPDX-License-Identifier: MIT
#pragma once

#include "draw_pass.hh"
#include "scene.hh"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::eevee {

/** Something that throws shadows. */
struct Caster {
  scene::Bounds bounds_ws;
  draw::ObjectIndex object = draw::object_identity;
  /** The call of its mesh in the pass that draws casters; lives as long as that pass. */
  draw::InstanceCall *instances = nullptr;
  /** Of its shape and place: another number, another shadow. */
  std::uint64_t fingerprint = 0;
  /** Read where a lamp is inside of the box, and until Shadows::finish. nullptr: the box is all that is known. */
  const scene::Mesh *mesh = nullptr;
  const glm::mat4 *world_from_object = nullptr;
};

/** Of plain numbers; for Caster::fingerprint. */
[[nodiscard]] std::uint64_t fingerprint_of(std::span<const std::byte> bytes);

/**
 * Boxes of what is in one list and not in the other, by fingerprint: where shadows are no longer what they were. Of a
 * caster that moved, both its old box and its new one.
 */
[[nodiscard]] std::vector<scene::Bounds> changed_bounds(const std::vector<Caster> &before,
                                                        const std::vector<Caster> &after);

/** Distance of the nearest point of a box, metres; 0 inside. */
[[nodiscard]] float distance_to(const scene::Bounds &box, const glm::vec3 &position_ws);

/** Distance of the nearest point of a caster, metres: of its box, or, from inside of that, of its triangles. */
[[nodiscard]] float distance_to(const Caster &caster, const glm::vec3 &position_ws);

/**
 * Distance of the near plane of a lamp, metres, for the best precision: depths lose it with the square of distance /
 * near. As far as the nearest caster allows; where the lamp is on one, a small part of its size. What is nearer is
 * drawn at the near plane, and not lost.
 *
 * \a range: what is farther casts nothing, metres.
 */
[[nodiscard]] float lamp_near(const glm::vec3 &position_ws, float range, const std::vector<Caster> &casters);

/**
 * The faces of a cube that a box touches, bit i for face i; never one too few.
 *
 * \a bounds: from the lamp, metres. \a half_size: of a face at distance 1, at least 1.
 */
[[nodiscard]] inline std::uint32_t cube_face_mask(const scene::Bounds &bounds, float half_size)
{
  // A face's pyramid is where h · a >= |b| and h · a >= |c|: along its axis at its farthest, across at its nearest.
  const glm::vec3 nearest = glm::max(bounds.min, -bounds.max);
  const glm::vec3 farthest = glm::max(bounds.max, -bounds.min);
  const glm::vec3 across(std::max(nearest.y, nearest.z), std::max(nearest.x, nearest.z),
                         std::max(nearest.x, nearest.y));
  const float rounding = 1e-5F * (farthest.x + farthest.y + farthest.z);
  std::uint32_t mask = 0;
  for (int axis = 0; axis < 3; axis++) {
    const float least = std::max(across[axis], 0.0F) - rounding;
    mask |= half_size * bounds.max[axis] >= least ? 1U << (2 * axis) : 0U;
    mask |= half_size * -bounds.min[axis] >= least ? 2U << (2 * axis) : 0U;
  }
  return mask;
}

}  // namespace gnomon::eevee
