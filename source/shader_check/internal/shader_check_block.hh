// SPDX-License-Identifier: MIT
#pragma once

#include "shader_check_blocks.hh"
#include "shader_check_compilation.hh"

namespace gnomon::shader_check {

/** Compares a block's layout in GLSL, given by \a binding and \a found, with its C++ \a layout. */
[[nodiscard]] BlockComparison compare_block(const Compilation &compilation,
                                            const gpu::ShaderInterface::Binding &binding, const StageDeclaration &found,
                                            const gpu::BlockLayout &layout);

}  // namespace gnomon::shader_check
