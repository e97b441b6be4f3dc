// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_caster_tree.hh"

#include "eevee_world.hh"
#include "eevee_world_shared.h"
#include "render_world.hh"

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace gnomon::eevee {

/**
 * The parts of a world's light that arrive at points (probes): around the surfaces of a view for pictures of one
 * sample, and over the scene to choose the directions of others. They are traced on the CPU: shadow maps for enough
 * directions would cost more. Internal to the engine.
 */
class WorldOcclusion {
 public:
  /**
   * Trace the rays that changed casters can have changed. \a is_sampled: for directions(); otherwise for write().
   * \return whether their results may be others \pre the scene has a world
   */
  bool update(const render_scene::RenderScene &scene, bool is_sampled);
  /**
   * Write the probes around the surfaces that \a view sees to the members of \a block that have them; around all
   * casters if it sees none. Traces probes that are new. \pre the last update() was not for directions()
   */
  void write(const draw::View &view, shared::WorldBlock &block);
  /**
   * Directions of the rest of the last update()'s world. Those from which more light arrives at the probes are more
   * frequent. \pre the rest is not black. The last update() was for directions
   */
  [[nodiscard]] WorldDirections directions() const;
  /** Number of probes of the scene, or of the last write(); 0 if nothing blocks the light. */
  [[nodiscard]] int probe_count() const
  {
    return count_.x * count_.y * count_.z;
  }
  /** Number of rays of probes that were traced, since the start. */
  [[nodiscard]] std::uint64_t rays_traced() const
  {
    return rays_traced_;
  }

 private:
  /** Irradiance on surfaces that face the positive and the negative axes, or parts of it. */
  struct Light {
    glm::vec3 positive{0.0F};
    glm::vec3 negative{0.0F};

    void add(float light, const glm::vec3 &direction)
    {
      positive += light * glm::max(direction, glm::vec3(0.0F));
      negative += light * glm::max(-direction, glm::vec3(0.0F));
    }
  };
  /**
   * The place of a probe of write(): its level, and its place among all points of the level. They do not depend on the
   * view, so that a view that moves keeps most of its probes.
   */
  using Place = std::array<int, 4>;
  struct Probe {
    std::array<RayHit, 256> hits{};
    /** The parts of the world's light that arrive. */
    Light parts;
    /** `hits` and `parts` are up to date. */
    bool is_traced = false;
    bool is_lit = false;
    /** `update_count_` of the last write(). */
    std::uint64_t used = 0;
  };
  /** The probes of a box, by index, and what its surfaces see of them. */
  struct Box;
  void place(const scene::Bounds &bounds_ws);
  void trace(std::span<const scene::Bounds> changed);
  /** Trace the rays of a probe that meet \a changed. \return their number */
  std::uint64_t trace(std::size_t variant, const glm::vec3 &position_ws, std::span<const scene::Bounds> changed,
                      std::size_t nearest_rays, std::span<RayHit> hits) const;
  /** Set `rays_`. */
  void light_rays();
  void add_up(std::size_t variant, Probe &probe) const;
  struct GridLight;
  [[nodiscard]] GridLight grid_light() const;
  [[nodiscard]] std::vector<SurfacePoint> seen_points(const draw::View &view) const;
  /** A box without probes around \a points, or around all casters if there are none. */
  [[nodiscard]] Box box_around(std::span<const SurfacePoint> points) const;
  /** Give a box its probes. Traces those that are new. */
  void fill(Box &box);
  void look(std::span<const SurfacePoint> points, Box &box) const;
  /** The light at a probe of a box, and its weight beside others. */
  struct Weighted {
    Light parts;
    float weight = 0.0F;
  };
  /** Give probes without a weight, which no point sees, light by their neighbours. \a probes: of \a box */
  void spread(const Box &box, std::span<Weighted> probes) const;
  [[nodiscard]] glm::ivec3 place_of(std::size_t probe) const;

  CasterTree casters_;
  scene::Bounds bounds_ws_;
  glm::ivec3 count_{0};
  /** Position of the first probe, and the distances between probes along the axes, metres. */
  glm::vec3 first_ws_{0.0F};
  glm::vec3 step_{1.0F};
  /** The light of the world from the direction of a ray. */
  struct Ray {
    /** Index in the grid of directions(). */
    std::uint16_t cell = 0;
    float luminance = 0.0F;
  };
  /** The world of `rays_`. */
  std::shared_ptr<const render_scene::WorldLight> world_;
  /** Indexed by the variant of the directions and the ray. */
  std::vector<Ray> rays_;
  /** Indexed by the probe of the scene and the ray. The variant of a probe is its index. Empty in pictures of one
   * sample. */
  std::vector<RayHit> hits_;
  /** The last probes of write(). Empty in pictures of several samples. */
  std::map<Place, Probe> probes_;
  /** The light of the whole world, in any unit. */
  Light whole_;
  std::uint64_t rays_traced_ = 0;
  std::uint64_t update_count_ = 0;
};

}  // namespace gnomon::eevee
