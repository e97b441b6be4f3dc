// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_world.hh"

#include "draw_pass.hh"
#include "eevee_world_shared.h"

#include <memory>
#include <optional>

namespace gnomon::eevee {

struct ResourceReport;
class WorldOcclusion;

/** The scene's world on the device. Internal to the engine. */
class SceneWorld {
 public:
  SceneWorld();
  SceneWorld(const SceneWorld &) = delete;
  SceneWorld &operator=(const SceneWorld &) = delete;
  ~SceneWorld();

  /**
   * Trace the light that arrives in the scene, if an input changed: in pictures of one sample it is drawn, and in
   * others it chooses the directions of the world. Creates no resources on the device.
   */
  void sync_occlusion(const render_scene::RenderScene &scene, const Settings &settings);
  /** The directions of the last sync_occlusion. Pictures of one sample have none. */
  [[nodiscard]] const WorldDirections &directions() const
  {
    return directions_;
  }
  /**
   * Create the resources of the world's light that \a features need, and free the others. \a rest: the directions of
   * the samples. \pre with Feature::World, the scene has a world. sync_occlusion was called
   */
  void update_light(const render_scene::RenderScene &scene, Feature features, const Settings &settings,
                    const RestDirections &rest);
  /**
   * Write the light that arrives at the surfaces that \a view sees. Only pictures of one sample have it.
   * \pre update_light
   */
  void follow(const draw::View &view, gpu::Device &device);
  /** Create the picture of the background if it is shown and changed; free it if it is not shown. */
  void update_picture(const render_scene::RenderScene &scene, const Settings &settings);
  /** After a submission was lost: the next update_light writes the block again. */
  void forget()
  {
    is_block_written_ = false;
  }
  void bind(draw::ShadingGroup &group) const;
  /**
   * Write the members of `world_block` that change with each sample. \a points: WORLD_SUN_POINTS of each sun.
   * \a first_sun: index of its light
   */
  void write_suns(std::span<const shared::WorldSunPoint> points, int first_sun, bool is_left_out,
                  gpu::CommandList &list) const;
  void report(ResourceReport &report) const;

  /** The picture of the background, rows from the bottom. Empty if none is shown. */
  [[nodiscard]] const gpu::Texture &picture() const
  {
    return picture_;
  }
  [[nodiscard]] const gpu::Sampler &picture_sampler() const
  {
    return picture_sampler_;
  }

 private:
  void write_block(const render_scene::RenderScene &scene);
  void make_levels(const render_scene::RenderScene &scene);
  /** \a weights: \see mirror_weights */
  void write_level(gpu::Device &device, int level, std::span<const glm::vec3> radiance,
                   std::span<const float> weights) const;

  /** Inputs from which `occlusion_` and `directions_` were made; the revisions of casters are 0 if none are traced. */
  struct OcclusionKey {
    /** Revisions of the world and of the inputs of its casters. */
    std::uint64_t world = 0;
    std::uint64_t objects = 0;
    std::uint64_t passes = 0;
    std::uint64_t content = 0;
    bool is_traced = false;
    bool is_sampled = false;

    bool operator==(const OcclusionKey &) const = default;
  };
  /** Inputs from which `block_` and `levels_` were made. */
  struct Key {
    /** RenderScene::world_revision. */
    std::uint64_t world = 0;
    int sample_count = 0;
    /** The light of the world is left out: `block_` and `levels_` hold black. */
    bool is_black = false;

    bool operator==(const Key &) const = default;
  };
  Key key_;
  std::optional<OcclusionKey> occlusion_key_;
  /** Empty unless pictures have a world and shadows. */
  std::unique_ptr<WorldOcclusion> occlusion_;
  WorldDirections directions_;
  /** `block_` is that of `occlusion_` and `directions_`. */
  bool is_block_written_ = false;
  /** The view whose surfaces `block_` has the occlusion of. */
  std::optional<draw::View> view_;
  /** Empty without Feature::World. */
  gpu::Buffer block_;
  /** Prefiltered levels for specular reflection. Empty without specular materials. */
  gpu::Texture levels_;
  /** The directions whose weights the first level has. */
  RestDirections rest_;
  gpu::Sampler sampler_;
  gpu::Texture picture_;
  gpu::Sampler picture_sampler_;
  /** Scene::world_revision from which `picture_` was made. */
  std::uint64_t picture_revision_ = 0;
};

}  // namespace gnomon::eevee
