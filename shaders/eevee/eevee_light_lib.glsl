// SPDX-License-Identifier: MIT
// Direct lighting of a surface.
#include "draw/draw_branch_lib.glsl"
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_surface_lib.glsl"
#ifdef USE_SPECULAR
#  include "shared/eevee_area_shared.h"
#endif
#include "shared/eevee_bsdf_shared.h"
#include "shared/eevee_light_shared.h"
#include "shared/eevee_material_shared.h"
#include "shared/slots_shared.h"
#if defined(USE_SHADOW_CUBE) || defined(USE_SHADOW_MAP)
#  define USE_SHADOW
#  include "eevee/eevee_shadow_lib.glsl"
#endif
#ifdef USE_LAMP_SHAPE
#  include "eevee/eevee_lamp_shape_lib.glsl"
/** 1: lamps are shaded as points, and may have highlights as a whole. \see eevee_lamp_highlight_lib.glsl */
SPECIALIZATION_CONSTANT(2) const int LAMP_HIGHLIGHTS = HAS_LAMP_HIGHLIGHTS;
#  ifdef USE_SPECULAR
#    define USE_LAMP_HIGHLIGHT
#  endif
#endif
#ifdef USE_MULTISCATTER
#  include "eevee/eevee_multiscatter_lib.glsl"
#endif
#ifdef USE_WORLD
#  include "eevee/eevee_world_lib.glsl"
#endif
#ifdef USE_LAYERS
#  include "eevee/eevee_layered_lib.glsl"
#endif
#ifdef USE_SHADOW_ESM
#  include "eevee/eevee_esm_lib.glsl"
#endif

#ifdef USE_LIGHT_CLUSTERS
#  include "eevee/eevee_light_cluster_lib.glsl"
#else
layout(std140, binding = LIGHT_BLOCK_SLOT) uniform light_block
{
  LightBlock light_data;
};
#endif

LightData light_at(int index)
{
#ifdef USE_LIGHT_CLUSTERS
  vec4 a = light_texel(index, 0);
  vec4 b = light_texel(index, 1);
  vec4 c = light_texel(index, 2);
  vec4 d = light_texel(index, 3);
  return LightData(a.xyz, int(a.w), b.xyz, b.w, c.xyz, c.w, d.x, d.y, int(d.z), int(d.w));
#else
  return light_data.lights[index];
#endif
}

#ifdef USE_LAMP_SHAPE
LightShape shape_at(int index)
{
#ifdef USE_LIGHT_CLUSTERS
  vec4 a = light_texel(index, 4);
  vec4 b = light_texel(index, 5);
  vec4 c = light_texel(index, 6);
  return LightShape(a.xyz, a.w, b.xyz, b.w, c.xyz, c.w);
#else
  return light_shapes.shapes[index];
#endif
}
#endif

// Which lights a loop visits. Callers pass a constant, so that the compiler removes the lookups of shadows that these lights cannot
// have. llvmpipe evaluates all code that is left, whatever its conditions.
#define LIGHTS_ALL 0
/** The first LightBlock::cube_light_count lights: their shadows are cubes or exponential, if they have any. */
#define LIGHTS_WITH_CUBES 1
/** The other lights: their shadows are maps or exponential, if they have any. */
#define LIGHTS_WITH_MAPS 2

/**
 * Visibility of a light, 1 lit and 0 in shadow. \a lights: LIGHTS_…. \a to_light: unit vector. \a is_receiver:
 * \see receiver_visibility.
 */
float light_visibility(LightData light, const int lights, Surface surface, vec3 to_light, const bool is_receiver)
{
#ifdef USE_SHADOW_CUBE
  if (lights != LIGHTS_WITH_MAPS && light.shadow_kind == SHADOW_CUBE) {
    return shadow_cube_visibility(cube_receiver(light.shadow_index, surface, light, to_light), surface, vec3(0.0), 0.0, is_receiver);
  }
#endif
#ifdef USE_SHADOW_MAP
  if (lights != LIGHTS_WITH_CUBES && light.shadow_kind == SHADOW_MAP) {
    return shadow_map_visibility(light.shadow_index, surface, to_light, vec3(0.0), 0.0, is_receiver);
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

#if defined(USE_LAMP_SHAPE) && defined(USE_SHADOW)
#  include "eevee/eevee_penumbra_lib.glsl"
#endif

#ifdef USE_LAYERS
/** GGX lobe of the base without Fresnel, 1/sr. \a alphas: those of layers.base_lobe, or larger ones for a lamp with a size. */
float base_specular_lobe(vec2 alphas, Surface surface, vec3 to_light, float cos_l, vec3 half_vector)
{
  mat3 lobe_from_world = layers.base_lobe.lobe_from_world;
  vec3 light = vec3((lobe_from_world * to_light).xy, cos_l);
  vec3 viewer = vec3((lobe_from_world * surface.view_ws).xy, max(dot(surface.normal_ws, surface.view_ws), 1e-4));
  vec3 middle = vec3((lobe_from_world * half_vector).xy, clamp(dot(surface.normal_ws, half_vector), 0.0, 1.0));
  return anisotropic_ggx_lobe(light, viewer, middle, alphas);
}
#endif

#ifdef USE_SPECULAR
/** Alpha for the mean of the lobes under a sample's share of a pixel. \a change_sq: \see filtered_alpha */
float sampled_alpha(float alpha, Surface surface, float change_sq)
{
  // n^-2 for n samples, as the bias of textures is -0.5 log2(n). A sample has 1/n of the area of a pixel, and so of the variance.
  // The samples beside it see a part of that variance: with 1/n alone, the error of four and more is larger than without a filter.
  float share = exp2(4.0 * view.texture_lod_bias);
  return filtered_alpha(alpha, change_sq, dot(surface.normal_ws, surface.view_ws), share);
}

/** GGX lobe without Fresnel, 1/sr. \a is_base: that of the base of the material. \a alpha_min: least alpha for this light. */
float specular_lobe(float alpha, float alpha_min, Surface surface, vec3 to_light, float cos_l, vec3 half_vector, const bool is_base)
{
#ifdef USE_LAYERS
  if (is_base) {
    return base_specular_lobe(max(layers.base_lobe.alphas, vec2(alpha_min)), surface, to_light, cos_l, half_vector);
  }
#endif
  float cos_v = max(dot(surface.normal_ws, surface.view_ws), 1e-4);
  float cos_h = clamp(dot(surface.normal_ws, half_vector), 0.0, 1.0);
  return ggx_lobe(cos_l, cos_v, cos_h, max(alpha, alpha_min));
}
#endif

/**
 * BRDF towards the viewer, 1/sr, times the cosine of the incident light. \see specular_lobe. \a specular_part: factor of the specular
 * lobe.
 */
vec3 reflected(MaterialData material, float alpha_min, float specular_part, Surface surface, vec3 to_light, float cos_l,
               const bool is_base)
{
#ifdef USE_SPECULAR
  vec3 half_vector = direction_or_zero(to_light + surface.view_ws);
  vec3 fresnel = fresnel_schlick(material.specular_f0, material.specular_f90, dot(surface.view_ws, half_vector));
  float lobe = specular_lobe(material.alpha, alpha_min, surface, to_light, cos_l, half_vector, is_base);
  vec3 specular = fresnel * (lobe * specular_part);
#  ifdef USE_MULTISCATTER
  return (smooth_brdf(material, surface, cos_l) + specular) * cos_l;
#  else
  float kept = 1.0 - max(max(fresnel.r, fresnel.g), fresnel.b);
  return (material.diffuse * (INV_PI * kept) + specular) * cos_l;
#  endif
#else
  return material.diffuse * (INV_PI * cos_l);
#endif
}

#if defined(USE_WORLD) && defined(USE_SPECULAR)
#  include "eevee/eevee_world_sun_lib.glsl"
#endif

#ifndef USE_MULTISCATTER
/** Diffuse radiance for an irradiance of 1 from \a to_light, reduced by the fraction that is reflected specularly. */
vec3 diffuse_share(MaterialData material, Surface surface, vec3 to_light)
{
#ifdef USE_SPECULAR
  vec3 half_vector = to_light + surface.view_ws;
  float length_sq = dot(half_vector, half_vector);
  half_vector *= length_sq > 0.0 ? inversesqrt(length_sq) : 0.0;
  vec3 fresnel = fresnel_schlick(material.specular_f0, material.specular_f90, dot(surface.view_ws, half_vector));
  return material.diffuse * (INV_PI * (1.0 - max(max(fresnel.r, fresnel.g), fresnel.b)));
#else
  return material.diffuse * INV_PI;
#endif
}
#endif

/** The light from the centre of a lamp. */
struct CenterLight {
  /** Unit vector to the lamp; the zero vector at the position of the lamp. */
  vec3 to_light;
  /** Square of the distance to the lamp, m²; 1 for suns. */
  float distance_sq;
  /** Irradiance for a light colour of 1 on a surface that faces the lamp. */
  float irradiance;
};

CenterLight center_light(LightData light, int index, const int lights, Surface surface)
{
  CenterLight center = CenterLight(-light.forward_ws, 1.0, 1.0);
#ifdef USE_PUNCTUAL
#ifdef USE_WORLD
  bool is_distant = light.kind == LIGHT_SUN || light.kind == LIGHT_WORLD;
#else
  bool is_distant = light.kind == LIGHT_SUN;
#endif
  if (lights == LIGHTS_WITH_CUBES || !is_distant) {
    vec3 vector = light.position_ws - surface.position_ws;
    center.distance_sq = dot(vector, vector);
    // At the position of the lamp the direction is undefined. The zero vector gives no light.
    center.to_light = center.distance_sq > 0.0 ? vector * inversesqrt(center.distance_sq) : vec3(0.0);
    center.irradiance = distance_falloff(center.distance_sq, light.radius_sq, light.range_inv_sq);
    if (light.kind == LIGHT_SPOT) {
#ifdef USE_LAMP_SHAPE
      LightShape shape = shape_at(index);
      float drop = elliptic_drop(-center.to_light, light.forward_ws, shape.axis_x_ws, shape.axis_y_ws);
#else
      float drop = one_minus_cos(-center.to_light, light.forward_ws);
#endif
      center.irradiance *= spot_mask(drop, light.spot_drop_outer, light.spot_inv_width);
    }
    if (lights != LIGHTS_WITH_MAPS && light.kind >= LIGHT_RECTANGLE) {
      float cosine = -dot(center.to_light, light.forward_ws);
      center.irradiance *= max(cosine, light.kind == LIGHT_SURFACE ? -cosine : 0.0);
    }
  }
#endif
  return center;
}

#ifdef USE_LAMP_SHAPE
#  include "eevee/eevee_shape_light_lib.glsl"
#endif
#ifdef USE_LAMP_HIGHLIGHT
#  include "eevee/eevee_lamp_highlight_lib.glsl"
#endif

#ifdef HAS_SURFACE_POINTS
/**
 * The light of emissive surfaces in one sample. The sum over all points has no shadows. The points that have shadows give the part of it
 * that arrives: with too few points the places of the points show, and lookups of shadows take most of the time.
 */
struct SurfaceLight {
  /** Radiance towards the viewer of all points without shadows, W/(sr m²). */
  vec3 radiance;
  /** Sum over the points that have shadows, as if they had none. */
  float shadowless;
  /** The same sum with their shadows. */
  float arriving;
};
SurfaceLight surface_light;
#endif

/**
 * Radiance towards the viewer from the light \a index, shaded as a point at its centre, W/(sr m²). \a has_shadow: false for points that
 * never have one. With HAS_SURFACE_POINTS, points of emissive surfaces are added to surface_light instead.
 */
vec3 point_radiance(int index, const int lights, const bool has_shadow, MaterialData material, Surface surface)
{
  LightData light = light_at(index);
  if (lights != LIGHTS_WITH_CUBES && light.kind == LIGHT_HEMI) {
    float irradiance = material.occlusion * hemi_irradiance(-dot(surface.normal_ws, light.forward_ws));
#ifdef USE_LAYERS
    material.diffuse = layered(material.diffuse, layers.sheen_albedo, vec3(0.0));
#endif
    return material.diffuse * light.color * (INV_PI * irradiance);
  }
  CenterLight center = center_light(light, index, lights, surface);
  float cos_l = dot(surface.normal_ws, center.to_light);
#ifdef USE_LAYERS
  MaterialData coat = layers.coat_material;
  float cos_coat = dot(layers.coat_surface.normal_ws, center.to_light);
  bool is_turned_away = max(cos_l, cos_coat) <= 0.0;
  cos_l = max(cos_l, 0.0);
  cos_coat = max(cos_coat, 0.0);
#else
  bool is_turned_away = cos_l <= 0.0;
#endif
  if (is_turned_away || center.irradiance <= 0.0) {
    return vec3(0.0);
  }
#ifdef USE_FULL_MATERIAL
  // A surface receives no light from behind, whatever its normal texture.
  if (dot(surface.geometric_normal_ws, center.to_light) <= 0.0) {
    return vec3(0.0);
  }
  material.diffuse *= bump_visibility(surface.smooth_normal_ws, surface.normal_ws, center.to_light);
#endif
  float visibility = has_shadow ? light_visibility(light, lights, surface, center.to_light, true) : 1.0;
#ifdef HAS_SURFACE_POINTS
  bool is_surface = lights != LIGHTS_WITH_MAPS && light.kind == LIGHT_SURFACE;
  float surface_visibility = visibility;
  visibility = is_surface ? 1.0 : visibility;
#endif
  if (visibility <= 0.0) {
    return vec3(0.0);
  }
  float alpha_min = 0.0;
#if defined(USE_SPECULAR) && defined(USE_PUNCTUAL)
  if (lights != LIGHTS_WITH_MAPS && light.kind == LIGHT_SURFACE) {
    // A lobe of the roughness alpha has a solid angle of about 4 π alpha².
    alpha_min = min(sqrt(0.25 * SURFACE_LOBE_POINTS * light.radius_sq / center.distance_sq), 1.0);
  }
#endif
  float points_share = 0.0;
#if defined(USE_WORLD) && defined(USE_SPECULAR)
  if (lights != LIGHTS_WITH_CUBES && light.kind == LIGHT_WORLD) {
    vec3 half_vector = direction_or_zero(center.to_light + surface.view_ws);
    float lobe = specular_lobe(material.alpha, world.alpha_sampled, surface, center.to_light, cos_l, half_vector, true);
    vec3 radiance = world_reflected(light, material, surface, world_shading, half_vector, lobe, cos_l);
#ifdef USE_LAYERS
    lobe = specular_lobe(coat.alpha, world.alpha_sampled, layers.coat_surface, center.to_light, cos_coat, half_vector, false);
    radiance = layered(radiance, light.color * cos_l * sheen_brdf(surface, center.to_light, cos_l),
                       world_reflected(light, coat, layers.coat_surface, layers.coat_world, half_vector, lobe, cos_coat));
#endif
    return visibility * radiance;
  }
  if (light.kind == LIGHT_SUN) {
    alpha_min = sqrt(light.radius_sq);
  }
  points_share = sun_points_share(light, index, material.alpha);
  vec3 highlight = sun_highlight(light, index, material, surface, points_share, true);
#endif
#ifdef USE_LAMP_HIGHLIGHT
  vec3 lamp_radiance = vec3(0.0);
  float lamp_share = 0.0;
  HighlightLamp lamp;
  if (LAMP_HIGHLIGHTS != 0) {
    lamp = highlight_lamp(light, index, lights, surface);
    lamp_share = whole_lamp_share(lamp, material.alpha);
#  ifdef USE_LAYERS
    if (layers.base_lobe.alphas.x > layers.base_lobe.alphas.y) {
      lamp_share = 0.0;
      alpha_min = max(alpha_min, lamp.alpha_points * ANISOTROPIC_ALPHA_PART);
    }
#  endif
    lamp_radiance = lamp_highlight(lamp, material, surface, base_shading, lamp_share, cos_l);
    points_share += lamp_share;
  }
#endif
  vec3 brdf_cos = reflected(material, alpha_min, 1.0 - points_share, surface, center.to_light, cos_l, true);
#ifdef USE_LAYERS
  float coat_share = 0.0;
#  if defined(USE_WORLD) && defined(USE_SPECULAR)
  coat_share = sun_points_share(light, index, coat.alpha);
  highlight = layered(highlight, vec3(0.0), sun_highlight(light, index, coat, layers.coat_surface, coat_share, false));
#  endif
#  ifdef USE_LAMP_HIGHLIGHT
  if (LAMP_HIGHLIGHTS != 0) {
    lamp_share = whole_lamp_share(lamp, coat.alpha);
    lamp_radiance = layered(lamp_radiance, vec3(0.0),
                            lamp_highlight(lamp, coat, layers.coat_surface, coat_shading, lamp_share, cos_coat));
    coat_share += lamp_share;
  }
#  endif
  brdf_cos = layered(brdf_cos, cos_l * sheen_brdf(surface, center.to_light, cos_l),
                     reflected(coat, alpha_min, 1.0 - coat_share, layers.coat_surface, center.to_light, cos_coat, false));
#endif
  vec3 radiance = light.color * (center.irradiance * visibility) * brdf_cos;
#if defined(USE_WORLD) && defined(USE_SPECULAR)
  radiance += visibility * highlight;
#endif
#ifdef USE_LAMP_HIGHLIGHT
  radiance += LAMP_HIGHLIGHTS != 0 ? visibility * lamp_radiance : vec3(0.0);
#endif
#ifdef HAS_SURFACE_POINTS
  if (is_surface) {
    surface_light.radiance += has_shadow ? vec3(0.0) : radiance;
    float sum = has_shadow ? radiance.r + radiance.g + radiance.b : 0.0;
    surface_light.shadowless += sum;
    surface_light.arriving += sum * surface_visibility;
    return vec3(0.0);
  }
#endif
  return radiance;
}

/** Index of the light number \a i of those that a loop visits. */
int light_index(int i, const int lights)
{
#ifdef USE_LIGHT_CLUSTERS
  return reaching_light(i, lights == LIGHTS_WITH_CUBES || (lights == LIGHTS_ALL && i < reaching.cube_count));
#else
  return i;
#endif
}

/**
 * Radiance towards the viewer from the lights \a first to \a end - 1, W/(sr m²): of all lights, or of those that can reach the
 * shaded point. \a lights: which these are, LIGHTS_….
 */
vec3 lights_radiance(int first, int end, const int lights, MaterialData material, Surface surface)
{
  vec3 sum = vec3(0.0);
  int i = first;
  if (i < end) {
    // The test is at the end: for a test at the start, llvmpipe evaluates the body once more and discards the result.
    do {
      int index = light_index(i, lights);
#ifdef USE_LAMP_SHAPE
      if (LAMP_HIGHLIGHTS == 0 && shape_at(index).extent > 0.0) {
        sum += shape_radiance(index, lights, material, surface);
      }
      else
#endif
      {
        sum += point_radiance(index, lights, true, material, surface);
      }
    } while (++i < end);
  }
  return sum;
}

#ifdef HAS_SURFACE_POINTS
/** Radiance towards the viewer from points of emissive surfaces, W/(sr m²), after the loops over the other lights. */
vec3 surface_points_radiance(MaterialData material, Surface surface)
{
#ifdef USE_LIGHT_CLUSTERS
  int i = clusters.first_surface_point;
  int end = i + clusters.surface_point_count;
#else
  int i = light_data.light_count;
  int end = min(i + light_data.surface_point_count, LIGHT_MAX);
#endif
  // Where nothing arrives, the others need no light.
  if (i < end && surface_light.arriving > 0.0) {
    // The test is at the end as in lights_radiance.
    do {
      point_radiance(i, LIGHTS_WITH_CUBES, false, material, surface);
    } while (++i < end);
  }
  return surface_light.radiance * (surface_light.arriving / max(surface_light.shadowless, 1e-30));
}
#endif

/** Radiance towards the viewer from all lights, W/(sr m²). */
vec3 direct_light(MaterialData material, Surface surface)
{
#ifdef USE_LAMP_SHAPE
  shade_shapes(material, surface);
#endif
#if defined(USE_WORLD) && defined(USE_LAYERS)
  vec3 coat = world_light(layers.coat_material, layers.coat_surface, layers.coat_surface.normal_ws);
  layers.coat_world = world_shading;
  vec3 base = world_light(material, surface, layers.base_lobe.bent_normal_ws);
  // The lobe of sheen is wide: its mean radiance is that of a cosine around the normal.
  bool is_sampled = branch_value(world.sample_count) > 0;
  vec3 mean = is_sampled ? vec3(0.0) : material.occlusion * world_diffuse(world_parts(surface), surface);
  vec3 sum = layered(base, layers.sheen_albedo * mean, coat);
#elif defined(USE_WORLD)
  vec3 sum = world_light(material, surface, surface.normal_ws);
#else
  vec3 sum = vec3(0.0);
#endif
#ifdef USE_LIGHT_CLUSTERS
  find_lights(surface.position_ws);
  int count = reaching.count;
  int cube_count = reaching.cube_count;
#else
  int count = branch_value(min(light_data.light_count, LIGHT_MAX));
  int cube_count = min(light_data.cube_light_count, count);
#endif
#ifdef HAS_SURFACE_POINTS
  surface_light = SurfaceLight(vec3(0.0), 0.0, 0.0);
#endif
#if defined(USE_SHADOW_CUBE) && defined(USE_SHADOW_MAP)
  sum += lights_radiance(0, cube_count, LIGHTS_WITH_CUBES, material, surface);
  sum += lights_radiance(cube_count, count, LIGHTS_WITH_MAPS, material, surface);
#else
  sum += lights_radiance(0, count, LIGHTS_ALL, material, surface);
#endif
#ifdef HAS_SURFACE_POINTS
  sum += surface_points_radiance(material, surface);
#endif
  return sum;
}
