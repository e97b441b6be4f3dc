// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"
#include "scene.hh"

#include <glm/vec2.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace gnomon::cli {

/** Options of `gnomon render` for the frames of an animation. */
struct FrameOptions {
  /** "A-B" or "A"; empty: one picture without an animation. */
  std::string range{};
  /** From one frame to the next, at least 1. */
  int step = 1;
  double frames_per_second = 24.0;
  /** Part of the time of a frame for which the shutter is open. 0: no motion blur. */
  double shutter = 0.0;
  /** Names of animations, or "all"; empty: all that animate other things than those before them. */
  std::vector<std::string> animations{};
  /** Whether to skip frames whose files are complete. */
  bool is_resumed = false;
};

/** Numbers, times and files of the frames that one command renders. */
class FrameSequence {
 public:
  /**
   * \throws UsageError if the range is invalid or has more than 2^24 frames, if the step is below 1, if there are
   * several frames and the output's name has no #, or if it has one without a range
   */
  FrameSequence(FrameOptions options, std::filesystem::path output);

  /** false: the command renders one picture without an animation. */
  [[nodiscard]] bool is_animated() const
  {
    return !options_.range.empty();
  }
  [[nodiscard]] int first() const
  {
    return first_;
  }
  [[nodiscard]] int last() const
  {
    return last_;
  }
  [[nodiscard]] int count() const
  {
    return (last_ - first_) / options_.step + 1;
  }
  /** Number of a frame. \a index: from 0 to count() - 1, also in the following functions */
  [[nodiscard]] int number(int index) const
  {
    return first_ + index * options_.step;
  }
  /** Time of a frame. Frame number 0 is at 0 s. */
  [[nodiscard]] double seconds(int index) const
  {
    return double(number(index)) / options_.frames_per_second;
  }
  /** The output's path. The last run of # in its name is replaced by the frame number, padded with zeros. */
  [[nodiscard]] std::filesystem::path path(int index) const;
  /** Frame number and time for the header of the picture; empty without an animation. */
  [[nodiscard]] Metadata metadata(int index) const;
  /**
   * Whether the frame can be skipped: --resume was given, its file is readable and has the size \a size_px, and is of
   * the plan \a plan_id, if that is not empty.
   */
  [[nodiscard]] bool is_done(int index, glm::ivec2 size_px, const std::string &plan_id) const;

  /** If --resume was given, removes temporary files of frames that a killed process left. */
  void remove_unfinished_files() const;

  /**
   * Chooses the animations that pose() plays, and adds a warning to \a scene about animations that are left out.
   * \throws std::runtime_error that names the reason if there is nothing to play, or if named animations move the same
   * thing
   */
  void choose_animations(scene::Scene &scene);
  /** Whether each sample of a frame has another time. */
  [[nodiscard]] bool has_shutter() const
  {
    return is_animated() && options_.shutter > 0.0;
  }
  /** Poses \a scene at the frame's time, or at a \a place from 0 to 1 in the time of its shutter, whose middle it is.
   */
  void pose(scene::Scene &scene, int index, double place = 0.5) const;

 private:
  FrameOptions options_;
  std::filesystem::path output_;
  int first_ = 0;
  int last_ = 0;
  /** All that are played, as one. */
  scene::Animation animation_;
};

}  // namespace gnomon::cli
