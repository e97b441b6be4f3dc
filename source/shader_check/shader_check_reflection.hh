// SPDX-License-Identifier: MIT
// The interface of a program, read by glslang. Needs no driver and no device. Any thread may call these functions.
#pragma once

#include "gpu_shader.hh"

namespace gnomon::shader_check {

/**
 * Compiles and links with glslang for OpenGL 4.5, and reads the interface. It is a gpu::ShaderReflection.
 *
 * \throws gpu::Error with glslang's message, which names file and line; also for a binding without a slot, and for two
 * bindings of one kind with the same slot.
 */
[[nodiscard]] gpu::ShaderInterface reflect(std::string_view name, const std::vector<gpu::ShaderSource> &stages);

}  // namespace gnomon::shader_check
