// SPDX-License-Identifier: MIT
// Position of a receiver in a shadow map.
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_shadow_shared.h"
#include "shared/slots_shared.h"

layout(std140, binding = SHADOW_BLOCK_SLOT) uniform shadow_block
{
  ShadowBlock shadow;
};

#ifdef USE_SHADOW_PCF
/** Edge of the square kernel, texels, odd. 0: a disk. */
SPECIALIZATION_CONSTANT(0) const int PCF_WIDTH = SHADOW_PCF_WIDTH;
/** Number of lookups on the disk. */
SPECIALIZATION_CONSTANT(1) const int PCF_TAPS = SHADOW_PCF_TAPS;
/** Radius of the disk, texels. With the texels around each lookup, the disk stays within CUBE_BORDER_TEXELS. */
const float PCF_DISK_RADIUS = 2.0;
#endif

/** Largest absolute component. */
float largest(vec3 v)
{
  vec3 a = abs(v);
  return max(max(a.x, a.y), a.z);
}

/** The receiver, offset along its normal to the side of the light. \a to_light: unit vector. \a normal_offset: metres. */
vec3 offset_position(Surface surface, vec3 to_light, float normal_offset)
{
  vec3 normal_ws = surface.geometric_normal_ws;
  return surface.position_ws + normal_ws * (dot(normal_ws, to_light) < 0.0 ? -normal_offset : normal_offset);
}

/** Reach of the filter kernel from the lookup, texels. */
float kernel_reach(int filter_kind)
{
#ifdef USE_SHADOW_PCF
  if (filter_kind == SHADOW_FILTER_PCF) {
    return PCF_WIDTH > 0 ? 0.5 * float(PCF_WIDTH + 1) : PCF_DISK_RADIUS + 1.0;
  }
#endif
  return 1.0;
}

/** Fraction of a map's half width over which a cascade blends into the next. */
const float CASCADE_FADE = 0.1;

/**
 * The receiver in a map, with its normal offset, metres: xy across the map, [0, 1] inside, and z its depth, all times w. w is 0 where
 * receivers are lit.
 */
vec4 map_receiver(ShadowMapData map, Surface surface, vec3 to_light, out float normal_offset)
{
  float w = (map.texco_from_world * vec4(surface.position_ws, 1.0)).w;
  float magnitude = largest(surface.position_ws) + abs(w);
  normal_offset =
      map.bias * shadow_normal_offset(map.texel_size * w, kernel_reach(map.filter_kind), map.rounding * w * w, magnitude);
  vec4 receiver = map.texco_from_world * vec4(offset_position(surface, to_light, normal_offset), 1.0);
  return w > map.far ? vec4(0.0) : receiver;
}

/**
 * 0 outside the map, 1 inside except near the edge of the map. \a texco: times w, as map_receiver returns it. The last map of a light
 * is deep enough for all receivers; the others for those that were seen when they were fitted.
 */
float map_coverage(ShadowMapData map, vec4 texco)
{
  bool is_in_depths = map.cascade_count == 1 || abs(texco.z - 0.5) <= 0.5;
  if (texco.w <= 0.0 || !is_in_depths) {
    return 0.0;
  }
  vec2 from_edge = min(texco.xy, texco.w - texco.xy) / texco.w;
  return clamp(min(from_edge.x, from_edge.y) / (0.5 * CASCADE_FADE), 0.0, 1.0);
}

/** Fraction of the weight not used by finer cascades. The last cascade does not fade. */
float cascade_share(bool is_last, float coverage)
{
  return is_last ? step(1e-30, coverage) : coverage;
}
