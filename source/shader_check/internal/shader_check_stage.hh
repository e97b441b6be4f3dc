// SPDX-License-Identifier: MIT
// Reads the declarations of a stage, their use and likely mistakes from glslang's tree.
#pragma once

#include "shader_check_sources.hh"

#include <glslang/Public/ShaderLang.h>

namespace gnomon::shader_check {

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
};

/** A block, texture, stage input or stage output. Types belong to the glslang program. */
struct Declaration {
  std::string name;
  const glslang::TType *type = nullptr;
  SourcePosition position;
  int set = 0;
  /** -1: none. */
  int slot = -1;
  int location = -1;
  int location_count = 1;
  /** The first component within the location, and the number of components; 0: all four. */
  int component = 0;
  int component_count = 0;
  /** Whether the outermost array holds the vertices or primitives that a stage works on. */
  bool is_arrayed = false;
  /** Whether transform feedback captures the output. */
  bool is_captured = false;
  /** Whether it is a member of a block of inputs or outputs: its use is known for the whole block only. */
  bool is_member = false;
  bool is_used = false;
  bool is_push_constant = false;
  /** Whether it is an image, which OpenGL numbers apart from textures. */
  bool is_image = false;
  /** Blocks. */
  std::vector<BlockMember> members;
};

struct StageFacts {
  std::vector<Declaration> uniform_blocks;
  std::vector<Declaration> storage_blocks;
  std::vector<Declaration> textures;
  std::vector<Declaration> inputs;
  std::vector<Declaration> outputs;
  std::vector<StageFinding> findings;
};

/** Call it after linking, which removes functions without a caller. Otherwise their uses count, too. */
[[nodiscard]] StageFacts read_stage(const glslang::TIntermediate &tree, const SourceLines &lines);

}  // namespace gnomon::shader_check
