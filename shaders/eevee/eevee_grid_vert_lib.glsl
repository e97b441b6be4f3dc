// SPDX-License-Identifier: MIT
// For vertex shaders: the position of a vertex, also where the device moves vertices to a coarse grid.
#ifdef HAS_COARSE_GRID
/**
 * Place before the vertex is moved: x and y in pixels from the lower left corner, and the depth, each times w; w.
 * \see eevee_grid_lib.glsl
 */
layout(location = 20) out vec4 grid_place;
/** 1 behind the eye, 0 elsewhere. */
layout(location = 21) out float grid_behind;

/**
 * How far a vertex is moved, in pixels, so that edges along the rows and columns of pixels stay in place. The centres of pixels are points
 * of the grid, and belong to the surface to the right of or above an edge through them. Edges along rows and columns are moved onto centres
 * from both sides, and therefore half a cell to the left or down in the mean. A vertex that would be moved left or down onto a centre is
 * moved to the next column or row of the grid instead, if an axis of world space has that direction in the picture: few other edges go
 * through centres after they are moved, and would be to the right or above by this.
 */
vec2 step_over_centre(mat4 clip_from_world, vec2 place_px)
{
  // In cells of 1/16 pixels, the coarsest that Vulkan allows. From the middle of a cell, a vertex may be moved to either side.
  vec2 beyond = 16.0 * fract(place_px - 0.5);
  vec2 steps = vec2(0.0);
  for (int i = 0; i < 3; i++) {
    vec4 axis = abs(clip_from_world[i]);
    bvec2 is_along = lessThanEqual(axis.xy + axis.w, 1e-6 * axis.yx);
    for (int k = 0; k < 2; k++) {
      if (is_along[k] && axis[1 - k] > 0.0 && beyond[k] > 0.0 && beyond[k] < 0.51) {
        steps[k] = (1.0 - beyond[k]) / 16.0;
      }
    }
  }
  return steps;
}
#endif

/** The position in clip space. \a size_px: of the picture. */
vec4 placed_vertex(mat4 clip_from_world, vec4 position_ws, vec2 size_px)
{
  vec4 position = clip_from_world * position_ws;
#ifdef HAS_COARSE_GRID
  grid_place = vec4(0.5 * size_px * (position.xy + position.w), position.zw);
  grid_behind = position.w > 0.0 ? 0.0 : 1.0;
  if (position.w > 0.0) {
    position.xy += step_over_centre(clip_from_world, grid_place.xy / position.w) * 2.0 / size_px * position.w;
  }
#endif
  return position;
}
