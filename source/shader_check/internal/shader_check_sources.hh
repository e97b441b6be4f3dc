// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

namespace gnomon::shader_check {

/** A line of a source. */
struct SourcePosition {
  /** Index in gpu::ShaderSource::files. */
  std::size_t file = 0;
  /** From 1. */
  int line = 1;

  auto operator<=>(const SourcePosition &) const = default;
};

/** Offset of the first whole word \a word in \a text at or after \a from; npos if there is none. */
[[nodiscard]] std::size_t find_word(std::string_view text, std::string_view word, std::size_t from = 0);

/** The lines of a stage and its includes, with their files. */
class SourceLines {
 public:
  explicit SourceLines(const gpu::ShaderSource &source);

  /** The line as written; empty if there is none. */
  [[nodiscard]] std::string_view line(SourcePosition position) const;
  /** The first line with \a name as a word outside of comments; preferably one where \a keyword precedes it. */
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

}  // namespace gnomon::shader_check
