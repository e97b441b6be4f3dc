// SPDX-License-Identifier: MIT
// Froxels: a grid of columns and rows across the view and of slices along its depth. Each has a list of the lights that can reach it.
#ifndef EEVEE_LIGHT_CLUSTER_SHARED_H
#define EEVEE_LIGHT_CLUSTER_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Texels of a light in `light_texture`: four rows of LightData, with integers as floats, and three of LightShape. */
#define LIGHT_TEXELS 7
/** The largest number of lights. Devices whose texture buffers are smaller have fewer. */
#define LIGHT_COUNT_MAX 65536

/** Content of `light_cluster_block`. */
struct LightClusterBlock {
  /**
   * Maps a point in world space: x / w is the column and y / w the row, with their fractions; z is the depth along the view
   * direction, metres. w is the depth in a perspective view, and 1 in an orthographic one.
   */
  mat4 grid_from_world;
  /** The slice is slice_scale · f + slice_bias. f: the natural logarithm of the depth, orthographic: the depth. */
  float slice_scale;
  float slice_bias;
  int is_perspective;
  int column_count;
  int row_count;
  int slice_count;
  /** LightBlock::cube_light_count. */
  int cube_light_count;
  /** The first of the lights before cube_light_count reach everywhere: this many, which are in no list. */
  int cube_everywhere_count;
  /** The same for the lights from cube_light_count on. */
  int other_everywhere_count;
  /** LightBlock::surface_point_count, and the index of the first of them. They are in no list. */
  int surface_point_count;
  int first_surface_point;
  int _pad0;
};
SHARED_ASSERT_SIZE(LightClusterBlock, 112)

/**
 * Index of the froxel of a point, in order of slices, rows and columns. Points outside of the grid belong to the nearest
 * froxel.
 */
SHARED_FUNCTION int light_froxel(LightClusterBlock grid, vec3 position_ws)
{
  vec4 p = grid.grid_from_world * vec4(position_ws, 1.0f);
  // Points at and behind the eye are outside of the view.
  float w = max(p.w, 1e-30f);
  float f = grid.is_perspective != 0 ? log(max(p.z, 1e-30f)) : p.z;
  int column = int(clamp(p.x / w, 0.0f, float(grid.column_count - 1)));
  int row = int(clamp(p.y / w, 0.0f, float(grid.row_count - 1)));
  int slice = int(clamp(grid.slice_scale * f + grid.slice_bias, 0.0f, float(grid.slice_count - 1)));
  int froxel = (slice * grid.row_count + row) * grid.column_count + column;
  // clamp and the conversion to an integer are undefined for NaN.
  return clamp(froxel, 0, grid.slice_count * grid.row_count * grid.column_count - 1);
}

SHARED_END

#endif
