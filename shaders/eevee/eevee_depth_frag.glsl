#version 450 core
// SPDX-License-Identifier: MIT
#ifdef USE_ALPHA_MASK
#  include "eevee/eevee_alpha_lib.glsl"
#endif

void main()
{
#ifdef USE_ALPHA_MASK
  if (is_cut_out(materials[surface_material].mask_cutoff)) {
    discard;
  }
#endif
}
