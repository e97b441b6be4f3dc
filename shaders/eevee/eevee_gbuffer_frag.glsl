#version 450 core
// SPDX-License-Identifier: MIT
// Writes the properties of a surface that deferred lighting reads. \see eevee_deferred_lit_frag.glsl
#include "eevee/eevee_grid_lib.glsl"
#include "eevee/eevee_gbuffer_lib.glsl"
#include "eevee/eevee_surface_frag_lib.glsl"
#include "draw/draw_clip_lib.glsl"

layout(location = 2) flat in uint surface_material;

/** \see eevee_gbuffer_shared.h */
layout(location = 0) out vec4 texel;

void main()
{
  write_depth_on_plane(0.125);
  Surface surface = make_surface();
  place_on_ray(surface);
  uint bits = surface_material;
#ifdef USE_SPECULAR
  // A positive half float has 15 bits.
  bits |= packHalf2x16(vec2(sqrt(normal_change_sq(surface)), 0.0)) << GBUFFER_MATERIAL_BITS;
#endif
  texel = vec4(gbuffer_from_direction(surface.normal_ws), gbuffer_from_direction(surface.geometric_normal_ws),
               gbuffer_float(bits), gbuffer_depth(surface.position_ws));
  discard_clipped();
}
