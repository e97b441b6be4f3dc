// SPDX-License-Identifier: MIT
// For fragment shaders: light from behind a surface that passes it (KHR_materials_transmission, KHR_materials_volume).
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_full_material_lib.glsl"
#include "eevee/eevee_layer_block_lib.glsl"
#include "eevee/eevee_ltc_lib.glsl"
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_area_shared.h"

layout(location = 18) in vec4 surface_transmission_uvs;
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

/** Radiance and alpha of what is behind. \a texco: in [0, 1]. \a level: at least 0; at 0 it is not blurred. */
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
  /** What the base passes of the radiance behind it, as if no layer lay over it. */
  vec3 passed;
  /** Radiance towards the viewer, W/(sr m²), and alpha of what is behind. */
  vec4 behind;
};

/**
 * \a material: with the diffuse albedo of a surface without transmission. \a roughness: perceptual, of the blur of what is behind.
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
  vec2 size = vec2(textureSize(behind, 0));
  vec2 texco = gl_FragCoord.xy / size;
  float way_m = 0.0;
  if (thickness > 0.0) {
    vec3 inside_ws = refract(-surface.view_ws, surface.normal_ws, 1.0 / surface_lens.z);
    // A way of 1 m in world space, measured in object space. A matrix that flattens the object has no inverse.
    float shrunk = length(surface_object_from_world * inside_ws);
    way_m = shrunk > 1e-9 && shrunk < 1e9 ? thickness / shrunk : 0.0;
    vec4 exit = view.clip_from_world * vec4(surface.position_ws + way_m * inside_ws, 1.0);
    texco = exit.w > 0.0 ? clamp(0.5 * exit.xy / exit.w + 0.5, vec2(0.0), vec2(1.0)) : texco;
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
  result.passed = result.part * entering * material.diffuse * beer_lambert(data.absorption, way_m);
  result.behind = behind_at(texco, transmission_level(roughness, surface_lens.z, size.y));
  return result;
}
