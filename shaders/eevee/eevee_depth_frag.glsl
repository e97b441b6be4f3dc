#version 450 core
// SPDX-License-Identifier: MIT
#include "eevee/eevee_grid_lib.glsl"
#ifdef USE_ALPHA_MASK
#  include "eevee/eevee_mask_lib.glsl"
#  ifdef USE_SURFACE_FUNCTION
#    include "eevee/eevee_surface_function_lib.glsl"
#  endif
#endif
#include "draw/draw_clip_lib.glsl"

void main()
{
  write_depth_on_plane(0.125);
#ifdef USE_ALPHA_MASK
#  ifdef USE_SURFACE_FUNCTION
  bool is_open = edited_alpha() < materials[surface_material].mask_cutoff;
#  else
  bool is_open = is_pixel_cut_out(materials[surface_material].mask_cutoff);
#  endif
  if (is_open) {
    discard;
  }
#endif
  discard_clipped();
}
