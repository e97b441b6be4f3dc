// SPDX-License-Identifier: MIT
// For vertex shaders: the inputs of alpha masks, and of surface functions that change alpha.
#if defined(USE_SURFACE_FUNCTION)
#  include "eevee/eevee_surface_function_vert_lib.glsl"
#elif defined(USE_FULL_MATERIAL)
#  include "eevee/eevee_full_alpha_vert_lib.glsl"
#else
#  include "eevee/eevee_base_color_vert_lib.glsl"
#endif

/** \a position_ws: of the vertex. */
void write_alpha_varyings(vec3 position_ws)
{
  write_material_varyings();
#ifdef USE_SURFACE_FUNCTION
  write_full_varyings();
  write_surface_varyings(position_ws);
  write_function_varyings();
#endif
}
