// SPDX-License-Identifier: MIT
// Light that microfacets reflect more than once, and the diffuse part beside it.
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_material_shared.h"
#include "shared/eevee_multiscatter_shared.h"
#include "shared/slots_shared.h"

layout(binding = MULTISCATTER_TABLE_SLOT) uniform sampler2D multiscatter_table;

vec4 multiscatter_texel(float alpha, float cosine)
{
  vec2 texel = multiscatter_place(alpha, cosine) * float(MULTISCATTER_TABLE_SIZE - 1) + 0.5;
  return textureLod(multiscatter_table, texel / float(MULTISCATTER_TABLE_SIZE), 0.0);
}

/** For Surface::multiscatter. \a surface: with its shading normal. */
Multiscatter multiscatter_of(MaterialData material, Surface surface)
{
  float cos_v = clamp(dot(surface.normal_ws, surface.view_ws), 1e-4, 1.0);
  return make_multiscatter(multiscatter_texel(material.alpha, cos_v), material.alpha, cos_v, material.specular_f0,
                           material.specular_f90);
}

/** For the direction of a light. A material that is lit by a sun of the world may have a wider lobe than the surface. */
LobeAlbedo albedo_towards(Surface surface, float cos_l)
{
  return lobe_albedo(multiscatter_texel(surface.multiscatter.alpha, cos_l), surface.multiscatter.alpha, cos_l);
}

/** BRDF of diffuse reflection and of multiple scattering, 1/sr. \a cos_l: of the incident light, above 0. */
vec3 smooth_brdf(MaterialData material, Surface surface, float cos_l)
{
  return smooth_brdf(surface.multiscatter, albedo_towards(surface, cos_l), material.diffuse, material.specular_f0,
                     material.specular_f90);
}
