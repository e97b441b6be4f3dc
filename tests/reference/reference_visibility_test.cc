// SPDX-License-Identifier: MIT
#include "reference_visibility.hh"
#include "reference_test_scene.hh"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace gnomon::reference {
namespace {

using scene::LampKind;
using test::add_rectangle;
using test::lamp_at;
using test::placed;

constexpr glm::dvec3 up{0.0, 0.0, 1.0};

/** Rotates x to up and z to -x without rounding: a wall at x = 0. */
glm::mat4 upright()
{
  glm::mat4 matrix(0.0F);
  matrix[0] = {0, 0, 1, 0};
  matrix[1] = {0, 1, 0, 0};
  matrix[2] = {-1, 0, 0, 0};
  matrix[3] = {0, 0, 0, 1};
  return matrix;
}

struct Place {
  double offset;
  double scale;
};

class ShadowPlaceTest : public testing::TestWithParam<Place> {};

TEST_P(ShadowPlaceTest, SquaresShadowEndsWhereTheThalesTheoremSays)
{
  // A lamp 8 m above a plane and a square of half width 1 at height 3. The half width of the shadow is 8 / 5.
  const Place place = GetParam();
  const float s = float(place.scale);
  const glm::vec3 origin(float(place.offset), -float(place.offset), 0.5F * float(place.offset));
  scene::Scene scene;
  add_rectangle(scene, {-100 * s, -100 * s}, {100 * s, 100 * s}, placed(origin));
  add_rectangle(scene, {-s, -s}, {s, s}, placed(origin + glm::vec3(0, 0, 3 * s)));
  const Tracer tracer(scene);
  const scene::PlacedLamp lamp = lamp_at(LampKind::Point, origin + glm::vec3(0, 0, 8 * s));
  const double edge = 1.6;
  // Coordinates are rounded to 2^-53 of the offset. The error of the edge is little more.
  const double tolerance = 1e-14 + 8.0 * 0x1p-53 * place.offset / place.scale;
  for (const glm::dvec2 along : {glm::dvec2(1, 0), glm::dvec2(0, -1), glm::dvec2(1, 0.375), glm::dvec2(-0.5, 1)}) {
    for (const double side : {-1.0, 1.0}) {
      const glm::dvec2 at = along * edge * (1.0 + side * tolerance * 4.0);
      const Receiver receiver = receiver_at(glm::dvec3(origin) + glm::dvec3(at * double(s), 0.0), up);
      EXPECT_EQ(is_visible(tracer, receiver, lamp), side > 0.0) << at.x << ' ' << at.y;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Places, ShadowPlaceTest,
                         testing::Values(Place{0.0, 1.0}, Place{0.0, 0x1p-13}, Place{0.0, 0x1p17}, Place{0x1p20, 1.0},
                                         Place{0x1p20, 0x1p17}));

TEST(Visibility, WallsShadowUnderAGrazingSunIsExact)
{
  // Elevations down to a millionth of a radian. The shadow of a wall of 1 m is up to 1000 km long.
  for (const double elevation : {0.5, 1e-2, 1e-4, 1e-6}) {
    const double length = 1.0 / std::tan(elevation);
    scene::Scene scene;
    add_rectangle(scene, {-10, -10}, {float(2.0 * length), 10});
    // The wall stands on the plane, across x.
    add_rectangle(scene, {0, -5}, {1, 5}, upright());
    const Tracer tracer(scene);
    const LightPoint sun{{-std::cos(elevation), 0.0, std::sin(elevation)}, true};
    for (const double share : {1e-9, 0.01, 0.5, 0.999, 1.0 - 1e-9}) {
      EXPECT_FALSE(is_visible(tracer, receiver_at({length * share, 0.5, 0.0}, up), sun)) << elevation << ' ' << share;
    }
    EXPECT_TRUE(is_visible(tracer, receiver_at({length * (1.0 + 1e-9), 0.5, 0.0}, up), sun)) << elevation;
    EXPECT_TRUE(is_visible(tracer, receiver_at({-1e-9, 0.5, 0.0}, up), sun)) << elevation;
    // Beside the wall.
    EXPECT_TRUE(is_visible(tracer, receiver_at({0.5 * length, 5.0 + 1e-9, 0.0}, up), sun)) << elevation;
  }
}

TEST(Visibility, ACasterThatTouchesDarkensUpToTheContact)
{
  scene::Scene scene;
  add_rectangle(scene, {-10, -10}, {10, 10});
  add_rectangle(scene, {0, -5}, {1, 5}, upright());
  const Tracer tracer(scene);
  const LightPoint sun{{-1.0, 0.0, 1.0}, true};
  EXPECT_FALSE(is_visible(tracer, receiver_at({1e-12, 0.25, 0.0}, up), sun));
  EXPECT_TRUE(is_visible(tracer, receiver_at({-1e-12, 0.25, 0.0}, up), sun));
}

TEST(Visibility, APlaneDoesNotShadowItself)
{
  // A plane of many triangles, rotated so that no corner is exact, lit at angles down to a millionth of a radian.
  std::vector<glm::vec3> corners;
  for (int i = 0; i < 20; i++) {
    for (int k = 0; k < 20; k++) {
      const glm::vec3 a(float(i) - 10.0F, float(k) - 10.0F, 0.0F);
      const glm::vec3 b = a + glm::vec3(1, 0, 0);
      const glm::vec3 c = a + glm::vec3(1, 1, 0);
      const glm::vec3 d = a + glm::vec3(0, 1, 0);
      corners.insert(corners.end(), {a, b, c, a, c, d});
    }
  }
  std::mt19937 random(11);
  std::uniform_real_distribution<double> coordinate(-9.0, 9.0);
  for (const float offset : {0.0F, 1048576.0F}) {
    for (const float scale : {1e-4F, 1.0F, 1e5F}) {
      scene::Scene scene;
      glm::mat4 matrix = glm::rotate(placed(glm::vec3(offset, -offset, offset)), 0.9F, glm::vec3(0.48F, -0.6F, 0.64F));
      matrix = glm::scale(matrix, glm::vec3(scale));
      test::add_triangles(scene, corners, matrix);
      // A second layer of the plane at the same position.
      add_rectangle(scene, {-10, -10}, {10, 10}, matrix);
      const Tracer tracer(scene);
      const glm::dmat4 world_from_object(matrix);
      const glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(matrix[0]), glm::dvec3(matrix[1])));
      for (int i = 0; i < 2000; i++) {
        const glm::dvec4 local(coordinate(random), coordinate(random), 0.0, 1.0);
        const Receiver receiver = receiver_at(glm::dvec3(world_from_object * local), normal);
        const double elevation = std::pow(10.0, -6.0 * double(i % 7) / 6.0);
        const double turn = coordinate(random);
        const glm::dvec3 across = glm::normalize(glm::dvec3(matrix[0])) * std::cos(turn) +
                                  glm::normalize(glm::dvec3(matrix[1])) * std::sin(turn);
        const glm::dvec3 to_light = across * std::cos(elevation) + normal * std::sin(elevation);
        ASSERT_TRUE(is_visible(tracer, receiver, LightPoint{to_light, true})) << offset << ' ' << scale << ' ' << i;
        ASSERT_TRUE(
            is_visible(tracer, receiver, LightPoint{receiver.position_ws + 30.0 * double(scale) * to_light, false}))
            << offset << ' ' << scale << ' ' << i;
      }
    }
  }
}

TEST(Visibility, LampOnAPlaneIsHiddenFromItAndNotByIt)
{
  scene::Scene scene;
  add_rectangle(scene, {-10, -10}, {10, 10});
  // One ceiling contains the lamp, another one is above it.
  add_rectangle(scene, {-10, -10}, {10, 10}, placed({0, 0, 3}));
  add_rectangle(scene, {-10, -10}, {10, 10}, placed({0, 0, 4}));
  const Tracer tracer(scene);
  const scene::PlacedLamp lamp = lamp_at(LampKind::Point, {0.3F, 0.2F, 3.0F});
  EXPECT_TRUE(is_visible(tracer, receiver_at({1, 2, 0}, up), lamp));
  EXPECT_TRUE(is_visible(tracer, receiver_at({1, 2, 4}, -up), lamp));
  EXPECT_FALSE(is_visible(tracer, receiver_at({1, 2, 3}, up), lamp));
  EXPECT_FALSE(is_visible(tracer, receiver_at({1, 2, 3}, -up), lamp));
  EXPECT_FALSE(is_facing(receiver_at({1, 2, 3}, up), lamp));
  // A lamp above the lower ceiling is blocked by it.
  EXPECT_FALSE(is_visible(tracer, receiver_at({1, 2, 0}, up), lamp_at(LampKind::Point, {0.3F, 0.2F, 3.5F})));
  // A receiver at the lamp itself does not face it.
  EXPECT_FALSE(is_visible(tracer, receiver_at(glm::dvec3(lamp.world_from_lamp[3]), up), lamp));
}

TEST(Visibility, SurfaceHidesPointsBehindIt)
{
  scene::Scene scene;
  add_rectangle(scene, {-10, -10}, {10, 10});
  const Tracer tracer(scene);
  EXPECT_FALSE(is_visible(tracer, receiver_at({1, 2, 0}, up), lamp_at(LampKind::Point, {0, 0, -1})));
  EXPECT_TRUE(is_visible(tracer, receiver_at({1, 2, 0}, -up), lamp_at(LampKind::Point, {0, 0, -1})));
  EXPECT_TRUE(is_visible(tracer, receiver_at({1, 2, 0}, up), lamp_at(LampKind::Hemi, {0, 0, 0})));
  scene::PlacedLamp unshadowed = lamp_at(LampKind::Point, {0, 0, -1});
  unshadowed.shadow.kind = scene::ShadowKind::None;
  EXPECT_TRUE(is_visible(tracer, receiver_at({1, 2, 0}, up), unshadowed));
}

TEST(Visibility, FloatPositionsAreMovedBackOntoTheirSurface)
{
  scene::Scene scene;
  const glm::mat4 matrix = glm::rotate(placed({100, 200, -50}), 1.1F, glm::vec3(0.48F, -0.6F, 0.64F));
  add_rectangle(scene, {-10, -10}, {10, 10}, matrix);
  const Tracer tracer(scene);
  const glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(matrix[0]), glm::dvec3(matrix[1])));
  for (int i = 0; i < 100; i++) {
    const glm::dvec3 exact(glm::dmat4(matrix) * glm::dvec4(0.19 * i - 9.5, 0.07 * i, 0.0, 1.0));
    const glm::vec3 rounded(exact);
    const std::optional<Receiver> receiver = find_receiver(tracer, glm::dvec3(rounded), glm::dvec3(glm::vec3(-normal)));
    ASSERT_TRUE(receiver);
    EXPECT_LT(std::abs(glm::dot(receiver->position_ws - exact, normal)), 1e-12);
    EXPECT_LT(glm::distance(receiver->position_ws, exact), 1e-4);
    EXPECT_LT(glm::distance(receiver->normal_ws, -normal), 1e-12);
    EXPECT_FALSE(find_receiver(tracer, exact + 0.01 * normal, normal));
  }
}

TEST(Visibility, HiddenFractionOfADiskIsACircularSegment)
{
  // A half plane at half the height of the lamp, with its edge at x = c. It hides the part of the lamp beyond x = 2c.
  for (const double cut : {-0.4, -0.1, 0.0, 0.25}) {
    scene::Scene scene;
    add_rectangle(scene, {float(cut), -50}, {50, 50}, placed({0, 0, 2}));
    const Tracer tracer(scene);
    scene::PlacedLamp lamp = lamp_at(LampKind::Point, {0, 0, 4});
    lamp.radius = 1.0F;
    const double x = 2.0 * double(float(cut));
    const double seen = 0.5 + (std::asin(x) + x * std::sqrt(1.0 - x * x)) / std::numbers::pi;
    const Estimate estimate = visibility(tracer, receiver_at({0, 0, 0}, up), lamp, 20000, 5);
    EXPECT_NEAR(estimate.mean, seen, 4.0 * estimate.standard_error);
    EXPECT_LT(estimate.standard_error, 0.004);
    // A plane through the axis of the sun's cone hides exactly half of it.
    scene::PlacedLamp sun = lamp_at(LampKind::Sun, {0, 0, 0});
    sun.angle = 0.5F;
    const Estimate half = visibility(tracer, receiver_at({double(float(cut)), 0, 0}, up), sun, 20000, 5);
    EXPECT_NEAR(half.mean, 0.5, 4.0 * half.standard_error);
  }
}

TEST(Visibility, StandardErrorIsNoSmallerThanTheSpreadOfSeeds)
{
  scene::Scene scene;
  add_rectangle(scene, {0.1F, -50}, {50, 50}, placed({0, 0, 2}));
  const Tracer tracer(scene);
  scene::PlacedLamp lamp = lamp_at(LampKind::Point, {0, 0, 4});
  lamp.radius = 1.0F;
  double sum = 0.0;
  double squares = 0.0;
  double stated = 0.0;
  constexpr int seeds = 200;
  for (int seed = 0; seed < seeds; seed++) {
    const Estimate estimate = visibility(tracer, receiver_at({0, 0, 0}, up), lamp, 64, std::uint64_t(seed));
    sum += estimate.mean;
    squares += estimate.mean * estimate.mean;
    stated += estimate.standard_error / seeds;
  }
  EXPECT_LE(std::sqrt(squares / seeds - sum * sum / (seeds * seeds)), stated);
  EXPECT_GT(stated, 0.0);
}

/** Expects this irradiance at an unoccluded receiver at the origin that faces up. */
void expect_irradiance(const scene::PlacedLamp &lamp, double expected)
{
  const scene::Scene scene;
  const Tracer tracer(scene);
  const Estimate estimate = irradiance(tracer, receiver_at({0, 0, 0}, up), lamp, 20000, 1);
  // The tolerance covers the float rounding of the lamp's axis, which the steep edge of a spot amplifies.
  EXPECT_NEAR(estimate.mean, expected, 4.0 * estimate.standard_error + 1e-5 * expected);
  EXPECT_LE(estimate.standard_error, 0.02 * expected);
}

TEST(Irradiance, LampsWithoutSizeFollowTheInverseSquareAndTheCosine)
{
  scene::PlacedLamp point = lamp_at(LampKind::Point, {3, 0, 4});
  point.intensity = 7.0F;
  expect_irradiance(point, 7.0 * 0.8 / 25.0);
  point.range = 10.0F;
  expect_irradiance(point, 7.0 * 0.8 / 25.0 * (1.0 - 1.0 / 16.0));
  scene::PlacedLamp sun = lamp_at(LampKind::Sun, {0, 0, 0}, {3, 0, -4});
  expect_irradiance(sun, 0.8);
  scene::PlacedLamp hemi = lamp_at(LampKind::Hemi, {0, 0, 0}, {3, 0, -4});
  expect_irradiance(hemi, 0.9);
}

TEST(Irradiance, SpotsConeIsASmoothstepOfTheCosine)
{
  for (const float blend : {0.0F, 0.25F, 1.0F}) {
    for (const double angle : {0.0, 0.2, 0.35, 0.39, 0.41, 1.0}) {
      scene::PlacedLamp spot =
          lamp_at(LampKind::Spot, {0, 0, 2}, {float(std::sin(angle)), 0.0F, -float(std::cos(angle))});
      spot.spot_outer_angle = 0.4F;
      spot.spot_blend = blend;
      const double edge = std::cos(double(0.4F));
      const double rise = std::cos(angle) - edge;
      const double t = std::clamp(blend > 0.0F ? rise / ((1.0 - edge) * double(blend)) : rise * 1e9, 0.0, 1.0);
      expect_irradiance(spot, 0.25 * t * t * (3.0 - 2.0 * t));
    }
  }
}

TEST(Irradiance, DisksRectanglesEllipsesAndSunsAreTheirClosedForms)
{
  scene::PlacedLamp point = lamp_at(LampKind::Point, {0, 0, 2});
  point.radius = 1.5F;
  expect_irradiance(point, 1.0 / (4.0 + 2.25));
  scene::PlacedLamp sun = lamp_at(LampKind::Sun, {0, 0, 0});
  for (const float angle : {0.01F, 1.0F, 3.14F}) {
    sun.angle = angle;
    expect_irradiance(sun, 1.0);
  }
  // A disk above the receiver and parallel to it: the form factor is r² / (h² + r²).
  scene::PlacedLamp area = lamp_at(LampKind::Area, {0, 0, 2});
  area.area_shape = scene::AreaShape::Ellipse;
  area.area_size_x = 3.0F;
  area.area_size_y = 3.0F;
  const double disk_area = std::numbers::pi * 2.25;
  expect_irradiance(area, 0.25 * std::numbers::pi / disk_area * 2.25 / (4.0 + 2.25));
  // A rectangle at the same position: four times Howell's form factor B-3, which is for a corner.
  area.area_shape = scene::AreaShape::Rectangle;
  area.area_size_y = 1.0F;
  const double a = 1.5 / 2.0;
  const double b = 0.5 / 2.0;
  const double quarter = (a / std::sqrt(1 + a * a) * std::atan(b / std::sqrt(1 + a * a)) +
                          b / std::sqrt(1 + b * b) * std::atan(a / std::sqrt(1 + b * b))) /
                         (2.0 * std::numbers::pi);
  expect_irradiance(area, 0.25 * std::numbers::pi * 4.0 * quarter / 3.0);
  // It emits to one side only.
  expect_irradiance(lamp_at(LampKind::Area, {0, 0, 2}, {0, 0, 1}), 0.0);
}

TEST(Irradiance, IsFiniteAtTheLamp)
{
  const scene::Scene scene;
  const Tracer tracer(scene);
  for (const LampKind kind : {LampKind::Point, LampKind::Sun, LampKind::Spot, LampKind::Hemi, LampKind::Area}) {
    for (const float size : {0.0F, 1e-12F, 1.0F, 1e12F}) {
      scene::PlacedLamp lamp = lamp_at(kind, {0, 0, 0});
      lamp.radius = size;
      lamp.angle = std::min(size, 3.14159F);
      lamp.area_size_x = std::max(size, 1e-30F);
      lamp.intensity = 1e12F;
      for (const double distance : {0.0, 1e-300, 1e-20, 1e-6, 1.0, 1e20, 1e150}) {
        const Estimate estimate = irradiance(tracer, receiver_at({0, 0, -distance}, up), lamp, 16, 1);
        EXPECT_TRUE(std::isfinite(estimate.mean) && estimate.mean >= 0.0)
            << int(kind) << ' ' << size << ' ' << distance;
        EXPECT_TRUE(std::isfinite(estimate.standard_error)) << int(kind) << ' ' << size << ' ' << distance;
      }
    }
  }
}

}  // namespace
}  // namespace gnomon::reference
