// SPDX-License-Identifier: MIT
// The view of the pass.
#include "shared/draw_view_shared.h"
#include "shared/slots_shared.h"

layout(std140, binding = VIEW_BLOCK_SLOT) uniform view_block
{
  ViewData view;
};
