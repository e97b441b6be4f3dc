#version 450 core
// SPDX-License-Identifier: MIT
// Tint of the picture that shows which cascades of a sun each pixel reads, and how they blend. The picture is multiplied by it.
#include "eevee/eevee_grid_lib.glsl"
#include "eevee/eevee_light_lib.glsl"
#include "eevee/eevee_shadow_place_lib.glsl"
#include "eevee/eevee_surface_frag_lib.glsl"

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Index of the sun in light_block. */
  int tinted_light;
};

layout(location = 0) out vec4 tint;

/** Tints from the finest cascade on: red, green, blue, yellow. */
const vec3 CASCADE_TINTS[4] = vec3[4](vec3(1.0, 0.4, 0.4), vec3(0.4, 1.0, 0.4), vec3(0.4, 0.6, 1.0), vec3(1.0, 0.9, 0.3));

void main()
{
  write_depth_on_plane(0.125);
  Surface surface = make_surface();
  place_on_ray(surface);
  LightData light = light_data.lights[tinted_light];
  int first = light.shadow_index;
  int count = min(shadow.maps[first].cascade_count, 4);
  vec3 sum = vec3(0.0);
  float open = 1.0;
  for (int i = 0; i < count && open > 0.0; i++) {
    float normal_offset;
    ShadowMapData map = shadow.maps[first + i];
    float coverage = map_coverage(map, map_receiver(map, surface, -light.forward_ws, normal_offset));
    float share = open * cascade_share(i == count - 1, coverage);
    sum += share * CASCADE_TINTS[i];
    open -= share;
  }
  // Pixels outside all cascades are unchanged.
  tint = vec4(sum + open, 1.0);
}
