// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace gnomon::gpu {

/** Fixed-function state of a draw, as a mask. A bit that is not set disables its function. */
enum class State : std::uint32_t {
  None = 0,
  WriteColor = 1U << 0,
  WriteDepth = 1U << 1,
  /** Depth test: passes where the depth is nearer than or equal to the stored depth. */
  DepthNearerEqual = 1U << 2,
  /** Depth test: passes where the depth equals the stored depth. */
  DepthEqual = 1U << 3,
  CullBack = 1U << 4,
  CullFront = 1U << 5,
  /** Front faces have clockwise vertices: for objects whose matrix mirrors. */
  FrontClockwise = 1U << 6,
  /** The colour is added to the stored colour. */
  BlendAdd = 1U << 7,
  /** Geometry before the near plane or behind the far plane is drawn at the depth of that plane instead of clipped. */
  DepthClamp = 1U << 8,
  /** The stored colour is multiplied by the colour. */
  BlendMultiply = 1U << 9,
  /** The colour, which is premultiplied by its alpha, lies over the stored colour. */
  BlendOver = 1U << 10,
  /** Depth test: passes where the depth is less than or equal to the stored depth. For a host's depth. */
  DepthLessEqual = 1U << 11,
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
