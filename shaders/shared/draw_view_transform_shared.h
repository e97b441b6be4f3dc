// SPDX-License-Identifier: MIT
#ifndef DRAW_VIEW_TRANSFORM_SHARED_H
#define DRAW_VIEW_TRANSFORM_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Clips linear light to [0, 1] and applies sRGB's transfer function. Blender calls it Standard. */
#define VIEW_TRANSFORM_STANDARD 0
/** Clips linear light to [0, 1] and applies no transfer function. */
#define VIEW_TRANSFORM_RAW 1
/**
 * AgX of Troy Sobotka, by the polynomial of Benjamin Wrensch ("Minimal AgX Implementation", 2023), in Rec. 2020 primaries:
 * compresses 16.5 stops around middle grey, and lets bright colours fade to white. Close to Blender's default look.
 */
#define VIEW_TRANSFORM_AGX 2
/**
 * Khronos's PBR Neutral tone mapper ("Khronos PBR Neutral Tone Mapper: Specification", 2024): base colours are preserved; only
 * highlights are compressed.
 */
#define VIEW_TRANSFORM_PBR_NEUTRAL 3

/** Colour encoding of a target. \see draw::Encoding */
#define ENCODING_SCENE_LINEAR 0
#define ENCODING_DISPLAY 1
#define ENCODING_SRGB_FORMAT 2

/** sRGB's transfer function (IEC 61966-2-1). \a linear in [0, 1]. */
SHARED_FUNCTION float srgb_encoded(float linear)
{
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * pow(linear, 1.0f / 2.4f) - 0.055f;
}

/** AgX's curve: from a position in its range of stops to display-referred light before the 2.2 power. \a x in [0, 1]. */
SHARED_FUNCTION float agx_curve(float x)
{
  return max(((((((15.5f * x - 40.14f) * x + 31.96f) * x - 6.868f) * x + 0.4298f) * x + 0.1191f) * x - 0.00232f), 0.0f);
}

/** The range of AgX relative to 1, as logarithms to the base 2. */
SHARED_CONSTANT float AGX_LOG_MIN = -12.47393f;
SHARED_CONSTANT float AGX_LOG_MAX = 4.026069f;

/** One channel of AgX, to be raised to the power 2.2. Any \a linear. */
SHARED_FUNCTION float agx_channel(float linear)
{
  float stops = log(max(linear, 1e-10f)) * 1.442695041f;
  return agx_curve(clamp((stops - AGX_LOG_MIN) / (AGX_LOG_MAX - AGX_LOG_MIN), 0.0f, 1.0f));
}

/** AgX of \a linear: linear light with Rec. 709 primaries, as the input; may leave [0, 1]. */
SHARED_FUNCTION vec3 agx(vec3 linear)
{
  // Rec. 2020 primaries, then the inset towards white, so that saturated light keeps detail.
  vec3 wide = vec3(dot(linear, vec3(0.6274f, 0.3293f, 0.0433f)), dot(linear, vec3(0.0691f, 0.9195f, 0.0113f)),
                   dot(linear, vec3(0.0164f, 0.0880f, 0.8956f)));
  vec3 inset = vec3(dot(wide, vec3(0.856627153f, 0.0951212405f, 0.0482516061f)),
                    dot(wide, vec3(0.137318973f, 0.761241991f, 0.101439036f)),
                    dot(wide, vec3(0.111898213f, 0.0767994186f, 0.811302368f)));
  vec3 curved = vec3(agx_channel(inset.x), agx_channel(inset.y), agx_channel(inset.z));
  vec3 outset = vec3(dot(curved, vec3(1.12710058f, -0.110606643f, -0.0164939387f)),
                     dot(curved, vec3(-0.141329763f, 1.15782370f, -0.0164939387f)),
                     dot(curved, vec3(-0.141329763f, -0.110606643f, 1.25193641f)));
  vec3 shown = pow(max(outset, vec3(0.0f)), vec3(2.2f));
  return vec3(dot(shown, vec3(1.6605f, -0.5876f, -0.0728f)), dot(shown, vec3(-0.1246f, 1.1329f, -0.0083f)),
              dot(shown, vec3(-0.0182f, -0.1006f, 1.1187f)));
}

/** PBR Neutral of \a linear: linear light. \pre no channel is negative */
SHARED_FUNCTION vec3 pbr_neutral(vec3 linear)
{
  float start = 0.76f;
  float smallest = min(linear.x, min(linear.y, linear.z));
  float offset = smallest < 0.08f ? smallest - 6.25f * smallest * smallest : 0.04f;
  vec3 color = linear - vec3(offset);
  float peak = max(color.x, max(color.y, color.z));
  if (peak < start) {
    return color;
  }
  float range = 1.0f - start;
  float new_peak = 1.0f - range * range / (peak + range - start);
  // Division first: peak may be close to the largest float.
  color = (color / vec3(peak)) * new_peak;
  float white = 1.0f - 1.0f / (0.15f * (peak - new_peak) + 1.0f);
  return color + (vec3(new_peak) - color) * white;
}

/** Displayed linear light in [0, 1]. \a view_transform: VIEW_TRANSFORM_… */
SHARED_FUNCTION vec3 displayed_light(vec3 linear, int view_transform)
{
  vec3 mapped = linear;
  if (view_transform == VIEW_TRANSFORM_AGX) {
    mapped = agx(clamp(linear, vec3(0.0f), vec3(1e30f)));
  }
  else if (view_transform == VIEW_TRANSFORM_PBR_NEUTRAL) {
    mapped = pbr_neutral(clamp(linear, vec3(0.0f), vec3(1e30f)));
  }
  return clamp(mapped, vec3(0.0f), vec3(1.0f));
}

/** Display-referred colour in [0, 1]. \a view_transform: VIEW_TRANSFORM_… */
SHARED_FUNCTION vec3 view_transformed(vec3 linear, int view_transform)
{
  vec3 clipped = displayed_light(linear, view_transform);
  if (view_transform == VIEW_TRANSFORM_RAW) {
    return clipped;
  }
  return vec3(srgb_encoded(clipped.r), srgb_encoded(clipped.g), srgb_encoded(clipped.b));
}

SHARED_END

#endif
