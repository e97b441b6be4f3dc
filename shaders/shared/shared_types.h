// SPDX-License-Identifier: MIT
// What lets a header be C++ and GLSL: types, functions and asserts under one name. Included first by each *_shared.h.
// Float literals carry an `f`. Members of a block are vec4, mat4, or a vec3 and a scalar that fills its row.
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

namespace gnomon::shared {
using uint = std::uint32_t;
using glm::abs;
using glm::clamp;
using glm::dot;
using glm::mat4;
using glm::max;
using glm::min;
using glm::mix;
using glm::normalize;
using glm::pow;
using glm::sqrt;
using glm::step;
using glm::vec2;
using glm::vec3;
using glm::vec4;
}  // namespace gnomon::shared

#  define SHARED_BEGIN namespace gnomon::shared {
#  define SHARED_END }
#  define SHARED_FUNCTION inline
#  define SHARED_CONSTANT inline constexpr
/** std140 gives `TYPE` this size, and so does C++; a test compares each offset. */
#  define SHARED_ASSERT_SIZE(TYPE, SIZE_BYTES) \
    static_assert(sizeof(TYPE) == (SIZE_BYTES) && (SIZE_BYTES) % 16 == 0, #TYPE " is not laid out as std140");
#else
#  define SHARED_BEGIN
#  define SHARED_END
#  define SHARED_FUNCTION
#  define SHARED_CONSTANT const
#  define SHARED_ASSERT_SIZE(TYPE, SIZE_BYTES)
#endif

/** Least size of a uniform block that every device takes (OpenGL, Vulkan). */
#define UNIFORM_BLOCK_BYTES_MAX 16384

#endif
