// SPDX-License-Identifier: MIT
#ifndef EEVEE_MATERIAL_SHARED_H
#define EEVEE_MATERIAL_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/**
 * A material: an entry of `material_block`. Colours are linear. With a base colour texture, diffuse and metal_f0 are factors of
 * the texture, and specular_f0 and specular_f90 are those for a white texture.
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
  /** The surface is cut out where the alpha of the base colour texture is below this. 0: nowhere. */
  float mask_cutoff;
  /** The part of specular_f0 that comes from the base colour of a metal. */
  vec3 metal_f0;
  float _pad0;
};
SHARED_ASSERT_SIZE(MaterialData, 64)

/**
 * Reflectance at grazing incidence from the reflectance at normal incidence. It fades below 2 %, so that a surface with a
 * black specular colour is Lambertian (Lagarde and de Rousiers 2014, 3.2).
 */
SHARED_FUNCTION float grazing_reflection(vec3 f0)
{
  return min(50.0f * max(max(f0.x, f0.y), f0.z), 1.0f);
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
