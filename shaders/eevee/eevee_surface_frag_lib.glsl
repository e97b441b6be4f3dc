// SPDX-License-Identifier: MIT
// For fragment shaders: the shaded point, from the outputs of eevee_surface_vert_lib.glsl.
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_surface_lib.glsl"
#ifdef USE_SPECULAR
#  include "shared/eevee_bsdf_shared.h"
#endif

layout(location = 0) in vec3 surface_position_ws;
layout(location = 1) in vec3 surface_normal_ws;

#ifdef USE_SPECULAR
/** Alpha for the mean of the lobes under a sample's share of a pixel. */
float sampled_alpha(float alpha, Surface surface)
{
  vec3 change_x = dFdx(surface.normal_ws);
  vec3 change_y = dFdy(surface.normal_ws);
  // n^-2 for n samples, as the bias of textures is -0.5 log2(n). A sample has 1/n of the area of a pixel, and so of the variance.
  // Of that, the samples beside it see a part: with 1/n alone, the error of four and more is larger than without a filter.
  float share = exp2(4.0 * view.texture_lod_bias);
  float change_sq = dot(change_x, change_x) + dot(change_y, change_y);
  return filtered_alpha(alpha, change_sq, dot(surface.normal_ws, surface.view_ws), share);
}
#endif

Surface make_surface()
{
  Surface surface;
  surface.position_ws = surface_position_ws;
  surface.view_ws = normalized(to_viewer(surface_position_ws), view.back_ws);
  vec3 edges_normal = cross(dFdx(surface_position_ws), dFdy(surface_position_ws));
  vec3 seen = normalized(edges_normal, surface.view_ws);
  surface.geometric_normal_ws = dot(seen, surface.view_ws) < 0.0 ? -seen : seen;
  vec3 normal_ws = normalized(surface_normal_ws, surface.geometric_normal_ws);
  surface.normal_ws = gl_FrontFacing ? normal_ws : -normal_ws;
#ifdef USE_FULL_MATERIAL
  surface.smooth_normal_ws = surface.normal_ws;
#endif
  return surface;
}
