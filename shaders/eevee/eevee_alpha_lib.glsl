// SPDX-License-Identifier: MIT
// For fragment shaders: alpha masks.
#ifdef USE_FULL_MATERIAL
#  include "eevee/eevee_full_alpha_lib.glsl"
#else
#  include "eevee/eevee_base_color_lib.glsl"
#endif
