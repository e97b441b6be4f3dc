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

}  // namespace gnomon::eevee
