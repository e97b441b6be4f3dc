// SPDX-License-Identifier: MIT
#pragma once

#include "draw_pass.hh"
#include "scene.hh"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace gnomon::eevee {

/** An object that casts shadows. */
struct Caster {
  scene::Bounds bounds_ws;
  draw::ObjectIndex object = draw::object_identity;
  /** The call of its mesh in the pass that draws casters; lives as long as that pass. */
  draw::InstanceCall *instances = nullptr;
  /** Of everything that its shadow depends on: a different number means a different shadow. */
  std::uint64_t fingerprint = 0;
  /** Read where a lamp is inside of the box, until ShadowCasters::finish returns. nullptr: only the box is known. */
  const scene::Mesh *mesh = nullptr;
  const glm::mat4 *world_from_object = nullptr;
};

/** Hash of plain numbers, for Caster::fingerprint. */
[[nodiscard]] std::uint64_t fingerprint_of(std::span<const std::byte> bytes);

/**
 * Boxes of the casters that are in only one of the lists, by fingerprint: where shadows change. A caster that moved
 * gives its old box and its new one.
 */
[[nodiscard]] std::vector<scene::Bounds> changed_bounds(const std::vector<Caster> &before,
                                                        const std::vector<Caster> &after);

/** Distance of the nearest point of a box, metres; 0 inside. */
[[nodiscard]] float distance_to(const scene::Bounds &box, const glm::vec3 &position_ws);

/** Distance of the nearest point of a caster, metres: of its box, or, from inside the box, of its triangles. */
[[nodiscard]] float distance_to(const Caster &caster, const glm::vec3 &position_ws);

/**
 * Distances from lamps to the triangles of casters, kept while the lamp's position and the caster's fingerprint stay.
 * Without it each sync would visit every triangle of each caster that surrounds a lamp.
 */
class CasterDistances {
 public:
  /** \see distance_to */
  float distance(const Caster &caster, const glm::vec3 &position_ws);
  /** Forget the distances from other positions and those of other casters. */
  void keep_only(std::span<const glm::vec3> positions_ws, const std::vector<Caster> &casters);
  /** Triangles whose distance was computed, since the start. */
  [[nodiscard]] std::uint64_t triangles_visited() const
  {
    return triangles_visited_;
  }

 private:
  /** Bits of a position, so that keys are ordered for every number. */
  using Position = std::array<std::uint32_t, 3>;
  /** Metres, by the lamp's position and the caster's fingerprint. */
  std::map<std::pair<Position, std::uint64_t>, float> distances_;
  std::uint64_t triangles_visited_ = 0;
};

/**
 * Distance of a lamp's near plane, metres, for the best precision: the error of depths grows with the square of
 * distance over near. It is as large as the nearest caster permits; where the lamp is on a caster, a small part of that
 * caster's size. What is nearer is drawn on the near plane and still casts.
 *
 * \a range: casters beyond it are ignored, metres.
 */
[[nodiscard]] float lamp_near(const glm::vec3 &position_ws, float range, const std::vector<Caster> &casters,
                              CasterDistances *distances = nullptr);

/** The casters of one sync and how they differ from those of the last sync. */
class ShadowCasters {
 public:
  /** Start the next list. After a sync that failed, the difference is to the last complete list. */
  void begin();
  void add(const Caster &caster)
  {
    casters_.push_back(caster);
  }
  /** After the last caster. */
  void finish();

  [[nodiscard]] const std::vector<Caster> &list() const
  {
    return casters_;
  }
  /** Around all casters. Empty without casters. */
  [[nodiscard]] const scene::Bounds &bounds_ws() const
  {
    return bounds_ws_;
  }
  /** A sphere around each caster. */
  [[nodiscard]] const std::vector<draw::CullingVolume> &volumes() const
  {
    return volumes_;
  }
  /** The calls of the casters, each once. */
  [[nodiscard]] const std::vector<draw::InstanceCall *> &calls() const
  {
    return calls_;
  }
  /** \see changed_bounds */
  [[nodiscard]] const std::vector<scene::Bounds> &changed() const
  {
    return changed_;
  }
  [[nodiscard]] CasterDistances &distances()
  {
    return distances_;
  }
  [[nodiscard]] const CasterDistances &distances() const
  {
    return distances_;
  }

 private:
  std::vector<Caster> casters_;
  std::vector<Caster> before_;
  /** casters_ is complete: finish was called since begin. */
  bool is_finished_ = false;
  scene::Bounds bounds_ws_;
  std::vector<draw::CullingVolume> volumes_;
  std::vector<draw::InstanceCall *> calls_;
  std::vector<scene::Bounds> changed_;
  CasterDistances distances_;
};

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
