#version 450 core
// SPDX-License-Identifier: MIT
// Writes what deferred lighting reads of a surface. \see eevee_deferred_lit_frag.glsl
#include "eevee/eevee_surface_frag_lib.glsl"
#include "shared/eevee_gbuffer_shared.h"

layout(location = 2) flat in uint surface_material;

/** \see eevee_gbuffer_shared.h */
layout(location = 0) out vec4 texel;

void main()
{
  Surface surface = make_surface();
  float change_sq = 0.0;
#ifdef USE_SPECULAR
  change_sq = normal_change_sq(surface);
#endif
  texel = vec4(gbuffer_from_direction(surface.normal_ws), gbuffer_from_direction(surface.geometric_normal_ws),
               gbuffer_float(surface_material), change_sq);
}
