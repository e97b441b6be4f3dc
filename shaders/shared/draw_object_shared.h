// SPDX-License-Identifier: MIT
#ifndef DRAW_OBJECT_SHARED_H
#define DRAW_OBJECT_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** One object: an entry of `object_block`. */
struct ObjectData {
  mat4 world_from_object;
  /** Columns of the normal matrix, up to scale. \see draw::normal_matrix */
  vec3 normal_x;
  /** Index of the object in `object_block`. */
  uint index;
  /** w is unused. */
  vec4 normal_y;
  vec3 normal_z;
  /** Defined by the engine. Eevee stores the index in `material_block`. */
  uint value;
};
SHARED_ASSERT_SIZE(ObjectData, 112)

SHARED_END

#endif
