// SPDX-License-Identifier: MIT
#include "shadow_spot.hh"

#include "shadow_cube.hh"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::eevee {

const glm::mat4 texcomat({0.5F, 0, 0, 0}, {0, 0.5F, 0, 0}, {0, 0, 1, 0}, {0.5F, 0.5F, 0, 1});

/** Fraction of a spot's map that is border. */
static float border_share(int size_px)
{
  return std::min(2.0F * float(CUBE_BORDER_TEXELS) / float(size_px), 0.5F);
}

draw::View shadow_spot_view(const glm::mat4 &world_from_lamp, float outer_angle, float near, int size_px)
{
  const float half_size = std::max(std::tan(outer_angle) / (1.0F - border_share(size_px)), 1e-4F);
  const glm::mat4 lamp_from_world(glm::inverse(glm::dmat4(world_from_lamp)));
  return {lamp_from_world, draw::perspective(half_size, half_size, near, std::numeric_limits<float>::infinity())};
}

/**
 * Bound of the error of the depths in layer \a i at w = 1, metres. It grows with w². \a half_step: \see
 * ShadowSlot::depth_half_step
 */
static float depth_error(const ShadowSlot &slot, std::size_t i, float half_step)
{
  const glm::mat4 &projection = slot.views[i].clip_from_view();
  // Reversed depth: near / w for a spot, where w is a distance, and (far - z) / (far - near) for a sun.
  if (slot.views[i].is_perspective()) {
    return (half_step + shared::DEPTH_ROUNDING) / projection[3][2];
  }
  // Depths of clamped casters are rounded before they are clamped.
  return half_step / projection[2][2] + shared::DEPTH_ROUNDING * float(slot.fits[i].caster_length);
}

/** Longer edge of a texel at w = 1, metres. It grows with w. */
static float texel_of(const ShadowSlot &slot, const draw::View &view)
{
  const glm::mat4 &projection = view.clip_from_view();
  return 2.0F / (float(slot.size_px) * std::min(projection[0][0], projection[1][1]));
}

double short_depth_error(const ShadowSlot &slot, const scene::Bounds &bounds_ws)
{
  // A sun's w is 1 everywhere.
  const float reach = glm::length(reach_from(slot.lamp.position_ws(), bounds_ws));
  const float w = slot.lamp.kind == scene::LampKind::Sun ? 1.0F : std::min(reach, slot.lamp.shadow_range());
  double largest = 0.0;
  for (std::size_t i = 0; i < slot.views.size(); i++) {
    const double error = depth_error(slot, i, short_depth_half_step);
    largest = std::max(largest, error * w / texel_of(slot, slot.views[i]));
  }
  return largest;
}

void MapTechnique::write_block(const ShadowSlot &slot, shared::ShadowBlock &block) const
{
  const int size_px = slot.size_px;
  const bool has_layers = (slot.drawn | slot.recorded_drawn) != 0;
  for (std::size_t i = 0; i < slot.views.size(); i++) {
    shared::ShadowMapData &data = block.maps[std::size_t(slot.place.entry) + i];
    const draw::View &view = slot.views[i];
    data.texco_from_world = texcomat * view.clip_from_world();
    data.texel_size = texel_of(slot, view);
    data.rounding = depth_error(slot, i, slot.depth_half_step);
    data.far = view.is_perspective() ? slot.lamp.shadow.clip_end.value_or(shadow_far_none) : shadow_far_none;
    data.bias = slot.lamp.shadow.bias.value_or(1.0F);
    data.layer = slot.place.first_layer + int(i);
    data.cascade_count = has_layers ? int(slot.views.size() - i) : 0;
    data.filter_kind = slot.place.kind == scene::ShadowKind::Pcf ? SHADOW_FILTER_PCF : SHADOW_FILTER_HARD;
    data.size_px = size_px;
  }
  if (slot.views.empty()) {
    // A cascade_count of 0 makes all receivers lit.
    block.maps[slot.place.entry].cascade_count = 0;
  }
}

double MapTechnique::texel_size(const ShadowSlot &slot, const ShadowInspection &inspection,
                                const glm::dvec3 &position_ws) const
{
  const shared::ShadowBlock &block = inspection.block;
  const int first = slot.place.entry;
  for (int i = first; i < first + block.maps[first].cascade_count; i++) {
    const shared::ShadowMapData &map = block.maps[i];
    const glm::dvec4 texco = glm::dmat4(map.texco_from_world) * glm::dvec4(position_ws, 1.0);
    const glm::dvec2 uv = glm::dvec2(texco) / texco.w;
    const bool is_in_depths = map.cascade_count == 1 || (texco.z >= 0.0 && texco.z <= 1.0);
    if (texco.w > 0.0 && is_in_depths && std::min({uv.x, uv.y, 1.0 - uv.x, 1.0 - uv.y}) > 0.0) {
      return double(map.texel_size) * texco.w;
    }
  }
  return 0.0;
}

namespace {

class SpotTechnique final : public MapTechnique {
 public:
  bool serves(const ShadowLamp &lamp, scene::ShadowKind kind) const override
  {
    const bool is_depth = kind == scene::ShadowKind::Hard || kind == scene::ShadowKind::Pcf;
    return is_depth && lamp.kind == scene::LampKind::Spot && !has_cube(lamp.kind, lamp.spot_outer_angle);
  }

  ShadowRequest request(const ShadowLamp &lamp, scene::ShadowKind /*kind*/,
                        const ShadowSettings &settings) const override
  {
    return {
        .array = ShadowArrayId::Maps, .layer_count_max = 1, .size_px = lamp.shadow.size.value_or(settings.map_size_px)};
  }

  ShadowTexelKey texel_key(const ShadowLamp &lamp) const override
  {
    return {lamp.world_from_lamp, lamp.spot_outer_angle, lamp.shadow_range(), lamp.shadow.clip_start};
  }

  void set_whole_views(ShadowSlot &slot) const override
  {
    slot.whole_views.assign(
        1, shadow_spot_view(slot.lamp.world_from_lamp, slot.lamp.spot_outer_angle, slot.near, slot.size_px));
  }

  double inner_share(const ShadowSlot &slot) const override
  {
    return slot.lamp.extent > 0.0F && !slot.lamp.is_sampled ? 0.0 : 1.0 - border_share(slot.size_px);
  }

  /** Conservative: the map is needed unless all visible corners are outside of one of its four side planes. */
  LayerMask layers_needed(const ShadowSlot &slot, const VisibleRange &visible) const override
  {
    const glm::dvec3 position_ws(slot.lamp.position_ws());
    const std::span sides = std::span(slot.views.front().frustum_planes_ws()).first(4);
    const bool is_outside = std::ranges::any_of(sides, [&](const glm::vec4 &side) {
      return std::ranges::all_of(visible.corners, [&](const glm::dvec3 &corner) {
        // The rounding error of the plane grows with the coordinates.
        const double slack = 1e-4 * (glm::length(corner) + glm::length(position_ws));
        return glm::dot(glm::dvec3(side), corner) + double(side.w) < -slack;
      });
    });
    return is_outside ? 0U : 1U;
  }

  void record(ShadowSlot &slot, const LayerPart &part, const ShadowRecording &recording) const override
  {
    // A map without a caster is not cleared, because lookups skip it. \see ShadowMapData::cascade_count
    record_depths(slot, part, false, recording);
  }

  ShadowLayers layers(const ShadowSlot &slot, const ShadowInspection &inspection) const override
  {
    return depth_layers(slot, inspection);
  }
};

}  // namespace

const ShadowTechnique &shadow_spot_technique()
{
  static const SpotTechnique technique;
  return technique;
}

}  // namespace gnomon::eevee
