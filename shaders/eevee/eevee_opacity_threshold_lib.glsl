// SPDX-License-Identifier: MIT
// For fragment shaders: casters that are blended or transmit light, which let a part of the light through. A shadow layer stores one
// depth, so each texel is either covered or not in one sample; over the samples it is covered as often as the opacity says.
#include "eevee/eevee_full_alpha_lib.glsl"
#include "shared/eevee_sequence_shared.h"

/** \see eevee_full_alpha_vert_lib.glsl */
layout(location = 5) flat in uint surface_object;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Index of the picture's sample, and its seed. */
  int sample_index;
  int sample_seed;
};

/** Part of the light that does not pass. Of light that is transmitted, the colour is lost. */
float caster_opacity()
{
  vec4 texel = has_input(INPUT_BASE_COLOR) ? textureLod(base_color_texture, surface_uv, 0.0) : vec4(1.0);
  if (has_input(INPUT_BLENDED)) {
    return blended_opacity(texel.a);
  }
  FullMaterialData full = full_materials[surface_material];
  return 1.0 - (1.0 - full.opacity) * luminance(full.base_color * surface_color.rgb * texel.rgb);
}

/** \a opacity: part of the light that does not pass. */
bool is_let_through(float opacity)
{
  uint occluder = 2u * surface_object + (gl_FrontFacing ? 1u : 0u);
  return opacity <= opacity_threshold(uint(gl_FragCoord.x), uint(gl_FragCoord.y), occluder, uint(sample_index),
                                      uint(sample_seed));
}
