// SPDX-License-Identifier: MIT
#include "eevee_area_shared.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace gnomon::shared {
namespace {

constexpr double pi = std::numbers::pi;
const vec3 unit_x(1, 0, 0);
const vec3 unit_y(0, 1, 0);
const vec3 unit_z(0, 0, 1);

TEST(RectangleSolidAngle, OfACubeFaceIsASixthOfTheSphere)
{
  for (const float size : {1e-4F, 1.0F, 1e5F}) {
    EXPECT_FLOAT_EQ(rectangle_solid_angle(size * unit_z, size * unit_x, size * unit_y), float(4.0 * pi / 6.0));
    EXPECT_FLOAT_EQ(rectangle_solid_angle(-size * unit_x, size * unit_y, size * unit_z), float(4.0 * pi / 6.0));
  }
}

TEST(RectangleSolidAngle, IsTheSumOfItsParts)
{
  for (const vec3 &center :
       {vec3(0.1F, 0.2F, 0.3F), vec3(3, -2, 1), vec3(0, 0, 1e-3F), vec3(1, 0.5F, 1e-4F), vec3(9, 9, 9)}) {
    double sum = 0.0;
    for (const float i : {-0.5F, 0.5F}) {
      for (const float j : {-0.5F, 0.5F}) {
        sum += double(rectangle_solid_angle(center + i * unit_x + j * unit_y, 0.5F * unit_x, 0.5F * unit_y));
      }
    }
    // At small heights the rounding of the corners dominates: 1e-7 m at a distance of 1e-4 m from the rim.
    EXPECT_NEAR(rectangle_solid_angle(center, unit_x, unit_y), sum, 1e-6 + 1e-6 * sum) << center.z;
  }
}

TEST(RectangleSolidAngle, FarAwayIsAreaOverSquaredDistance)
{
  const vec3 direction = glm::normalize(vec3(1, 2, 3));
  for (const float distance : {1e3F, 1e5F, 1e7F}) {
    const vec3 center = distance * direction;
    const double expected = 4.0 * double(direction.z) / (double(distance) * double(distance));
    // A few roundings. The next term of the series is 1 / distance², a relative 1e-6 at 1 km.
    EXPECT_NEAR(rectangle_solid_angle(center, unit_x, unit_y) / expected, 1.0, 2e-6) << distance;
  }
}

TEST(RectangleSolidAngle, GrowsToAHalfSpaceOnApproach)
{
  float before = 0.0F;
  for (float height = 1e6F; height > 1e-30F; height *= 0.5F) {
    const float angle = rectangle_solid_angle({0.25F, -0.5F, height}, unit_x, unit_y);
    // Close to 2π, only the last digits may change.
    ASSERT_GE(angle, before * (1.0F - 2e-7F)) << height;
    before = angle;
  }
  EXPECT_FLOAT_EQ(before, float(2.0 * pi));
  EXPECT_FLOAT_EQ(rectangle_solid_angle({0, 0, 1}, 1e8F * unit_x, 1e8F * unit_y), float(2.0 * pi));
}

// hazards.md: touching quads.
TEST(RectangleSolidAngle, IsAHalfSpaceForAnEyeOnTheRectangle)
{
  for (const vec3 &center : {vec3(0), vec3(0.5F, 0, 0), vec3(0.5F, 0.5F, 0), vec3(-0.999F, 0.999F, 0)}) {
    EXPECT_FLOAT_EQ(rectangle_solid_angle(center, unit_x, unit_y), float(2.0 * pi));
  }
}

// hazards.md: behind the horizon. The caller handles the lamp's side and the receiver's horizon.
TEST(RectangleSolidAngle, IsTheSameFromBothSidesAndWhicheverWayItsAxesPoint)
{
  const vec3 center(0.3F, -1.7F, 0.4F);
  const float angle = rectangle_solid_angle(center, 0.5F * unit_x, unit_y);
  EXPECT_EQ(rectangle_solid_angle(vec3(center.x, center.y, -center.z), 0.5F * unit_x, unit_y), angle);
  EXPECT_FLOAT_EQ(rectangle_solid_angle(center, -0.5F * unit_x, unit_y), angle);
  EXPECT_FLOAT_EQ(rectangle_solid_angle(center, unit_y, 0.5F * unit_x), angle);
  EXPECT_FLOAT_EQ(rectangle_solid_angle(-center, 0.5F * unit_x, unit_y), angle);
}

// hazards.md: edge-on and degenerate quads.
TEST(RectangleSolidAngle, IsZeroEdgeOnAndWithoutArea)
{
  EXPECT_EQ(rectangle_solid_angle({3, 0, 0}, unit_x, unit_y), 0.0F);
  EXPECT_EQ(rectangle_solid_angle({3, -7, 0}, unit_x, unit_y), 0.0F);
  for (const vec3 &center : {vec3(0), vec3(0, 0, 1), vec3(0.5F, 0, 0), vec3(3, 2, 1)}) {
    EXPECT_EQ(rectangle_solid_angle(center, vec3(0), unit_y), 0.0F);
    EXPECT_EQ(rectangle_solid_angle(center, unit_x, vec3(0)), 0.0F);
    EXPECT_EQ(rectangle_solid_angle(center, vec3(0), vec3(0)), 0.0F);
  }
}

TEST(RectangleSolidAngle, StaysInRangeOnTheRimAndForSkewedAxes)
{
  const std::array<float, 7> steps = {-1e5F, -1.0F, -1e-4F, 0.0F, 1e-4F, 1.0F, 1e5F};
  for (const float x : steps) {
    for (const float y : steps) {
      for (const float z : steps) {
        for (const vec3 &up : {unit_y, unit_x, 1e-4F * unit_y, unit_x + unit_y, vec3(-1, 1e-3F, 0), 1e5F * unit_z}) {
          const float angle = rectangle_solid_angle({x, y, z}, unit_x, up);
          ASSERT_TRUE(angle >= 0.0F && angle <= float(2.0 * pi)) << x << " " << y << " " << z << ": " << angle;
        }
      }
    }
  }
}

/** The sum of the angles between the planes through the edges, minus 2π: the naive form. */
float naive_solid_angle(const std::array<vec3, 4> &corner)
{
  float sum = -2.0F * float(pi);
  for (std::size_t i = 0; i < 4; i++) {
    const vec3 a = glm::normalize(glm::cross(corner[i], corner[(i + 1) % 4]));
    const vec3 b = glm::normalize(glm::cross(corner[(i + 1) % 4], corner[(i + 2) % 4]));
    sum += std::acos(glm::dot(-a, b));
  }
  return sum;
}

// The tests above detect the naive form.
TEST(RectangleSolidAngle, NaiveFormFailsEdgeOnAndFarAway)
{
  const auto corners = [](const vec3 &center) {
    return std::array<vec3, 4>{center - unit_x - unit_y, center + unit_x - unit_y, center + unit_x + unit_y,
                               center - unit_x + unit_y};
  };
  EXPECT_NEAR(naive_solid_angle(corners(unit_z)), 4.0 * pi / 6.0, 1e-5) << "a fair copy where nothing is degenerate";
  EXPECT_TRUE(std::isnan(naive_solid_angle(corners({1, 1, 0})))) << "a corner in the eye";
  EXPECT_TRUE(std::isnan(naive_solid_angle({vec3(-1, 0, 1), vec3(1, 0, 1), vec3(1, 0, 1), vec3(-1, 0, 1)})));
  const double far_away = 4.0 / 1e8;
  EXPECT_GT(std::abs(naive_solid_angle(corners({0, 0, 1e4F})) / far_away - 1.0), 0.5);
}

TEST(LinePlaneDistance, IsThatOfThePointOnThePlane)
{
  EXPECT_EQ(line_plane_distance(vec3(0), unit_z, vec3(5, 7, 2), unit_z), 2.0F);
  EXPECT_EQ(line_plane_distance(vec3(0), unit_z, vec3(5, 7, 2), -3.0F * unit_z), 2.0F)
      << "a normal of any length and side";
  EXPECT_EQ(line_plane_distance(vec3(0), -2.0F * unit_z, vec3(5, 7, 2), unit_z), -1.0F)
      << "behind, in lengths of the direction";
}

// hazards.md: a ray parallel to the plane.
TEST(LinePlaneDistance, OfAParallelLineIsFiniteAndLarge)
{
  EXPECT_EQ(line_plane_distance(vec3(0), unit_x, unit_z, unit_z), LINE_FAR);
  EXPECT_EQ(line_plane_distance(vec3(0), unit_x, vec3(0), unit_z), LINE_FAR) << "in the plane";
  EXPECT_EQ(line_plane_distance(vec3(0), vec3(0), unit_z, unit_z), LINE_FAR) << "no direction";
  EXPECT_EQ(line_plane_distance(vec3(0), unit_x + 1e-30F * unit_z, unit_z, unit_z), LINE_FAR);
  EXPECT_EQ(line_plane_distance(vec3(0), unit_x - 1e-30F * unit_z, unit_z, unit_z), -LINE_FAR);
  const vec3 reached = LINE_FAR * glm::normalize(vec3(1, 1, 1));
  EXPECT_TRUE(std::isfinite(dot(reached, reached)));
}

}  // namespace
}  // namespace gnomon::shared
