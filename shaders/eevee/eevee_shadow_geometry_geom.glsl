#version 450 core
// SPDX-License-Identifier: MIT
// Selects the layer of a caster's triangle, for devices whose vertex shaders cannot select the layer.

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

layout(location = 9) flat in int caster_layer[];
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
#  ifdef USE_SURFACE_FUNCTION
layout(location = 0) in vec3 caster_position_ws[];
layout(location = 0) out vec3 surface_position_ws;
layout(location = 1) in vec3 caster_normal_ws[];
layout(location = 1) out vec3 surface_normal_ws;
layout(location = 6) in vec4 caster_roughness_normal_uvs[];
layout(location = 6) out vec4 surface_roughness_normal_uvs;
layout(location = 7) in vec4 caster_occlusion_emissive_uvs[];
layout(location = 7) out vec4 surface_occlusion_emissive_uvs;
layout(location = 8) in vec4 caster_specular_uvs[];
layout(location = 8) out vec4 surface_specular_uvs;
layout(location = 10) in vec4 caster_mesh_uvs[];
layout(location = 10) out vec4 surface_mesh_uvs;
layout(location = 11) in vec3 caster_position_os[];
layout(location = 11) out vec3 surface_position_os;
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
#  ifdef USE_SURFACE_FUNCTION
    surface_position_ws = caster_position_ws[i];
    surface_normal_ws = caster_normal_ws[i];
    surface_roughness_normal_uvs = caster_roughness_normal_uvs[i];
    surface_occlusion_emissive_uvs = caster_occlusion_emissive_uvs[i];
    surface_specular_uvs = caster_specular_uvs[i];
    surface_mesh_uvs = caster_mesh_uvs[i];
    surface_position_os = caster_position_os[i];
#  endif
#endif
    EmitVertex();
  }
  EndPrimitive();
}
