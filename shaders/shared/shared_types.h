// SPDX-License-Identifier: MIT
// Types, functions and assertions that make a header valid in both C++ and GLSL. Each *_shared.h includes this file first.
// Float literals have the suffix `f`. Members of a block are vec4, mat4, or a vec3 and a scalar that fills its row.
//
// If SHARED_DOUBLE is defined, C++ compiles everything in double instead, in gnomon::shared_double. The results are those of a
// function without float rounding. Literals keep their float values and are combined with scalars only: `vec2(0.5f) * v`.
// `float` is a macro from here on, so include all other headers earlier.
#ifndef SHARED_TYPES_H
#define SHARED_TYPES_H

#ifdef __cplusplus
#  include <glm/common.hpp>
#  include <glm/exponential.hpp>
#  include <glm/geometric.hpp>
#  include <glm/mat4x4.hpp>
#  include <glm/trigonometric.hpp>
#  include <glm/vec2.hpp>
#  include <glm/vec3.hpp>
#  include <glm/vec4.hpp>

#  include <cstddef>
#  include <cstdint>

#  ifdef SHARED_DOUBLE
#    define float double
#    define SHARED_NAMESPACE gnomon::shared_double
#    define SHARED_ASSERT(CONDITION)
#  else
#    define SHARED_NAMESPACE gnomon::shared
#    define SHARED_ASSERT(CONDITION) static_assert(CONDITION);
#  endif

namespace SHARED_NAMESPACE {
using uint = std::uint32_t;
using ivec2 = glm::ivec2;
using vec2 = glm::vec<2, float>;
using vec3 = glm::vec<3, float>;
using vec4 = glm::vec<4, float>;
using mat4 = glm::mat<4, 4, float>;
using glm::abs;
using glm::atan;
using glm::clamp;
using glm::cos;
using glm::cross;
using glm::dot;
using glm::exp;
using glm::floatBitsToUint;
using glm::floor;
using glm::log;
using glm::max;
using glm::min;
using glm::mix;
using glm::normalize;
using glm::pow;
using glm::sin;
using glm::sqrt;
using glm::step;
using glm::uintBitsToFloat;
#  ifdef SHARED_DOUBLE
// GLM's functions are templates, which do not match a double and a float literal.
inline double clamp(double x, double low, double high)
{
  return glm::clamp(x, low, high);
}
inline double max(double x, double y)
{
  return glm::max(x, y);
}
inline double min(double x, double y)
{
  return glm::min(x, y);
}
#  endif
}  // namespace SHARED_NAMESPACE

#  define SHARED_BEGIN namespace SHARED_NAMESPACE {
#  define SHARED_END }
#  define SHARED_FUNCTION inline
#  define SHARED_CONSTANT inline constexpr
/** `TYPE` has this size in std140 and in C++. A test compares the offset of each member. */
#  define SHARED_ASSERT_SIZE(TYPE, SIZE_BYTES) \
    SHARED_ASSERT(sizeof(TYPE) == (SIZE_BYTES) && (SIZE_BYTES) % 16 == 0)
#else
#  define SHARED_BEGIN
#  define SHARED_END
#  define SHARED_FUNCTION
#  define SHARED_CONSTANT const
#  define SHARED_ASSERT(CONDITION)
#  define SHARED_ASSERT_SIZE(TYPE, SIZE_BYTES)
#endif

/** Size of a uniform block that every device supports (OpenGL, Vulkan). */
#define UNIFORM_BLOCK_BYTES_MAX 16384

#endif
