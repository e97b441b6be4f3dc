// SPDX-License-Identifier: MIT
#pragma once

#include "shader_check_blocks.hh"
#include "shader_check_compilation.hh"

namespace gnomon::shader_check {

/** Compare the block that \a binding and \a found both describe with C++'s \a layout of it. */
[[nodiscard]] BlockComparison compare_block(const Compilation &compilation,
                                            const gpu::ShaderInterface::Binding &binding, const StageDeclaration &found,
                                            const gpu::BlockLayout &layout);

}  // namespace gnomon::shader_check
