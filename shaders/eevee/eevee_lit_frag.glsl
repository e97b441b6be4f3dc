#version 450 core
// SPDX-License-Identifier: MIT
#include "eevee/eevee_material_lib.glsl"
#ifdef USE_BASE_COLOR_TEXTURE
#  include "eevee/eevee_base_color_lib.glsl"
#endif
#ifdef USE_LIGHT
#  include "eevee/eevee_light_lib.glsl"
#  include "eevee/eevee_surface_frag_lib.glsl"
#endif

layout(location = 0) out vec4 radiance;

void main()
{
  MaterialData material = materials[surface_material];
#ifdef USE_BASE_COLOR_TEXTURE
  material = tinted(material, base_color_tint());
#endif
  vec3 sum = material.emissive;
#ifdef USE_LIGHT
  Surface surface = make_surface();
  sum += direct_light(material, surface);
#endif
  radiance = vec4(sum, 1.0);
#ifdef USE_BASE_COLOR_TEXTURE
  // Another surface may have the same depth, so the depth test alone does not reject a masked fragment.
  if (is_cut_out(material.mask_cutoff)) {
    discard;
  }
#endif
}
