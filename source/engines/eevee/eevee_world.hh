// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_lamps.hh"

#include "gpu_device.hh"
#include "render_scene.hh"

/** Light of the scene's world, and the background of a picture. \see render_world.hh */
namespace gnomon::eevee {

struct Settings;

/** Number of directions of WorldLight::rest in each sample of a picture with several samples. */
inline constexpr int world_direction_count = 4;
/** A specular lobe is lit by sampled directions if it contains at least this number of them over all samples. */
inline constexpr double world_lobe_directions = 12.0;

/**
 * Lamps without a node that light a scene with \a world. LampShading::Whole: the suns of the world. LampShading::Point:
 * also `world_direction_count` lamps for WorldLight::rest, to which LampPoints gives a new direction in each sample.
 */
[[nodiscard]] std::vector<scene::PlacedLamp> world_lamps(const render_scene::WorldLight &world, LampShading shading);

/** Resources of a world that shaders read. */
struct WorldResources {
  gpu::Buffer block;
  /** Prefiltered levels for specular reflection. Empty without specular materials. */
  gpu::Texture levels;
  gpu::Sampler sampler;
  /** RenderScene::world_revision from which `block` and `levels` were made. */
  std::uint64_t revision = 0;
  int sample_count = 0;
  /** The light of the world is left out: `block` and `levels` hold black. */
  bool is_black = false;
  /** The picture of the background, rows from the bottom. */
  gpu::Texture picture;
  gpu::Sampler picture_sampler;
  /** Scene::world_revision from which `picture` was made. */
  std::uint64_t picture_revision = 0;
};

/**
 * Create the resources of the scene's world that \a features need, and free the others.
 * \pre with Feature::World, the scene has a world
 */
void update_world(WorldResources &resources, gpu::Device &device, const render_scene::RenderScene &scene,
                  Feature features, const Settings &settings);

/** Whether pixels without a surface show a background. */
[[nodiscard]] bool has_background(const Settings &settings, const render_scene::RenderScene &scene);
/** The radiance of the background, or the factor of the world's picture. \pre has_background */
[[nodiscard]] glm::vec3 background_color(const Settings &settings, const render_scene::RenderScene &scene);
/** Create the picture of the background if it is shown and changed; free it if it is not shown. */
void update_world_picture(WorldResources &resources, gpu::Device &device, const render_scene::RenderScene &scene,
                          const Settings &settings);

}  // namespace gnomon::eevee
