#version 450 core
// SPDX-License-Identifier: MIT
// Filters a layer over cones of equal solid angle: each texel looks up several directions around its own in the cube.
#include "eevee/eevee_esm_cube_lib.glsl"

#ifdef EVSM_TAPS
#  define ESM_TAPS EVSM_TAPS
#endif

SPECIALIZATION_CONSTANT(0) const int tap_count = ESM_TAPS;

#ifdef EVSM_TAPS
layout(location = 0) out vec2 stored;
#else
layout(location = 0) out float stored;
#endif

void main()
{
  EsmData data = esm.lamps[lamp];
  ivec2 texel = ivec2(gl_FragCoord.xy) - ESM_BORDER;
  if (max(texel.x, texel.y) >= data.size + ESM_BORDER) {
    discard;
  }
  vec3 axis = map_direction(texel, data.size);
  float sine = sin(0.5 * data.filter_angle);
  float versine = 2.0 * sine * sine;
  float weight = 1.0 / float(tap_count);
  vec3 direction = esm_cone_direction(axis, esm_disk_point(0, tap_count), versine);
  LogSum sum = log_sum_begin(cube_distance(direction, data.range), weight);
#ifdef EVSM_TAPS
  LogSum squares = sum;
#endif
  for (int i = 1; i < tap_count; i++) {
    direction = esm_cone_direction(axis, esm_disk_point(i, tap_count), versine);
    float tap = cube_distance(direction, data.range);
    sum = log_sum_add(sum, data.exponent, tap, weight);
#ifdef EVSM_TAPS
    squares = log_sum_add(squares, 2.0 * data.exponent, tap, weight);
#endif
  }
  float filtered = clamp(log_sum_value(sum, data.exponent), 0.0, data.range);
#ifdef EVSM_TAPS
  stored = vec2(filtered, log_sum_variance(sum, squares, 1.0));
#else
  stored = esm_encoded(filtered, data.range, data.format);
#endif
}
