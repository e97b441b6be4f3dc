// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_lamps.hh"

#include "gpu_device.hh"
#include "render_scene.hh"

/** Light from the scene's world, and the world as a background. \see render_world.hh */
namespace gnomon::eevee {

struct Settings;

/** Directions of a world's rest in each sample of a picture that has several. */
inline constexpr int world_direction_count = 4;
/** Directions that a lobe must hold, over all samples, for its sum over them to be smooth. */
inline constexpr double world_lobe_directions = 12.0;

/**
 * The lamps that light a scene with \a world, which no node has. Whole: its suns. Point: its suns and
 * `world_direction_count` directions of the rest, each of which a sample turns to a place of its own.
 */
[[nodiscard]] std::vector<scene::PlacedLamp> world_lamps(const render_scene::WorldLight &world, LampShading shading);

/** \a lamps are lit by a world; those whose index is \a first or more are directions of it. */
void mark_world(Lamps &lamps, std::size_t first);

/** \a features as programs have them: fewer variants where a world shines. */
[[nodiscard]] Feature with_world(Feature features);

/** What shaders read of a world. */
struct WorldResources {
  gpu::Buffer block;
  /** Where a specular surface mirrors it. */
  gpu::Texture levels;
  gpu::Sampler sampler;
  /** RenderScene::world_revision that both are of. */
  std::uint64_t revision = 0;
  int sample_count = 0;
  /** What the background shows, rows from the bottom. */
  gpu::Texture picture;
  gpu::Sampler picture_sampler;
  /** Scene::world_revision that it is of. */
  std::uint64_t picture_revision = 0;
};

/**
 * Make what \a features need of the scene's world, and free the rest. \a sample_count: of a picture.
 * \pre the scene has a world where \a features have World
 */
void update_world(WorldResources &resources, gpu::Device &device, const render_scene::RenderScene &scene,
                  Feature features, int sample_count);

/** Whether anything is drawn where there is no surface. */
[[nodiscard]] bool has_background(const Settings &settings, const render_scene::RenderScene &scene);
/** Its radiance, or a factor of the world's picture. \pre there is a background */
[[nodiscard]] glm::vec3 background_color(const Settings &settings, const render_scene::RenderScene &scene);
/** Make the picture that the background shows, and free one that it does not. */
void update_world_picture(WorldResources &resources, gpu::Device &device, const render_scene::RenderScene &scene,
                          const Settings &settings);

}  // namespace gnomon::eevee
