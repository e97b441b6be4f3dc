#version 450 core
// SPDX-License-Identifier: MIT
#ifdef USE_ALPHA_MASK
#  ifdef USE_OPACITY_THRESHOLD
#    include "eevee/eevee_opacity_threshold_lib.glsl"
#  else
#    include "eevee/eevee_alpha_lib.glsl"
#  endif
#endif

void main()
{
#ifdef USE_ALPHA_MASK
#  ifdef USE_OPACITY_THRESHOLD
  bool is_open = is_let_through();
#  else
  bool is_open = is_cut_out(materials[surface_material].mask_cutoff);
#  endif
  if (is_open) {
    discard;
  }
#endif
}
