#version 450 core
// SPDX-License-Identifier: MIT
// A line of about three pixels where one object of the mask ends and another, or none, begins.
#include "shared/slots_shared.h"

// The slot of the picture that a pass over the screen reads.
layout(binding = RADIANCE_SLOT) uniform sampler2D objects_texture;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Not premultiplied. */
  vec4 color;
  /** Lower left corner of the picture in the target. */
  ivec2 origin_px;
  /** Size of the picture, which may be smaller than the mask's texture. */
  ivec2 picture_size_px;
};

layout(location = 0) out vec4 display;

float object_at(ivec2 pixel)
{
  return texelFetch(objects_texture, clamp(pixel, ivec2(0), picture_size_px - 1), 0).x;
}

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy) - origin_px;
  float object = object_at(pixel);
  float others = 0.0;
  for (int y = -2; y <= 2; y++) {
    for (int x = -2; x <= 2; x++) {
      others += object_at(pixel + ivec2(x, y)) == object ? 0.0 : 1.0;
    }
  }
  // Beside a straight edge, two of five rows are another object's.
  float coverage = min(1.0, others / 10.0) * color.a;
  display = vec4(color.rgb * coverage, coverage);
}
