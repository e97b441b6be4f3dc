#version 450 core
// SPDX-License-Identifier: MIT
// Selects the layer of a caster's triangle, for devices whose vertex shaders cannot select the layer.

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

layout(location = 0) flat in int caster_layer[];
#ifdef USE_ALPHA_MASK
// Outputs of eevee_alpha_vert_lib.glsl. They are renamed, because the fragment shader needs the original names.
layout(location = 2) flat in uint caster_material[];
layout(location = 2) flat out uint surface_material;
layout(location = 3) in vec2 caster_uv[];
layout(location = 3) out vec2 surface_uv;
#  ifdef USE_FULL_MATERIAL
layout(location = 4) in vec4 caster_color[];
layout(location = 4) out vec4 surface_color;
#  endif
#  ifdef USE_OPACITY_THRESHOLD
layout(location = 5) flat in uint caster_object[];
layout(location = 5) flat out uint surface_object;
#  endif
#endif

void main()
{
  for (int i = 0; i < 3; i++) {
    gl_Position = gl_in[i].gl_Position;
    gl_Layer = caster_layer[0];
#ifdef USE_ALPHA_MASK
    surface_material = caster_material[i];
    surface_uv = caster_uv[i];
#  ifdef USE_FULL_MATERIAL
    surface_color = caster_color[i];
#  endif
#  ifdef USE_OPACITY_THRESHOLD
    surface_object = caster_object[i];
#  endif
#endif
    EmitVertex();
  }
  EndPrimitive();
}
