// SPDX-License-Identifier: MIT
#include "reference_compare.hh"
#include "reference_test_scene.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::reference {
namespace {

using scene::LampKind;
using test::add_rectangle;
using test::lamp_at;
using test::placed;

/** Receivers and visibilities of an engine. */
struct Shaded {
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<float> visibility;

  void add(const glm::vec3 &position, const glm::vec3 &normal, float value)
  {
    positions.push_back(position);
    normals.push_back(normal);
    visibility.push_back(value);
  }
  [[nodiscard]] ShadedReceivers view() const
  {
    return {positions, normals, visibility};
  }
};

/** A square of half width 1 at height 2 above a plane that is tilted around y. */
struct SquareOverPlane {
  scene::Scene scene;
  glm::mat4 plane{1.0F};

  explicit SquareOverPlane(float tilt)
  {
    plane = glm::rotate(glm::mat4(1.0F), tilt, glm::vec3(0, 1, 0));
    add_rectangle(scene, {-20, -20}, {20, 20}, plane);
    add_rectangle(scene, {-1, -1}, {1, 1}, placed({0, 0, 2}));
  }

  /** A grid of receivers with the exact visibility at positions shifted by \a shift_m. */
  [[nodiscard]] Shaded shaded(const Tracer &tracer, const scene::PlacedLamp &lamp, double shift_m) const
  {
    Shaded result;
    const LightPoint light = lamp_center(lamp);
    const glm::dvec3 normal(plane[2]);
    for (int i = 0; i < 80; i++) {
      for (int k = 0; k < 80; k++) {
        const glm::dvec3 position(glm::dmat4(plane) * glm::dvec4(0.0937 * (i - 40), 0.0937 * (k - 40), 0, 1));
        // Shifted along y, which lies in the plane and is perpendicular to the light of these tests.
        const glm::dvec3 there = position + glm::dvec3(0, shift_m, 0);
        const bool is_lit = is_visible(tracer, receiver_at(there, normal), light);
        result.add(glm::vec3(position), glm::vec3(normal), is_lit ? 1.0F : 0.0F);
      }
    }
    return result;
  }
};

TEST(Compare, ExactVisibilityHasNoError)
{
  for (const LampKind kind : {LampKind::Point, LampKind::Sun}) {
    const SquareOverPlane square(0.4F);
    const Tracer tracer(square.scene);
    const scene::PlacedLamp lamp = lamp_at(kind, {0.1F, 0.2F, 8.0F});
    const Shaded shaded = square.shaded(tracer, lamp, 0.0);
    const VisibilityError error =
        compare_visibility(tracer, lamp, shaded.view(), {.texel_size_m = [](const glm::dvec3 &) { return 0.01; }});
    EXPECT_EQ(error.receiver_count, 6400U);
    EXPECT_EQ(error.facing_count, 6400U);
    EXPECT_EQ(error.off_surface_count, 0U);
    EXPECT_EQ(error.wrong_count, 0U);
    EXPECT_EQ(error.mean_absolute_error, 0.0);
    EXPECT_EQ(error.edge_offset_max, 0.0);
  }
}

struct Shift {
  LampKind kind;
  float tilt;
  double texels;
};

class CompareShiftTest : public testing::TestWithParam<Shift> {};

TEST_P(CompareShiftTest, EdgeOffsetIsTheShiftOfTheShadows)
{
  const Shift shift = GetParam();
  const SquareOverPlane square(shift.tilt);
  const Tracer tracer(square.scene);
  // The lamp is distant, so that y is almost perpendicular to its light everywhere.
  const scene::PlacedLamp lamp = lamp_at(shift.kind, {0, 0, 200});
  constexpr double texel_m = 0.05;
  const Shaded shaded = square.shaded(tracer, lamp, shift.texels * texel_m);
  const VisibilityError error =
      compare_visibility(tracer, lamp, shaded.view(), {.texel_size_m = [](const glm::dvec3 &) { return texel_m; }});
  EXPECT_GT(error.wrong_count, 20U);
  EXPECT_EQ(error.leak_count, 0U);
  EXPECT_EQ(error.acne_count, 0U);
  // The distance of a receiver from the edge is below the shift, so the offset is at most the first ring that is not
  // smaller.
  const auto rings = edge_rings();
  EXPECT_LE(error.edge_offset_max, *std::ranges::lower_bound(rings, shift.texels * 1.02));
  EXPECT_GE(error.edge_offset_max, 0.7 * shift.texels);
  EXPECT_LE(error.edge_offset_median, error.edge_offset_p95);
  EXPECT_LE(error.edge_offset_p95, error.edge_offset_max);
}

INSTANTIATE_TEST_SUITE_P(Shifts, CompareShiftTest,
                         testing::Values(Shift{LampKind::Sun, 0.0F, 1.5}, Shift{LampKind::Sun, 1.4F, 1.5},
                                         Shift{LampKind::Point, 0.0F, 3.0}, Shift{LampKind::Point, 1.4F, 3.0},
                                         Shift{LampKind::Sun, 0.0F, 6.0}, Shift{LampKind::Point, 0.8F, 6.0}));

TEST(Compare, DepthOffsetAlongTheLightOfAGrazedPlaneIsMeasuredAcrossIt)
{
  // A wall on a plane under a sun at 5 degrees. The shadow is long, and one texel across the light covers 11 on the
  // plane.
  scene::Scene scene;
  add_rectangle(scene, {-50, -50}, {50, 50});
  glm::mat4 upright(0.0F);
  upright[0] = {0, 0, 1, 0};
  upright[1] = {0, 1, 0, 0};
  upright[2] = {-1, 0, 0, 0};
  upright[3] = {0, 0, 0, 1};
  add_rectangle(scene, {0, -20}, {1, 20}, upright);
  const Tracer tracer(scene);
  const double elevation = 5.0 * M_PI / 180.0;
  const scene::PlacedLamp sun =
      lamp_at(LampKind::Sun, {0, 0, 0}, {float(std::cos(elevation)), 0, -float(std::sin(elevation))});
  const double end = 1.0 / std::tan(elevation);
  constexpr double texel_m = 0.02;
  // A receiver two texels across the light beyond the end of the shadow: the engine is dark, the exact result is lit.
  Shaded shaded;
  shaded.add({float(end + 1.9 * texel_m / std::sin(elevation)), 0.5F, 0}, {0, 0, 1}, 0.0F);
  const VisibilityError error =
      compare_visibility(tracer, sun, shaded.view(), {.texel_size_m = [](const glm::dvec3 &) { return texel_m; }});
  EXPECT_EQ(error.wrong_count, 1U);
  EXPECT_EQ(error.acne_count, 0U);
  EXPECT_EQ(error.edge_offset_max, 2.0);
}

TEST(Compare, MovedReceiversStayOnTheirOwnSurface)
{
  // A steep plane, and a small caster above it at the height of the receiver. The plane below the caster is dark.
  scene::Scene scene;
  add_rectangle(scene, {-10, -10}, {10, 10}, glm::rotate(glm::mat4(1.0F), float(M_PI / 3), glm::vec3(0, 1, 0)));
  add_rectangle(scene, {0.9F, -0.1F}, {1.1F, 0.1F}, placed({0, 0, -0.35F}));
  const Tracer tracer(scene);
  Shaded shaded;
  shaded.add({0, 0, 0}, {float(std::sin(M_PI / 3)), 0, 0.5F}, 0.0F);
  const VisibilityError error = compare_visibility(tracer, lamp_at(LampKind::Sun, {0, 0, 0}), shaded.view(),
                                                   {.texel_size_m = [](const glm::dvec3 &) { return 0.5; }});
  EXPECT_EQ(error.wrong_count, 1U);
  EXPECT_EQ(error.acne_count, 0U);
  EXPECT_EQ(error.edge_offset_max, 2.0);
}

TEST(Compare, LeakAndAcneAreWrongFarFromAnyEdge)
{
  const SquareOverPlane square(0.0F);
  const Tracer tracer(square.scene);
  const scene::PlacedLamp sun = lamp_at(LampKind::Sun, {0, 0, 0});
  Shaded shaded = square.shaded(tracer, sun, 0.0);
  // Two receivers inside the shadow, one at its edge, three in the light.
  shaded.add({0, 0, 0}, {0, 0, 1}, 1.0F);
  shaded.add({0.5F, -0.5F, 0}, {0, 0, 1}, 0.75F);
  shaded.add({0.995F, 0, 0}, {0, 0, 1}, 1.0F);
  shaded.add({5, 5, 0}, {0, 0, 1}, 0.0F);
  shaded.add({-5, 5, 0}, {0, 0, 1}, 0.5F);
  shaded.add({5, -5, 0}, {0, 0, 1}, 0.25F);
  const VisibilityError error =
      compare_visibility(tracer, sun, shaded.view(), {.texel_size_m = [](const glm::dvec3 &) { return 0.01; }});
  EXPECT_EQ(error.wrong_count, 6U);
  EXPECT_EQ(error.leak_count, 2U);
  EXPECT_EQ(error.acne_count, 3U);
  EXPECT_EQ(error.edge_offset_max, 0.5);
  EXPECT_EQ(error.edge_count, 3U);
  EXPECT_DOUBLE_EQ(error.wrong_fraction, 6.0 / 6406.0);
  EXPECT_DOUBLE_EQ(error.mean_absolute_error, (1.0 + 0.75 + 1.0 + 1.0 + 0.5 + 0.75) / 6406.0);
  // Without a texel size, no receiver is near an edge.
  EXPECT_EQ(compare_visibility(tracer, sun, shaded.view(), {}).leak_count, 3U);
}

TEST(Compare, LightBehindAWallIsALeakHoweverNearItIs)
{
  // A wall on a plane, lit from the side of -y.
  scene::Scene scene;
  add_rectangle(scene, {-5, -5}, {5, 5}, glm::mat4(1.0F));
  add_rectangle(scene, {-1, 0}, {1, 1}, glm::rotate(glm::mat4(1.0F), 1.5707963F, glm::vec3(1, 0, 0)));
  const Tracer tracer(scene);
  const scene::PlacedLamp sun = lamp_at(LampKind::Sun, {0, 0, 0}, {0, 1, -1});
  CompareSettings settings;
  settings.texel_size_m = [](const glm::dvec3 & /*position_ws*/) { return 0.01; };
  Shaded shaded;
  // In the shadow, a third of a texel behind the wall, and as far from the free edge at x = 1.
  shaded.add({0.0F, 0.003F, 0.0F}, {0, 0, 1}, 1.0F);
  shaded.add({0.997F, 0.5F, 0.0F}, {0, 0, 1}, 1.0F);
  const VisibilityError error = compare_visibility(tracer, sun, shaded.view(), settings);
  EXPECT_EQ(error.wrong_count, 2U);
  EXPECT_EQ(error.leak_count, 1U);
}

TEST(Compare, AcneInsideOfASphereIsNotAnEdge)
{
  // The inside of a closed sphere with the lamp at its centre is lit, although every tangent plane is outside.
  std::vector<glm::vec3> corners;
  const auto corner = [](int row, int column) {
    const float polar = float(M_PI) * float(row) / 32.0F;
    const float turn = 2.0F * float(M_PI) * float(column % 64) / 64.0F;
    // All corners at a pole are exactly equal, so that triangles there do not fold.
    const float across = row % 32 == 0 ? 0.0F : std::sin(polar);
    return glm::vec3(across * std::cos(turn), across * std::sin(turn), std::cos(polar));
  };
  for (int row = 0; row < 32; row++) {
    for (int column = 0; column < 64; column++) {
      corners.insert(corners.end(), {corner(row, column), corner(row + 1, column), corner(row + 1, column + 1)});
      corners.insert(corners.end(), {corner(row, column), corner(row + 1, column + 1), corner(row, column + 1)});
    }
  }
  scene::Scene scene;
  test::add_triangles(scene, corners);
  const Tracer tracer(scene);
  Shaded shaded;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const glm::vec3 middle = (corners[i] + corners[i + 1] + corners[i + 2]) / 3.0F;
    shaded.add(middle, -middle, i % 30 == 0 ? 0.0F : 1.0F);
  }
  const VisibilityError error = compare_visibility(tracer, lamp_at(LampKind::Point, {0.1F, 0.2F, 0.3F}), shaded.view(),
                                                   {.texel_size_m = [](const glm::dvec3 &) { return 0.02; }});
  EXPECT_GT(error.facing_count, 3900U);
  EXPECT_GT(error.wrong_count, 300U);
  EXPECT_EQ(error.acne_count, error.wrong_count);
}

TEST(Compare, ReceiversThatCannotBeComparedAreCounted)
{
  const SquareOverPlane square(0.0F);
  const Tracer tracer(square.scene);
  const scene::PlacedLamp sun = lamp_at(LampKind::Sun, {0, 0, 0});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Shaded shaded;
  shaded.add({5, 5, 0}, {0, 0, 1}, 1.0F);
  shaded.add({5, 5, 0}, {0, 0, -1}, 1.0F);
  shaded.add({5, 5, 0.5F}, {0, 0, 1}, 1.0F);
  shaded.add({5, 5, nan}, {0, 0, 1}, 1.0F);
  shaded.add({5, 5, 0}, {0, 0, 0}, 1.0F);
  shaded.add({5, 5, 0}, {0, 0, nan}, 1.0F);
  shaded.add({5, 5, 0}, {0, 0, 1}, nan);
  const VisibilityError error = compare_visibility(tracer, sun, shaded.view(), {});
  EXPECT_EQ(error.receiver_count, 7U);
  EXPECT_EQ(error.off_surface_count, 4U);
  EXPECT_EQ(error.non_finite_count, 1U);
  EXPECT_EQ(error.facing_count, 1U);
  EXPECT_EQ(error.wrong_count, 0U);
  EXPECT_THROW(static_cast<void>(compare_visibility(tracer, sun, {shaded.positions, shaded.normals, {}}, {})),
               std::invalid_argument);
  EXPECT_EQ(compare_visibility(tracer, sun, {}, {}).wrong_fraction, 0.0);
}

TEST(Compare, ThreadsDoNotChangeTheResult)
{
  const SquareOverPlane square(0.4F);
  const Tracer tracer(square.scene);
  scene::PlacedLamp lamp = lamp_at(LampKind::Point, {0, 0, 8});
  lamp.radius = 0.5F;
  const Shaded shaded = square.shaded(tracer, lamp, 0.1);
  const auto judged = [&](unsigned threads) {
    return compare_visibility(
        tracer, lamp, shaded.view(),
        {.texel_size_m = [](const glm::dvec3 &) { return 0.05; }, .sample_count = 16, .thread_count = threads});
  };
  const VisibilityError one = judged(1);
  const VisibilityError many = judged(5);
  EXPECT_GT(one.wrong_count, 0U);
  EXPECT_EQ(one.mean_absolute_error, many.mean_absolute_error);
  EXPECT_EQ(one.wrong_count, many.wrong_count);
  EXPECT_EQ(one.edge_offset_p95, many.edge_offset_p95);
}

}  // namespace
}  // namespace gnomon::reference
