#version 450 core
// SPDX-License-Identifier: MIT
// Writes the picture to a target: applies exposure, view transform and, where the target has depth, the host's convention.
#include "shared/draw_view_transform_shared.h"
#include "shared/slots_shared.h"

layout(binding = RADIANCE_SLOT) uniform sampler2D radiance_texture;
#ifdef USE_TARGET_DEPTH
layout(binding = DEPTH_SLOT) uniform sampler2D depth_texture;
#endif

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** \see draw::DepthMap */
  vec4 depth_scale;
  /** Lower left corner of the picture in the target. */
  ivec2 origin_px;
  /** Pixel of the radiance that is the lower left pixel of the picture. */
  ivec2 radiance_origin_px;
  /** The same of the depth. */
  ivec2 depth_origin_px;
  ivec2 picture_size_px;
  /** If it differs from the picture's, the picture is interpolated. */
  ivec2 target_size_px;
  /** VIEW_TRANSFORM_… */
  int view_transform;
  /** ENCODING_… */
  int encoding;
  /** 2 to the exposure in stops. */
  float exposure_scale;
  /** Factor from the stored weighted sum of the samples to their mean. */
  float sample_scale;
  /** Depth that the target gets for pixels without a surface. */
  float background_depth;
  /**
   * 1 over the target's content: pixels without depth keep it. 2: only those pixels are drawn, for blended surfaces with nothing
   * behind them.
   */
  int is_over;
  /** 1: the colour is not multiplied by alpha. */
  int is_straight;
};

layout(location = 0) out vec4 display;

vec4 radiance_at(ivec2 pixel)
{
  return texelFetch(radiance_texture, radiance_origin_px + clamp(pixel, ivec2(0), picture_size_px - 1), 0);
}

/** \a place: in pixels of the picture, 0.5 being the middle of the first. */
vec4 interpolated_radiance(vec2 place)
{
  vec2 low = floor(place - 0.5);
  vec2 share = place - 0.5 - low;
  ivec2 pixel = ivec2(low);
  return mix(mix(radiance_at(pixel), radiance_at(pixel + ivec2(1, 0)), share.x),
             mix(radiance_at(pixel + ivec2(0, 1)), radiance_at(pixel + ivec2(1, 1)), share.x), share.y);
}

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy) - origin_px;
  vec4 radiance;
  if (picture_size_px == target_size_px) {
    radiance = texelFetch(radiance_texture, radiance_origin_px + pixel, 0);
  }
  else {
    vec2 place = (vec2(pixel) + 0.5) * vec2(picture_size_px) / vec2(target_size_px);
    radiance = interpolated_radiance(place);
    pixel = min(ivec2(place), picture_size_px - 1);
  }
  radiance *= sample_scale;
  float alpha = clamp(radiance.a, 0.0, 1.0);
  if (is_straight != 0 && alpha > 0.0) {
    radiance.rgb /= alpha;
  }
  vec3 color = radiance.rgb * exposure_scale;
  if (encoding == ENCODING_DISPLAY) {
    color = view_transformed(color, view_transform);
  }
  else if (encoding == ENCODING_SRGB_FORMAT) {
    color = displayed_light(color, view_transform);
  }
  display = vec4(color, alpha);
#ifdef USE_TARGET_DEPTH
  float depth = texelFetch(depth_texture, depth_origin_px + pixel, 0).r;
  if (is_over != 0 && (depth == 0.0) != (is_over == 2)) {
    discard;
  }
  float stored = (depth_scale.x * depth + depth_scale.y) / (depth_scale.z * depth + depth_scale.w);
  gl_FragDepth = depth == 0.0 ? background_depth : clamp(stored, 0.0, 1.0);
#endif
}
