// SPDX-License-Identifier: MIT
#include "eevee_depth_shared.h"

#include "draw_view.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace gnomon::shared {
namespace {

constexpr int kinds[] = {PROJECTION_PERSPECTIVE, PROJECTION_PERSPECTIVE_INFINITE, PROJECTION_ORTHOGRAPHIC};

TEST(DepthOfDistance, EqualsThatOfTheProjectionMatrix)
{
  for (const float near : {1e-3F, 0.1F, 2.0F}) {
    for (const float far : {3.0F, 100.0F, 1e5F}) {
      for (const int kind : kinds) {
        const glm::mat4 clip_from_view =
            kind == PROJECTION_ORTHOGRAPHIC
                ? draw::orthographic(1, 1, near, far)
                : draw::perspective(1, 1, near,
                                    kind == PROJECTION_PERSPECTIVE ? far : std::numeric_limits<float>::infinity());
        for (int i = 0; i <= 100; i++) {
          const float distance = near + (far - near) * float(i * i) / 1e4F;
          const glm::vec4 clip = clip_from_view * glm::vec4(0, 0, -distance, 1);
          // The matrix adds two numbers as large as far / (far - near), at most 3 here, before it divides.
          EXPECT_NEAR(depth_of_distance(distance, near, far, kind), clip.z / clip.w, 4e-7F)
              << near << " " << far << " " << kind;
        }
      }
    }
  }
}

TEST(DepthOfDistance, IsOneAtTheNearPlaneAndZeroAtTheFar)
{
  for (const float near : {1e-4F, 0.3F, 7.0F}) {
    for (const float far : {7.5F, 1e3F, 1e7F}) {
      for (const int kind : kinds) {
        EXPECT_EQ(depth_of_distance(near, near, far, kind), 1.0F);
        EXPECT_EQ(depth_of_distance(far, near, far, kind), kind == PROJECTION_PERSPECTIVE_INFINITE ? near / far : 0.0F);
        // An orthographic depth is a difference of distances of the magnitude of the far plane.
        const float tolerance = 3e-7F * (kind == PROJECTION_ORTHOGRAPHIC ? far : near);
        EXPECT_NEAR(distance_of_depth(1.0F, near, far, kind), near, tolerance);
      }
      EXPECT_FLOAT_EQ(distance_of_depth(0.0F, near, far, PROJECTION_PERSPECTIVE), far);
      EXPECT_EQ(distance_of_depth(0.0F, near, far, PROJECTION_ORTHOGRAPHIC), far);
    }
  }
}

TEST(DepthOfDistance, FallsWithDistanceAndComesBack)
{
  const float near = 0.01F;
  const float far = 1e4F;
  for (const int kind : kinds) {
    float before = std::numeric_limits<float>::infinity();
    for (float distance = near; distance < far; distance *= 1.01F) {
      const float depth = depth_of_distance(distance, near, far, kind);
      ASSERT_LE(depth, before);
      before = depth;
      // Rounding relative to the distance in perspective, and relative to the far plane in orthographic projection.
      const float tolerance = 1e-6F * (kind == PROJECTION_ORTHOGRAPHIC ? far : distance);
      ASSERT_NEAR(distance_of_depth(depth, near, far, kind), distance, tolerance) << kind;
    }
  }
}

TEST(DepthOfDistance, BehindTheEyeIsFiniteAndNearest)
{
  for (const float distance : {0.0F, -0.0F, -1e-3F, -1e5F, -1e30F}) {
    for (const int kind : {PROJECTION_PERSPECTIVE, PROJECTION_PERSPECTIVE_INFINITE}) {
      const float depth = depth_of_distance(distance, 0.1F, 100.0F, kind);
      EXPECT_GT(depth, 1.0F);
      EXPECT_TRUE(std::isfinite(depth));
    }
  }
}

TEST(DistanceOfDepth, OfAClearedMapIsFiniteAndFarthest)
{
  for (const float near : {1e-4F, 1.0F, 1e7F}) {
    const float distance = distance_of_depth(0.0F, near, 0.0F, PROJECTION_PERSPECTIVE_INFINITE);
    EXPECT_TRUE(std::isfinite(distance));
    EXPECT_GE(distance, 1e25F);
  }
}

}  // namespace
}  // namespace gnomon::shared
