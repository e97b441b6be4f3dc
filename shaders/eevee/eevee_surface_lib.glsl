// SPDX-License-Identifier: MIT

/** The point being lit. World space, unit vectors. */
struct Surface {
  vec3 position_ws;
  /** Shading normal, on the side that is seen. */
  vec3 normal_ws;
  /** Of the triangle, on the side that is seen. */
  vec3 geometric_normal_ws;
  /** Towards the viewer. */
  vec3 view_ws;
};
