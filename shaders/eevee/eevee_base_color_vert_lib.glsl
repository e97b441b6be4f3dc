// SPDX-License-Identifier: MIT
// For vertex shaders: writes the inputs of eevee_base_color_lib.glsl.
#include "draw/draw_object_lib.glsl"

layout(location = ATTRIBUTE_UV) in vec2 uv;

layout(location = 2) flat out uint surface_material;
layout(location = 3) out vec2 surface_uv;

void write_material_varyings()
{
  surface_material = object_value();
  surface_uv = uv;
}
