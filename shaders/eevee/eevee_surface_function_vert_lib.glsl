// SPDX-License-Identifier: MIT
// For vertex shaders: writes the inputs of eevee_surface_function_lib.glsl.
#include "eevee/eevee_full_material_vert_lib.glsl"
#include "eevee/eevee_surface_vert_lib.glsl"

layout(location = 10) out vec4 surface_mesh_uvs;
layout(location = 11) out vec3 surface_position_os;

/** Writes the varyings that no other library writes. */
void write_function_varyings()
{
  surface_mesh_uvs = vec4(uv, second_uv);
  surface_position_os = position;
}
