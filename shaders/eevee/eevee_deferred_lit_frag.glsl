#version 450 core
// SPDX-License-Identifier: MIT
// The light of the surface in the G-buffer, evaluated once for each pixel. It has no derivatives: a neighbour may be another surface.
#include "eevee/eevee_gbuffer_lib.glsl"
#include "eevee/eevee_light_lib.glsl"

layout(std140, binding = MATERIAL_BLOCK_SLOT) readonly buffer material_block
{
  MaterialData materials[];
};

/** The target of the pass: each pixel reads its own texel before it writes it. */
layout(binding = RADIANCE_SLOT) uniform sampler2D gbuffer;

layout(location = 0) out vec4 radiance;

void main()
{
  vec4 texel = texelFetch(gbuffer, ivec2(gl_FragCoord.xy), 0);
  uint bits = gbuffer_bits(texel.z);
  Surface surface;
  surface.position_ws = gbuffer_position(2.0 * gl_FragCoord.xy / vec2(textureSize(gbuffer, 0)) - 1.0, texel.w);
  surface.view_ws = normalized(to_viewer(surface.position_ws), view.back_ws);
  surface.normal_ws = gbuffer_to_direction(texel.x);
  surface.geometric_normal_ws = gbuffer_to_direction(texel.y);
  MaterialData material = materials[bits & GBUFFER_MATERIAL_MAX];
  vec3 sum = material.emissive;
#ifdef USE_SPECULAR
  float change = unpackHalf2x16(bits >> GBUFFER_MATERIAL_BITS).x;
  material.alpha = sampled_alpha(material.alpha, surface, change * change);
#endif
#ifdef USE_MULTISCATTER
  surface.multiscatter = multiscatter_of(material, surface);
#endif
  sum += direct_light(material, surface);
  radiance = vec4(sum, 1.0);
}
