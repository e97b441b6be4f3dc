// SPDX-License-Identifier: MIT
// Points of lamps with an extent: their mean light is that of the lamp.
#include "eevee_lamp_points.hh"

#include "eevee_closed_forms.hh"
#include "eevee_sobol.hh"
#include "eevee_test_scene.hh"
#include "eevee_world.hh"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>

namespace gnomon::eevee {
namespace {

using std::numbers::pi;

TEST(SobolPoint, OneOfEachAlignedPowerOfTwoIsInEachCell)
{
  for (const std::uint32_t seed : {0U, 1U, 99U}) {
    for (int columns_log2 = 0; columns_log2 <= 6; columns_log2++) {
      std::set<std::pair<int, int>> cells;
      std::set<int> depths;
      for (std::uint32_t i = 128; i < 192; i++) {
        const glm::vec3 point = sobol_point(i, seed);
        cells.insert({int(point.x * float(1 << columns_log2)), int(point.y * float(64 >> columns_log2))});
        depths.insert(int(point.z * 64.0F));
        ASSERT_GE(std::min({point.x, point.y, point.z}), 0.0F);
        ASSERT_LT(std::max({point.x, point.y, point.z}), 1.0F);
      }
      EXPECT_EQ(cells.size(), 64U) << "seed " << seed << ", 2^" << columns_log2 << " columns";
      EXPECT_EQ(depths.size(), 64U);
    }
  }
  EXPECT_EQ(sobol_point(5, 7), sobol_point(5, 7));
  EXPECT_NE(sobol_point(5, 7), sobol_point(5, 8));
}

scene::PlacedLamp lamp_of(scene::LampKind kind, float radius = 0.0F)
{
  scene::PlacedLamp lamp;
  lamp.kind = kind;
  lamp.radius = radius;
  // -Z is down.
  lamp.world_from_lamp = glm::translate(glm::dmat4(1.0), {1, 2, 3});
  return lamp;
}

/** The mean of \a value over the light of \a lamp at \a count points. */
template <typename Value>
double mean_over(const scene::PlacedLamp &lamp, int count, Value &&value)
{
  const std::vector<scene::PlacedLamp> placed = {lamp};
  const Lamps lamps = make_lamps(placed, LampShading::Point);
  const LampPoints points(placed, lamps, glm::vec3(0.0F));
  double sum = 0.0;
  for (int i = 0; i < count; i++) {
    sum += value(light_at(lamps.lights[0], points.sample(std::uint32_t(i), 3).points[0]));
  }
  return sum / count;
}

TEST(LampPoints, ABallIsAnEvenDiskFromEverySide)
{
  const scene::PlacedLamp lamp = lamp_of(scene::LampKind::Point, 0.5F);
  const glm::dvec3 center(lamp.world_from_lamp[3]);
  for (const glm::dvec3 &from : {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(0.6, 0.0, -0.8)}) {
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const double inside = mean_over(lamp, 4096, [&](const shared::LightData &light) {
        const glm::dvec3 offset = glm::dvec3(light.position_ws) - center;
        EXPECT_LE(glm::length(offset), 0.5 + 1e-6);
        const double along = glm::dot(offset, from);
        return glm::dot(offset, offset) - along * along <= 0.25 * share ? 1.0 : 0.0;
      });
      EXPECT_NEAR(inside, share, 0.006);
    }
  }
}

/** Irradiance on a surface at \a position_ws, without a shadow, as point_radiance has it. */
double irradiance(const shared::LightData &light, const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws)
{
  const double color = light.color.r;
  if (light.kind == LIGHT_SUN) {
    return color * std::max(-glm::dot(normal_ws, glm::dvec3(light.forward_ws)), 0.0);
  }
  const glm::dvec3 vector = glm::dvec3(light.position_ws) - position_ws;
  const double distance_sq = glm::dot(vector, vector);
  const glm::dvec3 to_light = vector / std::sqrt(distance_sq);
  const double ahead =
      light.kind >= LIGHT_RECTANGLE ? std::max(-glm::dot(to_light, glm::dvec3(light.forward_ws)), 0.0) : 1.0;
  return color * ahead * std::max(glm::dot(normal_ws, to_light), 0.0) *
         double(shared::distance_falloff(float(distance_sq), light.radius_sq, light.range_inv_sq));
}

const glm::dvec3 up(0, 0, 1);

TEST(LampPoints, APointLampsLightOnAPlaneIsTheClosedForm)
{
  // In radii.
  for (const double distance_r : {64.0, 16.0, 8.0, 4.0, 2.0}) {
    for (const glm::dvec3 &from : {glm::dvec3(0, 0, 1), glm::normalize(glm::dvec3(1, 0, 1))}) {
      scene::PlacedLamp lamp = lamp_of(scene::LampKind::Point, 0.5F);
      const double distance = 0.5 * distance_r;
      const glm::dvec3 position_ws = glm::dvec3(lamp.world_from_lamp[3]) - distance * from;
      const double expected = from.z / (distance * distance + 0.25);
      const double mean =
          mean_over(lamp, 16384, [&](const shared::LightData &light) { return irradiance(light, position_ws, up); });
      // The bias of a fall-off from the points instead of the centre, and its next term.
      const double bias = -1.25 * std::pow(distance_r, -4.0);
      EXPECT_NEAR(mean / expected, 1.0 + bias, 1e-5 + 1.5 * std::pow(distance_r, -6.0)) << distance_r << " radii";
    }
  }
}

TEST(LampPoints, ASunsLightOnAPlaneIsTheClosedForm)
{
  for (const float angle : {0.01F, 0.1F, 1.0F, 3.0F}) {
    scene::PlacedLamp lamp = lamp_of(scene::LampKind::Sun);
    lamp.angle = angle;
    for (const double tilt : {0.0, 0.05}) {
      // The whole sun is above the horizon.
      const glm::dvec3 normal(std::sin(tilt), 0.0, std::cos(tilt));
      const double mean = mean_over(
          lamp, 16384, [&](const shared::LightData &light) { return irradiance(light, glm::dvec3(0.0), normal); });
      EXPECT_NEAR(mean / std::cos(tilt), 1.0, 1e-4) << angle;
    }
  }
}

TEST(LampPoints, AnAreaLampsLightOnAPlaneIsTheClosedForm)
{
  scene::PlacedLamp lamp = lamp_of(scene::LampKind::Area);
  lamp.area_size_x = 2.0F;
  lamp.area_size_y = 1.0F;
  lamp.intensity = 10.0F;
  const glm::dvec3 center(lamp.world_from_lamp[3]);
  const glm::dvec3 position_ws(1.5, 1.0, 0.0);
  const auto mean = [&] {
    return mean_over(lamp, 65536, [&](const shared::LightData &light) { return irradiance(light, position_ws, up); });
  };
  const glm::dvec3 axis_x(1.0, 0.0, 0.0);
  const glm::dvec3 axis_y(0.0, 0.5, 0.0);
  // Radiance P / (4 A).
  const double rectangle = test::lambert_irradiance(test::rectangle_corners(center, axis_x, axis_y), position_ws);
  EXPECT_NEAR(mean() / (10.0 / (4.0 * 2.0) * rectangle), 1.0, 1e-4);
  lamp.area_shape = scene::AreaShape::Ellipse;
  const double ellipse = test::lambert_irradiance(test::ellipse_corners(center, axis_x, axis_y), position_ws);
  EXPECT_NEAR(mean() / (10.0 / (4.0 * 0.5 * pi) * ellipse), 1.0, 1e-4);
}

TEST(LampPoints, TurnASunsAxesAndKeepThemOrthonormal)
{
  scene::PlacedLamp lamp = lamp_of(scene::LampKind::Sun);
  lamp.angle = float(pi);
  const std::vector<scene::PlacedLamp> placed = {lamp};
  const LampPoints points(placed, make_lamps(placed, LampShading::Point), glm::vec3(0.0F));
  for (std::uint32_t i = 0; i < 256; i++) {
    const glm::mat3 axes(points.sample(i, 0).points[0].world_from_lamp);
    const glm::mat3 product = glm::transpose(axes) * axes;
    for (int column = 0; column < 3; column++) {
      EXPECT_NEAR(glm::distance(product[column], glm::mat3(1.0F)[column]), 0.0F, 1e-5F);
    }
    EXPECT_GT(glm::determinant(axes), 0.0F);
    EXPECT_GE(axes[2].z, -1e-6F) << "within the half space";
  }
}

TEST(LampPoints, PointsOfTheWorldsSunsHaveTheirLightAndAreWithinThem)
{
  // Two suns of different radiances, and a dim rest.
  const std::array<glm::dvec3, 2> to_suns = {glm::normalize(glm::dvec3(1, 1, 0)), glm::normalize(glm::dvec3(-1, 2, 1))};
  constexpr double half_angle = 0.12;
  scene::WorldPicture picture{256, 128, {}};
  for (int y = 0; y < picture.height; y++) {
    for (int x = 0; x < picture.width; x++) {
      const glm::dvec3 v = render_scene::direction_of((x + 0.5) / picture.width, 1.0 - (y + 0.5) / picture.height);
      picture.texels.emplace_back(glm::dot(v, to_suns[0]) > std::cos(half_angle)   ? 60.0F
                                  : glm::dot(v, to_suns[1]) > std::cos(half_angle) ? 30.0F
                                                                                   : 0.01F);
    }
  }
  const auto world = std::make_shared<const render_scene::WorldLight>(
      render_scene::world_light({.picture = std::make_shared<const scene::WorldPicture>(std::move(picture))}));
  ASSERT_EQ(world->suns.size(), 2U);
  std::vector<scene::PlacedLamp> placed = {lamp_of(scene::LampKind::Spot)};
  const WorldDirections directions{{world, &world->rest_directions}, WorldDirections::few};
  std::ranges::copy(world_lamps(*world, directions.count), std::back_inserter(placed));
  constexpr std::uint32_t sample_count = 16;
  const LampPoints points(placed, make_lamps(placed, LampShading::Point), glm::vec3(0.0F), world, directions,
                          sample_count);
  std::array<double, 2> light{};
  std::set<float> places;
  for (std::uint32_t i = 0; i < sample_count; i++) {
    const SampledLampPoints sampled = points.sample(i, 3);
    const std::vector<shared::WorldSunPoint> &sun_points = sampled.sun_points;
    ASSERT_EQ(sun_points.size(), 2U * WORLD_SUN_POINTS);
    EXPECT_EQ(sampled.first_sun, 1);
    for (std::size_t k = 0; k < sun_points.size(); k++) {
      const std::size_t sun = k / WORLD_SUN_POINTS;
      light[sun] += double(sun_points[k].irradiance.g) / sample_count;
      places.insert(sun_points[k].to_world.y);
      EXPECT_NEAR(glm::length(sun_points[k].to_world), 1.0F, 1e-6F);
      // A texel of the rim may be half of the sun's, and two are 0.05 rad.
      EXPECT_GT(glm::dot(glm::dvec3(sun_points[k].to_world), to_suns[sun]), std::cos(half_angle + 0.05));
    }
  }
  EXPECT_EQ(places.size(), 2U * WORLD_SUN_POINTS * sample_count) << "no point is drawn twice";
  const double sine = std::sin(half_angle / 2.0);
  // The texels of the rim change the area of the disks by a few percent.
  EXPECT_NEAR(light[0], 60.0 * 4.0 * pi * sine * sine, 0.05 * light[0]);
  EXPECT_NEAR(light[1], 30.0 * 4.0 * pi * sine * sine, 0.05 * light[1]);
  EXPECT_TRUE(points.centers().sun_points.empty());
}

/** A box and a floor under a sized and a hard lamp. */
class LampSamplesTest : public testing::Test {
 protected:
  LampSamplesTest()
  {
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    test::add_object(scene, test::add_box_mesh(scene, material), glm::dmat4(1.0));
    test::add_object(scene, test::add_square_mesh(scene, material),
                     glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, -1}), glm::dvec3(8.0)));
    hard = test::add_lamp(scene, scene::LampKind::Point, {1, 0, 4}, {0, 0, -1}, 10.0F);
    settings.shadow = {.cube_size_px = 32, .map_size_px = 64};
    settings.shadow.cascades.count = 1;
    settings.sample_count = 4;
  }
  std::uint64_t lamps_updated(const test::Renderer &renderer, draw::Viewport &viewport) const
  {
    return Inspection(renderer.engine, viewport).shadow_counters().lamps_updated;
  }
  static const FrameNode *step(const Report &report, std::string_view name)
  {
    return find(*find(report.tree, "passes"), name);
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  scene::Handle<scene::Lamp> hard;
  Settings settings;
  scene::PlacedCamera camera = test::camera_at({0, -6, 9}, {0, 0, 0});
};

TEST_F(LampSamplesTest, ALampWithoutAnExtentIsDrawnOnce)
{
  test::Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(camera);
  renderer.draw(camera);
  EXPECT_EQ(lamps_updated(renderer, renderer.viewport), 1U);
  const Report report = renderer.inspect().report();
  EXPECT_FALSE(step(report, "lamp_points")->is_made);
  EXPECT_EQ(step(report, "lamp_points")->why, "no lamp that gives light has a size");
}

TEST_F(LampSamplesTest, ALampWithAnExtentIsDrawnInEachSampleAndNoOtherLamp)
{
  for (const scene::LampKind kind : {scene::LampKind::Point, scene::LampKind::Spot, scene::LampKind::Sun}) {
    scene::Scene copy = scene;
    const auto lamp = test::add_lamp(copy, kind, {0, 1, 5}, {0, 0, -1}, 10.0F);
    copy.edit(lamp, [](scene::Lamp &value) {
      value.radius = value.kind == scene::LampKind::Sun ? 0.0F : 0.2F;
      value.angle = value.kind == scene::LampKind::Sun ? 0.1F : 0.0F;
    });
    test::Renderer renderer(*device, copy, {16, 16}, settings);
    renderer.draw(camera);
    EXPECT_EQ(lamps_updated(renderer, renderer.viewport), 1U + 4U);
    renderer.draw(camera);
    EXPECT_EQ(lamps_updated(renderer, renderer.viewport), 1U + 8U);
    const Report report = renderer.inspect().report();
    EXPECT_TRUE(step(report, "lamp_points")->is_made);
    EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
    settings.sample_count = 1;
    renderer.engine.set_settings(settings);
    test::Renderer single(*device, copy, {16, 16}, settings);
    single.draw(camera);
    single.draw(camera);
    EXPECT_EQ(lamps_updated(single, single.viewport), 2U) << "one sample: the lamp's centre";
    settings.sample_count = 4;
  }
}

TEST_F(LampSamplesTest, ViewportsThatTakeTurnsDrawTheirOwnSamples)
{
  const auto lamp = test::add_lamp(scene, scene::LampKind::Point, {0, 1, 5}, {0, 0, -1}, 10.0F);
  scene.edit(lamp, [](scene::Lamp &value) { value.radius = 0.2F; });
  test::Renderer renderer(*device, scene, {16, 16}, settings);
  draw::Viewport second(*device, {16, 16});
  const std::array<draw::Engine *, 1> engines = {&renderer.engine};
  second.sync(engines, renderer.render_scene.objects());
  const draw::View view = view_of(renderer.render_scene.relative(camera), {16, 16});
  renderer.viewport.draw(engines, view);
  for (int i = 0; i < 4; i++) {
    second.draw(engines, view);
  }
  renderer.viewport.draw(engines, view);
  EXPECT_EQ(lamps_updated(renderer, second), 3U) << "its first point was the first viewport's";
  EXPECT_EQ(lamps_updated(renderer, renderer.viewport), 2U + 1U);
}

}  // namespace
}  // namespace gnomon::eevee
