// SPDX-License-Identifier: MIT
// Distances from a lamp, looked up in its cube of depths.
#include "eevee/eevee_esm_block_lib.glsl"
#include "shared/eevee_depth_shared.h"
#include "shared/eevee_octahedral_shared.h"
#include "shared/eevee_shadow_shared.h"

layout(binding = SHADOW_CUBES_SLOT) uniform sampler2DArray shadow_cubes;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Index in `esm_block`. */
  int lamp;
  /** First of the cube's six layers in `shadow_cubes`. */
  int first_layer;
  /** Bit f: face f was drawn. */
  int face_mask;
  /** Distance of the cube's near plane, metres. */
  float near;
  /** Fraction of a face's width that its 90° cover, at most 1. */
  float uv_scale;
  /** Edge of a face, texels. The face is in the lower left corner of its layer. */
  int cube_size_px;
};

/** Distance of the nearest caster along the unit vector \a direction, metres: above 0, at most \a range. */
float cube_distance(vec3 direction, float range)
{
  int face = cube_face(direction);
  if ((face_mask & (1 << face)) == 0) {
    return range;
  }
  vec3 p = cube_face_project(face, direction);
  int size = cube_size_px;
  // p.z is at least 1 / √3.
  vec2 uv = p.xy / p.z * (0.5 * uv_scale) + 0.5;
  ivec2 texel = clamp(ivec2(uv * float(size)), ivec2(0), ivec2(size - 1));
  float depth = texelFetch(shadow_cubes, ivec3(texel, first_layer + face), 0).r;
  // The stored point lies on the ray through the centre of the texel.
  vec2 middle = ((vec2(texel) + 0.5) / float(size) * 2.0 - 1.0) / uv_scale;
  float along_axis = distance_of_depth(depth, near, 0.0, PROJECTION_PERSPECTIVE_INFINITE);
  return min(along_axis * sqrt(dot(middle, middle) + 1.0), range);
}

/** Direction of \a texel of the lamp's map. A texel of the border has the direction of the texel that it repeats. */
vec3 map_direction(ivec2 texel, int size)
{
  return octahedral_to_direction((vec2(octahedral_texel(texel, size)) + 0.5) / float(size));
}
