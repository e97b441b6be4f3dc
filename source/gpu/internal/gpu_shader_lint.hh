// SPDX-License-Identifier: MIT
// Reads glslang's tree of a stage: what it declares, what it uses, and what is likely a mistake.
#pragma once

#include "gpu_glslang.hh"

#include <map>
#include <set>

namespace gnomon::gpu {

/** Where something stands in a source. */
struct SourcePosition {
  /** In ShaderSource::files. */
  std::size_t file = 0;
  int line = 1;

  auto operator<=>(const SourcePosition &) const = default;
};

/** The lines of a stage with its includes in place, by where each came from. */
class SourceLines {
 public:
  explicit SourceLines(const ShaderSource &source);

  /** The line as it was written; empty where there is none. */
  [[nodiscard]] std::string_view line(SourcePosition position) const;
  /** The first line, outside of comments, that holds \a name as a word; one with \a keyword before it is preferred. */
  [[nodiscard]] SourcePosition find_declaration(std::string_view name, std::string_view keyword) const;

 private:
  struct Line {
    SourcePosition position;
    std::string text;
    /** Without comments. */
    std::string code;
  };
  std::vector<Line> lines_;
};

/** Something at a line, rule and text as in CheckMessage. */
struct LintFinding {
  std::string_view rule;
  SourcePosition position;
  std::string text;
  bool is_error = false;
};

struct BlockMember {
  /** As reflection names it: `lights[0].color`. */
  std::string name;
  /** The struct that it is declared in; empty: the block itself. */
  std::string structure;
  SourcePosition position;
};

/** A block, a texture, a stage's input or output. Types belong to the glslang program. */
struct Declaration {
  std::string name;
  const glslang::TType *type = nullptr;
  SourcePosition position;
  int set = 0;
  /** -1: none. */
  int slot = -1;
  int location = -1;
  int location_count = 1;
  bool is_used = false;
  /** Blocks. */
  std::vector<BlockMember> members;
};

struct StageFacts {
  std::vector<Declaration> uniform_blocks;
  std::vector<Declaration> storage_blocks;
  std::vector<Declaration> textures;
  std::vector<Declaration> inputs;
  std::vector<Declaration> outputs;
  bool has_push_constants = false;
  std::vector<LintFinding> findings;
};

/** GLSL's name of the type. \a is_arrayed: an element a vertex, as a geometry shader's inputs have, is not a part of
 * it. */
[[nodiscard]] std::string interface_type(const Declaration &declaration, bool is_arrayed);

/** After linking, which drops functions that nothing calls; before it they count, too. */
[[nodiscard]] StageFacts read_stage(const glslang::TIntermediate &tree, const SourceLines &lines);

}  // namespace gnomon::gpu
