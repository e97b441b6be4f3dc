// SPDX-License-Identifier: MIT
#include "render_world.hh"

#include "eevee_world_shared.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

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

TEST(WorldLight, WhatGivesLessThanATwentiethOfTheLightIsNoSun)
{
  // A disk of 0.1 rad covers 1/400 of the sphere.
  const double share_of_sphere = 0.5 * (1.0 - std::cos(0.1));
  for (const double share : {0.03, 0.08}) {
    const double radiance = share / ((1.0 - share) * share_of_sphere);
    const WorldLight light = world_light(
        world_of([&](const glm::dvec3 &v) { return glm::vec3(v.x > std::cos(0.1) ? float(radiance) : 1.0F); }));
    EXPECT_EQ(light.suns.size(), share > 0.05 ? 1U : 0U);
    // All of the light is in one of the parts.
    double flux =
        light.suns.empty() ? 0.0 : sum_over(light.suns[0].directions, [](const glm::dvec3 &) { return 1.0; }).x;
    flux += sum_over(light.rest_directions, [](const glm::dvec3 &) { return 1.0; }).x;
    EXPECT_NEAR(flux, 4.0 * pi / (1.0 - share), 0.02 * flux);
  }
}

TEST(WorldLight, RotationTurnsPlusXToMinusZ)
{
  scene::World world = world_of([](const glm::dvec3 &v) { return glm::vec3(v.x > 0.98 ? 100.0F : 0.1F); });
  world.rotation = float(0.5 * pi);
  const WorldLight light = world_light(world);
  ASSERT_EQ(light.suns.size(), 1U);
  EXPECT_LT(glm::distance(glm::dvec3(light.suns[0].lamp.world_from_lamp[2]), glm::dvec3(0, 0, -1)), 0.02);
}

TEST(WorldLight, OfALargePictureHasTheMeansOverItsTexels)
{
  std::mt19937 random(1);
  scene::WorldPicture picture{600, 300, {}};
  for (int i = 0; i < picture.width * picture.height; i++) {
    picture.texels.emplace_back(1.0F + float(random() % 1024) / 1024.0F);
  }
  scene::World world{.picture = std::make_shared<const scene::WorldPicture>(picture)};
  world.rotation = 0.7F;
  const WorldLight light = world_light(world);
  ASSERT_TRUE(light.suns.empty());
  const auto at = [&](double u, double v) {
    const double turned = u + double(world.rotation) / (2.0 * pi);
    const double x = turned * picture.width - 0.5;
    const double y = (1.0 - v) * picture.height - 0.5;
    const auto texel = [&](int column, int row) {
      return double(picture.at((column + picture.width) % picture.width, std::clamp(row, 0, picture.height - 1)).x);
    };
    const int left = int(std::floor(x));
    const int top = int(std::floor(y));
    const auto across = [&](int row) { return std::lerp(texel(left, row), texel(left + 1, row), x - left); };
    return std::lerp(across(top), across(top + 1), y - top);
  };
  // Three texels of the picture are at least as wide as one of the grid, and two places are in each.
  constexpr int fine = 6;
  for (const glm::ivec2 &texel : {glm::ivec2(0, 0), glm::ivec2(255, 127), glm::ivec2(100, 0), glm::ivec2(226, 64)}) {
    double mean = 0.0;
    for (int i = 0; i < fine * fine; i++) {
      mean += at((texel.x + (i % fine + 0.5) / fine) / WorldLight::size.x,
                 (texel.y + (i / fine + 0.5) / fine) / WorldLight::size.y) /
              (fine * fine);
    }
    EXPECT_NEAR(light.rest[std::size_t(texel.y * WorldLight::size.x + texel.x)].x, mean, 1e-6) << texel.x;
  }
}

TEST(WorldLight, BlackGivesNothing)
{
  const WorldLight light = world_light({.color = glm::vec3(0.0F)});
  EXPECT_TRUE(light.is_black());
  EXPECT_EQ(irradiance(light, {0, 1, 0}), glm::vec3(0.0F));
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

TEST(WorldDistribution, WithAnyImportanceHasTheSameLight)
{
  const WorldLight light =
      world_light(world_of([](const glm::dvec3 &v) { return glm::vec3(1.0F + 0.5F * float(v.y)); }));
  std::vector<float> importance;
  for (std::size_t i = 0; i < light.rest.size(); i++) {
    importance.push_back(0.1F + 3.0F * float(i % 256) / 256.0F + (i > 16384 ? 1.0F : 0.0F));
  }
  const auto irradiance_up = [](const WorldDistribution &directions) {
    return sum_over(directions, [](const glm::dvec3 &v) { return std::max(v.y, 0.0); }).g;
  };
  // ∫ (1 + y / 2) y over the upper half.
  const double expected = pi + pi / 3.0;
  EXPECT_NEAR(irradiance_up(light.rest_directions), expected, 1e-3 * expected);
  EXPECT_NEAR(irradiance_up(rest_distribution(light.rest, importance)), expected, 2e-3 * expected);
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

TEST(Prefiltered, OfALinearSkyIsItsMeanOverTheLobe)
{
  // The mean of 2 + x over a lobe around n is 2 + k x(n), where k is the lobe's mean cosine.
  const auto sky = world_light(world_of([](const glm::dvec3 &v) { return glm::vec3(float(2.0 + v.x)); })).rest;
  constexpr int level_count = 8;
  const auto levels = prefiltered(sky, level_count);
  for (int level = 0; level < level_count; level++) {
    const double alpha_sq = std::pow(double(level) / (level_count - 1), 4.0);
    double sum = 0.0;
    double cosine_sum = 0.0;
    constexpr int count = 100000;
    for (int i = 0; i < count; i++) {
      // Angles are denser at the centre of the lobe.
      const double place = (i + 0.5) / count;
      const double angle = 0.5 * pi * place * place * place;
      const double cosine = level > 0 ? std::cos(angle) : 1.0;
      const double h_sq = 0.5 + 0.5 * cosine;
      const double t = 1.0 - h_sq + alpha_sq * h_sq;
      const double weight = std::sin(angle) * cosine / (level > 0 ? t * t : 1.0) * place * place;
      sum += weight;
      cosine_sum += weight * cosine;
    }
    const double mean_cosine = cosine_sum / sum;
    for (std::size_t i = 0; i < sky.size(); i += 97) {
      const glm::dvec3 normal = direction_of((double(i % 256) + 0.5) / 256.0, (double(i / 256) + 0.5) / 128.0);
      // The largest differences: 0.003 without a filter, 0.033 with lobes that are cut at 1/200 of their peak, and
      // 0.065 with the widest lobes, at the poles, whose cells are 11° high.
      const double tolerance = level == 0 ? 0.004 : level < 5 ? 0.035 : 0.07;
      ASSERT_NEAR(levels[std::size_t(level)][i].x, 2.0 + mean_cosine * normal.x, tolerance) << level << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace gnomon::render_scene
