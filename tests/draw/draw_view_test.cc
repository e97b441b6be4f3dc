// SPDX-License-Identifier: MIT
#include "draw_view.hh"

#include "draw_view_shared.h"
#include "gpu_error.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include "gpu/gpu_testing.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace gnomon::draw {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

glm::vec3 ndc(const glm::mat4 &clip_from_view, const glm::vec3 &position_vs)
{
  const glm::vec4 clip = clip_from_view * glm::vec4(position_vs, 1);
  return glm::vec3(clip) / clip.w;
}

TEST(Perspective, NearIsOneAndFarIsZero)
{
  for (const auto &[near, far] : {std::pair(0.1F, 100.0F), std::pair(1.0F, 1.001F), std::pair(1e-3F, 1e3F)}) {
    const glm::mat4 matrix = perspective(1, 1, near, far);
    EXPECT_NEAR(ndc(matrix, {0, 0, -near}).z, 1, 2e-7F * far / (far - near));
    EXPECT_NEAR(ndc(matrix, {0, 0, -far}).z, 0, 2e-7F * far / (far - near));
  }
  const glm::mat4 matrix = perspective(1, 1, 0.25F, infinity);
  EXPECT_EQ(ndc(matrix, {0, 0, -0.25F}).z, 1);
  EXPECT_EQ(ndc(matrix, {0, 0, -1e30F}).z, 0.25F / 1e30F);
}

TEST(Perspective, MatchesItsClosedForm)
{
  const float near = 0.5F;
  for (const float far : {30.0F, infinity}) {
    const glm::mat4 matrix = perspective(0.75F, 0.5F, near, far);
    for (const double distance : {0.5, 0.7, 1.0, 5.0, 29.0}) {
      const double depth = std::isinf(far) ? near / distance : near * (far - distance) / (distance * (far - near));
      const glm::vec3 point = ndc(matrix, {0.3F, -0.2F, -float(distance)});
      EXPECT_NEAR(point.x, 0.3 / (0.75 * distance), 1e-6);
      EXPECT_NEAR(point.y, -0.2 / (0.5 * distance), 1e-6);
      EXPECT_NEAR(point.z, depth, 2e-7);
      EXPECT_EQ((matrix * glm::vec4(0, 0, -float(distance), 1)).w, float(distance));
    }
  }
}

TEST(Perspective, FarPlaneAtInfinityIsTheLimit)
{
  const glm::mat4 endless = perspective(1, 1, 0.1F, infinity);
  const glm::mat4 distant = perspective(1, 1, 0.1F, 1e30F);
  for (int column = 0; column < 4; column++) {
    for (int row = 0; row < 4; row++) {
      EXPECT_NEAR(endless[column][row], distant[column][row], 1e-8F);
      EXPECT_TRUE(std::isfinite(endless[column][row]));
    }
  }
}

TEST(Perspective, DepthResolvesEveryDistanceAlikeAtARatioOfAMillion)
{
  // The purpose of a reversed float depth: the error of the distance is relative to the distance.
  const double near = 1e-2;
  const double far = 1e4;
  const glm::mat4 matrix = perspective(1, 1, float(near), float(far));
  double worst = 0;
  float depth_before = 2;
  for (int i = 0; i <= 4000; i++) {
    const auto distance = float(near * std::pow(far / near, i / 4000.0) * (i == 4000 ? 0.999999 : 1));
    const float depth = ndc(matrix, {0, 0, -distance}).z;
    EXPECT_LT(depth, depth_before) << "not monotone at " << distance;
    depth_before = depth;
    // Solved for the distance, in double.
    const double stored = near * far / (double(depth) * (far - near) + near);
    worst = std::max(worst, std::abs(stored - distance) / distance);
  }
  EXPECT_LT(worst, 5e-7);
}

TEST(Orthographic, MatchesItsClosedForm)
{
  for (const auto &[near, far] : {std::pair(0.5F, 20.0F), std::pair(-8.0F, 8.0F), std::pair(0.0F, 1e5F)}) {
    const glm::mat4 matrix = orthographic(4, 2, near, far);
    EXPECT_NEAR(ndc(matrix, {0, 0, -near}).z, 1, 2e-7);
    EXPECT_NEAR(ndc(matrix, {0, 0, -far}).z, 0, 2e-7);
    const double middle = (double(near) + far) / 2;
    const glm::vec3 point = ndc(matrix, {3, -1, -float(middle)});
    EXPECT_NEAR(point.x, 0.75, 1e-6);
    EXPECT_NEAR(point.y, -0.5, 1e-6);
    EXPECT_NEAR(point.z, 0.5, 2e-7);
    EXPECT_EQ((matrix * glm::vec4(1, 2, 3, 1)).w, 1);
  }
}

TEST(ProjectionInternalErrorTest, DegenerateVolumeIsAnAssertionWithItsValues)
{
  constexpr float NAN_VALUE = std::numeric_limits<float>::quiet_NaN();
  test::expect_internal_error([&] { static_cast<void>(perspective(1, 1, 0, 10)); }, "near 0.*far 10");
  test::expect_internal_error([&] { static_cast<void>(perspective(1, 1, 2, 2)); }, "near 2.*far 2");
  test::expect_internal_error([&] { static_cast<void>(perspective(0, 1, 1, 2)); }, "half size 0x1");
  test::expect_internal_error([&] { static_cast<void>(perspective(1, NAN_VALUE, 1, 2)); }, "half size 1xnan");
  test::expect_internal_error([&] { static_cast<void>(orthographic(1, 1, 3, 2)); }, "near 3.*far 2");
  test::expect_internal_error([&] { static_cast<void>(orthographic(1, 0, 1, 2)); }, "half size 1x0");
}

TEST(View, HasItsProjection)
{
  EXPECT_TRUE(View(glm::mat4(1), perspective(1, 1, 0.1F, 10)).is_perspective());
  EXPECT_FALSE(View(glm::mat4(1), orthographic(1, 1, 0.1F, 10)).is_perspective());
  const glm::mat4 view_from_world = glm::lookAt(glm::vec3(1, 2, 3), glm::vec3(0), glm::vec3(0, 0, 1));
  const View view(view_from_world, perspective(1, 1, 0.1F, 10));
  EXPECT_EQ(view.clip_from_world(), perspective(1, 1, 0.1F, 10) * view_from_world);
}

void expect_plane(const glm::vec4 &plane, const glm::vec4 &expected)
{
  for (int i = 0; i < 4; i++) {
    EXPECT_NEAR(plane[i], expected[i], 2e-5F * std::max(1.0F, std::abs(expected[i]))) << "component " << i;
  }
}

TEST(View, PlanesOfAPerspectiveAreTheClosedForm)
{
  // |x| <= w·d and |y| <= h·d, near <= d <= far, where d = -z is the distance.
  const float w = 0.75F;
  const float h = 0.5F;
  for (const float far : {40.0F, infinity}) {
    const auto planes = View(glm::mat4(1), perspective(w, h, 0.5F, far)).frustum_planes_ws();
    const float side = 1 / std::sqrt(1 + w * w);
    const float up = 1 / std::sqrt(1 + h * h);
    expect_plane(planes[0], {side, 0, -w * side, 0});
    expect_plane(planes[1], {-side, 0, -w * side, 0});
    expect_plane(planes[2], {0, up, -h * up, 0});
    expect_plane(planes[3], {0, -up, -h * up, 0});
    expect_plane(planes[4], {0, 0, -1, -0.5F});
    expect_plane(planes[5], std::isinf(far) ? glm::vec4(0, 0, 0, 1) : glm::vec4(0, 0, 1, far));
  }
}

TEST(View, PlanesOfAnOrthographicAreItsBoxInTheWorld)
{
  // Looks along +x from (10, 0, 0), up is z: right is -y.
  const glm::mat4 view_from_world = glm::lookAt(glm::vec3(10, 0, 0), glm::vec3(11, 0, 0), glm::vec3(0, 0, 1));
  const auto planes = View(view_from_world, orthographic(3, 2, 1, 5)).frustum_planes_ws();
  expect_plane(planes[0], {0, -1, 0, 3});
  expect_plane(planes[1], {0, 1, 0, 3});
  expect_plane(planes[2], {0, 0, 1, 2});
  expect_plane(planes[3], {0, 0, -1, 2});
  expect_plane(planes[4], {1, 0, 0, -11});
  expect_plane(planes[5], {-1, 0, 0, 15});
}

/** Cameras of all kinds, at random places. */
std::vector<View> random_views(std::mt19937 &random, int count)
{
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(0.1F, 3);
  std::vector<View> views;
  for (int i = 0; i < count; i++) {
    const glm::vec3 eye(5 * normal(random), 5 * normal(random), 5 * normal(random));
    const glm::vec3 forward(normal(random), normal(random), normal(random));
    const glm::mat4 view_from_world = glm::lookAt(eye, eye + forward, glm::vec3(0.3F, 0.2F, 1));
    const float near = uniform(random);
    switch (i % 3) {
      case 0:
        views.emplace_back(view_from_world, perspective(uniform(random), uniform(random), near, near + 20));
        break;
      case 1: views.emplace_back(view_from_world, perspective(uniform(random), uniform(random), near, infinity)); break;
      default:
        views.emplace_back(view_from_world, orthographic((i % 2 == 0 ? 4.0F : -4.0F) * uniform(random),
                                                         4 * uniform(random), near, near + 20));
        break;
    }
  }
  return views;
}

/** In double, slightly inside. */
bool is_inside(const View &view, const glm::dvec3 &point)
{
  const glm::dvec4 clip = glm::dmat4(view.clip_from_world()) * glm::dvec4(point, 1);
  const double inner = clip.w * (1 - 1e-5);
  return clip.w > 0 && std::abs(clip.x) < inner && std::abs(clip.y) < inner && clip.z > 0 && clip.z < inner;
}

TEST(View, CullsNoSphereThatHasAPointInTheFrustum)
{
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(0, 1);
  int touched = 0;
  int culled = 0;
  for (const View &view : random_views(random, 60)) {
    for (int i = 0; i < 60; i++) {
      const CullingVolume volume{glm::vec3(normal(random), normal(random), normal(random)) * 12.0F,
                                 4 * uniform(random) * uniform(random)};
      const bool is_touched = view.touches(volume);
      (is_touched ? touched : culled)++;
      for (int sample = 0; sample < 300 && !is_touched; sample++) {
        const glm::vec3 direction = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
        const float share = sample % 2 == 0 ? 1 : std::cbrt(uniform(random));
        const glm::vec3 point = volume.center_ws + direction * (volume.radius * share * (1 - 1e-5F));
        ASSERT_FALSE(is_inside(view, point)) << "a sphere is culled with a point of it inside";
      }
    }
  }
  // Both results must occur, otherwise nothing is tested.
  EXPECT_GT(touched, 300);
  EXPECT_GT(culled, 300);
}

TEST(View, CullsWhatIsBehindAPlaneByMoreThanItsRadius)
{
  const View view(glm::mat4(1), perspective(1, 1, 1, 50));
  const float diagonal = std::sqrt(0.5F);
  struct Case {
    const char *side;
    glm::vec3 inside;
    glm::vec3 outwards;
  };
  for (const Case &one :
       {Case{"left", {-10, 0, -10}, {-diagonal, 0, diagonal}}, Case{"right", {10, 0, -10}, {diagonal, 0, diagonal}},
        Case{"bottom", {0, -10, -10}, {0, -diagonal, diagonal}}, Case{"top", {0, 10, -10}, {0, diagonal, diagonal}},
        Case{"near", {0, 0, -1}, {0, 0, 1}}, Case{"far", {0, 0, -50}, {0, 0, -1}}}) {
    SCOPED_TRACE(one.side);
    EXPECT_TRUE(view.touches({one.inside + one.outwards * 1.99F, 2}));
    EXPECT_FALSE(view.touches({one.inside + one.outwards * 2.01F, 2}));
    EXPECT_TRUE(view.touches({one.inside + one.outwards * 2.01F, -1})) << "a negative radius is never culled";
  }
}

TEST(View, FarAtInfinityCullsNothingInFront)
{
  const View view(glm::mat4(1), perspective(1, 1, 1, infinity));
  EXPECT_TRUE(view.touches({{0, 0, -1e20F}, 1}));
  EXPECT_FALSE(view.touches({{0, 0, 1e3F}, 1}));
}

TEST(View, ClipPlanesInCoordinatesOfFragmentsHaveTheSameSides)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-5.0F, 5.0F);
  const glm::mat4 view_from_world = glm::lookAt(glm::vec3(1, 2, 12), glm::vec3(0), glm::vec3(0, 1, 0));
  constexpr glm::ivec2 size_px(640, 360);
  for (const glm::mat4 &projection : {perspective(0.8F, 0.45F, 0.1F, infinity), perspective(0.8F, 0.45F, 0.1F, 100.0F),
                                      orthographic(8, 4.5F, 0.1F, 50)}) {
    int behind = 0;
    for (int i = 0; i < 1000; i++) {
      const glm::vec4 plane(place(random), place(random), place(random), place(random));
      const View view = View(view_from_world, projection).with_clip_planes({{0, 0, 0, 1}, plane});
      shared::ViewData data{};
      set_clip_planes(data, view, {{0, 0}, size_px});
      const glm::vec3 point(place(random), place(random), place(random));
      const float height = glm::dot(plane, glm::vec4(point, 1.0F));
      const glm::vec3 at = ndc(view.clip_from_world(), point);
      const glm::vec4 fragment(0.5F * (at.x + 1.0F) * float(size_px.x), 0.5F * (at.y + 1.0F) * float(size_px.y), at.z,
                               1);
      if (std::abs(height) > 1e-3F) {
        EXPECT_EQ(glm::dot(data.clip_planes[1], fragment) < 0.0F, height < 0.0F) << i;
      }
      EXPECT_GE(glm::dot(data.clip_planes[0], fragment), 0.0F);
      EXPECT_EQ(data.clip_planes[2], glm::vec4(0.0F)) << "no plane";
      behind += height < 0.0F ? 1 : 0;
    }
    EXPECT_GT(behind, 300);
  }
}

TEST(View, KeepsItsClipPlanesAndRefusesTooMany)
{
  const View view = View().with_clip_planes({{1, 0, 0, 2}});
  EXPECT_NE(view, View());
  EXPECT_EQ(view.with_clip_planes({}), View());
  EXPECT_EQ(view.with_hidden({}).clip_planes(), view.clip_planes());
  EXPECT_EQ(view.with_matrices(glm::mat4(2), glm::mat4(1)).clip_planes(), view.clip_planes());
  EXPECT_NO_THROW(static_cast<void>(View().with_clip_planes(std::vector<glm::vec4>(6))));
  EXPECT_THROW(static_cast<void>(View().with_clip_planes(std::vector<glm::vec4>(7))), gpu::Error);
  EXPECT_NO_THROW(static_cast<void>(View().with_clip_planes({glm::vec4(std::numeric_limits<float>::max())})));
  EXPECT_THROW(static_cast<void>(View().with_clip_planes({{NAN, 0, 0, 1}})), gpu::Error);
  EXPECT_THROW(static_cast<void>(View().with_clip_planes({{0, 0, 0, -INFINITY}})), gpu::Error);
}

}  // namespace
}  // namespace gnomon::draw
