// SPDX-License-Identifier: MIT
// glslang's messages, and messages of bounded length.
#pragma once

#include "shader_check.hh"
#include "shader_check_sources.hh"

namespace gnomon::shader_check {

/** \a text, or its beginning and length if it is too long for a message: tokens may have any length. */
[[nodiscard]] std::string bounded(std::string_view text);
/** bounded() of each line. */
[[nodiscard]] std::string bounded_lines(std::string_view text);

struct CompileMessage {
  Severity severity = Severity::Error;
  std::string_view rule;
  SourcePosition position;
  std::string text;
};

/** The messages of glslang's log about \a source, in its order, without those that only follow from an earlier error.
 */
[[nodiscard]] std::vector<CompileMessage> compile_messages(std::string_view log, StageSource &source);

struct LinkMessage {
  Severity severity = Severity::Error;
  std::string text;
};

[[nodiscard]] std::vector<LinkMessage> link_messages(std::string_view log);

}  // namespace gnomon::shader_check
