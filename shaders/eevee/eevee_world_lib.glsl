// SPDX-License-Identifier: MIT
// Light of the world beside its suns.
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_light_shared.h"
#include "shared/eevee_world_shared.h"
#include "shared/slots_shared.h"
#ifdef USE_SPECULAR
#  include "eevee/eevee_ltc_lib.glsl"
#endif

layout(std140, binding = WORLD_BLOCK_SLOT) uniform world_block
{
  WorldBlock world;
};

#ifdef USE_SPECULAR
layout(binding = WORLD_LEVELS_SLOT) uniform sampler2DArray world_levels;

/** Mean radiance over a lobe of \a alpha around the unit vector \a direction. */
vec3 world_radiance(vec3 direction, float alpha)
{
  vec2 texco = equirectangular(direction);
  float level = sqrt(alpha) * float(WORLD_LEVEL_COUNT - 1);
  float low = floor(level);
  vec3 sharp = textureLod(world_levels, vec3(texco, low), 0.0).rgb;
  vec3 blurred = textureLod(world_levels, vec3(texco, min(low + 1.0, float(WORLD_LEVEL_COUNT - 1))), 0.0).rgb;
  return max(mix(sharp, blurred, level - low), vec3(0.0));
}

/**
 * Radiance that the specular lobe of \a material sends to the viewer, as if nothing stood in the way. The split sum (Karis
 * 2013): what the lobe sees on average, times its \a albedo.
 */
vec3 world_mirrored(MaterialData material, Surface surface, vec3 albedo)
{
  vec3 mirrored = 2.0 * dot(surface.normal_ws, surface.view_ws) * surface.normal_ws - surface.view_ws;
  // A rough lobe leans towards the normal (Lagarde and de Rousiers 2014, 4.9.3).
  float lean = (1.0 - material.alpha) * (sqrt(max(1.0 - material.alpha, 0.0)) + material.alpha);
  return albedo * world_radiance(mix(surface.normal_ws, mirrored, lean), material.alpha);
}

vec4 albedo_table(Surface surface, float alpha)
{
  float cos_v = clamp(dot(surface.normal_ws, surface.view_ws), 1e-4, 1.0);
  return textureLod(ltc_table, ltc_texco(alpha, cos_v) + vec2(0.5, 0.0), 0.0);
}
#endif

#ifdef USE_SPECULAR
/** What all directions of the world share at one point. */
struct WorldShading {
  /** What the specular lobe mirrors by the levels, for each unit of the lobe of `alpha`. */
  vec3 mirrored;
  /** Of a lobe that the directions can draw. */
  float alpha;
  /** Of the specular light that comes from the levels. */
  float level_share;
};

/** Of the shaded point; world_light sets it. */
WorldShading world_shading;
#endif

/** Radiance of the world's light towards the viewer, W/(sr m²), where it is not sampled; otherwise 0. Sets world_shading. */
vec3 world_light(MaterialData material, Surface surface)
{
#ifdef USE_SPECULAR
  vec3 albedo = specular_albedo(albedo_table(surface, material.alpha), material.specular_f0, material.specular_f90);
#endif
  if (world.is_sampled != 0) {
#ifdef USE_SPECULAR
    world_shading.alpha = max(material.alpha, world.alpha_sampled);
    world_shading.level_share = 1.0 - smoothstep(0.7, 1.0, material.alpha / world.alpha_sampled);
    world_shading.mirrored = vec3(0.0);
    if (world_shading.level_share > 0.0) {
      float whole = specular_albedo(albedo_table(surface, world_shading.alpha), vec3(1.0), 1.0).r;
      world_shading.mirrored = world_mirrored(material, surface, albedo) / max(whole, 1e-4);
    }
#endif
    return vec3(0.0);
  }
  vec3 diffuse = material.diffuse * material.occlusion * world_irradiance(world, surface.normal_ws);
#ifdef USE_SPECULAR
  return diffuse * (1.0 - max(max(albedo.r, albedo.g), albedo.b)) + world_mirrored(material, surface, albedo);
#else
  return diffuse;
#endif
}

#ifdef USE_SPECULAR
/**
 * Radiance towards the viewer of a direction of the world, where nothing stands in its way. A lobe that is narrower than
 * the directions lie apart mirrors the levels, as far as the directions in a wider lobe are open.
 */
vec3 world_reflected(LightData light, MaterialData material, Surface surface, vec3 to_light, float cos_l)
{
  vec3 half_vector = to_light + surface.view_ws;
  float length_sq = dot(half_vector, half_vector);
  float cos_v = max(dot(surface.normal_ws, surface.view_ws), 1e-4);
  half_vector *= length_sq > 0.0 ? inversesqrt(length_sq) : 0.0;
  float cos_h = clamp(dot(surface.normal_ws, half_vector), 0.0, 1.0);
  vec3 fresnel = fresnel_schlick(material.specular_f0, material.specular_f90, dot(surface.view_ws, half_vector));
  float kept = 1.0 - max(max(fresnel.r, fresnel.g), fresnel.b);
  float lobe = ggx_lobe(cos_l, cos_v, cos_h, world_shading.alpha) * cos_l;
  vec3 specular = light.color * fresnel * (lobe * (1.0 - world_shading.level_share)) +
                  world_shading.mirrored * (light.radius_sq * lobe * world_shading.level_share);
  return light.color * material.diffuse * (INV_PI * kept * cos_l) + specular;
}
#endif
