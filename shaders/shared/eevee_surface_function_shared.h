// SPDX-License-Identifier: MIT
#ifndef EEVEE_SURFACE_FUNCTION_SHARED_H
#define EEVEE_SURFACE_FUNCTION_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Content of `surface_function_block`. */
struct SurfaceFunctionData {
  /** The device's origin in the scene's world space, metres. */
  vec3 origin_ws;
  /** Factor of the light that surfaces emit: 0 in pictures of a part of the light without emission, otherwise 1. */
  float emission;
};
SHARED_ASSERT_SIZE(SurfaceFunctionData, 16)

SHARED_END

#endif
