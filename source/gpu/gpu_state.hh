// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

/** Operators of an enumeration whose values are sets of bits, in its namespace. */
#define GNOMON_MASK_OPERATORS(Mask)                          \
  constexpr Mask operator|(Mask a, Mask b)                   \
  {                                                          \
    return Mask(std::uint32_t(a) | std::uint32_t(b));        \
  }                                                          \
  constexpr Mask operator&(Mask a, Mask b)                   \
  {                                                          \
    return Mask(std::uint32_t(a) & std::uint32_t(b));        \
  }                                                          \
  constexpr Mask without(Mask mask, Mask bits)               \
  {                                                          \
    return Mask(std::uint32_t(mask) & ~std::uint32_t(bits)); \
  }                                                          \
  /** Whether at least one of \a bits is set. */             \
  constexpr bool has(Mask mask, Mask bits)                   \
  {                                                          \
    return (mask & bits) != Mask(0);                         \
  }

namespace gnomon::gpu {

/** Mask of fixed-function state. A bit that is not set disables its function. */
enum class State : std::uint32_t {
  None = 0,
  WriteColor = 1U << 0,
  WriteDepth = 1U << 1,
  /** Depth test: passes if the depth is nearer than or equal to the stored depth (reversed depth: >=). */
  DepthNearerEqual = 1U << 2,
  /** Depth test: passes if the depth equals the stored depth. */
  DepthEqual = 1U << 3,
  CullBack = 1U << 4,
  CullFront = 1U << 5,
  /** Front faces have clockwise vertices. For objects whose matrix mirrors, or for views that mirror. */
  FrontClockwise = 1U << 6,
  /** Blending: stored + colour. */
  BlendAdd = 1U << 7,
  /** Geometry in front of the near plane or beyond the far plane is drawn at that plane's depth instead of clipped. */
  DepthClamp = 1U << 8,
  /** Blending: stored * colour. */
  BlendMultiply = 1U << 9,
  /** Blending: colour + (1 - alpha) * stored. The colour must be premultiplied by its alpha. */
  BlendOver = 1U << 10,
  /** Depth test: passes if the depth is less than or equal to the stored depth. For depth buffers of the host. */
  DepthLessEqual = 1U << 11,
  /** Two indices make a line of one pixel's width, or one index a point of one pixel. Neither: three make a triangle.
   */
  DrawLines = 1U << 12,
  DrawPoints = 1U << 13,
  /** Depth test: passes if the depth is further than the stored depth (reversed depth: <). */
  DepthFurther = 1U << 14,
  /** Triangles are drawn as their edges, one pixel wide. \pre Limits::has_wireframe */
  Wireframe = 1U << 15,
};

GNOMON_MASK_OPERATORS(State)

/** Number of indices or vertices of a primitive. */
constexpr std::uint32_t primitive_size(State mask)
{
  return has(mask, State::DrawPoints) ? 1 : has(mask, State::DrawLines) ? 2 : 3;
}

/** Returns the names of the bits, such as "write_depth depth_nearer_equal", or "none" for an empty mask. */
[[nodiscard]] std::string to_string(State mask);

}  // namespace gnomon::gpu
