// SPDX-License-Identifier: MIT
// Light of the world without its suns, which are lights of light_block.
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_light_shared.h"
#include "shared/eevee_world_shared.h"
#include "shared/slots_shared.h"
#if defined(USE_MULTISCATTER)
#  include "eevee/eevee_multiscatter_lib.glsl"
#elif defined(USE_SPECULAR)
#  include "eevee/eevee_ltc_lib.glsl"
#endif

layout(std140, binding = WORLD_BLOCK_SLOT) uniform world_block
{
  WorldBlock world;
};

#ifdef USE_SPECULAR
layout(binding = WORLD_LEVELS_SLOT) uniform sampler2DArray world_levels;

/** Mean radiance of the world over a lobe of \a alpha around the unit vector \a direction. */
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
 * Specular radiance of the world towards the viewer without occlusion, by the split-sum approximation (Karis 2013): the
 * mean radiance over the lobe, times the \a albedo of the lobe. \a normal_ws: at which the view is mirrored.
 */
vec3 world_mirrored(MaterialData material, Surface surface, vec3 normal_ws, vec3 albedo)
{
  vec3 mirrored = 2.0 * dot(normal_ws, surface.view_ws) * normal_ws - surface.view_ws;
  // The dominant direction of a rough lobe is closer to the normal (Lagarde and de Rousiers 2014, 4.9.3).
  float lean = (1.0 - material.alpha) * (sqrt(max(1.0 - material.alpha, 0.0)) + material.alpha);
  return albedo * world_radiance(mix(normal_ws, mirrored, lean), material.alpha);
}

/** Directional albedo of a lobe of \a alpha. */
vec3 albedo_of(Surface surface, float alpha, vec3 f0, float f90)
{
  float cos_v = clamp(dot(surface.normal_ws, surface.view_ws), 1e-4, 1.0);
#  ifdef USE_MULTISCATTER
  return single_albedo(lobe_albedo(multiscatter_texel(alpha, cos_v), alpha, cos_v), f0, f90);
#  else
  return specular_albedo(textureLod(ltc_table, ltc_texco(alpha, cos_v) + vec2(0.5, 0.0), 0.0), f0, f90);
#  endif
}
#endif

#ifdef USE_SPECULAR
/** Values at the shaded point that are the same for all sampled directions of the world. */
struct WorldShading {
  /** Specular radiance from `world_levels`, divided by the albedo of a lobe of `alpha` with Fresnel terms of 1. */
  vec3 mirrored;
  /** Fraction of the specular light that comes from `world_levels`. */
  float level_share;
};

/** Of the last call of world_light. */
WorldShading world_shading;
#endif

/**
 * Radiance of the world towards the viewer, W/(sr m²); 0 if the world is sampled. Sets world_shading for samples.
 * \a mirror_ws: normal at which the view is mirrored.
 */
vec3 world_light(MaterialData material, Surface surface, vec3 mirror_ws)
{
#ifdef USE_SPECULAR
  vec3 albedo = albedo_of(surface, material.alpha, material.specular_f0, material.specular_f90);
#endif
  if (world.is_sampled != 0) {
#ifdef USE_SPECULAR
    world_shading.level_share = 1.0 - smoothstep(0.7, 1.0, material.alpha / world.alpha_sampled);
    world_shading.mirrored = vec3(0.0);
    if (world_shading.level_share > 0.0) {
      float whole = albedo_of(surface, max(material.alpha, world.alpha_sampled), vec3(1.0), 1.0).r;
      world_shading.mirrored = world_mirrored(material, surface, mirror_ws, albedo) / max(whole, 1e-4);
    }
#endif
    return vec3(0.0);
  }
  vec3 diffuse = material.diffuse * material.occlusion * world_irradiance(world, surface.normal_ws);
#if defined(USE_MULTISCATTER)
  Multiscatter multiscatter = surface.multiscatter;
  diffuse *= unreflected(multiscatter.view, material.specular_f0, material.specular_f90, multiscatter.color);
  // Its lobe is wide, so that it reflects the mean radiance around the normal.
  vec3 multiple = multiscatter.color * (multiscatter.view.missing * material.occlusion);
  return diffuse + multiple * world_irradiance(world, surface.normal_ws) +
         world_mirrored(material, surface, mirror_ws, albedo);
#elif defined(USE_SPECULAR)
  return diffuse * (1.0 - max(max(albedo.r, albedo.g), albedo.b)) + world_mirrored(material, surface, mirror_ws, albedo);
#else
  return diffuse;
#endif
}

#ifdef USE_SPECULAR
/**
 * Radiance towards the viewer from a sampled direction of the world, without occlusion. A lobe that is too narrow for the
 * sampled directions reads `world_levels` instead. The directions within a wider lobe then determine its visibility.
 * \a lobe: in this direction, 1/sr, with an alpha of at least WorldBlock::alpha_sampled.
 */
vec3 world_reflected(LightData light, MaterialData material, Surface surface, WorldShading shading, vec3 half_vector, float lobe,
                     float cos_l)
{
  vec3 fresnel = fresnel_schlick(material.specular_f0, material.specular_f90, dot(surface.view_ws, half_vector));
  lobe *= cos_l;
  vec3 specular = light.color * fresnel * (lobe * (1.0 - shading.level_share)) +
                  shading.mirrored * (light.radius_sq * lobe * shading.level_share);
#  ifdef USE_MULTISCATTER
  return light.color * smooth_brdf(material, surface, cos_l) * cos_l + specular;
#  else
  float kept = 1.0 - max(max(fresnel.r, fresnel.g), fresnel.b);
  return light.color * material.diffuse * (INV_PI * kept * cos_l) + specular;
#  endif
}
#endif
