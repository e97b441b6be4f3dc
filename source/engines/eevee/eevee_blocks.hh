// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

namespace gnomon::eevee {

/** Every block that the engine fills, field by field as C++ has it: what checks and tests compare GLSL with. */
[[nodiscard]] std::span<const gpu::BlockLayout> block_layouts();

}  // namespace gnomon::eevee
