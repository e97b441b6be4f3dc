// SPDX-License-Identifier: MIT
#pragma once

#include "cli_output.hh"
#include "scene.hh"

#include <glm/vec2.hpp>

#include <filesystem>
#include <string>

namespace gnomon::cli {

/** The options of `gnomon render` for the frames of an animation. */
struct FrameOptions {
  /** "A-B" or "A"; empty: one picture without an animation. */
  std::string range;
  double frames_per_second = 24.0;
  /** Empty: the scene's first. */
  std::string animation;
  bool is_resumed = false;
};

/** The numbers, times and files of the frames of one command. */
class FrameSequence {
 public:
  /** \throws UsageError where the range is not one, or the output's name has no place for the number. */
  FrameSequence(FrameOptions options, std::filesystem::path output);

  /** false: one picture, of the scene as its file has it. */
  [[nodiscard]] bool is_animated() const
  {
    return !options_.range.empty();
  }
  [[nodiscard]] int count() const
  {
    return last_ - first_ + 1;
  }
  /** The number of the frame at a place from 0 to count() - 1. */
  [[nodiscard]] int number(int index) const
  {
    return first_ + index;
  }
  [[nodiscard]] double seconds(int index) const
  {
    return double(number(index)) / options_.frames_per_second;
  }
  /** The output's name with its last run of # replaced by the number, with at least as many digits. */
  [[nodiscard]] std::filesystem::path path(int index) const;
  /** The number and the time for the header of the frame's picture; empty for one picture without an animation. */
  [[nodiscard]] Metadata metadata(int index) const;
  /** Whether the frame need not be rendered: --resume was given, and its file can be read whole and has that size. */
  [[nodiscard]] bool is_done(int index, glm::ivec2 size_px) const;

  /** Sets \a scene to the frame's time. \throws std::runtime_error where the scene has no such animation. */
  void pose(scene::Scene &scene, int index) const;

  /** On a terminal: the frame, and an estimate of the time left from the frames that were rendered. */
  void show_progress(int index, int rendered_count, double rendered_seconds) const;

 private:
  FrameOptions options_;
  std::filesystem::path output_;
  int first_ = 0;
  int last_ = 0;
};

}  // namespace gnomon::cli
