// SPDX-License-Identifier: MIT
#include "eevee_lamps.hh"

#include "eevee_light_cluster_shared.h"
#include "shadows/shadow_cube.hh"
#include "shadows/shadow_plan.hh"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <numbers>

namespace gnomon::eevee {
namespace {

scene::PlacedLamp unit_lamp(scene::LampKind kind)
{
  scene::PlacedLamp lamp;
  lamp.name = "lamp";
  lamp.kind = kind;
  lamp.world_from_lamp = glm::translate(glm::mat4(1.0F), glm::vec3(1, 2, 3));
  lamp.color = {1.0F, 0.5F, 0.25F};
  lamp.intensity = 8.0F;
  return lamp;
}

TEST(LightData, ShinesAlongTheLampsMinusZ)
{
  scene::PlacedLamp lamp = unit_lamp(scene::LampKind::Spot);
  lamp.world_from_lamp =
      lamp.world_from_lamp * glm::rotate(glm::dmat4(1.0), 0.5 * 3.14159265358979, glm::dvec3(1, 0, 0));
  const shared::LightData light = light_data(lamp);
  // -Z turned by 90° around X is +Y.
  EXPECT_NEAR(glm::distance(light.forward_ws, glm::vec3(0, 1, 0)), 0.0F, 1e-6F);
  EXPECT_EQ(light.position_ws, glm::vec3(1, 2, 3));
  EXPECT_EQ(light.color, glm::vec3(8, 4, 2));
}

// hazards.md: a lamp without a shadow was looked up at index -1.
TEST(LightData, HasNoShadowByDefault)
{
  const shared::LightData light = light_data(unit_lamp(scene::LampKind::Point));
  EXPECT_EQ(light.shadow_kind, SHADOW_NONE);
  EXPECT_EQ(light.shadow_index, -1);
}

TEST(LightData, IsFiniteForEveryRange)
{
  scene::PlacedLamp lamp = unit_lamp(scene::LampKind::Point);
  for (const float range : {1e-45F, 1e-30F, 1.0F, 1e30F}) {
    lamp.range = range;
    const shared::LightData light = light_data(lamp);
    EXPECT_EQ(shared::distance_falloff(0.0F, light.radius_sq, light.range_inv_sq), 1e12F) << range;
    EXPECT_EQ(shared::distance_falloff(100.0F, light.radius_sq, light.range_inv_sq), range < 10.0F ? 0.0F : 0.01F)
        << range;
  }
}

TEST(Lamps, AreaLampsAreScaledByTheirNode)
{
  std::vector<scene::PlacedLamp> placed;
  placed = {unit_lamp(scene::LampKind::Area)};
  placed[0].area_shape = scene::AreaShape::Ellipse;
  placed[0].area_size_x = 3.0F;
  placed[0].area_size_y = 2.0F;
  placed[0].scale = {2.0, 0.5, 7.0};
  const Lamps lamps = make_lamps(placed);
  EXPECT_EQ(lamps.features, Feature::Light | Feature::Punctual | Feature::LampShape);
  EXPECT_EQ(lamps.lights[0].kind, LIGHT_ELLIPSE);
  // Blender's power P: radiance P / (4 A), which is P / 4 straight ahead.
  EXPECT_EQ(lamps.lights[0].color, glm::vec3(2, 1, 0.5F));
  EXPECT_EQ(lamps.shapes[0].axis_x_ws, glm::vec3(3, 0, 0));
  EXPECT_EQ(lamps.shapes[0].axis_y_ws, glm::vec3(0, 0.5F, 0));
}

TEST(Lamps, AreaLampsWithoutAreaAreNamedAndLeftOut)
{
  std::vector<scene::PlacedLamp> placed;
  placed = {unit_lamp(scene::LampKind::Area), unit_lamp(scene::LampKind::Sun)};
  placed[0].scale.y = 0.0;
  const Lamps lamps = make_lamps(placed);
  EXPECT_EQ(lamps.light_count(), 1);
  EXPECT_EQ(lamps.lamp_index, std::vector<std::uint32_t>{1});
  ASSERT_EQ(lamps.warnings.size(), 1U);
  EXPECT_NE(lamps.warnings[0].find("'lamp': the scale of its node leaves it no area"), std::string::npos);
}

TEST(Lamps, ScaleMakesASpotsConeElliptical)
{
  std::vector<scene::PlacedLamp> placed;
  placed = {unit_lamp(scene::LampKind::Spot)};
  placed[0].scale = {3.0, 3.0, 3.0};
  EXPECT_EQ(make_lamps(placed).features, Feature::Light | Feature::Punctual);
  placed[0].scale = {2.0, 0.5, 1.0};
  const Lamps lamps = make_lamps(placed);
  EXPECT_EQ(lamps.features, Feature::Light | Feature::Punctual | Feature::LampShape);
  const shared::LightShape &shape = lamps.shapes[0];
  // At the rim along each axis, the tangent is that of the round cone times the scale.
  const shared::LightData &light = lamps.lights[0];
  const float tangent = std::tan(placed[0].spot_outer_angle);
  for (const glm::vec3 &rim : {glm::vec3(2.0F * tangent, 0, -1), glm::vec3(0, 0.5F * tangent, -1)}) {
    EXPECT_NEAR(shared::elliptic_drop(glm::normalize(rim), light.forward_ws, shape.axis_x_ws, shape.axis_y_ws),
                light.spot_drop_outer, 1e-6F);
  }
  // A singular matrix leaves the cone round.
  placed[0].scale = {2.0, 0.5, 0.0};
  EXPECT_EQ(make_lamps(placed).features, Feature::Light | Feature::Punctual);
}

TEST(Lamps, LampsShadedAsPointsHaveNoExtent)
{
  std::vector<scene::PlacedLamp> placed;
  placed = {unit_lamp(scene::LampKind::Point), unit_lamp(scene::LampKind::Sun), unit_lamp(scene::LampKind::Area)};
  placed[0].radius = 0.5F;
  placed[1].angle = 0.2F;
  const Lamps whole = make_lamps(placed, LampShading::Whole);
  EXPECT_FLOAT_EQ(whole.shapes[0].extent, 0.5F);
  // The area is before the sun, as its shadow is a cube.
  EXPECT_GT(whole.shapes[1].extent, 0.0F);
  EXPECT_FLOAT_EQ(whole.shapes[2].extent, std::tan(0.1F));
  const Lamps point = make_lamps(placed, LampShading::Point);
  for (int i = 0; i < 3; i++) {
    EXPECT_EQ(point.shapes[std::size_t(i)].extent, 0.0F);
  }
}

TEST(Lamps, WholeHighlightsNeedLobesThatAreNarrowAtTheNearestSurface)
{
  std::vector<scene::PlacedLamp> placed{unit_lamp(scene::LampKind::Point)};
  placed[0].radius = 0.5F;
  placed[0].world_from_lamp[3] = {1.0, 2.0, 3.0, 1.0};
  const auto highlight_alpha = [&](int sample_count, const scene::Bounds &receivers_ws) {
    Lamps lamps = make_lamps(placed, LampShading::Point);
    set_highlights(lamps, placed, placed.size(), sample_count, receivers_ws);
    return lamps.highlight_alpha;
  };
  // A lobe of 4 π alpha² contains HIGHLIGHT_LOBE_POINTS of the `sample_count` points in the lamp's solid angle.
  const double solid_angle = 2.0 * std::numbers::pi * (1.0 - std::cos(std::atan(0.5 / 1.5)));
  const double expected = std::sqrt(double(HIGHLIGHT_LOBE_POINTS) / 256.0 * solid_angle / (4.0 * std::numbers::pi));
  const scene::Bounds below{{-5.0F, -5.0F, -5.0F}, {5.0F, 0.5F, 5.0F}};
  EXPECT_NEAR(double(highlight_alpha(256, below)), expected, 1e-6);
  EXPECT_NEAR(double(highlight_alpha(1024, below)), 0.5 * expected, 1e-6);
  // A surface at the lamp sees it in half of all directions.
  EXPECT_NEAR(double(highlight_alpha(256, {{-5.0F, -5.0F, -5.0F}, {5.0F, 5.0F, 5.0F}})), std::sqrt(0.125), 1e-6);
  placed[0].radius = 0.0F;
  EXPECT_EQ(highlight_alpha(256, below), 0.0F);
}

TEST(Lamps, SizedLampsAreDrawnWithoutAWarning)
{
  std::vector<scene::PlacedLamp> placed;
  placed = {unit_lamp(scene::LampKind::Point), unit_lamp(scene::LampKind::Sun)};
  placed[0].radius = 0.5F;
  placed[1].angle = 0.1F;
  const Lamps lamps = make_lamps(placed);
  EXPECT_EQ(lamps.light_count(), 2);
  EXPECT_TRUE(lamps.warnings.empty());
  EXPECT_FLOAT_EQ(lamps.lights[0].radius_sq, 0.25F);
}

TEST(Lamps, BlackLampsHaveNoEntry)
{
  std::vector<scene::PlacedLamp> placed;
  placed = {unit_lamp(scene::LampKind::Sun), unit_lamp(scene::LampKind::Point)};
  placed[0].intensity = 0.0F;
  placed[1].color = glm::vec3(0.0F);
  const Lamps lamps = make_lamps(placed);
  EXPECT_EQ(lamps.light_count(), 0);
  EXPECT_EQ(lamps.features, Feature::None);
}

TEST(Lamps, FeaturesAreThoseOfTheKinds)
{
  std::vector<scene::PlacedLamp> placed;
  placed = {unit_lamp(scene::LampKind::Sun)};
  EXPECT_EQ(make_lamps(placed).features, Feature::Light);
  placed = {unit_lamp(scene::LampKind::Hemi)};
  EXPECT_EQ(make_lamps(placed).features, Feature::Light);
  placed = {unit_lamp(scene::LampKind::Spot)};
  EXPECT_EQ(make_lamps(placed).features, Feature::Light | Feature::Punctual);
}

// hazards.md: the lamp above the maximum was written out of range, or dropped silently.
TEST(Lamps, LampAboveTheLimitIsNamedAndTheOthersAreUnchanged)
{
  std::vector<scene::PlacedLamp> placed(LIGHT_COUNT_MAX + 1, unit_lamp(scene::LampKind::Point));
  for (std::size_t i = 0; i < placed.size(); i++) {
    placed[i].name = "lamp" + std::to_string(i);
    placed[i].intensity = float(i + 1);
  }
  const Lamps lamps = make_lamps(placed);
  ASSERT_EQ(lamps.light_count(), LIGHT_COUNT_MAX);
  for (std::size_t i = 0; i < LIGHT_COUNT_MAX; i++) {
    ASSERT_EQ(lamps.lights[i].color.r, float(i + 1));
  }
  ASSERT_EQ(lamps.limits.size(), 1U);
  EXPECT_NE(lamps.limits[0].find("'lamp65536'"), std::string::npos) << lamps.limits[0];
  EXPECT_EQ(lamps.limits[0].find("'lamp65535'"), std::string::npos);

  placed.pop_back();
  EXPECT_TRUE(make_lamps(placed).limits.empty());
}

// Shaders visit the lights whose shadows are cubes, and the others, in loops of their own.
TEST(Lamps, LampsWithCubesAreBeforeTheOthers)
{
  std::vector<scene::PlacedLamp> placed;
  using enum scene::LampKind;
  const std::vector<scene::LampKind> kinds = {Sun, Point, Hemi, Area, Spot, Point, Spot};
  for (std::size_t i = 0; i < kinds.size(); i++) {
    placed.push_back(unit_lamp(kinds[i]));
    placed.back().radius = 0.5F + float(i);
  }
  placed[5].intensity = 0.0F;
  placed[6].spot_outer_angle = 1.3F;
  const Lamps lamps = make_lamps(placed);
  EXPECT_EQ(lamps.lamp_index, (std::vector<std::uint32_t>{1, 3, 6, 0, 2, 4}));
  EXPECT_EQ(lamps.cube_light_count, 3);
  ASSERT_EQ(lamps.light_count(), 6);
  EXPECT_EQ(lamps.lights[0].kind, LIGHT_POINT);
  EXPECT_EQ(lamps.lights[1].kind, LIGHT_RECTANGLE);
  EXPECT_EQ(lamps.lights[2].kind, LIGHT_SPOT);
  EXPECT_EQ(lamps.lights[3].kind, LIGHT_SUN);
  EXPECT_EQ(lamps.lights[4].kind, LIGHT_HEMI);
  EXPECT_EQ(lamps.lights[5].kind, LIGHT_SPOT);
  EXPECT_EQ(lamps.shapes[0].extent, 1.5F);
  EXPECT_EQ(lamps.shapes[5].extent, 4.5F);

  // plan_shadows gives memory to the first lamps of the scene, whatever their kind.
  const std::vector<ShadowLamp> shadows = shadow_lamps(placed, lamps);
  ASSERT_EQ(shadows.size(), 6U);
  EXPECT_EQ(shadows[0].kind, Sun);
  EXPECT_EQ(shadows[0].light, 3);
  EXPECT_EQ(shadows[5].light, 2);
}

TEST(Lamps, SpotThatItsScaleMakesWideHasACube)
{
  std::vector<scene::PlacedLamp> placed;
  placed = {unit_lamp(scene::LampKind::Sun), unit_lamp(scene::LampKind::Spot)};
  placed[1].spot_outer_angle = 0.9F;
  EXPECT_EQ(make_lamps(placed).cube_light_count, 0);
  placed[1].scale = {3.0, 1.0, 1.0};
  const Lamps lamps = make_lamps(placed);
  EXPECT_EQ(lamps.cube_light_count, 1);
  EXPECT_EQ(lamps.lights[0].kind, LIGHT_SPOT);
}

// The error is that of the window; beyond the range it is the whole irradiance.
TEST(Lamps, LoweredRangesTakeAtMostTheThreshold)
{
  constexpr float threshold = 0.01F;
  for (const scene::LampKind kind : {scene::LampKind::Point, scene::LampKind::Spot}) {
    for (const float range : {0.0F, 3.0F, 1e4F}) {
      scene::PlacedLamp lamp = unit_lamp(kind);
      lamp.intensity = 20.0F;
      lamp.color = {0.5F, 1.0F, 0.2F};
      lamp.range = range;
      lamp.radius = 0.3F;
      const shared::LightData all = light_data(lamp);
      lower_range(lamp, threshold);
      const shared::LightData less = light_data(lamp);
      EXPECT_TRUE(lamp.range > 0.0F && (range == 0.0F || lamp.range <= range));
      for (float distance = 0.1F; distance < 200.0F; distance *= 1.01F) {
        const float whole = shared::distance_falloff(distance * distance, all.radius_sq, all.range_inv_sq);
        const float part = shared::distance_falloff(distance * distance, less.radius_sq, less.range_inv_sq);
        EXPECT_LE(all.color.g * (whole - part), 1.0001F * threshold) << distance;
        EXPECT_GE(whole, part) << distance;
      }
    }
  }
  scene::PlacedLamp lamp = unit_lamp(scene::LampKind::Point);
  lower_range(lamp, 0.0F);
  EXPECT_EQ(lamp.range, 0.0F);
  // The light of an area lamp as a whole has no window, and would end at an edge.
  for (const scene::LampKind kind : {scene::LampKind::Sun, scene::LampKind::Hemi, scene::LampKind::Area}) {
    lamp = unit_lamp(kind);
    lower_range(lamp, threshold);
    EXPECT_EQ(lamp.range, 0.0F);
  }
}

// The float nearest to π/2 is above π/2, where the tangent is negative.
TEST(Lamps, AStretchedSpotOfAHalfSpaceReachesItsRange)
{
  for (const float angle : {1.5F, std::numbers::pi_v<float> / 2.0F}) {
    for (const double scale : {0.5, 1.0, 2.0, 3.0}) {
      scene::PlacedLamp lamp = unit_lamp(scene::LampKind::Spot);
      lamp.spot_outer_angle = angle;
      lamp.range = 4.0F;
      lamp.scale = {scale, scale, 1.0};
      EXPECT_NEAR(widest_half_angle(lamp), std::atan2(scale * std::sin(angle), std::cos(angle)), 1e-6F);
      EXPECT_TRUE(has_cube(lamp.kind, widest_half_angle(lamp)));
      EXPECT_NEAR(light_reach(lamp, LampShading::Whole).radius, 4.0F, 0.05F) << angle << " " << scale;
    }
  }
}

TEST(Lamps, MessagesNameTenLamps)
{
  const std::vector<std::string> names = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l"};
  EXPECT_EQ(listed(std::span(names).first(2)), "'a', 'b'");
  EXPECT_EQ(listed(std::span(names).first(10)), "'a', 'b', 'c', 'd', 'e', 'f', 'g', 'h', 'i', 'j'");
  EXPECT_EQ(listed(names), "'a', 'b', 'c', 'd', 'e', 'f', 'g', 'h', 'i', 'j' and 2 more");
}

TEST(Lamps, LampsThatReachEverywhereAreBeforeTheOthersOfTheirGroup)
{
  using enum scene::LampKind;
  std::vector<scene::PlacedLamp> placed = {unit_lamp(Point), unit_lamp(Sun),  unit_lamp(Point), unit_lamp(Spot),
                                           unit_lamp(Spot),  unit_lamp(Area), unit_lamp(Point)};
  for (const std::size_t i : {0, 3, 6}) {
    placed[i].range = 5.0F;
  }
  const Lamps lamps = make_lamps(placed);
  EXPECT_EQ(lamps.lamp_index, (std::vector<std::uint32_t>{2, 5, 0, 6, 1, 4, 3}));
  EXPECT_EQ(lamps.cube_light_count, 4);
  EXPECT_EQ(lamps.cube_everywhere_count, 2);
  EXPECT_EQ(lamps.other_everywhere_count, 2);
  EXPECT_EQ(lamps.local_count(), 3);
}

}  // namespace
}  // namespace gnomon::eevee
