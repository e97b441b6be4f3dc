#version 450 core
// SPDX-License-Identifier: MIT
#include "overlay/overlay_lines_lib.glsl"

layout(location = 0) flat in vec4 line_color;
layout(location = 1) in float line_across_px;
layout(location = 2) flat in float line_half_width_px;
#ifdef USE_HIDDEN_LINES
layout(location = 3) flat in uint line_is_on_top;

/** y: depth of the nearest object; 0: none. */
layout(binding = RADIANCE_SLOT) uniform sampler2D objects_texture;
#endif

layout(location = 0) out vec4 display;

void main()
{
#ifdef USE_HIDDEN_LINES
  float object_depth = texelFetch(objects_texture, ivec2(gl_FragCoord.xy) - origin_px, 0).y;
  // Lines on a surface are seen: of a perspective picture, depth is inverse to the distance, here within 0.1 %.
  if (line_is_on_top == 0u && gl_FragCoord.z * 1.001 < object_depth) {
    discard;
  }
#endif
  float coverage = clamp(line_half_width_px + 0.5 - abs(line_across_px), 0.0, 1.0) * line_color.a;
  display = vec4(line_color.rgb * coverage, coverage);
}
