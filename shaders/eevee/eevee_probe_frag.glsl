#version 450 core
// SPDX-License-Identifier: MIT
// The engine's visibility of one lamp at each pixel, for comparison with the reference.
#include "eevee/eevee_grid_lib.glsl"
#include "eevee/eevee_light_lib.glsl"
#include "eevee/eevee_surface_frag_lib.glsl"

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Entry of light_block. */
  int probed_light;
};

layout(location = 0) out vec4 position_visibility;
layout(location = 1) out vec4 normal;

void main()
{
  write_depth_on_plane(0.125);
  Surface surface = make_surface();
  place_on_ray(surface);
  LightData light = light_data.lights[probed_light];
  vec3 to_light = light.kind == LIGHT_SUN ? -light.forward_ws : light.position_ws - surface.position_ws;
  float visibility = light_visibility(light, LIGHTS_ALL, surface, normalized(to_light, vec3(0.0)), true);
  position_visibility = vec4(surface.position_ws, visibility);
  normal = vec4(surface.geometric_normal_ws, 1.0);
}
