// SPDX-License-Identifier: MIT
#ifndef DRAW_OBJECT_SHARED_H
#define DRAW_OBJECT_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** One object: an entry of `object_block`. */
struct ObjectData {
  mat4 world_from_object;
  /** Columns of the normal matrix, up to scale. w is unused. \see draw::normal_matrix */
  vec4 normal_x;
  vec4 normal_y;
  vec3 normal_z;
  /** Defined by the engine. Eevee stores the index in `material_block`. */
  uint value;
};
SHARED_ASSERT_SIZE(ObjectData, 112)

SHARED_END

#endif
