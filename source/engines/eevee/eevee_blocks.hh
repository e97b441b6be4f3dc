// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

namespace gnomon::eevee {

/** The C++ layouts of all blocks that the engine fills. Checks and tests compare the layouts in GLSL with them. */
[[nodiscard]] std::span<const gpu::BlockLayout> block_layouts();

}  // namespace gnomon::eevee
