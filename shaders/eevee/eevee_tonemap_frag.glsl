#version 450 core
// SPDX-License-Identifier: MIT
// Applies exposure and the view transform to the picture.
#include "shared/eevee_tonemap_shared.h"
#include "shared/slots_shared.h"

layout(binding = RADIANCE_SLOT) uniform sampler2D radiance_texture;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** VIEW_TRANSFORM_… */
  int view_transform;
  /** 2 to the exposure in stops. */
  float exposure_scale;
};

layout(location = 0) out vec4 display;

void main()
{
  vec4 radiance = texelFetch(radiance_texture, ivec2(gl_FragCoord.xy), 0);
  display = vec4(view_transformed(radiance.rgb * exposure_scale, view_transform), clamp(radiance.a, 0.0, 1.0));
}
