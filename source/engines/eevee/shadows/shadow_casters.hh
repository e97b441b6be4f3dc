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
  /** The call of the mesh in the pass that draws casters. It must live as long as that pass. */
  draw::InstanceCall *instances = nullptr;
  /** Hash of everything that the shadow depends on. A shadow with the same fingerprint has the same texels. */
  std::uint64_t fingerprint = 0;
  /**
   * Mesh for the distance to lamps that are inside the bounds. Both must live until SceneShadows::finish, which
   * forgets them. nullptr: the distance of these lamps is 0.
   */
  const scene::Mesh *mesh = nullptr;
  const glm::mat4 *world_from_object = nullptr;
  /** It lets a part of the light through: each sample of a picture has another shadow of it. */
  bool is_blended = false;
};

/** Hash of \a bytes, for Caster::fingerprint. */
[[nodiscard]] std::uint64_t fingerprint_of(std::span<const std::byte> bytes);

/**
 * Bounds of the casters whose fingerprint is in only one of the lists: the regions in which shadows change. A caster
 * that moved contributes its old bounds and its new bounds.
 */
[[nodiscard]] std::vector<scene::Bounds> changed_bounds(const std::vector<Caster> &before,
                                                        const std::vector<Caster> &after);

/** Distance from \a position_ws to the nearest point of \a box, metres; 0 inside. */
[[nodiscard]] float distance_to(const scene::Bounds &box, const glm::vec3 &position_ws);

/** Distance from \a position_ws to the caster's bounds, metres; inside the bounds, to the nearest triangle. */
[[nodiscard]] float distance_to(const Caster &caster, const glm::vec3 &position_ws);

/**
 * Cache of distances from lamps to the triangles of casters. The key is the position of the lamp and the fingerprint of
 * the caster. Without the cache, each sync would visit all triangles of each caster whose bounds contain a lamp.
 */
class CasterDistances {
 public:
  /** \see distance_to */
  float distance(const Caster &caster, const glm::vec3 &position_ws);
  /** Remove all distances except those from \a positions_ws to \a casters. */
  void keep_only(std::span<const glm::vec3> positions_ws, const std::vector<Caster> &casters);
  /** Number of triangles whose distance was computed, since the start. */
  [[nodiscard]] std::uint64_t triangles_visited() const
  {
    return triangles_visited_;
  }

 private:
  /** Bits of a position. They have a total order for all values, including NaN. */
  using Position = std::array<std::uint32_t, 3>;
  /** Distances in metres. */
  std::map<std::pair<Position, std::uint64_t>, float> distances_;
  std::uint64_t triangles_visited_ = 0;
};

/**
 * Distance of a lamp's near plane, metres. It is chosen as large as possible, because the error of depths grows with
 * distance² / near: half the distance to the nearest caster, but at least 1e-4 of the radius of that caster's bounds,
 * for lamps on the surface of a caster. Casters in front of the near plane are clamped to it and still cast shadows.
 * The result is rounded down to a sixteenth of a power of 2, so that small moves of casters do not change it.
 *
 * \a range: the range of the lamp, metres; casters beyond it have no effect. \a distances: optional cache.
 */
[[nodiscard]] float lamp_near(const glm::vec3 &position_ws, float range, const std::vector<Caster> &casters,
                              CasterDistances *distances = nullptr);

/** The casters of one sync, and their difference from those of the last sync. */
class ShadowCasters {
 public:
  /** Start the next list. If the last list was not finished, the difference refers to the last finished list. */
  void begin();
  void add(const Caster &caster)
  {
    casters_.push_back(caster);
  }
  /** Call after the last caster. */
  void finish();
  /** Forget Caster::mesh and Caster::world_from_object of all casters, which others may change or remove. */
  void forget_meshes();

  [[nodiscard]] const std::vector<Caster> &list() const
  {
    return casters_;
  }
  /** Bounds of all casters. Empty without casters. */
  [[nodiscard]] const scene::Bounds &bounds_ws() const
  {
    return bounds_ws_;
  }
  /** Bounding spheres, in the order of list(). */
  [[nodiscard]] const draw::CullingArrays &volumes() const
  {
    return volumes_;
  }
  /** The calls of the casters, without duplicates. */
  [[nodiscard]] const std::vector<draw::InstanceCall *> &calls() const
  {
    return calls_;
  }
  /** Indices in list() of those that are blended. */
  [[nodiscard]] const std::vector<std::size_t> &blended() const
  {
    return blended_;
  }
  /** Result of changed_bounds for the last list and this list. */
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
  /** finish was called since begin. */
  bool is_finished_ = false;
  scene::Bounds bounds_ws_;
  draw::CullingArrays volumes_;
  std::vector<draw::InstanceCall *> calls_;
  std::vector<std::size_t> blended_;
  std::vector<scene::Bounds> changed_;
  CasterDistances distances_;
};

/**
 * The faces of a cube that a box touches: bit i for face i. Conservative: the mask may contain additional faces.
 *
 * \a bounds: relative to the lamp, metres. \a half_size: half the edge of a face at distance 1, at least 1.
 */
[[nodiscard]] inline std::uint32_t cube_face_mask(const scene::Bounds &bounds, float half_size)
{
  // The pyramid of a face contains the points with h · a >= |b| and h · a >= |c|, where a is the coordinate along the
  // face's axis. The test uses the largest a, and the smallest |b| and |c| of the box.
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
