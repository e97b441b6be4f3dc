// SPDX-License-Identifier: MIT
#ifdef USE_MULTISCATTER
#  include "shared/eevee_multiscatter_shared.h"
#endif

/** The shaded point. World space; all vectors have unit length. */
struct Surface {
  vec3 position_ws;
  /** Shading normal, on the visible side. */
  vec3 normal_ws;
#ifdef USE_FULL_MATERIAL
  /** Shading normal without the normal texture. */
  vec3 smooth_normal_ws;
#endif
  /** Normal of the triangle, on the visible side. */
  vec3 geometric_normal_ws;
  /** Towards the viewer. */
  vec3 view_ws;
#ifdef USE_MULTISCATTER
  /** \see multiscatter_of */
  Multiscatter multiscatter;
#endif
};

/** Unit vector in the direction of \a v; \a fallback for the zero vector. */
vec3 normalized(vec3 v, vec3 fallback)
{
  float length_sq = dot(v, v);
  return length_sq > 0.0 ? v * inversesqrt(length_sq) : fallback;
}

/** A unit vector perpendicular to the unit vector \a n. */
vec3 any_across(vec3 n)
{
  return normalize(abs(n.z) < 0.9 ? vec3(n.y, -n.x, 0.0) : vec3(0.0, n.z, -n.y));
}
