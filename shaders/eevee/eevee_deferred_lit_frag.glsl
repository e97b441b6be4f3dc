#version 450 core
// SPDX-License-Identifier: MIT
// The light of the surface in the G-buffer, evaluated once for each pixel. It has no derivatives: a neighbour may be another surface.
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_light_lib.glsl"
#include "shared/eevee_gbuffer_shared.h"

layout(std140, binding = MATERIAL_BLOCK_SLOT) readonly buffer material_block
{
  MaterialData materials[];
};

/** The target of the pass: each pixel reads its own texel before it writes it. */
layout(binding = RADIANCE_SLOT) uniform sampler2D gbuffer;
layout(binding = DEPTH_SLOT) uniform sampler2D depth_texture;

layout(location = 0) out vec4 radiance;

vec3 position_at(ivec2 pixel)
{
  vec2 place = (vec2(pixel) + 0.5) / vec2(textureSize(depth_texture, 0));
  vec4 position = view.world_from_clip * vec4(2.0 * place - 1.0, texelFetch(depth_texture, pixel, 0).r, 1.0);
  return position.xyz / position.w;
}

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 texel = texelFetch(gbuffer, pixel, 0);
  Surface surface;
  surface.position_ws = position_at(pixel);
  surface.view_ws = normalized(to_viewer(surface.position_ws), view.back_ws);
  surface.normal_ws = gbuffer_to_direction(texel.x);
  surface.geometric_normal_ws = gbuffer_to_direction(texel.y);
  MaterialData material = materials[gbuffer_bits(texel.z)];
  vec3 sum = material.emissive;
#ifdef USE_SPECULAR
  material.alpha = sampled_alpha(material.alpha, surface, texel.w);
#endif
#ifdef USE_MULTISCATTER
  surface.multiscatter = multiscatter_of(material, surface);
#endif
  radiance = vec4(sum + direct_light(material, surface), 1.0);
}
