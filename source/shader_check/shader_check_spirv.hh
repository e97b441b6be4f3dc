// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

namespace gnomon::shader_check {

/** gpu::SpirvCompiler with glslang and the optimiser of SPIRV-Tools. Threads may call it concurrently. */
[[nodiscard]] std::vector<gpu::SpirvStage> compile_spirv(std::string_view name,
                                                         const std::vector<gpu::ShaderSource> &stages);

}  // namespace gnomon::shader_check
