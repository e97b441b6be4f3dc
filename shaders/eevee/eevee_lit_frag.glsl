#version 450 core
// SPDX-License-Identifier: MIT
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_material_lib.glsl"
#include "eevee/eevee_surface_lib.glsl"
#ifdef USE_BASE_COLOR_TEXTURE
#  include "eevee/eevee_base_color_lib.glsl"
#endif
#ifdef USE_LIGHT
#  include "eevee/eevee_light_lib.glsl"
#endif

#ifdef USE_LIGHT
layout(location = 0) in vec3 surface_position_ws;
layout(location = 1) in vec3 surface_normal_ws;
#endif

layout(location = 0) out vec4 radiance;

#ifdef USE_LIGHT
/** \a fallback for a zero vector. */
vec3 normalized(vec3 v, vec3 fallback)
{
  float length_sq = dot(v, v);
  return length_sq > 0.0 ? v * inversesqrt(length_sq) : fallback;
}

Surface make_surface()
{
  Surface surface;
  surface.position_ws = surface_position_ws;
  vec3 view_ws = view.is_perspective != 0 ? view.position_ws - surface_position_ws : view.back_ws;
  surface.view_ws = normalized(view_ws, view.back_ws);
  vec3 edges_normal = cross(dFdx(surface_position_ws), dFdy(surface_position_ws));
  vec3 seen = normalized(edges_normal, surface.view_ws);
  surface.geometric_normal_ws = dot(seen, surface.view_ws) < 0.0 ? -seen : seen;
  vec3 normal_ws = normalized(surface_normal_ws, surface.geometric_normal_ws);
  surface.normal_ws = gl_FrontFacing ? normal_ws : -normal_ws;
  return surface;
}
#endif

void main()
{
  MaterialData material = materials[surface_material];
#ifdef USE_BASE_COLOR_TEXTURE
  material = tinted(material, base_color_tint());
#endif
  vec3 sum = material.emissive;
#ifdef USE_LIGHT
  Surface surface = make_surface();
  for (int i = 0; i < min(light_data.light_count, LIGHT_MAX); i++) {
    sum += light_radiance(light_data.lights[i], material, surface);
  }
#endif
  radiance = vec4(sum, 1.0);
#ifdef USE_BASE_COLOR_TEXTURE
  // The depth of another surface may be the same.
  if (is_cut_out(material.mask_cutoff)) {
    discard;
  }
#endif
}
