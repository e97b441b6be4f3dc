#version 450 core
// SPDX-License-Identifier: MIT

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

layout(location = 0) flat in int caster_layer[];

void main()
{
  for (int i = 0; i < 3; i++) {
    gl_Position = gl_in[i].gl_Position;
    gl_Layer = caster_layer[0];
    EmitVertex();
  }
  EndPrimitive();
}
