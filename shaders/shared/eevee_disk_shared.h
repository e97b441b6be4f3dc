// SPDX-License-Identifier: MIT
// Points that cover the unit disk evenly: filters of shadows.
#ifndef EEVEE_DISK_SHARED_H
#define EEVEE_DISK_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** The golden angle, radians: the turn from one point of a Vogel disk to the next. */
#define GOLDEN_ANGLE 2.39996323f

/** Radius of point \a i of \a count points of a Vogel disk, in (0, 1). */
SHARED_FUNCTION float vogel_radius(int i, int count)
{
  return sqrt((float(i) + 0.5f) / float(count));
}

/** Point \a i of \a count points that cover equal areas of the unit disk (Vogel 1979). \a i: 0 to count - 1. */
SHARED_FUNCTION vec2 vogel_disk(int i, int count)
{
  float radius = vogel_radius(i, count);
  float angle = GOLDEN_ANGLE * float(i);
  return vec2(radius * cos(angle), radius * sin(angle));
}

SHARED_END

#endif
