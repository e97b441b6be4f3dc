// SPDX-License-Identifier: MIT
#pragma once

#include "view_document.hh"

#include <vector>

namespace gnomon::view {

/**
 * Plays an animation of the document's scene. Its poses are not edits: undo leaves them out, and a saved scene stays
 * saved.
 */
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
  /** Play or stop. After its end, the animation starts again. No effect without an animation. */
  void play(bool is_playing)
  {
    is_playing_ = is_playing && !is_empty();
  }
  /** The time of the last pose, seconds. */
  [[nodiscard]] double seconds() const
  {
    return seconds_;
  }
  /** Pose the scene. \a seconds: within the duration of the animation. \throws scene::InvalidEdit */
  void set_time(Document &document, double seconds);
  /** Pose the scene as set_time did last. No effect before the first pose. \throws scene::InvalidEdit */
  void pose_again(Document &document);
  /**
   * Pose the scene \a seconds later, if it plays. Time waits while a transform is running. A pose that fails stops the
   * animation. \throws scene::InvalidEdit
   */
  void step(Document &document, double seconds);
  /** Show it as a line of the current ImGui window. \throws scene::InvalidEdit */
  void show(Document &document);

 private:
  std::vector<scene::Animation> animations_;
  std::size_t chosen_ = 0;
  double seconds_ = 0.0;
  /** Whether set_time has posed the scene. */
  bool is_posed_ = false;
  bool is_playing_ = false;
};

}  // namespace gnomon::view
