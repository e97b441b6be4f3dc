// SPDX-License-Identifier: MIT
#include "shadow_octahedral.hh"

#include "shadow_cube.hh"

#include "eevee_octahedral_shared.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::eevee {

float esm_range(const ShadowLamp &lamp, const scene::Bounds &bounds_ws)
{
  const float reach = 1.01F * glm::length(reach_from(lamp.position_ws(), bounds_ws));
  const float stepped = std::exp2(0.25F * std::ceil(4.0F * std::log2(std::clamp(reach, 1e-6F, 1e30F))));
  return std::clamp(std::min(stepped, lamp.shadow_range()), 1e-6F, 1e30F);
}

EsmLamp esm_lamp(const ShadowLamp &lamp, const ShadowPlace &place, const scene::Bounds &bounds_ws,
                 const ShadowSettings &settings)
{
  const scene::LampShadow &asked = lamp.shadow;
  EsmLamp result{.name = lamp.name, .range = esm_range(lamp, bounds_ws), .settings = settings.esm, .key = lamp.key};
  result.settings.method = place.kind == scene::ShadowKind::Evsm ? EsmMethod::Evsm : EsmMethod::Esm;
  result.settings.exponent = asked.exponent ? asked.exponent : settings.esm.exponent;
  result.settings.bias = asked.bias.value_or(settings.esm.bias);
  result.settings.filter_angle = asked.filter_angle ? asked.filter_angle : settings.esm.filter_angle;
  result.settings.size_px = place.given.octahedral_px;
  if (asked.esm_format) {
    result.settings.format = asked.esm_format;
  }
  return result;
}

namespace {

class OctahedralTechnique final : public ShadowTechnique {
 public:
  bool serves(const ShadowLamp &lamp, scene::ShadowKind kind) const override
  {
    const bool is_exponential = kind == scene::ShadowKind::Esm || kind == scene::ShadowKind::Evsm;
    return is_exponential && lamp.kind != scene::LampKind::Sun;
  }

  int light_shadow_kind() const override
  {
    return SHADOW_ESM;
  }

  Feature features(scene::ShadowKind kind) const override
  {
    return Feature::ShadowEsm | (kind == scene::ShadowKind::Evsm ? Feature::ShadowEvsm : Feature::None);
  }

  ShadowRequest request(const ShadowLamp &lamp, scene::ShadowKind kind, const ShadowSettings &settings) const override
  {
    const int octahedral_px = lamp.shadow.esm_size.value_or(settings.esm.size_px);
    return {.array = ShadowArrayId::DistanceCube,
            .layer_count_max = 6,
            .size_px = lamp.shadow.size.value_or(esm_cube_size_px(octahedral_px)),
            .octahedral_px = octahedral_px,
            .octahedral_texel_bytes = int(sizeof(float)) * (kind == scene::ShadowKind::Evsm ? 2 : 1)};
  }

  ShadowTexelKey texel_key(const ShadowLamp &lamp) const override
  {
    return shadow_cube_technique().texel_key(lamp);
  }

  void set_whole_views(ShadowSlot &slot) const override
  {
    shadow_cube_technique().set_whole_views(slot);
  }

  LayerMask changed_layers(LayerMask touched) const override
  {
    // A change makes all faces necessary, because the shared cube no longer holds the depths of this lamp.
    return touched == 0 ? 0U : ~0U;
  }

  LayerMask layers_needed(const ShadowSlot &slot, const VisibleRange & /*visible*/) const override
  {
    // The filter reads across the edges of faces, so that every face is needed.
    return slot.all_layers();
  }

  void write_block(const ShadowSlot & /*slot*/, shared::ShadowBlock & /*block*/) const override
  {
    // The octahedral store writes its own block, `esm_block`.
  }

  bool has_divisible_layers() const override
  {
    // All faces and the filter must follow each other without those of another lamp.
    return false;
  }

  void record(ShadowSlot &slot, const LayerPart &part, const ShadowRecording &recording) const override
  {
    const LayerMask drawn = record_depths(slot, part, false, recording);
    const int size_px = slot.place.given.size_px;
    recording.octahedral.record(recording.list, std::size_t(slot.place.entry),
                                {.texture = recording.array.texture(),
                                 .first_layer = slot.place.first_layer,
                                 .near = slot.near,
                                 .face_mask = drawn,
                                 .uv_scale = shared::cube_uv_scale(float(size_px)),
                                 .size_px = size_px});
  }

  double texel_size(const ShadowSlot &slot, const ShadowInspection &inspection,
                    const glm::dvec3 &position_ws) const override
  {
    const glm::dvec3 from_light = position_ws - glm::dvec3(slot.lamp.position_ws());
    const int size_px = inspection.octahedral.data(std::size_t(slot.place.entry)).size;
    return glm::length(from_light) *
           double(shared::octahedral_texel_angle(glm::vec3(glm::normalize(from_light)), size_px));
  }

  ShadowLayers layers(const ShadowSlot &slot, const ShadowInspection &inspection) const override
  {
    const auto index = std::size_t(slot.place.entry);
    const shared::EsmData &data = inspection.octahedral.data(index);
    ShadowLayers layers = depth_layers(slot, inspection);
    layers.count = 1;
    layers.texture = &inspection.octahedral.texture(index);
    layers.first_layer = data.layer;
    layers.size_px = data.size;
    layers.border = ESM_BORDER;
    layers.drawn = 1;
    layers.esm_format = data.format;
    layers.near_far = {{0.0F, data.range}};
    const glm::vec3 reach = reach_from(slot.lamp.position_ws(), inspection.caster_bounds_ws);
    layers.shown.y = std::min(glm::length(reach), slot.lamp.shadow_range());
    return layers;
  }
};

}  // namespace

const ShadowTechnique &shadow_octahedral_technique()
{
  static const OctahedralTechnique technique;
  return technique;
}

}  // namespace gnomon::eevee
