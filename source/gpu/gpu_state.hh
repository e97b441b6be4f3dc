// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace gnomon::gpu {

/** Fixed-function state of a draw, as a mask. What is not named is off. */
enum class State : std::uint32_t {
  None = 0,
  WriteColor = 1U << 0,
  WriteDepth = 1U << 1,
  /** Passes what is nearer than, or as near as, what is stored. */
  DepthNearerEqual = 1U << 2,
  /** Passes what has exactly the stored depth. */
  DepthEqual = 1U << 3,
  CullBack = 1U << 4,
  CullFront = 1U << 5,
  /** The front is where the vertices go clockwise: objects whose matrix mirrors. */
  FrontClockwise = 1U << 6,
  /** Colour is added to what is there. */
  BlendAdd = 1U << 7,
  /** What lies before the near or behind the far plane is drawn on it instead of cut off. */
  DepthClamp = 1U << 8,
  /** What is there is multiplied by the colour. */
  BlendMultiply = 1U << 9,
};

constexpr State operator|(State a, State b)
{
  return State(std::uint32_t(a) | std::uint32_t(b));
}
constexpr State without(State mask, State bits)
{
  return State(std::uint32_t(mask) & ~std::uint32_t(bits));
}
constexpr bool has(State mask, State bit)
{
  return (std::uint32_t(mask) & std::uint32_t(bit)) != 0;
}

/** "write_depth depth_nearer_equal"; "none" for an empty mask. */
[[nodiscard]] std::string to_string(State mask);

}  // namespace gnomon::gpu
