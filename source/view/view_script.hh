// SPDX-License-Identifier: MIT
#pragma once

#include "view_app.hh"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::view {

/** A line of a script: a command and its arguments. */
struct ScriptLine {
  int number = 0;
  std::vector<std::string> words;
};

/**
 * Lines that are not empty. Words are separated by spaces; one with spaces is in double quotes; # begins a comment.
 * \throws std::runtime_error naming the line, where a quote is not closed
 */
[[nodiscard]] std::vector<ScriptLine> parse_script(std::string_view text);

/** Commands that do what a person would do. doc/view.md lists them. */
class Script {
 public:
  /** \throws std::runtime_error naming the file where it cannot be read, and the line that is no command */
  explicit Script(const std::filesystem::path &path);

  /**
   * Run the commands up to the next one that needs a frame. Call it before each frame, until is_done.
   * \throws std::runtime_error naming file, line and reason
   */
  void step(App &app);
  /** All commands were run, and the pictures that they wait for are complete. */
  [[nodiscard]] bool is_done() const
  {
    return next_ == lines_.size() && frames_ == 0 && !waits_ && awaited_.empty();
  }

 private:
  std::filesystem::path path_;
  std::vector<ScriptLine> lines_;
  std::size_t next_ = 0;
  /** To be drawn before the next command. */
  int frames_ = 0;
  /** For all pictures to be complete. */
  bool waits_ = false;
  /** For a message with this text; empty: for none. */
  std::string awaited_;
  /** Messages that were awaited, and those before them. */
  std::size_t seen_ = 0;
};

}  // namespace gnomon::view
