// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_caster_tree.hh"

#include "eevee_world.hh"
#include "eevee_world_shared.h"
#include "render_world.hh"

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gnomon::eevee {

/**
 * The parts of a world's light that arrive at points of a grid over the scene (probes): for pictures of one sample, and
 * to choose the directions of others. They are traced on the CPU: shadow maps for enough directions would cost more.
 * Internal to the engine.
 */
class WorldOcclusion {
 public:
  /**
   * Trace the rays that changed casters can have changed. \a has_probes: also add up the world's light over those that
   * meet nothing, for write(). \return whether directions() and the probes may be others \pre the scene has a world
   */
  bool update(const render_scene::RenderScene &scene, bool has_probes = true);
  /** Write the probes to the members of \a block that have them. \pre the last update() had probes */
  void write(shared::WorldBlock &block) const;
  /**
   * Directions of the rest of the last update()'s world. Those from which more light arrives at the probes are more
   * frequent. \pre the rest is not black
   */
  [[nodiscard]] WorldDirections directions() const;
  /** Number of probes; 0 if nothing blocks the light. */
  [[nodiscard]] int probe_count() const
  {
    return count_.x * count_.y * count_.z;
  }
  /** Number of rays that were traced, since the start. */
  [[nodiscard]] std::uint64_t rays_traced() const
  {
    return rays_traced_;
  }

 private:
  /** The parts of the irradiance on surfaces that face the positive and the negative axes. */
  struct Probe {
    glm::vec3 positive{1.0F};
    glm::vec3 negative{1.0F};
    /** Less inside of a body, so that it counts only where no other probe does. */
    float weight = 1.0F;
  };
  void place(const scene::Bounds &bounds_ws);
  void trace(std::span<const scene::Bounds> changed);
  /** Set `rays_`. */
  void light_rays();
  void add_up();
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
  /** By probe and ray, as `hits_`. */
  std::vector<Ray> rays_;
  std::vector<RayHit> hits_;
  /** Empty: to be added up. */
  std::vector<Probe> probes_;
  glm::vec3 whole_positive_{0.0F};
  glm::vec3 whole_negative_{0.0F};
  std::uint64_t rays_traced_ = 0;
};

}  // namespace gnomon::eevee
