// SPDX-License-Identifier: MIT
// For fragment shaders: their depth, also where the device moves vertices to a coarse grid, and interpolated values with them.
#ifdef HAS_COARSE_GRID
layout(location = 20) in vec4 grid_place;
layout(location = 21) in float grid_behind;
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
  vec2 place_px = grid_place.xy / grid_place.w;
  float depth = grid_place.z / grid_place.w;
  vec2 across = dFdx(place_px);
  vec2 up = dFdy(place_px);
  // The area of the triangle divided by its area after its corners were moved.
  float area = across.x * up.y - across.y * up.x;
  bool has_area = abs(area) > 1e-3;
  vec2 slope = vec2(dFdx(depth) * up.y - dFdy(depth) * across.y, dFdy(depth) * across.x - dFdx(depth) * up.x) / area;
  vec2 moved_px = gl_FragCoord.xy - place_px;
  bool is_kept = grid_behind <= 0.0 && dot(moved_px, moved_px) <= least_px * least_px;
  float change = dot(slope, moved_px);
  // Neither infinite nor NaN, as where corners are far outside of the picture.
  bool is_known = abs(change) <= 1.0;
  gl_FragDepth = gl_FragCoord.z + (has_area && !is_kept && is_known ? change : 0.0);
  if (!has_area && grid_behind <= 0.0) {
    discard;
  }
#endif
}
