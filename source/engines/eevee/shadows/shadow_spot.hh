// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_technique.hh"

namespace gnomon::eevee {

/** The matrix from clip space to texture coordinates. It maps xy from [-1, 1] to [0, 1] and keeps the depth. */
extern const glm::mat4 texcomat;

/**
 * Maximum half opening angle of spots with a planar map, radians. Wider spots have a cube, because the texels of a
 * plane would be stretched too much. In addition, lamp_near gives half the distance to a caster, and beyond 60° the
 * distance along the spot's axis is less than that.
 */
inline constexpr float spot_map_angle_max = 1.04F;

/**
 * The view of a spot's shadow map, with a border for the filter kernel around the cone. \a outer_angle: half the
 * opening angle, radians, at most spot_map_angle_max. \a near: distance of the near plane, metres. \a size_px: edge of
 * the map, texels.
 */
[[nodiscard]] draw::View shadow_spot_view(const glm::mat4 &world_from_lamp, float outer_angle, float near, int size_px);

/** Planar shadow maps of spots up to spot_map_angle_max. */
[[nodiscard]] const ShadowTechnique &shadow_spot_technique();

/** Half a step of 16-bit depths. */
inline constexpr float short_depth_half_step = 0.5F / 65535.0F;
/** Maps whose 16-bit depths would have a larger error have 32-bit depths, texels. \see shared::NORMAL_OFFSET_TEXELS */
inline constexpr double short_depth_error_max = 0.1;
/** The same for maps that are fitted to depths, which serve pictures of many samples. */
inline constexpr double fitted_short_depth_error_max = 0.05;
/**
 * The largest error of 16-bit depths in the maps of a spot or a sun, in texels at the surface. \a bounds_ws: of all
 * surfaces.
 */
[[nodiscard]] double short_depth_error(const ShadowSlot &slot, const scene::Bounds &bounds_ws);

/** Planar maps of spots and suns. */
class MapTechnique : public ShadowTechnique {
 public:
  int light_shadow_kind() const override
  {
    return SHADOW_MAP;
  }
  Feature features(scene::ShadowKind kind) const override
  {
    return Feature::ShadowMap | (kind == scene::ShadowKind::Pcf ? Feature::ShadowPcf : Feature::None);
  }
  void write_block(const ShadowSlot &slot, shared::ShadowBlock &block) const override;
  double texel_size(const ShadowSlot &slot, const ShadowInspection &inspection,
                    const glm::dvec3 &position_ws) const override;
};

}  // namespace gnomon::eevee
