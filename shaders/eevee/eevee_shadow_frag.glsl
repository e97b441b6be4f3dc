#version 450 core
// SPDX-License-Identifier: MIT
#include "eevee/eevee_grid_lib.glsl"
#ifdef USE_ALPHA_MASK
#  ifdef USE_OPACITY_THRESHOLD
#    include "eevee/eevee_opacity_threshold_lib.glsl"
#  else
#    include "eevee/eevee_alpha_lib.glsl"
#  endif
#  ifdef USE_SURFACE_FUNCTION
#    include "eevee/eevee_surface_function_lib.glsl"
#  endif
#endif

void main()
{
  write_depth_on_plane(0.0);
#ifdef USE_ALPHA_MASK
#  if defined(USE_SURFACE_FUNCTION) && defined(USE_OPACITY_THRESHOLD)
  bool is_open = is_let_through(edited_alpha());
#  elif defined(USE_SURFACE_FUNCTION)
  bool is_open = edited_alpha() < materials[surface_material].mask_cutoff;
#  elif defined(USE_OPACITY_THRESHOLD)
  bool is_open = is_let_through(caster_opacity());
#  else
  bool is_open = is_cut_out(materials[surface_material].mask_cutoff);
#  endif
  if (is_open) {
    discard;
  }
#endif
}
