// SPDX-License-Identifier: MIT
#pragma once

#include "view_document.hh"

#include <vector>

namespace gnomon::view {

/** Plays an animation of the document's scene. Its poses are no edits, for undo as for the mark of unsaved ones. */
class TimeLine {
 public:
  /** Offer the animations of \a scene: all at once, if there are several that can be joined, and each. */
  void open(const scene::Scene &scene);
  /** Whether the scene has no animation. */
  [[nodiscard]] bool is_empty() const
  {
    return animations_.empty();
  }
  [[nodiscard]] bool is_playing() const
  {
    return is_playing_;
  }
  /** Play, from the begin again after the end, or stop. No effect without an animation. */
  void play(bool is_playing)
  {
    is_playing_ = is_playing && !is_empty();
  }
  /** Of the last pose, seconds. */
  [[nodiscard]] double seconds() const
  {
    return seconds_;
  }
  /** Pose the scene. \a seconds: within the duration of the animation. \throws scene::InvalidEdit */
  void set_time(Document &document, double seconds);
  /** Pose the scene \a seconds later, if it plays. A pose that fails ends that. \throws scene::InvalidEdit */
  void step(Document &document, double seconds);
  /** Show it as a line of the current ImGui window. \throws scene::InvalidEdit */
  void show(Document &document);

 private:
  std::vector<scene::Animation> animations_;
  std::size_t chosen_ = 0;
  double seconds_ = 0.0;
  bool is_playing_ = false;
};

}  // namespace gnomon::view
