// SPDX-License-Identifier: MIT
#include "view_fly.hh"

#include <algorithm>
#include <cmath>

namespace gnomon::view {

namespace {

/** The turn for a pointer that moves by the picture's height, radians. */
constexpr double look_angle = 1.5;
constexpr double fast_factor = 5.0;
constexpr double wheel_factor = 1.2;
/** Limit of the time of one step, so that a slow frame does not move the eye through walls unseen. */
constexpr double seconds_max = 0.1;

}  // namespace

void Fly::step(Navigation &navigation, const FlyInput &input)
{
  speed_ = std::clamp(speed_ * std::pow(wheel_factor, input.wheel), 1e-4, 1e6);
  navigation.turn(-look_angle * input.looked);
  const double metres = speed_ * (input.is_fast ? fast_factor : 1.0) * std::min(input.seconds, seconds_max);
  navigation.move(metres * input.direction);
}

}  // namespace gnomon::view
