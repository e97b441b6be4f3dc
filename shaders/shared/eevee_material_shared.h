// SPDX-License-Identifier: MIT
#ifndef EEVEE_MATERIAL_SHARED_H
#define EEVEE_MATERIAL_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** An entry of `material_block`. Linear colours. */
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
  float _pad0;
};
SHARED_ASSERT_SIZE(MaterialData, 48)

SHARED_END

#endif
