// SPDX-License-Identifier: MIT
// Direct light at a surface.
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_bsdf_shared.h"
#include "shared/eevee_light_shared.h"
#include "shared/eevee_material_shared.h"
#include "shared/slots_shared.h"
#if defined(USE_SHADOW_CUBE) || defined(USE_SHADOW_MAP)
#  define USE_SHADOW
#  include "eevee/eevee_shadow_lib.glsl"
#endif
#ifdef USE_SHADOW_ESM
#  include "eevee/eevee_esm_lib.glsl"
#endif

layout(std140, binding = LIGHT_BLOCK_SLOT) uniform light_block
{
  LightBlock light_data;
};

/** Visibility of a light, 1 lit and 0 in shadow. \a to_light: unit vector. */
float light_visibility(LightData light, Surface surface, vec3 to_light)
{
#ifdef USE_SHADOW_CUBE
  if (light.shadow_kind == SHADOW_CUBE) {
    return shadow_cube_visibility(light.shadow_index, surface, light, to_light);
  }
#endif
#ifdef USE_SHADOW_MAP
  if (light.shadow_kind == SHADOW_MAP) {
    return shadow_map_visibility(light.shadow_index, surface, to_light);
  }
#endif
#ifdef USE_SHADOW_ESM
  if (light.shadow_kind == SHADOW_ESM) {
    return shadow_esm_visibility(light.shadow_index, surface.position_ws - light.position_ws,
                                 surface.geometric_normal_ws);
  }
#endif
  return 1.0;
}

/** BRDF towards the viewer, 1/sr, times the cosine of the incident light. */
vec3 reflected(MaterialData material, Surface surface, vec3 to_light, float cos_l)
{
#ifdef USE_SPECULAR
  vec3 half_vector = to_light + surface.view_ws;
  float length_sq = dot(half_vector, half_vector);
  float cos_v = max(dot(surface.normal_ws, surface.view_ws), 1e-4);
  half_vector *= length_sq > 0.0 ? inversesqrt(length_sq) : 0.0;
  float cos_h = clamp(dot(surface.normal_ws, half_vector), 0.0, 1.0);
  vec3 fresnel = fresnel_schlick(material.specular_f0, material.specular_f90, dot(surface.view_ws, half_vector));
  float kept = 1.0 - max(max(fresnel.r, fresnel.g), fresnel.b);
  vec3 specular = fresnel * ggx_lobe(cos_l, cos_v, cos_h, material.alpha);
  return (material.diffuse * (INV_PI * kept) + specular) * cos_l;
#else
  return material.diffuse * (INV_PI * cos_l);
#endif
}

/** Radiance towards the viewer from one light, W/(sr m²). */
vec3 light_radiance(LightData light, MaterialData material, Surface surface)
{
  if (light.kind == LIGHT_HEMI) {
    return material.diffuse * light.color * (INV_PI * hemi_irradiance(-dot(surface.normal_ws, light.forward_ws)));
  }
  vec3 to_light = -light.forward_ws;
  float irradiance = 1.0;
#ifdef USE_PUNCTUAL
  if (light.kind != LIGHT_SUN) {
    vec3 vector = light.position_ws - surface.position_ws;
    float distance_sq = dot(vector, vector);
    // At the lamp itself the direction is undefined. The zero vector gives no light.
    to_light = distance_sq > 0.0 ? vector * inversesqrt(distance_sq) : vec3(0.0);
    irradiance = distance_falloff(distance_sq, light.radius_sq, light.range_inv_sq);
    if (light.kind == LIGHT_SPOT) {
      irradiance *= spot_mask(one_minus_cos(-to_light, light.forward_ws), light.spot_drop_outer, light.spot_inv_width);
    }
  }
#endif
  float cos_l = dot(surface.normal_ws, to_light);
  if (cos_l <= 0.0 || irradiance <= 0.0) {
    return vec3(0.0);
  }
  float visibility = light_visibility(light, surface, to_light);
  if (visibility <= 0.0) {
    return vec3(0.0);
  }
  return light.color * (irradiance * visibility) * reflected(material, surface, to_light, cos_l);
}
