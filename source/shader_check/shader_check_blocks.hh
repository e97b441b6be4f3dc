// SPDX-License-Identifier: MIT
// Compares the layout of blocks in C++ and GLSL.
#pragma once

#include "gpu_shader.hh"

namespace gnomon::shader_check {

/** A block, field by field: its layout in C++ and its layout in GLSL. */
struct BlockComparison {
  struct Field {
    /** The name of the GLSL struct that declares the field; empty: the block itself. */
    std::string structure;
    /** Name as in gpu::BlockLayout. */
    std::string name;
    std::optional<std::size_t> cpp_offset_bytes;
    std::optional<std::size_t> glsl_offset_bytes;
    /** File of the field in GLSL, or of the struct or block that lacks it. */
    std::string file;
    int line = 1;
  };
  std::string block;
  std::size_t cpp_size_bytes = 0;
  std::size_t glsl_size_bytes = 0;
  /** Fields in GLSL's order, followed by the fields that only C++ has. */
  std::vector<Field> fields;
  /** File of the block in GLSL. */
  std::string file;
  int line = 1;
};

/** Compares the blocks that \a desc reads and \a blocks contains. \throws gpu::Error if \a desc does not compile. */
[[nodiscard]] std::vector<BlockComparison> compare_blocks(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files,
                                                          std::span<const gpu::BlockLayout> blocks);

struct BlockDifference {
  std::string file;
  int line = 1;
  /** One sentence. */
  std::string text;
};

/** The differences between C++ and GLSL; empty: the layouts are equal. */
[[nodiscard]] std::vector<BlockDifference> differences(const BlockComparison &comparison);

}  // namespace gnomon::shader_check
