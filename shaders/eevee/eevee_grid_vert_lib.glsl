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

/**
 * A w at which the vertex is at most 2^25 pixels from the middle of the picture. SwiftShader has places of vertices in 1/16 pixels as
 * integers of 32 bits, also before it clips, and drew no triangle with an edge beside the eye, where w is 0. As seen from the eye, the
 * vertex moves by size_px / 2^26, in pixels the square of size_px / 2^13.5 where it is most.
 */
float distant_w(vec4 position, vec2 size_px)
{
  vec2 sides = abs(position.xy) * size_px;
  float least = exp2(-26.0) * max(sides.x, sides.y);
  return abs(position.w) >= least ? position.w : position.w < 0.0 ? -least : least;
}
#endif

/** The position in clip space. \a size_px: of the picture. */
vec4 placed_vertex(mat4 clip_from_world, vec4 position_ws, vec2 size_px)
{
  vec4 position = clip_from_world * position_ws;
#ifdef HAS_COARSE_GRID
  grid_place = vec4(0.5 * size_px * (position.xy + position.w), position.zw);
  grid_behind = position.w > 0.0 ? 0.0 : 1.0;
  position.w = distant_w(position, size_px);
  if (position.w > 0.0) {
    position.xy += step_over_centre(clip_from_world, grid_place.xy / position.w) * 2.0 / size_px * position.w;
  }
#endif
  return position;
}
