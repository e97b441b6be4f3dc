// SPDX-License-Identifier: MIT
// Positions of the surfaces in the G-buffer.
#include "draw/draw_view_lib.glsl"
#include "shared/eevee_gbuffer_shared.h"

/** Depth beyond view.depth_origin_ws, metres. */
float gbuffer_depth(vec3 position_ws)
{
  return dot(view.depth_origin_ws - position_ws, view.back_ws);
}

/** \see ViewData::place_middle. \a ndc: normalized device coordinates. */
vec3 gbuffer_place(vec2 ndc)
{
  return view.place_middle + ndc.x * view.place_right.xyz + ndc.y * view.place_up.xyz;
}

/** \a ndc: normalized device coordinates. \a depth: a gbuffer_depth(). */
vec3 gbuffer_position(vec2 ndc, float depth)
{
  vec3 place = gbuffer_place(ndc);
  float scale = view.is_perspective != 0 ? view.depth_origin + depth : 1.0;
  return view.depth_origin_ws + scale * place - depth * view.back_ws;
}

#ifdef HAS_COARSE_GRID
/**
 * The gbuffer_depth() at which the ray of the pixel meets the plane of the triangle. \a position_ws: of the surface. Where vertices are
 * moved to a coarse grid, it is of a place beside the pixel's centre, and a position from its depth would be off the plane, which would then
 * shadow itself. \a normal_ws: of the triangle. SwiftShader's places are up to 1.4 pixels beside the centre, on triangles that are clipped.
 * The bound, the change of the depth over two pixels, keeps rays along the plane from depths far off the surface.
 */
float gbuffer_depth_on_plane(vec3 position_ws, vec3 normal_ws)
{
  vec2 ndc = gl_FragCoord.xy * vec2(view.place_right.w, view.place_up.w) - 1.0;
  float depth = gbuffer_depth(position_ws);
  float slope = dot((view.is_perspective != 0 ? gbuffer_place(ndc) : vec3(0.0)) - view.back_ws, normal_ws);
  float off_plane = dot(position_ws - gbuffer_position(ndc, depth), normal_ws);
  float bound = 2.0 * fwidth(depth);
  return depth + (abs(slope) > 1e-6 ? clamp(off_plane / slope, -bound, bound) : 0.0);
}
#endif
