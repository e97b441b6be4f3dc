// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

namespace gnomon::overlay {

/** The C++ layouts of the blocks that only overlays fill. Checks compare the layouts in GLSL with them. */
[[nodiscard]] std::span<const gpu::BlockLayout> block_layouts();

}  // namespace gnomon::overlay
