// SPDX-License-Identifier: MIT
// The view of the pass.
#include "shared/draw_view_shared.h"
#include "shared/slots_shared.h"

layout(std140, binding = VIEW_BLOCK_SLOT) uniform view_block
{
  ViewData view;
};

/** From a point of world space towards the viewer, of any length. */
vec3 to_viewer(vec3 position_ws)
{
  return view.is_perspective != 0 ? view.position_ws - position_ws : view.back_ws;
}
