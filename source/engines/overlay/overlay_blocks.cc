// SPDX-License-Identifier: MIT
#include "overlay_blocks.hh"

#include "overlay_line_shared.h"

#include <array>

namespace gnomon::overlay {

namespace {

using Field = gpu::BlockLayout::Field;
using shared::LineData;

constexpr auto line_fields = std::to_array<Field>({
    {"lines[0].from_ws", offsetof(LineData, from_ws)},
    {"lines[0].width_px", offsetof(LineData, width_px)},
    {"lines[0].to_ws", offsetof(LineData, to_ws)},
    {"lines[0].is_on_top", offsetof(LineData, is_on_top)},
    {"lines[0].color", offsetof(LineData, color)},
});

constexpr std::array<gpu::BlockLayout, 1> layouts = {{
    {"line_block", sizeof(LineData), line_fields},
}};

}  // namespace

std::span<const gpu::BlockLayout> block_layouts()
{
  return layouts;
}

}  // namespace gnomon::overlay
