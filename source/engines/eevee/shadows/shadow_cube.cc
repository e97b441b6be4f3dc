// SPDX-License-Identifier: MIT
#include "shadow_cube.hh"

#include "shadow_spot.hh"

#include <glm/geometric.hpp>
#include <glm/packing.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gnomon::eevee {

// The matrices are given by columns. Each comment gives the world axes to the right, up and backwards in the face's
// view.
const std::array<glm::mat4, 6> cubefacemat = {
    glm::mat4({0, 0, -1, 0}, {0, -1, 0, 0}, {-1, 0, 0, 0}, {0, 0, 0, 1}),  // +X: -z, -y, -x
    glm::mat4({0, 0, 1, 0}, {0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 1}),    // -X: z, -y, x
    glm::mat4({1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}),    // +Y: x, z, -y
    glm::mat4({1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {0, 0, 0, 1}),    // -Y: x, -z, y
    glm::mat4({1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, 1}),   // +Z: x, -y, -z
    glm::mat4({-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}),   // -Z: -x, -y, z
};

std::array<draw::View, 6> shadow_cube_views(const glm::vec3 &position_ws, float near, int size_px)
{
  const float half_size = 1.0F / shared::cube_uv_scale(float(size_px));
  const glm::mat4 clip_from_face =
      draw::perspective(half_size, half_size, near, std::numeric_limits<float>::infinity());
  glm::mat4 lamp_from_world(1.0F);
  lamp_from_world[3] = glm::vec4(-position_ws, 1.0F);
  std::array<draw::View, 6> views;
  for (std::size_t face = 0; face < 6; face++) {
    views[face] = draw::View(cubefacemat[face] * lamp_from_world, clip_from_face);
  }
  return views;
}

bool has_cube(scene::LampKind kind, float spot_outer_angle)
{
  const bool is_wide = kind == scene::LampKind::Spot && spot_outer_angle > spot_map_angle_max;
  return kind == scene::LampKind::Point || kind == scene::LampKind::Area || is_wide;
}

namespace {

/** Whether \a face contains a direction in the emitting half-space of an area lamp. */
bool reaches_ahead(const ShadowLamp &lamp, std::size_t face)
{
  const glm::vec3 forward_ws = -glm::vec3(lamp.world_from_lamp[2]);
  const int axis = int(face / 2);
  const float along = face % 2 == 0 ? forward_ws[axis] : -forward_ws[axis];
  const float across = std::abs(forward_ws[(axis + 1) % 3]) + std::abs(forward_ws[(axis + 2) % 3]);
  // The test uses the corner of the face that is farthest along the lamp's axis. It is conservative.
  return along + across > -1e-5F;
}

class CubeTechnique final : public ShadowTechnique {
 public:
  bool serves(const ShadowLamp &lamp, scene::ShadowKind kind) const override
  {
    const bool is_depth = kind == scene::ShadowKind::Hard || kind == scene::ShadowKind::Pcf;
    return is_depth && has_cube(lamp.kind, lamp.spot_outer_angle);
  }

  int light_shadow_kind() const override
  {
    return SHADOW_CUBE;
  }

  Feature features(scene::ShadowKind kind) const override
  {
    return Feature::ShadowCube | (kind == scene::ShadowKind::Pcf ? Feature::ShadowPcf : Feature::None);
  }

  ShadowRequest request(const ShadowLamp &lamp, scene::ShadowKind /*kind*/,
                        const ShadowSettings &settings) const override
  {
    return {.array = ShadowArrayId::Cubes,
            .layer_count_max = 6,
            .size_px = lamp.shadow.size.value_or(settings.cube_size_px)};
  }

  ShadowTexelKey texel_key(const ShadowLamp &lamp) const override
  {
    ShadowTexelKey key{.range = lamp.shadow_range(), .clip_start = lamp.shadow.clip_start};
    // The faces are aligned with the world axes, so that only the position of the lamp matters.
    key.world_from_lamp[3] = lamp.world_from_lamp[3];
    return key;
  }

  void set_whole_views(ShadowSlot &slot) const override
  {
    const auto views = shadow_cube_views(slot.lamp.position_ws(), slot.near, slot.size_px);
    slot.whole_views.assign(views.begin(), views.end());
  }

  double inner_share(const ShadowSlot &slot) const override
  {
    // Lookups for the penumbra of a whole lamp reach beyond the receivers.
    return slot.lamp.extent > 0.0F && !slot.lamp.is_sampled ? 0.0 : double(shared::cube_uv_scale(float(slot.size_px)));
  }

  /** Conservative: the faces that have, for each of their four side planes, a visible corner on the inner side. */
  LayerMask layers_needed(const ShadowSlot &slot, const VisibleRange &visible) const override
  {
    const glm::dvec3 position_ws(slot.lamp.position_ws());
    // For each face, bit i: at least one corner is on the inner side of the i-th plane.
    std::array<std::uint32_t, 6> within{};
    for (const glm::dvec3 &corner : visible.corners) {
      const glm::dvec3 v = corner - position_ws;
      // Lookups of a lamp that is shaded as a whole are offset from the receiver by up to 15 half axes: search radius
      // in eevee_penumbra_lib.glsl. The difference of two components changes by √2 times the offset.
      const double offset = slot.lamp.extent * std::min(glm::length(v) / slot.near, 15.0);
      const double slack = 1e-5 * (std::abs(v.x) + std::abs(v.y) + std::abs(v.z)) + std::numbers::sqrt2 * offset;
      for (std::size_t face = 0; face < 6; face++) {
        const std::size_t axis = face / 2;
        const double along = (face % 2 == 0 ? v[int(axis)] : -v[int(axis)]) + slack;
        const double a = v[int((axis + 1) % 3)];
        const double b = v[int((axis + 2) % 3)];
        within[face] |=
            (along >= a ? 1U : 0U) | (along >= -a ? 2U : 0U) | (along >= b ? 4U : 0U) | (along >= -b ? 8U : 0U);
      }
    }
    LayerMask faces = 0;
    for (std::size_t face = 0; face < 6; face++) {
      const bool is_lit = slot.lamp.kind != scene::LampKind::Area || reaches_ahead(slot.lamp, face);
      faces |= is_lit && within[face] == 15U ? 1U << face : 0U;
    }
    return faces;
  }

  void write_block(const ShadowSlot &slot, shared::ShadowBlock &block) const override
  {
    const int size_px = slot.size_px;
    shared::ShadowCubeData &data = block.cubes[slot.place.entry];
    data.near = slot.near;
    data.far = slot.lamp.shadow.clip_end.value_or(shadow_far_none);
    const glm::vec2 extent = extent_of(slot.crop);
    data.texel_size = 2.0F * std::max(extent.x, extent.y) / (float(size_px) * shared::cube_uv_scale(float(size_px)));
    data.bias = slot.lamp.shadow.bias.value_or(1.0F);
    int steps = 0;
    for (int face = 0; face < 6; face++) {
      steps |= (slot.placed >> face & 1U) != 0 ? slot.index_of(face) << 3 * face : 0;
    }
    data.layers = shared::cube_layers(slot.place.first_layer, steps);
    const int filter = slot.place.kind == scene::ShadowKind::Pcf ? SHADOW_FILTER_PCF : SHADOW_FILTER_HARD;
    data.faces_and_filter = int(slot.drawn | slot.recorded_drawn) | filter << SHADOW_CUBE_FACE_BITS;
    data.crop = glm::packUnorm4x8(glm::vec4(slot.crop) / 255.0F);
    data.size_px = size_px;
  }

  void record(ShadowSlot &slot, const LayerPart &part, const ShadowRecording &recording) const override
  {
    // Faces without a caster are not cleared, because lookups skip them. \see ShadowCubeData::faces_and_filter
    record_depths(slot, part, false, recording);
  }

  double texel_size(const ShadowSlot &slot, const ShadowInspection &inspection,
                    const glm::dvec3 &position_ws) const override
  {
    const glm::dvec3 size = glm::abs(position_ws - glm::dvec3(slot.lamp.position_ws()));
    return double(inspection.block.cubes[slot.place.entry].texel_size) * std::max({size.x, size.y, size.z});
  }

  ShadowLayers layers(const ShadowSlot &slot, const ShadowInspection &inspection) const override
  {
    ShadowLayers layers = depth_layers(slot, inspection);
    layers.is_cube = true;
    return layers;
  }
};

}  // namespace

const ShadowTechnique &shadow_cube_technique()
{
  static const CubeTechnique technique;
  return technique;
}

}  // namespace gnomon::eevee
