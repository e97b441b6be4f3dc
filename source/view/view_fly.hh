// SPDX-License-Identifier: MIT
#pragma once

#include "view_navigation.hh"

namespace gnomon::view {

/** What keys and pointer ask for since the last step of a flight. */
struct FlyInput {
  /** Right, up and back, each -1, 0 or 1. */
  glm::dvec3 direction{0.0};
  /** Of the pointer: right and down, as fractions of the picture's height. */
  glm::dvec2 looked{0.0};
  /** Notches of the wheel, away from the user: faster. */
  double wheel = 0.0;
  bool is_fast = false;
  double seconds = 0.0;
};

/** A flight through the scene, which ends where it is or where it began. */
class Fly {
 public:
  /** The speed suits the distance to the point that \a navigation turns around. */
  explicit Fly(const Navigation &navigation) : before_(navigation), speed_(0.5 * navigation.distance()) {}

  void step(Navigation &navigation, const FlyInput &input);
  /** Where it began. */
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
