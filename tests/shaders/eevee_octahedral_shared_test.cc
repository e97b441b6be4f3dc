// SPDX-License-Identifier: MIT
#include "eevee_octahedral_shared.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

namespace gnomon::shared {
namespace {

vec3 round_trip(const vec3 &v)
{
  return octahedral_to_direction(octahedral_from_direction(v));
}

/** Angle between two unit vectors, radians. */
float angle(const vec3 &a, const vec3 &b)
{
  return 2.0F * std::asin(std::min(0.5F * glm::distance(a, b), 1.0F));
}

// hazards.md: sign(0), fold lines, the zero vector.
TEST(Octahedral, RoundTripIsExactOnAxes)
{
  for (const float length : {1e-20F, 0.3F, 1.0F, 1e20F}) {
    for (int axis = 0; axis < 3; axis++) {
      for (const float sign : {-1.0F, 1.0F}) {
        for (const float zero : {-0.0F, 0.0F}) {
          vec3 v(zero);
          v[axis] = sign * length;
          vec3 unit(0.0F);
          unit[axis] = sign;
          EXPECT_EQ(round_trip(v), unit) << "axis " << axis << " sign " << sign << " zero " << zero;
        }
      }
    }
  }
}

TEST(Octahedral, RoundTripIsExactOnEdges)
{
  const float half = std::sqrt(0.5F);
  for (int axis = 0; axis < 3; axis++) {
    for (const float a : {-1.0F, 1.0F}) {
      for (const float b : {-1.0F, 1.0F}) {
        for (const float zero : {-0.0F, 0.0F}) {
          vec3 v(zero);
          v[(axis + 1) % 3] = a;
          v[(axis + 2) % 3] = b;
          const vec3 back = round_trip(v);
          EXPECT_EQ(back[axis], 0.0F);
          EXPECT_FLOAT_EQ(back[(axis + 1) % 3], a * half);
          EXPECT_FLOAT_EQ(back[(axis + 2) % 3], b * half);
        }
      }
    }
  }
}

TEST(Octahedral, RoundTripIsAlmostExactOnDiagonals)
{
  for (int i = 0; i < 8; i++) {
    const vec3 v(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    // 1/3 is not a float. Its rounding error becomes that of a number near 1 when 1/2 is added.
    const vec3 back = round_trip(v);
    EXPECT_EQ(std::abs(back.x), std::abs(back.y));
    EXPECT_LE(angle(back, glm::normalize(v)), 3e-7F);
  }
}

TEST(Octahedral, RoundTripOfDirectionsIsWithinRounding)
{
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  float worst = 0.0F;
  for (int i = 0; i < 200000; i++) {
    const vec3 v = glm::normalize(vec3(normal(random), normal(random), normal(random)));
    const vec3 back = round_trip(v);
    ASSERT_NEAR(glm::length(back), 1.0F, 2e-7F);
    worst = std::max(worst, angle(back, v));
  }
  // Coordinates near 1 are rounded to 6e-8. The error is twice that on the octahedron, and three times more on the
  // sphere. Normalisation adds 1e-7. The worst of 20 million directions: 4.5e-7.
  EXPECT_LE(worst, 4.6e-7F);
}

TEST(Octahedral, RoundTripOfTexelsIsWithinRounding)
{
  for (const int size : {1, 2, 7, 64, 257}) {
    for (int y = 0; y < size; y++) {
      for (int x = 0; x < size; x++) {
        const vec2 uv = (vec2(float(x), float(y)) + 0.5F) / float(size);
        const vec2 back = octahedral_from_direction(octahedral_to_direction(uv));
        ASSERT_NEAR(back.x, uv.x, 2e-7F) << size << " " << x << " " << y;
        ASSERT_NEAR(back.y, uv.y, 2e-7F) << size << " " << x << " " << y;
      }
    }
  }
}

TEST(Octahedral, DirectionToTexelAndBackIsWithinATexel)
{
  std::mt19937 random(8);
  std::normal_distribution<float> normal;
  for (const int size : {64, 512}) {
    for (int i = 0; i < 20000; i++) {
      const vec3 v = glm::normalize(vec3(normal(random), normal(random), normal(random)));
      const vec2 uv = octahedral_from_direction(v);
      const ivec2 texel = glm::clamp(ivec2(uv * float(size)), ivec2(0), ivec2(size - 1));
      const vec3 back = octahedral_to_direction((vec2(texel) + 0.5F) / float(size));
      float corner = 0.0F;
      for (const vec2 half : {vec2(-0.5F, -0.5F), vec2(0.5F, -0.5F), vec2(-0.5F, 0.5F), vec2(0.5F, 0.5F)}) {
        corner = std::max(corner, angle(back, octahedral_to_direction((vec2(texel) + 0.5F + half) / float(size))));
      }
      // The error is at most the distance from the texel's centre to its corners.
      ASSERT_LE(angle(v, back), corner * 1.001F) << size;
      ASSERT_LE(corner, 1.25F * octahedral_texel_angle(back, size)) << size;
    }
  }
}

TEST(OctahedralTexelWeight, SumsToTheSphere)
{
  constexpr int size = 64;
  double sum = 0.0;
  for (int y = 0; y < size; y++) {
    for (int x = 0; x < size; x++) {
      const float a =
          octahedral_texel_angle(octahedral_to_direction((vec2(float(x), float(y)) + 0.5F) / float(size)), size);
      sum += double(a) * double(a);
    }
  }
  EXPECT_NEAR(sum, 4.0 * 3.14159265, 1e-3 * 12.57);
}

TEST(Octahedral, ZeroVectorMapsToPlusZ)
{
  EXPECT_EQ(octahedral_from_direction(vec3(0.0F)), vec2(0.5F));
  EXPECT_EQ(octahedral_from_direction(vec3(-0.0F)), vec2(0.5F));
  EXPECT_EQ(octahedral_to_direction(vec2(0.5F)), vec3(0, 0, 1));
}

TEST(Octahedral, CornersAreMinusZAndEdgesAreMirrored)
{
  for (const float u : {0.0F, 1.0F}) {
    for (const float v : {0.0F, 1.0F}) {
      EXPECT_EQ(octahedral_to_direction({u, v}), vec3(0, 0, -1));
    }
    for (int i = 0; i <= 64; i++) {
      const float along = float(i) / 64.0F;
      EXPECT_EQ(octahedral_to_direction({u, along}), octahedral_to_direction({u, 1.0F - along}));
      EXPECT_EQ(octahedral_to_direction({along, u}), octahedral_to_direction({1.0F - along, u}));
    }
  }
}

/** The naive form with GLSL's sign(), which is 0 at 0. */
vec2 naive_from_direction(vec3 v)
{
  v /= std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
  vec2 p(v.x, v.y);
  if (v.z < 0.0F) {
    p = vec2((1.0F - std::abs(v.y)) * glm::sign(v.x), (1.0F - std::abs(v.x)) * glm::sign(v.y));
  }
  return 0.5F * p + 0.5F;
}

// The tests above detect the naive form.
TEST(Octahedral, NaiveFormFailsAtTheFoldAndForTheZeroVector)
{
  EXPECT_GT(angle(octahedral_to_direction(naive_from_direction({1, 0, -1})), glm::normalize(vec3(1, 0, -1))), 0.7F);
  EXPECT_GT(angle(octahedral_to_direction(naive_from_direction({0, 0, -1})), vec3(0, 0, -1)), 1.5F);
  EXPECT_TRUE(std::isnan(naive_from_direction(vec3(0.0F)).x));
}

TEST(OctahedralTexel, InsideIsUnchanged)
{
  for (int y = 0; y < 5; y++) {
    for (int x = 0; x < 5; x++) {
      EXPECT_EQ(octahedral_texel({x, y}, 5), ivec2(x, y));
    }
  }
}

TEST(OctahedralTexel, OutsideIsTheNeighbourOnTheSphere)
{
  for (const int size : {2, 3, 8, 33}) {
    const auto direction = [&](const ivec2 &texel) {
      return octahedral_to_direction((vec2(texel) + 0.5F) / float(size));
    };
    // The largest step between neighbours in the interior.
    float widest = 0.0F;
    for (int y = 0; y < size; y++) {
      for (int x = 0; x + 1 < size; x++) {
        widest = std::max(widest, angle(direction({x, y}), direction({x + 1, y})));
      }
    }
    for (int i = 0; i < size; i++) {
      const std::array<std::array<ivec2, 2>, 4> steps = {{{ivec2(0, i), ivec2(-1, i)},
                                                          {ivec2(size - 1, i), ivec2(size, i)},
                                                          {ivec2(i, 0), ivec2(i, -1)},
                                                          {ivec2(i, size - 1), ivec2(i, size)}}};
      for (const auto &[inside, outside] : steps) {
        const ivec2 texel = octahedral_texel(outside, size);
        EXPECT_TRUE(texel.x >= 0 && texel.x < size && texel.y >= 0 && texel.y < size);
        EXPECT_LE(angle(direction(inside), direction(texel)), widest * 1.0001F) << outside.x << " " << outside.y;
        // The edge lies on a plane of symmetry. The map continues mirrored at it.
        vec3 mirrored = direction(inside);
        mirrored[inside.x == outside.x ? 0 : 1] *= -1.0F;
        EXPECT_LE(angle(mirrored, direction(texel)), 5e-7F) << outside.x << " " << outside.y;
      }
    }
  }
}

TEST(OctahedralTexel, PastACornerIsTheOppositeCorner)
{
  EXPECT_EQ(octahedral_texel({-1, -1}, 8), ivec2(7, 7));
  EXPECT_EQ(octahedral_texel({8, 8}, 8), ivec2(0, 0));
  EXPECT_EQ(octahedral_texel({-1, 8}, 8), ivec2(7, 0));
  EXPECT_EQ(octahedral_texel({9, -2}, 8), ivec2(1, 6));
}

}  // namespace
}  // namespace gnomon::shared
