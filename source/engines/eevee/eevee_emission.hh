// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_lamps.hh"

#include "render_scene.hh"
#include "scene_emission.hh"

#include <memory>
#include <optional>
#include <vector>

/** Light that emissive surfaces give to others in pictures of several samples: decision 0029. */
namespace gnomon::eevee {

/** The emissive surfaces of a scene, relative to RenderScene::origin_ws. */
class SceneEmission {
 public:
  /** Follow \a scene. \a is_used: false frees the surfaces. Keeps them while nothing that emits light has changed. */
  void update(const render_scene::RenderScene &scene, bool is_used);
  /** nullptr if they are not used, or there are none. */
  [[nodiscard]] const std::shared_ptr<const scene::EmissiveSurfaces> &surfaces() const
  {
    return surfaces_;
  }
  /** Increased when the surfaces change. */
  [[nodiscard]] std::uint64_t revision() const
  {
    return revision_;
  }

 private:
  struct Key {
    scene::EmissionState state;
    glm::dvec3 origin_ws{0.0};

    bool operator==(const Key &) const = default;
  };
  /** Empty: not used. */
  std::optional<Key> seen_;
  /** Scene::revision of the last update. */
  scene::Revision seen_edit_ = 0;
  std::shared_ptr<const scene::EmissiveSurfaces> surfaces_;
  std::uint64_t revision_ = 0;
};

/**
 * \a count lamps without a node. LampPoints moves each to a point of the emissive surfaces in each sample.
 * \a bounds_ws: of the scene.
 */
[[nodiscard]] std::vector<scene::PlacedLamp> emission_lamps(int count, const scene::Bounds &bounds_ws);

/**
 * Points of emissive surfaces in one sample, for each that has a shadow. With fewer, the places of the points show;
 * more change little: decision 0029.
 */
inline constexpr int points_per_shadow = 8;

/**
 * \a count lamps for the further points of a picture of one sample, which have no shadow. \a first: number of the
 * emission_lamps.
 */
[[nodiscard]] std::vector<scene::PlacedLamp> further_emission_lamps(int first, int count);

}  // namespace gnomon::eevee
