#version 450 core
// SPDX-License-Identifier: MIT
#include "eevee/eevee_grid_lib.glsl"
#include "eevee/eevee_material_lib.glsl"
#if defined(USE_FULL_MATERIAL)
#  include "eevee/eevee_full_material_lib.glsl"
#  ifdef USE_LIGHT
#    include "eevee/eevee_normal_map_lib.glsl"
#  endif
#elif defined(USE_BASE_COLOR_TEXTURE)
#  include "eevee/eevee_base_color_lib.glsl"
#endif
#if (defined(USE_FULL_MATERIAL) && !defined(USE_SURFACE_FUNCTION)) || defined(USE_BASE_COLOR_TEXTURE)
#  include "eevee/eevee_mask_lib.glsl"
#endif
#ifdef USE_LIGHT
#  include "eevee/eevee_light_lib.glsl"
#  include "eevee/eevee_surface_frag_lib.glsl"
#endif
#ifdef USE_SURFACE_FUNCTION
#  include "eevee/eevee_surface_function_lib.glsl"
#endif
#ifdef USE_LAYERS
#  include "eevee/eevee_layers_lib.glsl"
#endif
#ifdef USE_TRANSMISSION
#  include "eevee/eevee_transmission_lib.glsl"
#endif
#include "draw/draw_clip_lib.glsl"

layout(location = 0) out vec4 radiance;

void main()
{
  write_depth_on_plane(0.125);
#if defined(USE_SURFACE_FUNCTION)
  Surface surface = normal_mapped(make_surface());
  StandardSurface edited =
      edited_surface(surface.position_ws, surface.smooth_normal_ws, surface.normal_ws, surface.view_ws);
  surface.normal_ws = edited.normal_ws;
  MaterialData material = edited_material(edited);
#elif defined(USE_FULL_MATERIAL)
  MaterialData material = full_material();
#else
  MaterialData material = materials[surface_material];
#endif
#ifdef USE_BASE_COLOR_TEXTURE
  material = tinted(material, texture(base_color_texture, surface_uv, view.texture_lod_bias).rgb);
#endif
  vec3 sum = material.emissive;
  float alpha = 1.0;
#ifdef USE_LIGHT
#  ifndef USE_SURFACE_FUNCTION
  Surface surface = make_surface();
#    ifdef USE_FULL_MATERIAL
  surface = normal_mapped(surface);
#    endif
#  endif
  place_on_ray(surface);
#  ifdef USE_SPECULAR
  material.alpha = sampled_alpha(material.alpha, surface, normal_change_sq(surface));
#  endif
#  ifdef USE_LAYERS
  set_layers(make_layers(material.alpha, surface));
  // For all that knows round lobes only: one of the same height at its centre.
  material.alpha = sqrt(layers.base_lobe.alphas.x * layers.base_lobe.alphas.y);
  sum *= 1.0 - layers.coat_share;
#  endif
#  ifdef USE_MULTISCATTER
  surface.multiscatter = multiscatter_of(material, surface);
#  endif
#  ifdef USE_TRANSMISSION
#    ifdef USE_SURFACE_FUNCTION
  float roughness_behind = edited.roughness;
#    else
  float roughness_behind = textured_surface().roughness;
#    endif
  Transmission transmission = make_transmission(material, surface, roughness_behind);
  material.diffuse *= 1.0 - transmission.part;
  vec3 passed = layered(transmission.passed, vec3(0.0), vec3(0.0));
  sum += passed * transmission.behind.rgb + layered(transmission.mirrored, vec3(0.0), vec3(0.0));
  // 1 - the transmittance of the surface, before a transparent picture, as the mean of red, green and blue.
  alpha = 1.0 - dot(passed, vec3(1.0 / 3.0)) * (1.0 - transmission.behind.a);
#    ifdef USE_WORLD
  mirror_seen = mirror_part(surface, roughness_behind);
#    endif
#  endif
  sum += direct_light(material, surface);
#endif
  radiance = vec4(sum, alpha);
#if defined(USE_SURFACE_FUNCTION)
  radiance *= has_input(INPUT_BLENDED) ? edited.alpha : 1.0;
  if (edited.alpha < materials[surface_material].mask_cutoff) {
    discard;
  }
#elif defined(USE_FULL_MATERIAL)
  radiance *= surface_opacity();
#endif
#if (defined(USE_FULL_MATERIAL) && !defined(USE_SURFACE_FUNCTION)) || defined(USE_BASE_COLOR_TEXTURE)
  // Another surface may have the same depth, so the depth test alone does not reject a masked fragment.
  if (is_pixel_cut_out(materials[surface_material].mask_cutoff)) {
    discard;
  }
#endif
  discard_clipped();
}
