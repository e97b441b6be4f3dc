// SPDX-License-Identifier: MIT
#ifndef EEVEE_TONEMAP_SHARED_H
#define EEVEE_TONEMAP_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Clips linear light to [0, 1] and applies sRGB's transfer function. Blender calls it Standard. */
#define VIEW_TRANSFORM_STANDARD 0
/** Clips linear light to [0, 1] and applies no transfer function. */
#define VIEW_TRANSFORM_RAW 1

/** sRGB's transfer function (IEC 61966-2-1). \a linear in [0, 1]. */
SHARED_FUNCTION float srgb_encoded(float linear)
{
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * pow(linear, 1.0f / 2.4f) - 0.055f;
}

/** Display-referred colour in [0, 1]. \a view_transform: VIEW_TRANSFORM_… */
SHARED_FUNCTION vec3 view_transformed(vec3 linear, int view_transform)
{
  vec3 clipped = clamp(linear, vec3(0.0f), vec3(1.0f));
  if (view_transform == VIEW_TRANSFORM_RAW) {
    return clipped;
  }
  return vec3(srgb_encoded(clipped.r), srgb_encoded(clipped.g), srgb_encoded(clipped.b));
}

SHARED_END

#endif
