// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_caster_tree.hh"

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
   * Trace the rays that changed casters can have changed, and add up the world's light over the others.
   * \pre the scene has a world
   */
  void update(const render_scene::RenderScene &scene);
  /** Write the probes to the members of \a block that have them. */
  void write(shared::WorldBlock &block) const;
  /**
   * Directions of the rest of \a world, that of the last update(). Those from which more light arrives at the probes
   * are more frequent. \pre the rest is not black
   */
  [[nodiscard]] WorldDirections directions(const std::shared_ptr<const render_scene::WorldLight> &world) const;
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
  void add_up(const render_scene::WorldLight &world);
  [[nodiscard]] glm::ivec3 place_of(std::size_t probe) const;

  CasterTree casters_;
  scene::Bounds bounds_ws_;
  glm::ivec3 count_{0};
  /** Position of the first probe, and the distances between probes along the axes, metres. */
  glm::vec3 first_ws_{0.0F};
  glm::vec3 step_{1.0F};
  /** By probe and ray. */
  std::vector<RayHit> hits_;
  std::vector<Probe> probes_;
  glm::vec3 whole_positive_{0.0F};
  glm::vec3 whole_negative_{0.0F};
  std::uint64_t rays_traced_ = 0;
};

}  // namespace gnomon::eevee
