// SPDX-License-Identifier: MIT
// For vertex shaders: writes the inputs of eevee_full_alpha_lib.glsl.
#include "draw/draw_object_lib.glsl"
#include "eevee/eevee_full_block_lib.glsl"

layout(location = ATTRIBUTE_UV) in vec2 uv;
layout(location = ATTRIBUTE_SECOND_UV) in vec2 second_uv;
layout(location = ATTRIBUTE_COLOR) in vec4 color;

layout(location = 2) flat out uint surface_material;
layout(location = 3) out vec2 surface_uv;
layout(location = 4) out vec4 surface_color;
#ifdef USE_OPACITY_THRESHOLD
/** Index in object_block. */
layout(location = 5) flat out uint surface_object;
#endif

/** Texture coordinates from two rows of FullMaterialData::uv_rows. */
vec2 transformed_uv(vec4 row_u, vec4 row_v)
{
  vec3 mesh_uv = vec3(row_u.w == 0.0 ? uv : second_uv, 1.0);
  return vec2(dot(row_u.xyz, mesh_uv), dot(row_v.xyz, mesh_uv));
}

/**
 * Texture coordinates of the texture with bit \a index of the INPUT_ bits. Fragment shaders cannot compute them: llvmpipe's
 * invocations outside of a triangle read zeros from storage blocks, which makes derivatives wrong.
 */
vec2 input_uv(uint material, int index)
{
  return transformed_uv(full_materials[material].uv_rows[2 * index], full_materials[material].uv_rows[2 * index + 1]);
}

void write_material_varyings()
{
  surface_material = object_value();
  surface_uv = input_uv(surface_material, 0);
  surface_color = color;
#ifdef USE_OPACITY_THRESHOLD
  surface_object = draw_instance.x;
#endif
}
