// SPDX-License-Identifier: MIT
#ifndef EEVEE_DEPTH_SHARED_H
#define EEVEE_DEPTH_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** How a view makes depths. \see draw::perspective, draw::orthographic */
#define PROJECTION_PERSPECTIVE 0
/** The far plane at infinity: `far` is not read. */
#define PROJECTION_PERSPECTIVE_INFINITE 1
#define PROJECTION_ORTHOGRAPHIC 2

/** Divisors below it would not leave a finite quotient. */
SHARED_CONSTANT float DEPTH_DIVISOR_MIN = 1e-30f;

/**
 * Reversed depth of a point \a distance metres along the view's axis: 1 at \a near, 0 at \a far, outside of [0, 1] beyond them.
 *
 * \a near, \a far: metres, far above near; near above 0 in perspective, and below 1e8. A point of a perspective that is
 * not in front of the eye has a finite depth above 1: nearer than everything.
 */
SHARED_FUNCTION float depth_of_distance(float distance, float near, float far, int projection)
{
  // Behind the eye of a perspective there is no depth: all of it is as near as its eye.
  float in_front = projection == PROJECTION_ORTHOGRAPHIC ? distance : max(distance, DEPTH_DIVISOR_MIN);
  float from_far = (far - in_front) / max(far - near, DEPTH_DIVISOR_MIN);
  if (projection == PROJECTION_ORTHOGRAPHIC) {
    return from_far;
  }
  // near·far / (far - near) · (1 / distance - 1 / far), as a product that is 1 and 0 where it must be.
  float infinite = near / in_front;
  return projection == PROJECTION_PERSPECTIVE_INFINITE ? infinite : infinite * from_far;
}

/**
 * The inverse: metres along the view's axis, for \a depth in [0, 1]. What was cleared to 0 is at \a far, or, where that
 * is infinite, finitely far beyond everything: 1e30 times \a near.
 */
SHARED_FUNCTION float distance_of_depth(float depth, float near, float far, int projection)
{
  if (projection == PROJECTION_ORTHOGRAPHIC) {
    return far - depth * (far - near);
  }
  if (projection == PROJECTION_PERSPECTIVE_INFINITE) {
    return near / max(depth, DEPTH_DIVISOR_MIN);
  }
  // A sum of what is not negative: as exact at the far plane as at the near one.
  return near * (far / (near + depth * (far - near)));
}

SHARED_END

#endif
