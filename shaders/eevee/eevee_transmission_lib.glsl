// SPDX-License-Identifier: MIT
// For fragment shaders: light from behind a surface that passes it (KHR_materials_transmission, KHR_materials_volume).
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_bodies_lib.glsl"
#include "eevee/eevee_full_material_lib.glsl"
#include "eevee/eevee_layer_block_lib.glsl"
#include "eevee/eevee_ltc_lib.glsl"
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_area_shared.h"

INTERPOLATED(18, vec4, surface_transmission_uvs, grid_transmission_uvs)
layout(location = 12) flat in mat3 surface_object_from_world;

layout(binding = TRANSMISSION_SLOT) uniform sampler2D transmission_texture;
layout(binding = THICKNESS_SLOT) uniform sampler2D thickness_texture;
/** The picture without the surfaces that transmit light, premultiplied by alpha. A texel of a mip level is a mean. */
layout(binding = BEHIND_SLOT) uniform sampler2D behind;

/** A mip level of `behind` under a cubic B-spline, which hides the squares of coarse levels, by four bilinear lookups. */
vec4 smooth_behind(vec2 texco, float level)
{
  vec2 size = vec2(textureSize(behind, int(level)));
  vec2 texel = texco * size - 0.5;
  vec2 low_texel = floor(texel);
  vec2 t = texel - low_texel;
  vec2 s = 1.0 - t;
  // Weights of the texels -1 and 0, and of -1 and 2 alone, relative to low_texel.
  vec2 low = (s * s * s + 4.0 - 3.0 * t * t * (2.0 - t)) / 6.0;
  vec2 high = 1.0 - low;
  vec2 at_low = (low_texel + 0.5 - s * s * s / (6.0 * low)) / size;
  vec2 at_high = (low_texel + 1.5 + t * t * t / (6.0 * high)) / size;
  vec4 bottom = low.x * textureLod(behind, at_low, level) + high.x * textureLod(behind, vec2(at_high.x, at_low.y), level);
  vec4 top = low.x * textureLod(behind, vec2(at_low.x, at_high.y), level) + high.x * textureLod(behind, at_high, level);
  return low.y * bottom + high.y * top;
}

/** Radiance and alpha of the picture behind. \a texco: in [0, 1]. \a level: at least 0; at 0 it is not blurred. */
vec4 behind_at(vec2 texco, float level)
{
  level = min(level, float(textureQueryLevels(behind) - 1));
  float fine = floor(level);
  vec4 radiance = fine > 0.0 ? smooth_behind(texco, fine) : textureLod(behind, texco, 0.0);
  return level > fine ? mix(radiance, smooth_behind(texco, fine + 1.0), level - fine) : radiance;
}

/** The light of a surface that comes from behind it. */
struct Transmission {
  /** Part of the light in the base that passes instead of being scattered. */
  float part;
  /** Part of the radiance behind the base that the base passes, as if no layer lay over it. */
  vec3 passed;
  /** Radiance that surfaces behind this one mirror, as much as the base passes of it. */
  vec3 mirrored;
  /** Radiance towards the viewer, W/(sr m²), and alpha of the picture behind. */
  vec4 behind;
};

/** Factor of the Fresnel reflectance of a dielectric by which a material reflects: glTF lets a material reflect less than its index says. */
float reflection_scale(FullMaterialData full, float ior)
{
  float f0 = (ior - 1.0) / (ior + 1.0);
  vec3 color = full.specular_color;
  return min(0.04 * full.specular * max(max(color.r, color.g), color.b) / max(f0 * f0, 1e-6), 1.0);
}

/**
 * 1 if a ray of mirrored light from a surface meets neither a surface that transmits light nor one in the picture; otherwise 0.
 * \a normal_ws: on the ray's side.
 */
float sky_part(vec3 position_ws, vec3 direction_ws, vec3 normal_ws, bool is_front)
{
  // The ray must not meet the side of its own surface that it leaves.
  Ray ray = Ray(position_ws, direction_ws, !is_front);
  if (dot(direction_ws, normal_ws) <= 0.0 || trace_bodies(ray).distance_m < NO_HIT) {
    return 0.0;
  }
  bool has_samples = view.texture_lod_bias < 0.0;
  return march_behind(ray, NO_HIT, has_samples ? 0.9 * random_pair(65u).y : 0.0).is_met ? 0.0 : 1.0;
}

/** The light's way behind the nearest surface. */
struct Way {
  Ray ray;
  /** The part of the light that its surfaces and its media pass. */
  vec3 left;
  /** Radiance of the world that its surfaces mirror, multiplied by the part that reaches the nearest surface. */
  vec3 mirrored;
  /** Within a body of this material. */
  bool is_inside;
  uint material;
  /** No surface has changed its direction, so that it ends in the pixel of the surface. */
  bool is_straight;
};

/**
 * Let the light pass a surface of a body. \a normal_ws: towards the ray's origin. \a roughness: 0 unless the picture has several
 * samples. Each sample then meets another microfacet. \return the share that microfacets do not shadow; 0 if no light passes
 */
float refracted(inout Way way, vec3 normal_ws, bool is_front, float ior, float roughness, uint number)
{
  float alpha = roughness * roughness;
  vec3 facet_ws = normal_ws;
  if (alpha > ALPHA_MIN) {
    facet_ws = visible_microfacet(normal_ws, -way.ray.direction, alpha, random_pair(number));
  }
  vec3 direction = refract(way.ray.direction, facet_ws, is_front ? 1.0 / ior : ior);
  float cos_l = -dot(direction, normal_ws);
  way.is_straight = false;
  way.is_inside = is_front;
  way.ray.direction = direction;
  way.ray.left_front = is_front;
  // 0: total reflection.
  return cos_l <= 0.0 ? 0.0 : alpha > ALPHA_MIN ? 2.0 * cos_l * ggx_masking_over_2cos(cos_l, alpha) : 1.0;
}

/** The part of the entering light that a surface passes, and its roughness. The part that the surface reflects is not in it. */
struct Passage {
  vec3 left;
  float roughness;
};

/**
 * The passage of a surface behind the nearest one, by the factors of its material. With a texture of the metallic factor, the surface counts
 * as not metallic, because the texture is not read.
 */
Passage passage_of(uint material)
{
  FullMaterialData full = full_materials[material];
  float metallic = (full.inputs & INPUT_METALLIC_ROUGHNESS) != 0u ? 0.0 : full.metallic;
  return Passage(layer_materials[material].transmission * (1.0 - metallic) * full.base_color, full.roughness);
}

/**
 * Radiance and alpha at the end of a way. \a nearest: of the nearest surface, whose textures hold for the other surfaces of its material.
 * \a slab_m: length of the way in a body whose back is not found.
 */
vec4 radiance_behind(inout Way way, Passage nearest, float slab_m, float level, bool has_samples)
{
  vec2 size = vec2(textureSize(behind, 0));
  vec2 texco = gl_FragCoord.xy / size;
  float seen_depth = texelFetch(behind_depth, ivec2(gl_FragCoord.xy), 0).r;
  float start = has_samples ? 0.9 * random_pair(66u).y : 0.0;
  for (int i = 1; i <= BODY_SURFACES_MAX; i++) {
    BodyHit hit = trace_bodies(way.ray);
    bool is_slab = way.is_inside && (hit.distance_m >= NO_HIT || hit.is_front);
    vec3 absorption = layer_materials[way.material].absorption;
    if (way.is_straight) {
      vec4 place = view.clip_from_world * vec4(way.ray.origin + hit.distance_m * way.ray.direction, 1.0);
      if (hit.distance_m >= NO_HIT || place.z < seen_depth * place.w) {
        return behind_at(texco, level);
      }
    }
    else {
      float length_m = is_slab ? slab_m : hit.distance_m;
      PictureHit seen = march_behind(way.ray, length_m, start);
      if (seen.is_met) {
        way.left *= way.is_inside ? beer_lambert(absorption, seen.distance_m) : vec3(1.0);
        return behind_at(seen.texco, level);
      }
      if (is_slab) {
        way.left *= beer_lambert(absorption, slab_m);
        if (seen.texco.x >= 0.0) {
          return behind_at(seen.texco, level);
        }
        vec4 exit = view.clip_from_world * vec4(way.ray.origin + slab_m * way.ray.direction, 1.0);
        return behind_at(exit.w > 0.0 ? clamp(0.5 * exit.xy / exit.w + 0.5, vec2(0.0), vec2(1.0)) : texco, level);
      }
      if (hit.distance_m >= NO_HIT) {
        return background_radiance(way.ray.direction);
      }
    }
    LayerData layer = layer_materials[hit.material];
    FullMaterialData full = full_materials[hit.material];
    way.left *= way.is_inside ? beer_lambert(absorption, hit.distance_m) : vec3(1.0);
    way.ray.origin += hit.distance_m * way.ray.direction;
    bool is_nearest = hit.material == surface_material;
    Passage passage = is_nearest ? nearest : passage_of(hit.material);
    // The light has not entered where a texture of the thickness is 0.
    bool is_body = layer.thickness > 0.0 && (hit.is_front || way.is_inside || !is_nearest);
    float cos_i = -dot(hit.normal_ws, way.ray.direction);
    float ratio = hit.is_front || !is_body ? 1.0 / layer.ior : layer.ior;
    float reflectance = reflection_scale(full, layer.ior) * dielectric_reflectance(cos_i, ratio);
#ifdef USE_WORLD
    if (hit.is_front && reflectance > 0.01) {
      vec3 mirrored_ws = reflect(way.ray.direction, hit.normal_ws);
      vec3 sky = world_radiance(mirrored_ws, passage.roughness * passage.roughness);
      way.mirrored += way.left * sky * (reflectance * sky_part(way.ray.origin, mirrored_ws, hit.normal_ws, true));
    }
#endif
    way.left *= (1.0 - reflectance) * passage.left;
    if (is_body) {
      way.left *= refracted(way, hit.normal_ws, hit.is_front, layer.ior, has_samples ? passage.roughness : 0.0, uint(i));
      way.material = hit.material;
    }
    else {
      way.ray.left_front = hit.is_front;
    }
    if (max(max(way.left.r, way.left.g), way.left.b) <= 0.0) {
      return vec4(0.0, 0.0, 0.0, 1.0);
    }
  }
  return vec4(0.0, 0.0, 0.0, 1.0);
}

/**
 * \a material: with the diffuse albedo of a surface without transmission. \a roughness: perceptual, of the blur of the picture behind.
 */
Transmission make_transmission(MaterialData material, Surface surface, float roughness)
{
  LayerData data = layer_materials[surface_material];
  Transmission result;
  result.part = data.transmission;
  if (has_input(INPUT_TRANSMISSION)) {
    result.part *= texture(transmission_texture, surface_transmission_uvs.xy, view.texture_lod_bias).r;
  }
  float thickness = data.thickness;
  if (has_input(INPUT_THICKNESS)) {
    thickness *= texture(thickness_texture, surface_transmission_uvs.zw, view.texture_lod_bias).g;
  }
#ifdef USE_MULTISCATTER
  float entering = unreflected(surface.multiscatter.view, material.specular_f0, material.specular_f90,
                               surface.multiscatter.color);
#else
  float cos_v = clamp(dot(surface.normal_ws, surface.view_ws), 1e-4, 1.0);
  vec4 table = textureLod(ltc_table, ltc_texco(material.alpha, cos_v) + vec2(0.5, 0.0), 0.0);
  vec3 albedo = specular_albedo(table, material.specular_f0, material.specular_f90);
  float entering = clamp(1.0 - max(max(albedo.r, albedo.g), albedo.b), 0.0, 1.0);
#endif
  Way way = Way(Ray(surface.position_ws, -surface.view_ws, gl_FrontFacing), vec3(result.part * entering) * material.diffuse, vec3(0.0), false,
                surface_material, true);
  // The bias is 0 for one sample.
  bool has_samples = view.texture_lod_bias < 0.0;
  bool is_body = thickness > 0.0;
  float slab_m = 0.0;
  if (is_body) {
    way.left *= refracted(way, surface.normal_ws, gl_FrontFacing, surface_lens.z, has_samples ? roughness : 0.0, 0u);
    // A way of 1 m in world space, measured in object space. A matrix that flattens the object has no inverse.
    float shrunk = length(surface_object_from_world * way.ray.direction);
    slab_m = shrunk > 1e-9 && shrunk < 1e9 ? thickness / shrunk : 0.0;
  }
  // Microfacets blur the picture behind a body, over the samples.
  float level = is_body && has_samples ? 0.0 : transmission_level(roughness, surface_lens.z, float(textureSize(behind, 0).y));
  result.behind = radiance_behind(way, Passage(result.part * material.diffuse, roughness), slab_m, level, has_samples);
  result.passed = way.left;
  result.mirrored = way.mirrored;
  return result;
}

/**
 * Part of the world's mirrored light that nothing hides: neither a surface that transmits light nor one in the picture. 0 or 1, in each
 * sample for another microfacet.
 */
float mirror_part(Surface surface, float roughness)
{
  bool has_samples = view.texture_lod_bias < 0.0;
  float alpha = roughness * roughness;
  vec3 facet_ws = surface.normal_ws;
  if (alpha > ALPHA_MIN) {
    // A mirrored direction would be that of the whole lobe.
    if (!has_samples) {
      return 1.0;
    }
    facet_ws = visible_microfacet(surface.normal_ws, surface.view_ws, alpha, random_pair(64u));
  }
  return sky_part(surface.position_ws, reflect(-surface.view_ws, facet_ws), surface.normal_ws, gl_FrontFacing);
}
