// SPDX-License-Identifier: MIT
#pragma once

#include "view_app.hh"
#include "view_words.hh"

#include <filesystem>
#include <string>
#include <vector>

namespace gnomon::view {

/** A sequence of commands that operates the window. doc/view.md lists the commands. */
class Script {
 public:
  /** \throws std::runtime_error, which names the file, and the line if it is not a valid command */
  explicit Script(const std::filesystem::path &path);

  /**
   * Run the commands up to the next one that needs a frame. Call it before each frame, until is_done.
   * \throws std::runtime_error naming file, line and reason
   */
  void step(App &app);
  /** Whether all commands were run and all awaited pictures are complete. */
  [[nodiscard]] bool is_done() const
  {
    return next_ == lines_.size() && frames_ == 0 && !waits_ && awaited_.empty();
  }

 private:
  std::filesystem::path path_;
  std::vector<ScriptLine> lines_;
  std::size_t next_ = 0;
  /** The number of frames to draw before the next command. */
  int frames_ = 0;
  /** Waits until all pictures are complete. */
  bool waits_ = false;
  /** Has waited for the next command. \see Command::is_after_pictures */
  bool has_waited_ = false;
  /** Text of the message to wait for. Empty: none. */
  std::string awaited_;
  /** Number of messages up to the last awaited one. */
  std::size_t seen_ = 0;
};

}  // namespace gnomon::view
