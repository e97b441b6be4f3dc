// SPDX-License-Identifier: MIT
#ifndef DRAW_OBJECT_SHARED_H
#define DRAW_OBJECT_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** An entry of `object_block`. */
struct ObjectData {
  mat4 world_from_object;
  /** Columns of the matrix for normals, up to scale; w unused. \see draw::normal_matrix */
  vec4 normal_x;
  vec4 normal_y;
  vec3 normal_z;
  /** The engine's: eevee's index in `material_block`. */
  uint value;
};
SHARED_ASSERT_SIZE(ObjectData, 112)

SHARED_END

#endif
