#version 450 core
// SPDX-License-Identifier: MIT
// One triangle that covers the whole target. Its corners are computed from the vertex index.

void main()
{
#ifdef VULKAN
  int vertex = gl_VertexIndex;
#else
  int vertex = gl_VertexID;
#endif
  vec2 corner = vec2(vertex & 1, vertex >> 1) * 4.0 - 1.0;
  gl_Position = vec4(corner, 0.0, 1.0);
}
