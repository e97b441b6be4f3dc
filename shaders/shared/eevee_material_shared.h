// SPDX-License-Identifier: MIT
#ifndef EEVEE_MATERIAL_SHARED_H
#define EEVEE_MATERIAL_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/**
 * An entry of `material_block`. Linear colours. With a base colour texture, diffuse and metal_f0 are factors, and
 * specular_f0 and specular_f90 are those of a white one.
 */
struct MaterialData {
  /** Diffuse albedo: base colour without the metallic share. */
  vec3 diffuse;
  /** GGX alpha: roughness², in [ALPHA_MIN, 1]. */
  float alpha;
  /** Reflection at normal incidence; 0: no specular reflection at any angle. */
  vec3 specular_f0;
  /** Reflection at grazing incidence. */
  float specular_f90;
  /** Radiance, W/(sr m²). */
  vec3 emissive;
  /** Where the base colour texture's alpha is below it, the surface is cut out; 0: nowhere. */
  float mask_cutoff;
  /** The share of specular_f0 that is the base colour of a metal. */
  vec3 metal_f0;
  float _pad0;
};
SHARED_ASSERT_SIZE(MaterialData, 64)

/**
 * Reflection at grazing incidence for that at normal incidence. It fades below 2 %, so that black specular is
 * Lambertian (Lagarde and de Rousiers 2014, 3.2).
 */
SHARED_FUNCTION float grazing_reflection(vec3 f0)
{
  return min(50.0f * max(max(f0.x, f0.y), f0.z), 1.0f);
}

/** The material with its base colour multiplied. */
SHARED_FUNCTION MaterialData tinted(MaterialData material, vec3 color)
{
  material.diffuse = material.diffuse * color;
  // The larger term first: what is left of a metal is exactly 0.
  material.specular_f0 = (material.specular_f0 - material.metal_f0) + material.metal_f0 * color;
  material.specular_f90 = grazing_reflection(material.specular_f0);
  return material;
}

SHARED_END

#endif
