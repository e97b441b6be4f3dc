// SPDX-License-Identifier: MIT
// For fragment shaders: their depth and interpolated values, also where the device moves vertices to a coarse grid.
#ifdef HAS_COARSE_GRID
layout(location = 20) in vec4 grid_place;
layout(location = 21) in float grid_behind;

/** The place in the picture that interpolated values are of, which may be beside the centre of the pixel, and its derivatives. */
vec2 grid_place_px = grid_place.xy / grid_place.w;
mat2 grid_step_px = mat2(dFdx(grid_place_px), dFdy(grid_place_px));
vec2 grid_moved_px = gl_FragCoord.xy - grid_place_px;
/** Whether the triangle's area before its corners were moved is more than a thousandth of that after. */
bool grid_has_area = abs(determinant(grid_step_px)) > 1e-3;
/** Factors of derivatives, whose sum is the change of an interpolated value from its place to the centre of the pixel. */
vec2 grid_steps = grid_has_area ? inverse(grid_step_px) * grid_moved_px : vec2(0.0);
/** The same, for values that have no bound: 0 where corners are so far outside of the picture that the place is unknown. */
vec2 grid_near_steps = dot(grid_moved_px, grid_moved_px) <= 4.0 ? grid_steps : vec2(0.0);

/**
 * Declares an input, and a variable with its value at the centre of the pixel. Colours are inputs without it: beside a triangle that is
 * smaller than a pixel, they would be outside of the range of those of its corners.
 */
#  define INTERPOLATED(LOCATION, TYPE, NAME, INPUT) \
    layout(location = LOCATION) in TYPE INPUT; \
    TYPE NAME = INPUT + grid_near_steps.x * dFdx(INPUT) + grid_near_steps.y * dFdy(INPUT);
#else
#  define INTERPOLATED(LOCATION, TYPE, NAME, INPUT) layout(location = LOCATION) in TYPE NAME;
#endif

/**
 * Write the depth of the triangle's plane at the centre of the pixel. The interpolated one is that of another place of the plane, on
 * large triangles far from the pixel. If that place is within \a least_px, and no part of the triangle is behind the eye, the interpolated
 * depth is kept: where two surfaces touch, their edge would be moved less, but always into the smaller one. Discards triangles without
 * area, whose corners the grid moves out of their line. Does nothing on other devices.
 */
void write_depth_on_plane(float least_px)
{
#ifdef HAS_COARSE_GRID
  float depth = grid_place.z / grid_place.w;
  bool is_kept = grid_behind <= 0.0 && dot(grid_moved_px, grid_moved_px) <= least_px * least_px;
  float change = grid_steps.x * dFdx(depth) + grid_steps.y * dFdy(depth);
  // Neither infinite nor NaN, as where corners are far outside of the picture.
  bool is_known = abs(change) <= 1.0;
  gl_FragDepth = gl_FragCoord.z + (!is_kept && is_known ? change : 0.0);
  if (!grid_has_area && grid_behind <= 0.0) {
    discard;
  }
#endif
}
