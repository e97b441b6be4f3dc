// SPDX-License-Identifier: MIT
#ifndef EEVEE_DEPTH_SHARED_H
#define EEVEE_DEPTH_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Projection of a view. \see draw::perspective, draw::orthographic */
#define PROJECTION_PERSPECTIVE 0
/** The far plane is at infinity: `far` is not read. */
#define PROJECTION_PERSPECTIVE_INFINITE 1
#define PROJECTION_ORTHOGRAPHIC 2

/** Least divisor for which quotients stay finite. */
SHARED_CONSTANT float DEPTH_DIVISOR_MIN = 1e-30f;

/**
 * Reversed depth of a point at \a distance metres along the view's axis: 1 at \a near, 0 at \a far, outside [0, 1] beyond them.
 *
 * \a near, \a far: metres, \a far is greater than \a near. In perspective, near is above 0 and below 1e8, and a point that is
 * not in front of the eye has a finite depth above 1, which is nearer than all others.
 */
SHARED_FUNCTION float depth_of_distance(float distance, float near, float far, int projection)
{
  // In perspective, points behind the eye have no depth. They get the depth of the eye.
  float in_front = projection == PROJECTION_ORTHOGRAPHIC ? distance : max(distance, DEPTH_DIVISOR_MIN);
  float from_far = (far - in_front) / max(far - near, DEPTH_DIVISOR_MIN);
  if (projection == PROJECTION_ORTHOGRAPHIC) {
    return from_far;
  }
  // near·far / (far - near) · (1 / distance - 1 / far), written as a product that is exactly 1 at near and 0 at far.
  float infinite = near / in_front;
  return projection == PROJECTION_PERSPECTIVE_INFINITE ? infinite : infinite * from_far;
}

/**
 * The inverse of depth_of_distance: metres along the view's axis, for \a depth in [0, 1]. The cleared value 0 gives \a far, or
 * 1e30 times \a near if the far plane is at infinity.
 */
SHARED_FUNCTION float distance_of_depth(float depth, float near, float far, int projection)
{
  if (projection == PROJECTION_ORTHOGRAPHIC) {
    return far - depth * (far - near);
  }
  if (projection == PROJECTION_PERSPECTIVE_INFINITE) {
    return near / max(depth, DEPTH_DIVISOR_MIN);
  }
  // The sum has no negative terms, so it is as accurate at the far plane as at the near plane.
  return near * (far / (near + depth * (far - near)));
}

SHARED_END

#endif
