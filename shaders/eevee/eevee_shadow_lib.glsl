// SPDX-License-Identifier: MIT
// Visibility of a light, 1 lit and 0 in shadow, from the depths that its casters left.
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_shadow_shared.h"
#include "shared/slots_shared.h"

layout(std140, binding = SHADOW_BLOCK_SLOT) uniform shadow_block
{
  ShadowBlock shadow;
};

#ifdef USE_SHADOW_CUBE
layout(binding = SHADOW_CUBES_SLOT) uniform sampler2DArrayShadow shadow_cubes;
#endif
#ifdef USE_SHADOW_MAP
layout(binding = SHADOW_MAPS_SLOT) uniform sampler2DArrayShadow shadow_maps;
#endif

/** Texels between a lookup and the farthest one it reads: the diagonal of the 2x2 that hardware blends. */
const float FILTER_RADIUS = 1.5;

/** The receiver, lifted off its plane to the side of the light. \a to_light: unit vector. */
vec3 lifted_position(Surface surface, vec3 to_light, float texel, float magnitude)
{
  float cos_angle = dot(surface.geometric_normal_ws, to_light);
  float lift = shadow_lift(texel, FILTER_RADIUS, cos_angle, magnitude);
  return surface.position_ws + surface.geometric_normal_ws * (cos_angle < 0.0 ? -lift : lift);
}

float largest(vec3 v)
{
  vec3 a = abs(v);
  return max(max(a.x, a.y), a.z);
}

#ifdef USE_SHADOW_CUBE
float shadow_cube_visibility(int index, Surface surface, vec3 light_position_ws)
{
  ShadowCubeData cube = shadow.cubes[index];
  vec3 from_light = surface.position_ws - light_position_ws;
  float distance_sq = dot(from_light, from_light);
  if (distance_sq == 0.0) {
    return 1.0;
  }
  float magnitude = largest(surface.position_ws) + largest(light_position_ws);
  vec3 to_light = -from_light * inversesqrt(distance_sq);
  vec3 lifted = lifted_position(surface, to_light, cube.texel_size * largest(from_light), magnitude);
  from_light = lifted - light_position_ws;
  int face = cube_face(from_light);
  vec3 p = cube_face_project(face, from_light);
  // Nearer than the near plane casters are clamped to it, and so is the receiver.
  float w = max(p.z, cube.near);
  return texture(shadow_cubes, vec4(p.xy / w * 0.5 + 0.5, float(cube.layer + face), cube.near / w));
}
#endif

#ifdef USE_SHADOW_MAP
float shadow_map_visibility(int index, Surface surface, vec3 to_light)
{
  ShadowMapData map = shadow.maps[index];
  float w = (map.texco_from_world * vec4(surface.position_ws, 1.0)).w;
  if (w <= 0.0) {
    return 1.0;
  }
  vec3 lifted = lifted_position(surface, to_light, map.texel_size * w, largest(surface.position_ws) + w);
  vec4 texco = map.texco_from_world * vec4(lifted, 1.0);
  if (texco.w <= 0.0) {
    return 1.0;
  }
  texco.xyz /= texco.w;
  // Outside of the map nothing casts.
  if (any(lessThan(texco.xy, vec2(0.0))) || any(greaterThan(texco.xy, vec2(1.0)))) {
    return 1.0;
  }
  return texture(shadow_maps, vec4(texco.xy, float(map.layer), clamp(texco.z, 0.0, 1.0)));
}
#endif
