// SPDX-License-Identifier: MIT
// Light of the world without its suns, which are lights of light_block.
#include "draw/draw_branch_lib.glsl"
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

/** 1: in a picture of one sample, the surface receives occlusion of the world's light. */
SPECIALIZATION_CONSTANT(3) const int WORLD_OCCLUSION = HAS_WORLD_OCCLUSION;

/** Parts of the world's light that arrive on surfaces that face the positive and the negative axes. */
struct WorldParts {
  vec3 positive;
  vec3 negative;
};

/** The light that arrives at \a surface, from the probes above its plane. */
WorldParts world_parts(Surface surface)
{
  if (WORLD_OCCLUSION == 0) {
    return WorldParts(vec3(1.0), vec3(1.0));
  }
  bool has_probes = branch_value(int(world.probe_count.x)) > 0;
  vec3 last = max(world.probe_count.xyz - 1.0, 0.0);
  // In cells between probes.
  vec3 place = surface.position_ws * world.probe_scale.xyz + world.probe_offset.xyz;
  vec3 normal = has_probes ? surface.geometric_normal_ws : vec3(0.0);
  // Above the surface, between probes of which some count also if others are in its plane.
  vec3 above = clamp(place + 0.2 * normal, vec3(0.0), last);
  vec3 low = clamp(floor(above), vec3(0.0), max(last - 1.0, 0.0));
  vec3 share = above - low;
  ivec3 stride = 2 * ivec3(1, int(world.probe_count.x), int(world.probe_count.x * world.probe_count.y));
  int first = int(low.x) * stride.x + int(low.y) * stride.y + int(low.z) * stride.z;
  // Without probes, all light arrives.
  const float whole = 1e-12;
  WorldParts sum = WorldParts(vec3(whole), vec3(whole));
  float weights = whole;
  int corner = has_probes ? 0 : 7;
  // The test is at the end as in lights_radiance.
  do {
    ivec3 side = ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
    vec3 near = mix(1.0 - share, share, vec3(side));
    int probe = has_probes ? first + side.x * stride.x + side.y * stride.y + side.z * stride.z : 0;
    float height = dot(normal, low + vec3(side) - place);
    float weight = near.x * near.y * near.z * world_probe_weight(height) * world.probes[probe].w;
    sum.positive += weight * world.probes[probe].xyz;
    sum.negative += weight * world.probes[probe + 1].xyz;
    weights += weight;
  } while (++corner < 8);
  sum.positive /= weights;
  sum.negative /= weights;
  // The probes hold square roots, so that those beyond a wall add little to dark places.
  return WorldParts(sum.positive * sum.positive, sum.negative * sum.negative);
}

/**
 * Part of the world's light from around the unit vector \a direction that arrives at \a surface. Probes see the surface itself
 * block the light from below its plane, of which it has none: the arriving part is divided by the part that a plane leaves.
 */
float world_arriving(WorldParts parts, Surface surface, vec3 direction)
{
  vec3 is_positive = step(0.0, direction);
  // The light on a surface is between those on surfaces that face the axes (McTaggart 2004).
  vec3 weight = direction * direction * mix(world.whole_negative.xyz, world.whole_positive.xyz, is_positive);
  vec3 above = 0.5 + 0.5 * surface.geometric_normal_ws * (2.0 * is_positive - 1.0);
  float whole = dot(weight, above);
  float arriving = dot(weight, mix(parts.negative, parts.positive, is_positive));
  return arriving < whole ? arriving / whole : 1.0;
}

/** Irradiance / π of the world's light that arrives at \a surface. */
vec3 world_diffuse(WorldParts parts, Surface surface)
{
  return world_irradiance(world, surface.normal_ws) * world_arriving(parts, surface, surface.normal_ws);
}

#ifdef USE_TRANSMISSION
/** Part of the mirrored world that the picture does not hide. \see mirror_part */
float mirror_seen = 1.0;
#endif

#ifdef USE_SPECULAR
/** Alpha of the first layer: the sum of world_mirror_weight over the sampled directions of the picture, divided by the number of samples. */
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

/** The unit vector to the viewer, mirrored at the unit vector \a normal_ws. */
vec3 mirrored_view(Surface surface, vec3 normal_ws)
{
  return 2.0 * dot(normal_ws, surface.view_ws) * normal_ws - surface.view_ws;
}

/**
 * Specular radiance of the world towards the viewer without occlusion, by the split-sum approximation (Karis 2013): the
 * mean radiance over the lobe, times the \a albedo of the lobe. \a normal_ws: at which the view is mirrored.
 */
vec3 world_mirrored(MaterialData material, Surface surface, vec3 normal_ws, vec3 albedo)
{
  vec3 mirrored = mirrored_view(surface, normal_ws);
  // The dominant direction of a rough lobe is closer to the normal (Lagarde and de Rousiers 2014, 4.9.3).
  float lean = (1.0 - material.alpha) * (sqrt(max(1.0 - material.alpha, 0.0)) + material.alpha);
#  ifdef USE_TRANSMISSION
  albedo *= mirror_seen;
#  endif
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
  /** Specular radiance from `world_levels`. */
  vec3 mirrored;
  /**
   * Factors of the visibility in the middle of the lobe, divided by the mean over the samples of the sums of world_mirror_weight,
   * and around it, divided by the albedo of a lobe of `alpha_sampled` with Fresnel terms of 1.
   */
  float inner;
  float outer;
  /** Unit vector to the world. */
  vec3 direction_ws;
  /** Fraction of the specular light that comes from `world_levels`. */
  float level_share;
};

/** Set by the last call of world_light. */
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
  if (branch_value(world.sample_count) > 0) {
#ifdef USE_SPECULAR
    world_shading.level_share = 1.0 - smoothstep(0.7, 1.0, material.alpha / world.alpha_sampled);
    world_shading.mirrored = vec3(0.0);
    world_shading.inner = world_shading.outer = 0.0;
    world_shading.direction_ws = mirrored_view(surface, mirror_ws);
    if (world_shading.level_share > 0.0) {
      float weights = textureLod(world_levels, vec3(equirectangular(world_shading.direction_ws), 0.0), 0.0).a;
      float whole = albedo_of(surface, max(material.alpha, world.alpha_sampled), vec3(1.0), 1.0).r;
      // The part of a GGX lobe that is farther from its middle than the mean of world_mirror_weight in a world of one radiance.
      float alpha_sq = material.alpha * material.alpha;
      float outside = alpha_sq / (alpha_sq + world.alpha_sampled * world.alpha_sampled / 8.0);
      // Near the horizon, some of the directions around the mirrored one have no light, because they are below the surface.
      float height = dot(surface.normal_ws, world_shading.direction_ws) / (1.414 * world.alpha_sampled);
      outside = mix(1.0, outside, smoothstep(0.25, 1.0, height));
      world_shading.mirrored = world_mirrored(material, surface, mirror_ws, albedo);
      world_shading.inner = (1.0 - outside) / max(weights, 1e-6);
      world_shading.outer = outside / max(whole, 1e-4);
    }
#endif
    return vec3(0.0);
  }
  WorldParts parts = world_parts(surface);
  vec3 irradiance = world_diffuse(parts, surface);
  vec3 diffuse = material.diffuse * material.occlusion * irradiance;
#if defined(USE_MULTISCATTER)
  Multiscatter multiscatter = surface.multiscatter;
  diffuse *= unreflected(multiscatter.view, material.specular_f0, material.specular_f90, multiscatter.color);
  // Its lobe is wide, so that it reflects the mean radiance around the normal.
  vec3 multiple = multiscatter.color * (multiscatter.view.missing * material.occlusion);
  return diffuse + multiple * irradiance +
         world_arriving(parts, surface, mirrored_view(surface, mirror_ws)) * world_mirrored(material, surface, mirror_ws, albedo);
#elif defined(USE_SPECULAR)
  return diffuse * (1.0 - max(max(albedo.r, albedo.g), albedo.b)) +
         world_arriving(parts, surface, mirrored_view(surface, mirror_ws)) * world_mirrored(material, surface, mirror_ws, albedo);
#else
  return diffuse;
#endif
}

#ifdef USE_SPECULAR
/** Weight of the visibility of a sampled direction for the mirrored one. */
float mirror_weight(LightData light, WorldShading shading)
{
  float reach_sq = world_mirror_reach_sq(light.radius_sq / float(max(world.sample_count, 1)));
  vec3 apart = light.forward_ws + shading.direction_ws;
  return world_mirror_weight(dot(apart, apart) / max(reach_sq, 1e-20));
}

/**
 * Radiance towards the viewer from a sampled direction of the world, without occlusion. A lobe that is too narrow for the
 * sampled directions reads `world_levels` instead. The directions around the mirrored one and those in a wider lobe then determine its
 * visibility.
 * \a lobe: in this direction, 1/sr, with an alpha of at least WorldBlock::alpha_sampled.
 */
vec3 world_reflected(LightData light, MaterialData material, Surface surface, WorldShading shading, vec3 half_vector, float lobe,
                     float cos_l)
{
  vec3 fresnel = fresnel_schlick(material.specular_f0, material.specular_f90, dot(surface.view_ws, half_vector));
  lobe *= cos_l;
  float seen = shading.inner * mirror_weight(light, shading) + shading.outer * light.radius_sq * lobe;
  vec3 specular = light.color * fresnel * (lobe * (1.0 - shading.level_share)) +
                  shading.mirrored * (seen * shading.level_share);
#  ifdef USE_MULTISCATTER
  return light.color * smooth_brdf(material, surface, cos_l) * cos_l + specular;
#  else
  float kept = 1.0 - max(max(fresnel.r, fresnel.g), fresnel.b);
  return light.color * material.diffuse * (INV_PI * kept * cos_l) + specular;
#  endif
}
#endif
