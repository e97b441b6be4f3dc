#version 450 core
// SPDX-License-Identifier: MIT
// Properties of surfaces without light, as layers for compositing.
#include "eevee/eevee_grid_lib.glsl"
#include "eevee/eevee_material_lib.glsl"
#if defined(USE_FULL_MATERIAL)
#  include "eevee/eevee_full_material_lib.glsl"
#  include "eevee/eevee_normal_map_lib.glsl"
#elif defined(USE_BASE_COLOR_TEXTURE)
#  include "eevee/eevee_base_color_lib.glsl"
#endif
#if (defined(USE_FULL_MATERIAL) && !defined(USE_SURFACE_FUNCTION)) || defined(USE_BASE_COLOR_TEXTURE)
#  include "eevee/eevee_mask_lib.glsl"
#endif
#include "eevee/eevee_surface_frag_lib.glsl"
#ifdef USE_SURFACE_FUNCTION
#  include "eevee/eevee_surface_function_lib.glsl"
#endif

layout(location = 9) flat in uint surface_object;

/** World space; w: distance from the eye along the view axis, metres. */
layout(location = 0) out vec4 position_depth;
/** World space, unit length; w: index in object_block, which a float holds exactly below 2^24. */
layout(location = 1) out vec4 normal_object;
layout(location = 2) out vec4 albedo_roughness;

void main()
{
  write_depth_on_plane(0.125);
  Surface surface = make_surface();
#if defined(USE_SURFACE_FUNCTION)
  surface = normal_mapped(surface);
  StandardSurface edited =
      edited_surface(surface.position_ws, surface.smooth_normal_ws, surface.normal_ws, surface.view_ws);
  surface.normal_ws = edited.normal_ws;
  MaterialData material = edited_material(edited);
#elif defined(USE_FULL_MATERIAL)
  MaterialData material = full_material();
  surface = normal_mapped(surface);
#else
  MaterialData material = materials[surface_material];
#endif
  // The base colour: that of the diffuse part and that of the metal. It is 0 for unlit materials, which reflect no light.
  vec3 albedo = material.diffuse + material.metal_f0;
#ifdef USE_BASE_COLOR_TEXTURE
  albedo *= texture(base_color_texture, surface_uv, view.texture_lod_bias).rgb;
#endif
  place_on_ray(surface);
  position_depth = vec4(surface.position_ws, dot(view.back_ws, view.position_ws - surface.position_ws));
  normal_object = vec4(surface.normal_ws, float(surface_object));
  albedo_roughness = vec4(albedo, sqrt(material.alpha));
#if defined(USE_SURFACE_FUNCTION)
  if (edited.alpha < materials[surface_material].mask_cutoff) {
    discard;
  }
#elif defined(USE_FULL_MATERIAL) || defined(USE_BASE_COLOR_TEXTURE)
  if (is_pixel_cut_out(materials[surface_material].mask_cutoff)) {
    discard;
  }
#endif
}
