#version 450 core
// SPDX-License-Identifier: MIT
// Two triangles for each line: a rectangle on the screen, with half a pixel more at each side for a soft edge. It ends where
// the line does, so that the lines of a curve hardly overlap, and their soft edges are blended once.
#include "overlay/overlay_lines_lib.glsl"
#include "shared/overlay_line_shared.h"

layout(std140, binding = LINE_BLOCK_SLOT) readonly buffer line_block
{
  LineData lines[];
};

layout(location = 0) flat out vec4 line_color;
/** Distance from the line's middle. */
layout(location = 1) out float line_across_px;
layout(location = 2) flat out float line_half_width_px;
#ifdef USE_HIDDEN_LINES
layout(location = 3) flat out uint line_is_on_top;
#endif

vec2 pixel_of(vec4 clip)
{
  return (0.5 * clip.xy / clip.w + 0.5) * vec2(picture_size_px);
}

void main()
{
#ifdef VULKAN
  int vertex = gl_VertexIndex;
#else
  int vertex = gl_VertexID;
#endif
  LineData line = lines[vertex / 6];
  int corner = vertex % 6;
  bool is_to = corner == 1 || corner == 2 || corner == 4;
  float side = corner == 2 || corner == 4 || corner == 5 ? 1.0 : -1.0;
  vec4 from = clip_from_world * vec4(line.from_ws, 1.0);
  vec4 to = clip_from_world * vec4(line.to_ws, 1.0);

  line_color = line.color;
  line_half_width_px = 0.5 * line.width_px;
  line_across_px = side * (line_half_width_px + 0.5);
#ifdef USE_HIDDEN_LINES
  line_is_on_top = line.is_on_top;
#endif
  // Above 0 beyond the near plane, where z is w.
  float from_depth = from.w - from.z;
  float to_depth = to.w - to.z;
  if (from_depth <= 0.0 && to_depth <= 0.0) {
    gl_Position = vec4(2.0, 2.0, 0.0, 1.0);
    return;
  }
  if (from_depth < 0.0) {
    from = mix(from, to, from_depth / (from_depth - to_depth));
  }
  else if (to_depth < 0.0) {
    to = mix(to, from, to_depth / (to_depth - from_depth));
  }
  vec2 from_px = pixel_of(from);
  vec2 way_px = pixel_of(to) - from_px;
  float length_px = length(way_px);
  vec2 along = length_px > 0.0 ? way_px / length_px : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  vec4 end = is_to ? to : from;
  vec2 pixel = pixel_of(end) + across * line_across_px;
  gl_Position = vec4(2.0 * pixel / vec2(picture_size_px) - 1.0, end.z / end.w, 1.0);
}
