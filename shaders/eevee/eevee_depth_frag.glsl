#version 450 core
// SPDX-License-Identifier: MIT
#ifdef HAS_COARSE_GRID
#  include "eevee/eevee_grid_lib.glsl"
#endif
#ifdef USE_ALPHA_MASK
#  include "eevee/eevee_mask_lib.glsl"
#  ifdef USE_SURFACE_FUNCTION
#    include "eevee/eevee_surface_function_lib.glsl"
#  endif
#endif
#ifdef USE_CLIP_PLANES
#  include "draw/draw_clip_lib.glsl"
#endif

void main()
{
#ifdef HAS_COARSE_GRID
  write_depth_on_plane(0.125);
#endif
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
#ifdef USE_CLIP_PLANES
  if (is_clipped()) {
    discard;
  }
#endif
}
