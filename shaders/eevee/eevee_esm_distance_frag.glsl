#version 450 core
// SPDX-License-Identifier: MIT
// Writes one distance for each texel of the map, metres, without a border: the input of the separable filter.
#include "eevee/eevee_esm_cube_lib.glsl"

layout(location = 0) out float distance_m;

void main()
{
  EsmData data = esm.lamps[lamp];
  ivec2 texel = ivec2(gl_FragCoord.xy);
  if (max(texel.x, texel.y) >= data.size) {
    discard;
  }
  distance_m = cube_distance(map_direction(texel, data.size), data.range);
}
