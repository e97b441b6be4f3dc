// SPDX-License-Identifier: MIT
#include "eevee_emission.hh"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::eevee {

namespace {

/** Edge of a face of the shadow of a point, texels. Errors of texels average out over the points. */
constexpr int shadow_size_px = 256;
/**
 * Distance from a point up to which nothing blocks its light, fraction of the radius of the scene. The surface around
 * the point is nearer: by rounding it may seem to be on either side, and would block all light there.
 */
constexpr float clear_share = 1e-4F;

}  // namespace

void SceneEmission::update(const render_scene::RenderScene &scene, bool is_used)
{
  const scene::Revision edit = scene.scene().revision();
  if (is_used ? seen_ && seen_edit_ == edit && seen_->origin_ws == scene.origin_ws() : !seen_) {
    return;
  }
  seen_edit_ = edit;
  const std::optional<Key> key =
      is_used ? std::optional(Key{scene::emission_state(scene.scene()), scene.origin_ws()}) : std::nullopt;
  if (seen_ == key) {
    return;
  }
  seen_ = key;
  const bool had_surfaces = surfaces_ != nullptr;
  surfaces_.reset();
  if (key && key->state.object_count > 0) {
    std::vector<scene::Object> objects = scene.scene().objects();
    for (scene::Object &object : objects) {
      object.world_from_object[3] -= glm::dvec4(scene.origin_ws(), 0.0);
    }
    auto surfaces = std::make_shared<const scene::EmissiveSurfaces>(scene.scene(), objects);
    if (!surfaces->empty()) {
      surfaces_ = std::move(surfaces);
    }
  }
  revision_ += had_surfaces || surfaces_ ? 1 : 0;
}

/** \a index: of the point. */
static scene::PlacedLamp emission_lamp(int index)
{
  scene::PlacedLamp lamp;
  lamp.name = fmt::format("emissive surfaces {}", index + 1);
  lamp.kind = scene::LampKind::Point;
  lamp.node.index = emission_node_first + std::uint32_t(index);
  return lamp;
}

std::vector<scene::PlacedLamp> emission_lamps(int count, const scene::Bounds &bounds_ws)
{
  std::vector<scene::PlacedLamp> lamps;
  for (int i = 0; i < count; i++) {
    scene::PlacedLamp &lamp = lamps.emplace_back(emission_lamp(i));
    // Any radius, so that has_extent is true and LampPoints samples the lamp.
    lamp.radius = 1.0F;
    lamp.shadow.kind = scene::ShadowKind::Hard;
    lamp.shadow.size = shadow_size_px;
    lamp.shadow.clip_start = std::max(clear_share * bounds_ws.radius(), 1e-6F);
  }
  return lamps;
}

std::vector<scene::PlacedLamp> further_emission_lamps(int first, int count)
{
  std::vector<scene::PlacedLamp> lamps;
  for (int i = 0; i < count; i++) {
    lamps.emplace_back(emission_lamp(first + i)).shadow.kind = scene::ShadowKind::None;
  }
  return lamps;
}

}  // namespace gnomon::eevee
