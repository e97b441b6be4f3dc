// SPDX-License-Identifier: MIT
#pragma once

#include "view_navigation.hh"

namespace gnomon::view {

/** The input of keys and pointer since the last step of a flight. */
struct FlyInput {
  /** Right, up and back, each -1, 0 or 1. */
  glm::dvec3 direction{0.0};
  /** The pointer's motion right and down, as fractions of the picture's height. */
  glm::dvec2 looked{0.0};
  /** Notches of the wheel, positive away from the user; positive values increase the speed. */
  double wheel = 0.0;
  bool is_fast = false;
  double seconds = 0.0;
};

/** State of fly mode, whose end keeps the current view or restores the first. */
class Fly {
 public:
  /** The initial speed is proportional to the distance to the orbit centre of \a navigation. */
  explicit Fly(const Navigation &navigation) : before_(navigation), speed_(0.5 * navigation.distance()) {}

  void step(Navigation &navigation, const FlyInput &input);
  /** The view at the start. */
  [[nodiscard]] const Navigation &before() const
  {
    return before_;
  }
  /** Metres per second. */
  [[nodiscard]] double speed() const
  {
    return speed_;
  }

 private:
  Navigation before_;
  double speed_;
};

}  // namespace gnomon::view
