// SPDX-License-Identifier: MIT
// The declarations of a stage, their use and likely mistakes.
#pragma once

#include "shader_check_program.hh"
#include "shader_check_sources.hh"

#include <glslang/Public/ShaderLang.h>

namespace gnomon::shader_check {

/** The type of a declaration or of a member of a block. */
struct DeclaredType {
  /** GLSL's name without the sizes of arrays. */
  std::string name;
  /** The type of each component, such as `float`; empty: structs, and types such as samplers. */
  std::string scalar;
  /** 1: scalars, structs and others. */
  int vector_size = 1;
  /** Rows of a matrix; 0: no matrix. */
  int row_count = 0;
  bool is_struct = false;
  /** The sizes of arrays, outermost first; 0: the shader gives none. */
  std::vector<int> array_sizes;
};

/** GLSL's name of a type. \a is_arrayed: leave out the outermost array, the vertices of a primitive. */
[[nodiscard]] std::string type_name(const DeclaredType &type, bool is_arrayed = false);

/** A mistake at a line; rule and text as in CheckMessage. */
struct StageFinding {
  std::string_view rule;
  SourcePosition position;
  std::string text;
  bool is_error = false;
};

struct BlockMember {
  /** Name as in reflection: `lights[0].color`. */
  std::string name;
  /** Name of the struct that declares it; empty for the block itself. */
  std::string structure;
  SourcePosition position;
  /** The type and the place in the block. Only read_spirv() sets them. */
  DeclaredType type{};
  std::uint32_t offset_bytes = 0;
  std::uint32_t size_bytes = 0;
  std::vector<ProgramBinding::Array> arrays{};
  std::uint32_t matrix_stride_bytes = 0;
  bool is_row_major = false;
};

/** A block, texture, stage input or stage output. */
struct Declaration {
  std::string name;
  DeclaredType type;
  SourcePosition position;
  int set = 0;
  /** -1: none. */
  int slot = -1;
  int location = -1;
  int location_count = 1;
  /** The first component within each location, and the number of components; 0: all four. */
  int component = 0;
  int component_count = 0;
  /** Whether the outermost array holds the vertices or primitives that a stage works on. */
  bool is_arrayed = false;
  /** Whether transform feedback captures the output. */
  bool is_captured = false;
  bool is_used = false;
  /** Members of a block of inputs or outputs: whether the stage uses this or another member. */
  bool is_block_used = false;
  /** Inputs and outputs, from the syntax tree only. */
  bool is_flat = false;
  bool is_no_perspective = false;
  bool is_invariant = false;
  bool is_push_constant = false;
  /** The same as in StageVariable and ProgramBinding. Only read_spirv() sets them. */
  int index = 0;
  std::string_view format{};
  std::vector<std::string_view> qualifiers{};
  int attachment = -1;
  std::uint32_t offset_bytes = 0;
  /** Whether it is an image, which OpenGL numbers apart from textures. */
  bool is_image = false;
  /**
   * Blocks, and inputs and outputs whose type is a struct. The types of the latter have the sizes of all arrays around
   * the member, without that of `is_arrayed`.
   */
  std::vector<BlockMember> members;
  /** Blocks. A uniform block ends at the end of its last member's row of 16 bytes. */
  std::uint32_t size_bytes = 0;
};

struct StageFacts {
  std::vector<Declaration> uniform_blocks;
  std::vector<Declaration> storage_blocks;
  std::vector<Declaration> textures;
  /** Outside of blocks. From SPIR-V, of structs each member. */
  std::vector<Declaration> uniforms;
  std::vector<Declaration> inputs;
  std::vector<Declaration> outputs;
  /** Only read_spirv() sets them. */
  std::vector<ProgramConstant> constants;
  std::optional<Workgroup> workgroup;
  std::vector<StageFinding> findings;
};

/** Whether each component takes 64 bits. */
[[nodiscard]] bool is_64_bit(const DeclaredType &type);

/** Sets the components of an input or output each of whose elements takes one location. */
void set_components(Declaration &declaration, int first);

/** Reports \a member if it is an array whose elements C++ packs. \a has_rows: whether each element fills 16 bytes. */
void check_array(const DeclaredType &type, bool has_rows, const BlockMember &member,
                 std::vector<StageFinding> &findings);

/**
 * Reads glslang's tree. Call it after linking, which removes functions without a caller. Otherwise their uses count,
 * too. \a with_mistakes: also look for mistakes in functions.
 */
[[nodiscard]] StageFacts read_tree(const glslang::TIntermediate &tree, const SourceLines &lines, bool with_mistakes);
/** Reads declarations and their use, but no mistakes in functions, from \a spirv, which glslang made after linking. */
[[nodiscard]] StageFacts read_spirv(std::span<const std::uint32_t> spirv, Stage stage, const SourceLines &lines);

}  // namespace gnomon::shader_check
