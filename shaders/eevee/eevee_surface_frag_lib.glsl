// SPDX-License-Identifier: MIT
// For fragment shaders: the shaded point, from the outputs of eevee_surface_vert_lib.glsl.
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_grid_lib.glsl"
#include "eevee/eevee_surface_lib.glsl"
#ifdef HAS_COARSE_GRID
#  include "eevee/eevee_gbuffer_lib.glsl"
#endif

layout(location = 0) in vec3 surface_position_ws;
INTERPOLATED(1, vec3, surface_normal_ws, grid_normal_ws)

#ifdef USE_SPECULAR
/** Square of the change of the shading normal from pixel to pixel, the sum of that to the right and that up. */
float normal_change_sq(Surface surface)
{
  vec3 change_x = dFdx(surface.normal_ws);
  vec3 change_y = dFdy(surface.normal_ws);
  return dot(change_x, change_x) + dot(change_y, change_y);
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

/**
 * Move the surface along its plane to the ray of the pixel, on devices that move vertices to a coarse grid. It is then lit as at the same
 * place in all passes. Does nothing on other devices.
 */
void place_on_ray(inout Surface surface)
{
#ifdef HAS_COARSE_GRID
  vec2 ndc = gl_FragCoord.xy * vec2(view.place_right.w, view.place_up.w) - 1.0;
  // With a lens of 1e12 m, SwiftShader interpolates positions that are not finite.
  bool is_place = dot(surface.position_ws, surface.position_ws) <= 1e37;
  surface.position_ws = is_place ? surface.position_ws : view.position_ws;
  surface.position_ws = gbuffer_position(ndc, gbuffer_depth_on_plane(surface.position_ws, surface.geometric_normal_ws));
  surface.view_ws = normalized(to_viewer(surface.position_ws), view.back_ws);
#endif
}
