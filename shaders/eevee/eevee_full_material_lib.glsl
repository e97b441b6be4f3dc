// SPDX-License-Identifier: MIT
// For fragment shaders: the shading parameters of a surface from all textures of its material and from vertex colours.
#include "eevee/eevee_full_alpha_lib.glsl"
// Shadow layers have no view.
#ifndef WITHOUT_VIEW
#  include "draw/draw_view_lib.glsl"
#endif

INTERPOLATED(6, vec4, surface_roughness_normal_uvs, grid_roughness_normal_uvs)
INTERPOLATED(7, vec4, surface_occlusion_emissive_uvs, grid_occlusion_emissive_uvs)
INTERPOLATED(8, vec4, surface_specular_uvs, grid_specular_uvs)
#ifdef USE_TRANSMISSION
/**
 * Factor of the roughness, whether its texture is used, and the index of refraction. Mip levels of the picture behind are computed
 * from them and not from storage blocks: llvmpipe takes the level of several invocations from one of them, which may be outside
 * of the triangle and reads zeros there.
 */
layout(location = 15) flat in vec3 surface_lens;
#endif

layout(binding = METALLIC_ROUGHNESS_SLOT) uniform sampler2D metallic_roughness_texture;
layout(binding = OCCLUSION_SLOT) uniform sampler2D occlusion_texture;
layout(binding = EMISSIVE_SLOT) uniform sampler2D emissive_texture;
layout(binding = SPECULAR_SLOT) uniform sampler2D specular_texture;
layout(binding = SPECULAR_COLOR_SLOT) uniform sampler2D specular_color_texture;

/** Bias of the mip levels of textures. */
float texture_bias()
{
#ifdef WITHOUT_VIEW
  return 0.0;
#else
  return view.texture_lod_bias;
#endif
}

/** Part of the light from behind that the surface covers; 1 unless the material is blended. */
float surface_opacity()
{
  if (!has_input(INPUT_BLENDED)) {
    return 1.0;
  }
  float texel = has_input(INPUT_BASE_COLOR) ? texture(base_color_texture, surface_uv, texture_bias()).a : 1.0;
  return blended_opacity(texel);
}

/** A surface of the metallic-roughness model before it is lit. A surface function may edit it. */
struct StandardSurface {
  /** Linear, in [0, 1]. */
  vec3 base_color;
  /** In [0, 1]. */
  float metallic;
  /** Perceptual, in [0, 1]. */
  float roughness;
  /** Factor of dielectric reflection, in [0, 1], and its tint. */
  float specular;
  vec3 specular_color;
  /** World space, unit length, on the visible side. */
  vec3 normal_ws;
  /** Radiance, W/(sr m²). */
  vec3 emission;
  /** Fraction of ambient light that arrives, in [0, 1]. */
  float occlusion;
  /** In [0, 1]. Has an effect on masked and blended materials only. */
  float alpha;
};

vec3 textured_base_color()
{
  vec3 base_color = full_materials[surface_material].base_color * surface_color.rgb;
  if (has_input(INPUT_BASE_COLOR)) {
    base_color *= texture(base_color_texture, surface_uv, texture_bias()).rgb;
  }
  return base_color;
}

/** The factors and textures of the material. Normal and alpha are not set. */
StandardSurface textured_surface()
{
  FullMaterialData full = full_materials[surface_material];
  StandardSurface result;
  result.base_color = textured_base_color();
#ifdef USE_TRANSMISSION
  vec2 roughness_metallic = vec2(surface_lens.x, full.metallic);
  bool has_texture = surface_lens.y != 0.0;
#else
  vec2 roughness_metallic = vec2(full.roughness, full.metallic);
  bool has_texture = has_input(INPUT_METALLIC_ROUGHNESS);
#endif
  if (has_texture) {
    roughness_metallic *= texture(metallic_roughness_texture, surface_roughness_normal_uvs.xy, texture_bias()).gb;
  }
  result.roughness = roughness_metallic.x;
  result.metallic = roughness_metallic.y;
  result.specular = full.specular;
  if (has_input(INPUT_SPECULAR)) {
    result.specular *= texture(specular_texture, surface_specular_uvs.xy, texture_bias()).a;
  }
  result.specular_color = full.specular_color;
  if (has_input(INPUT_SPECULAR_COLOR)) {
    result.specular_color *= texture(specular_color_texture, surface_specular_uvs.zw, texture_bias()).rgb;
  }
  result.emission = full.emissive;
  if (has_input(INPUT_EMISSIVE)) {
    result.emission *= texture(emissive_texture, surface_occlusion_emissive_uvs.zw, texture_bias()).rgb;
  }
  result.occlusion = 1.0;
  if (has_input(INPUT_OCCLUSION)) {
    float open = texture(occlusion_texture, surface_occlusion_emissive_uvs.xy, texture_bias()).r;
    result.occlusion += full.occlusion_strength * (open - 1.0);
  }
  return result;
}

MaterialData standard_material(StandardSurface standard)
{
  MaterialData material = metallic_roughness_material(standard.base_color, standard.metallic, standard.roughness,
                                                      standard.specular_color, standard.specular);
  material.emissive = standard.emission;
  material.occlusion = standard.occlusion;
  return material;
}

MaterialData full_material()
{
  if (has_input(INPUT_UNLIT)) {
    return unlit_material(textured_base_color());
  }
  return standard_material(textured_surface());
}
