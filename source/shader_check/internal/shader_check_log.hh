// SPDX-License-Identifier: MIT
// glslang's messages, and messages of bounded length.
#pragma once

#include "shader_check.hh"
#include "shader_check_sources.hh"

namespace gnomon::shader_check {

/** \a text, or its start and its length if it is longer than a reader wants: tokens may have any length. */
[[nodiscard]] std::string bounded(std::string_view text);
/** bounded() of each line. */
[[nodiscard]] std::string bounded_lines(std::string_view text);

struct CompileMessage {
  Severity severity = Severity::Error;
  SourcePosition position;
  std::string text;
};

/** The messages of a compiler's log that name a line. Those that only follow from an earlier one are left out. */
[[nodiscard]] std::vector<CompileMessage> compile_messages(std::string_view log);

struct LinkMessage {
  std::string text;
  /** The name of the declaration at fault; empty: unknown. */
  std::string name;
};

[[nodiscard]] std::vector<LinkMessage> link_messages(std::string_view log);

}  // namespace gnomon::shader_check
