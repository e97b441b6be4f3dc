// SPDX-License-Identifier: MIT
#include "render_world.hh"

#include "eevee_world_shared.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

namespace gnomon::render_scene {
namespace {

constexpr double pi = std::numbers::pi;

/** A picture with \a radiance of each direction. */
template <typename F>
scene::World world_of(F &&radiance)
{
  scene::WorldPicture picture{256, 128, {}};
  for (int y = 0; y < picture.height; y++) {
    for (int x = 0; x < picture.width; x++) {
      picture.texels.push_back(radiance(direction_of((x + 0.5) / picture.width, 1.0 - (y + 0.5) / picture.height)));
    }
  }
  return {.picture = std::make_shared<const scene::WorldPicture>(std::move(picture))};
}

glm::vec3 irradiance(const WorldLight &light, const glm::vec3 &normal)
{
  shared::WorldBlock block{};
  for (std::size_t i = 0; i < 9; i++) {
    block.harmonics[i] = glm::vec4(light.harmonics[i], 0.0F);
  }
  return shared::world_irradiance(block, normal);
}

TEST(WorldLight, OfOneRadianceIsThatRadianceEverywhere)
{
  const WorldLight light = world_light({.color = {1.0F, 0.5F, 0.25F}, .strength = 2.0F});
  EXPECT_TRUE(light.suns.empty());
  for (const glm::vec3 &normal : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0.6F, 0, -0.8F)}) {
    EXPECT_NEAR(glm::distance(irradiance(light, normal), glm::vec3(2.0F, 1.0F, 0.5F)), 0.0F, 2e-3F);
  }
}

TEST(WorldLight, HarmonicsAreExactForALinearSky)
{
  // Irradiance over π of 1 + cos is 1 + 2/3 cos of the normal.
  const glm::dvec3 up = glm::normalize(glm::dvec3(1, 2, -3));
  const WorldLight light =
      world_light(world_of([&](const glm::dvec3 &v) { return glm::vec3(float(1.0 + glm::dot(v, up))); }));
  EXPECT_TRUE(light.suns.empty());
  for (const glm::dvec3 &normal : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), -up}) {
    EXPECT_NEAR(irradiance(light, glm::vec3(normal)).x, 1.0 + 2.0 / 3.0 * glm::dot(normal, up), 3e-3);
  }
}

TEST(WorldLight, AFewBrightTexelsAreASunThere)
{
  const glm::dvec3 back = glm::normalize(glm::dvec3(1, 1, 0.5));
  const double half_angle = 0.15;
  const WorldLight light = world_light(world_of(
      [&](const glm::dvec3 &v) { return glm::vec3(glm::dot(v, back) > std::cos(half_angle) ? 100.0F : 0.1F); }));
  ASSERT_EQ(light.suns.size(), 1U);
  const scene::PlacedLamp &sun = light.suns[0].lamp;
  EXPECT_GT(glm::dot(glm::dvec3(sun.world_from_lamp[2]), back), 0.9999);
  EXPECT_NEAR(sun.angle, 2.0 * half_angle, 0.02);
  const double sine = std::sin(half_angle);
  EXPECT_NEAR(sun.color.x, 100.0 * pi * sine * sine, 0.05 * 100.0 * pi * sine * sine);
  // The rest is the dim sky.
  EXPECT_NEAR(irradiance(light, {0, 1, 0}).x, 0.1F, 0.005F);
}

TEST(WorldLight, RotationTurnsPlusXToMinusZ)
{
  scene::World world = world_of([](const glm::dvec3 &v) { return glm::vec3(v.x > 0.98 ? 100.0F : 0.1F); });
  world.rotation = float(0.5 * pi);
  const WorldLight light = world_light(world);
  ASSERT_EQ(light.suns.size(), 1U);
  EXPECT_LT(glm::distance(glm::dvec3(light.suns[0].lamp.world_from_lamp[2]), glm::dvec3(0, 0, -1)), 0.02);
}

TEST(WorldLight, BlackGivesNothing)
{
  const WorldLight light = world_light({.color = glm::vec3(0.0F)});
  EXPECT_TRUE(light.is_black());
  EXPECT_EQ(irradiance(light, {0, 1, 0}), glm::vec3(0.0F));
}

/** Mean over \a count² even places of irradiance times \a value of the direction. */
template <typename F>
glm::dvec3 sum_over(const WorldDistribution &directions, F &&value)
{
  constexpr int count = 200;
  glm::dvec3 sum(0.0);
  for (int y = 0; y < count; y++) {
    for (int x = 0; x < count; x++) {
      const WorldDirection direction = directions.at({(x + 0.5) / count, (y + 0.5) / count});
      sum += direction.irradiance * value(direction.to_world);
    }
  }
  return sum / double(count * count);
}

TEST(WorldDistribution, IntegratesItsTexels)
{
  // 2 + x has the integral 8 π, and weighted by z² a third of that, less what the steps of the texels leave.
  const WorldLight light = world_light(world_of([](const glm::dvec3 &v) { return glm::vec3(float(2.0 + v.x)); }));
  const auto flux = sum_over(light.rest_directions, [](const glm::dvec3 &) { return 1.0; });
  EXPECT_NEAR(flux.x, 8.0 * pi, 2e-3 * 8.0 * pi);
  const auto squares = sum_over(light.rest_directions, [](const glm::dvec3 &v) { return v.z * v.z; });
  EXPECT_NEAR(squares.x, 8.0 * pi / 3.0, 2e-3 * 8.0 * pi / 3.0);
  const auto tilted = sum_over(light.rest_directions, [](const glm::dvec3 &v) { return v.x; });
  EXPECT_NEAR(tilted.x, 4.0 * pi / 3.0, 4e-3 * 4.0 * pi / 3.0);
}

TEST(WorldDistribution, OfASunHasItsLightWhereItIs)
{
  const glm::dvec3 back = glm::normalize(glm::dvec3(-1, 0.3, 0.02));
  const WorldLight light = world_light(
      world_of([&](const glm::dvec3 &v) { return glm::vec3(glm::dot(v, back) > std::cos(0.1) ? 50.0F : 0.05F); }));
  ASSERT_EQ(light.suns.size(), 1U) << "it lies across the picture's left and right edge";
  const double flux = sum_over(light.suns[0].directions, [](const glm::dvec3 &) { return 1.0; }).x;
  const double sine = std::sin(0.05);
  EXPECT_NEAR(flux, 50.0 * 4.0 * pi * sine * sine, 0.03 * flux);
  // The centres of the bright texels are within 0.1. Interpolation between texels, samples a quarter of a texel off the
  // centre, and directions anywhere in a texel add 1.75 texels along both axes: 1.75 · √2 · 2 π / 256 = 0.061.
  EXPECT_NEAR(sum_over(light.suns[0].directions,
                       [&](const glm::dvec3 &v) { return glm::dot(v, back) > std::cos(0.161) ? 1.0 : 0.0; })
                  .x,
              flux, 1e-9 * flux);
}

TEST(Prefiltered, OfOneRadianceIsThatRadianceAtEveryRoughness)
{
  const auto levels = prefiltered(world_light({.color = glm::vec3(3.0F)}).rest, 4);
  ASSERT_EQ(levels.size(), 4U);
  for (const std::vector<glm::vec3> &level : levels) {
    for (const glm::vec3 &texel : level) {
      ASSERT_NEAR(texel.x, 3.0F, 1e-3F);
    }
  }
}

}  // namespace
}  // namespace gnomon::render_scene
