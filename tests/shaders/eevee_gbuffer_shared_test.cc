// SPDX-License-Identifier: MIT
#include "eevee_gbuffer_shared.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

namespace gnomon::shared {
namespace {

TEST(GBuffer, AllBitsSurviveAsNormalFloats)
{
  std::mt19937 random(3);
  for (int i = 0; i < 100000; i++) {
    // The ends of the range first.
    const std::uint32_t bits = (i < 30   ? 1U << i
                                : i < 60 ? 0x3fffffffU >> (i - 30)
                                         : std::uint32_t(random())) &
                               0x3fffffffU;
    const float stored = gbuffer_float(bits);
    ASSERT_TRUE(std::isnormal(stored)) << bits;
    ASSERT_EQ(gbuffer_bits(stored), bits);
  }
}

TEST(GBuffer, DirectionsAreExactOnAxesAndCloseElsewhere)
{
  for (int axis = 0; axis < 3; axis++) {
    for (const float sign : {-1.0F, 1.0F}) {
      vec3 v(0.0F);
      v[axis] = sign;
      EXPECT_EQ(gbuffer_to_direction(gbuffer_from_direction(v)), v);
    }
  }
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  float largest = 0.0F;
  for (int i = 0; i < 100000; i++) {
    const vec3 v = glm::normalize(vec3(normal(random), normal(random), normal(random)));
    largest = std::max(largest, glm::distance(gbuffer_to_direction(gbuffer_from_direction(v)), v));
  }
  // Half a step h of x and of y changes z by 2 h: the point on the octahedron moves by √6 h, and the direction by up to
  // √3 of that, as the octahedron is at least 1 / √3 from the centre.
  EXPECT_LT(largest, std::sqrt(18.0F) / 32766.0F);
  EXPECT_GT(largest, 0.5F / 32766.0F);
}

TEST(GBuffer, DirectionsHaveAnyLength)
{
  EXPECT_EQ(gbuffer_to_direction(gbuffer_from_direction(vec3(0.0F))), vec3(0, 0, 1));
  EXPECT_EQ(gbuffer_to_direction(gbuffer_from_direction(vec3(0, 0, 1e-38F))), vec3(0, 0, 1));
  EXPECT_EQ(gbuffer_to_direction(gbuffer_from_direction(vec3(1e30F, 0, 0))), vec3(1, 0, 0));
}

TEST(GBuffer, FloatsAreNormalWhateverTheirBits)
{
  for (const std::uint32_t bits : {0U, 1U, 0x7f800000U, 0x7fc00000U, 0xff800000U, 0xffffffffU}) {
    EXPECT_TRUE(std::isnormal(gbuffer_float(bits))) << bits;
  }
}

}  // namespace
}  // namespace gnomon::shared
