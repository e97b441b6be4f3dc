// SPDX-License-Identifier: MIT
// Visibility of a light, 1 lit and 0 in shadow, from the depths that its casters left.
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_light_shared.h"
#include "shared/eevee_shadow_shared.h"
#include "shared/slots_shared.h"

layout(std140, binding = SHADOW_BLOCK_SLOT) uniform shadow_block
{
  ShadowBlock shadow;
};

#ifdef USE_SHADOW_CUBE
layout(binding = SHADOW_CUBES_SLOT) uniform sampler2DArray shadow_cubes;
#endif
#ifdef USE_SHADOW_MAP
layout(binding = SHADOW_MAPS_SLOT) uniform sampler2DArray shadow_maps;
#endif

float largest(vec3 v)
{
  vec3 a = abs(v);
  return max(max(a.x, a.y), a.z);
}

/** The receiver, lifted off its plane to the side of the light. \a to_light: unit vector. */
vec3 lifted_position(Surface surface, vec3 to_light, float lift)
{
  vec3 normal_ws = surface.geometric_normal_ws;
  return surface.position_ws + normal_ws * (dot(normal_ws, to_light) < 0.0 ? -lift : lift);
}

/** \a slope: change of the receiver's depth over the whole map, across and up. */
float map_visibility(sampler2DArray depths, vec2 uv, int layer, float depth, vec2 slope)
{
  vec2 size = vec2(textureSize(depths, 0).xy);
  vec2 texel = uv * size - 0.5;
  vec2 fraction = fract(texel);
  // At the corner that the four texels share, so that rounding cannot choose others.
  vec4 stored = textureGather(depths, vec3((floor(texel) + 1.0) / size, float(layer)));
  return gathered_visibility(stored, plane_depths(depth, slope / size, fraction), fraction);
}

#ifdef USE_SHADOW_CUBE
float shadow_cube_visibility(int index, Surface surface, LightData light, vec3 to_light)
{
  ShadowCubeData cube = shadow.cubes[index];
  // Distance along the axis of the receiver's face.
  float w = largest(surface.position_ws - light.position_ws);
  float magnitude = largest(surface.position_ws) + largest(light.position_ws);
  float lift = shadow_lift(cube.texel_size * w, DEPTH_ROUNDING / cube.near * w * w, magnitude);
  // Not past the lamp: from behind, the plane would look turned round.
  lift = min(lift, 0.5 * abs(dot(surface.geometric_normal_ws, surface.position_ws - light.position_ws)));
  vec3 from_light = lifted_position(surface, to_light, lift) - light.position_ws;
  int face = cube_face(from_light);
  vec3 p = cube_face_project(face, from_light);
  if (p.z <= cube.near) {
    // Nearer than the near plane nothing casts.
    return 1.0;
  }
  // A plane n · p = c has 1 / z = (n.x · x/z + n.y · y/z + n.z) / c; texture coordinates are half of x/z.
  vec3 n = cube_face_project(face, surface.geometric_normal_ws);
  float scale = slope_quotient(2.0 * cube.near, dot(n, p));
  return map_visibility(shadow_cubes, p.xy / p.z * 0.5 + 0.5, cube.layer + face, cube.near / p.z, n.xy * scale);
}
#endif

#ifdef USE_SHADOW_MAP
float shadow_map_visibility(int index, Surface surface, vec3 to_light)
{
  ShadowMapData map = shadow.maps[index];
  float w = (map.texco_from_world * vec4(surface.position_ws, 1.0)).w;
  float lift = shadow_lift(map.texel_size * w, map.rounding * w * w, largest(surface.position_ws) + abs(w));
  vec4 texco = map.texco_from_world * vec4(lifted_position(surface, to_light, lift), 1.0);
  if (texco.w <= 0.0) {
    return 1.0;
  }
  texco.xyz /= texco.w;
  // Outside of the map nothing casts.
  if (any(lessThan(texco.xy, vec2(0.0))) || any(greaterThan(texco.xy, vec2(1.0)))) {
    return 1.0;
  }
  // Two directions on the receiver's plane, as the map sees them: d(q / w) = (dq - q / w · dw) / w.
  vec3 n = surface.geometric_normal_ws;
  vec3 tangent = normalize(abs(n.z) < 0.9 ? vec3(n.y, -n.x, 0.0) : vec3(0.0, n.z, -n.y));
  vec4 along = map.texco_from_world * vec4(tangent, 0.0);
  vec4 across = map.texco_from_world * vec4(cross(n, tangent), 0.0);
  vec3 plane = cross(along.xyz - texco.xyz * along.w, across.xyz - texco.xyz * across.w);
  vec2 slope = vec2(slope_quotient(-plane.x, plane.z), slope_quotient(-plane.y, plane.z));
  return map_visibility(shadow_maps, texco.xy, map.layer, texco.z, slope);
}
#endif
