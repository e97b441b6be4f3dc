// SPDX-License-Identifier: MIT
#pragma once

#include "shader_check.hh"

namespace gnomon::cli {

/** The outcome of a check of several shaders. */
struct ShaderReport {
  std::vector<shader_check::CheckMessage> messages;
  std::size_t program_count = 0;
  std::size_t variant_count = 0;
  std::vector<shader_check::CheckTarget> targets;
  /** The target of a program, where it follows from the program's files. */
  struct Choice {
    std::string program;
    shader_check::CheckTarget target;
    /** A clause. */
    std::string reason;
  };
  std::vector<Choice> choices;
  double seconds = 0.0;

  [[nodiscard]] bool has_errors() const;
};

/**
 * Lines of the form `FILE:LINE: error: TEXT [RULE] (WHERE)`, one for all variants with the same message, and a summary.
 */
[[nodiscard]] std::string to_text(const ShaderReport &report);
[[nodiscard]] std::string to_json(const ShaderReport &report);
/** SARIF 2.1.0, a format for code hosts and editors. */
[[nodiscard]] std::string to_sarif(const ShaderReport &report);

}  // namespace gnomon::cli
