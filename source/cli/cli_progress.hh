// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace gnomon::cli {

/**
 * Progress of a command on stderr: a line that is replaced, if stderr is a terminal, and the lines of --progress, which
 * programs that manage farms read: "PROGRESS 12.5%".
 */
class Progress {
 public:
  /** \a picture_count: pictures of the command. \a sample_count: samples of each; 0: unknown, for the time limits them
   */
  Progress(bool has_lines, int picture_count, int sample_count);

  /** \a picture: from 0. \a samples_drawn: of this picture */
  void drawn(int picture, int samples_drawn);
  /** The picture is written. \a seconds_left: estimate for the others */
  void written(int picture, double seconds_left);

 private:
  void show_part(double part);

  bool has_lines_;
  bool is_terminal_;
  int picture_count_;
  int sample_count_;
  /** The progress in the last line, tenths of a percent; negative: none. */
  std::int64_t shown_ = -1;
};

}  // namespace gnomon::cli
