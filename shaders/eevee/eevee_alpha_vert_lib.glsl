// SPDX-License-Identifier: MIT
// For vertex shaders: the inputs of alpha masks.
#ifdef USE_FULL_MATERIAL
#  include "eevee/eevee_full_alpha_vert_lib.glsl"
#else
#  include "eevee/eevee_base_color_vert_lib.glsl"
#endif
