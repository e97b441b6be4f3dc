// SPDX-License-Identifier: MIT
#ifndef OVERLAY_LINE_SHARED_H
#define OVERLAY_LINE_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** One line: an entry of `line_block`. */
struct LineData {
  /** World space, metres, as is to_ws. */
  vec3 from_ws;
  /** Pixels. */
  float width_px;
  vec3 to_ws;
  /** 1: objects do not hide the line. */
  uint is_on_top;
  /** Not premultiplied. */
  vec4 color;
};
SHARED_ASSERT_SIZE(LineData, 48)

SHARED_END

#endif
