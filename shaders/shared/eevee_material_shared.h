// SPDX-License-Identifier: MIT
#ifndef EEVEE_MATERIAL_SHARED_H
#define EEVEE_MATERIAL_SHARED_H

#include "shared/eevee_bsdf_shared.h"
#include "shared/shared_types.h"

SHARED_BEGIN

/**
 * Parameters of a surface for shading. An entry of `material_block` has those of a material without textures. Colours are linear.
 * With a base colour texture only, diffuse and metal_f0 are factors of the texture, and specular_f0 and specular_f90 apply to a
 * white texture. With other textures, the parameters are computed from FullMaterialData.
 */
struct MaterialData {
  /** Diffuse albedo: the base colour times 1 - metallic. */
  vec3 diffuse;
  /** GGX alpha: roughness², in [ALPHA_MIN, 1]. */
  float alpha;
  /** Reflectance at normal incidence. 0: no specular reflection at any angle. */
  vec3 specular_f0;
  /** Reflectance at grazing incidence. */
  float specular_f90;
  /** Radiance, W/(sr m²). */
  vec3 emissive;
  /**
   * The surface is cut out where the alpha of its texture and its vertex colours is below this. 0: nowhere. With a surface function, where
   * the alpha of the function is below.
   */
  float mask_cutoff;
  /** Part of specular_f0 due to the base colour of a metal. */
  vec3 metal_f0;
  /** Fraction of ambient light that reaches the surface: 1 without occlusion. */
  float occlusion;
};
SHARED_ASSERT_SIZE(MaterialData, 64)

/** Bits of FullMaterialData::inputs for present textures, in the order of scene::texture_inputs. */
#define INPUT_BASE_COLOR 1u
#define INPUT_METALLIC_ROUGHNESS 2u
#define INPUT_NORMAL 4u
#define INPUT_OCCLUSION 8u
#define INPUT_EMISSIVE 16u
#define INPUT_SPECULAR 32u
#define INPUT_SPECULAR_COLOR 64u
#define INPUT_COAT 128u
#define INPUT_COAT_ROUGHNESS 256u
#define INPUT_SHEEN_COLOR 512u
#define INPUT_SHEEN_ROUGHNESS 1024u
#define INPUT_ANISOTROPY 2048u
#define INPUT_COAT_NORMAL 4096u
#define INPUT_TRANSMISSION 8192u
#define INPUT_THICKNESS 16384u
/** Unlit material: its radiance is the base colour. */
#define INPUT_UNLIT 65536u
/** The surface is blended over the picture behind it. */
#define INPUT_BLENDED 131072u
/** The material has an alpha mask and a surface function, which reads the alpha of the mask. */
#define INPUT_MASKED 262144u
/** Textures of FullMaterialData, and after them those of LayerData: first of coats, sheen and anisotropy, then of transmission. */
#define FULL_TEXTURE_COUNT 7
#define LAYER_TEXTURE_COUNT 6
#define TRANSMISSION_TEXTURE_COUNT 2

/** An entry of `full_material_block`: factors of the textures and of vertex colours. */
struct FullMaterialData {
  vec3 base_color;
  float metallic;
  vec3 specular_color;
  float specular;
  vec3 emissive;
  float roughness;
  float normal_scale;
  float occlusion_strength;
  /** INPUT_ bits. */
  uint inputs;
  /**
   * Factor of alpha of a blended surface, and of one with INPUT_MASKED. Of another one, for shadows: 1 - the part of white light that a
   * white surface transmits.
   */
  float opacity;
  /** Two rows for each texture. It is looked up at xyz · (u, v, 1); w of the first row: 0 for the first set of uvs, 1 for the second. */
  vec4 uv_rows[2 * FULL_TEXTURE_COUNT];
};
SHARED_ASSERT_SIZE(FullMaterialData, 64 + 32 * FULL_TEXTURE_COUNT)

/**
 * An entry of `layer_block`: factors of the layers over the base of a material (KHR_materials_clearcoat, KHR_materials_sheen), of
 * the base's anisotropy (KHR_materials_anisotropy) and of the light that passes the base (KHR_materials_transmission,
 * KHR_materials_volume).
 */
struct LayerData {
  vec3 sheen_color;
  float sheen_roughness;
  float coat;
  float coat_roughness;
  float transmission;
  /** Object space, at least 0. */
  float thickness;
  /** Absorption coefficient, 1/m. */
  vec3 absorption;
  /** Index of refraction, at least 1. */
  float ior;
  /** xy: cosine and sine of the angle from the tangent to the rougher direction. z: strength, in [0, 1]. */
  vec3 anisotropy;
  float coat_normal_scale;
  /** The same as FullMaterialData::uv_rows. */
  vec4 uv_rows[2 * (LAYER_TEXTURE_COUNT + TRANSMISSION_TEXTURE_COUNT)];
};
SHARED_ASSERT_SIZE(LayerData, 64 + 32 * (LAYER_TEXTURE_COUNT + TRANSMISSION_TEXTURE_COUNT))

/**
 * Reflectance at grazing incidence from the reflectance at normal incidence. It fades below 2 %, so that a surface with a
 * black specular colour is Lambertian (Lagarde and de Rousiers 2014, 3.2).
 */
SHARED_FUNCTION float grazing_reflection(vec3 f0)
{
  return min(50.0f * max(max(f0.x, f0.y), f0.z), 1.0f);
}

/** Metallic-roughness surface of glTF 2.0, appendix B, with KHR_materials_specular. 0.04 is a dielectric of index 1.5. */
SHARED_FUNCTION MaterialData metallic_roughness_material(vec3 base_color, float metallic, float roughness, vec3 specular_color,
                                              float specular)
{
  vec3 dielectric = min(0.04f * specular_color, vec3(1.0f)) * specular;
  MaterialData material;
  material.diffuse = base_color * (1.0f - metallic);
  material.alpha = max(roughness * roughness, ALPHA_MIN);
  material.specular_f0 = mix(dielectric, base_color, metallic);
  material.specular_f90 = grazing_reflection(material.specular_f0);
  material.emissive = vec3(0.0f);
  material.mask_cutoff = 0.0f;
  material.metal_f0 = base_color * metallic;
  material.occlusion = 1.0f;
  return material;
}

/** The coat of a surface as a material: a lobe without Fresnel terms. */
SHARED_FUNCTION MaterialData coat_material(float roughness)
{
  MaterialData material = metallic_roughness_material(vec3(0.0f), 0.0f, roughness, vec3(0.0f), 0.0f);
  material.specular_f0 = vec3(1.0f);
  material.specular_f90 = 1.0f;
  return material;
}

/** Part of the light that a coat reflects, by KHR_materials_clearcoat. \a cos_v: between the coat's normal and the viewer. */
SHARED_FUNCTION float coat_reflectance(float coat, float cos_v)
{
  return coat * fresnel_schlick(vec3(0.04f), 1.0f, cos_v).x;
}

/** Luminance of a linear colour with Rec. 709 primaries. */
SHARED_FUNCTION float luminance(vec3 color)
{
  return 0.2126f * color.x + 0.7152f * color.y + 0.0722f * color.z;
}

/**
 * Absorption coefficient, 1/m, of a medium that leaves the part \a left of light after \a distance_m metres (Beer-Lambert). Where
 * \a left is 0, nothing is left after any length.
 */
SHARED_FUNCTION vec3 absorption_of(vec3 left, float distance_m)
{
  // The quotient overflows for the smallest distances.
  return vec3(left.x > 0.0f ? clamp(-log(left.x) / distance_m, 0.0f, 1e30f) : 1e30f,
              left.y > 0.0f ? clamp(-log(left.y) / distance_m, 0.0f, 1e30f) : 1e30f,
              left.z > 0.0f ? clamp(-log(left.z) / distance_m, 0.0f, 1e30f) : 1e30f);
}

/** Part of the light that is left after \a length_m metres. */
SHARED_FUNCTION vec3 beer_lambert(vec3 absorption, float length_m)
{
  // Beyond 100, the result is 0 in floats. The product may be infinite; its exponential is NaN on some devices.
  return exp(vec3(0.0f) - min(absorption * length_m, vec3(100.0f)));
}

/**
 * Mip level of a picture of \a height_px that transmission through a surface of \a roughness reads. The blur is a part of the picture:
 * 2^(10 (r - 1)) of its height with r = roughness · clamp(2 ior - 2, 0, 1), as in Khronos's sample viewer, whose picture has 1024 texels
 * in height and width.
 */
SHARED_FUNCTION float transmission_level(float roughness, float ior, float height_px)
{
  float scaled = roughness * clamp(2.0f * ior - 2.0f, 0.0f, 1.0f);
  // The limit keeps smooth surfaces sharp in pictures of more than 1024 pixels.
  return clamp(log(height_px) * 1.44269504f - 10.0f * (1.0f - scaled), 0.0f, 20.0f * scaled);
}

/** A surface that emits \a radiance and reflects no light. */
SHARED_FUNCTION MaterialData unlit_material(vec3 radiance)
{
  MaterialData material = metallic_roughness_material(vec3(0.0f), 0.0f, 1.0f, vec3(0.0f), 0.0f);
  material.emissive = radiance;
  return material;
}

/** The material with its base colour multiplied by \a color. */
SHARED_FUNCTION MaterialData tinted(MaterialData material, vec3 color)
{
  material.diffuse = material.diffuse * color;
  // Subtract first: for a pure metal the difference is exactly 0.
  material.specular_f0 = (material.specular_f0 - material.metal_f0) + material.metal_f0 * color;
  material.specular_f90 = grazing_reflection(material.specular_f0);
  return material;
}

SHARED_END

#endif
