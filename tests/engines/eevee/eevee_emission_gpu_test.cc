// SPDX-License-Identifier: MIT
// Light that emissive surfaces give to others, compared with closed forms, on the driver.
#include "eevee_closed_forms.hh"
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <numbers>

namespace gnomon::eevee {
namespace {

using std::numbers::pi;

constexpr glm::dvec3 radiance(1.0, 0.5, 0.25);
constexpr double half_edge = 0.5;

/** A white floor at z = 0 and ceiling at z = 2, and in the middle between them a square that emits light. */
class EmissionTest : public test::SharedDeviceTest {
 protected:
  EmissionTest()
  {
    const auto white = test::add_material(scene, glm::vec3(1.0F));
    const auto mesh = test::add_square_mesh(scene, white);
    test::add_object(scene, mesh, glm::scale(glm::dmat4(1.0), glm::dvec3(20.0)));
    test::add_object(scene, mesh, glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 2}), glm::dvec3(20.0)));
    emitter = test::add_material(scene, glm::vec3(0.0F));
    scene.edit(emitter, [](scene::Material &material) { material.emissive = glm::vec3(radiance); });
    square = test::add_object(scene, test::add_square_mesh(scene, emitter),
                              glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 1}), glm::dvec3(half_edge)));
  }
  /** Irradiance of the square, radiance 1, from \a low_x on, at \a position_ws one metre below it. */
  static double irradiance(const glm::dvec3 &position_ws, double low_x = -half_edge)
  {
    const double half_x = 0.5 * (half_edge - low_x);
    return test::lambert_irradiance(test::rectangle_corners({low_x + half_x, 0, 1}, {half_x, 0, 0}, {0, half_edge, 0}),
                                    position_ws);
  }
  /** A point of the floor, or of the ceiling, at \a x and y = 0, seen from the side. */
  [[nodiscard]] glm::vec3 seen(double x, bool is_ceiling, const Settings &settings) const
  {
    test::Renderer renderer(*device, scene, {3, 3}, settings);
    const test::Picture picture = renderer.picture(camera_at_floor(x, is_ceiling));
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture.middle();
  }
  static scene::PlacedCamera camera_at_floor(double x, bool is_ceiling = false)
  {
    return test::camera_at({float(x) + 3.0F, 0.0F, is_ceiling ? 0.5F : 1.5F},
                           {float(x), 0.0F, is_ceiling ? 2.0F : 0.0F}, 1e-4F);
  }

  scene::Scene scene;
  scene::Handle<scene::Material> emitter;
  scene::Handle<scene::Node> square;
};

TEST_F(EmissionTest, ConvergesToTheFormFactorOnBothSides)
{
  // They stand for disks of a radius of 0.025, which take 6e-4 of the light at this distance.
  for (const double x : {0.0, 0.4, 1.0}) {
    for (const bool is_ceiling : {false, true}) {
      const glm::dvec3 expected = radiance * irradiance({x, 0, 0}) / pi;
      const glm::vec3 light = seen(x, is_ceiling, {.sample_count = 128, .emissive_point_count = 4});
      for (int i = 0; i < 3; i++) {
        EXPECT_NEAR(double(light[i]) / expected[i], 1.0, 3e-3) << x << ' ' << is_ceiling;
      }
    }
  }
}

TEST_F(EmissionTest, IsFinerWithMorePoints)
{
  const double expected = radiance.r * irradiance({0.4, 0, 0}) / pi;
  const auto error = [&](int count) {
    return std::abs(double(seen(0.4, false, {.sample_count = 16, .emissive_point_count = count}).r) / expected - 1.0);
  };
  // The disks of 16 points take 2 % of the light here, those of 256 less than 0.2 %.
  EXPECT_LT(error(1), 0.1);
  EXPECT_LT(error(16), 0.01);
}

TEST_F(EmissionTest, PointsThatAreAskedForLightAPictureOfOneSample)
{
  // The disks of 128 points have a radius of 0.05; those of 32 points, of 0.1, take 1 % of the light at 1 m.
  for (const double x : {0.0, 0.4, 1.0}) {
    const double expected = radiance.r * irradiance({x, 0, 0}) / pi;
    EXPECT_EQ(seen(x, false, {}), glm::vec3(0.0F)) << "no light unless it is asked for";
    EXPECT_NEAR(double(seen(x, false, {.emissive_point_count = 16}).r) / expected, 1.0, 0.02) << x;
    EXPECT_NEAR(double(seen(x, true, {.emissive_point_count = 4}).r) / expected, 1.0, 0.06) << x;
  }
  // A plate that hides the square.
  const auto black = test::add_material(scene, glm::vec3(0.0F));
  test::add_object(scene, test::add_square_mesh(scene, black),
                   glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 0.9}), glm::dvec3(0.9)));
  EXPECT_EQ(seen(0.0, false, {.emissive_point_count = 4}), glm::vec3(0.0F));
  EXPECT_GT(seen(0.0, true, {.emissive_point_count = 4}).r, 0.1F);
}

TEST_F(EmissionTest, EditsOfOneSampleWithPointsGiveThePictureOfANewRenderer)
{
  const auto black = test::add_material(scene, glm::vec3(0.0F));
  const auto plate = test::add_object(scene, test::add_square_mesh(scene, black),
                                      glm::scale(glm::translate(glm::dmat4(1.0), {0.5, 0, 0.5}), glm::dvec3(0.4)));
  Settings settings{.emissive_point_count = 4};
  const scene::PlacedCamera camera = test::camera_at({3.0F, 0.0F, 1.5F}, {0.0F, 0.0F, 0.0F});
  SceneRenderer live(*device, scene, {24, 16}, settings);
  const auto picture_of = [&](SceneRenderer &renderer) {
    renderer.sync();
    renderer.draw(camera);
    return renderer.read_picture();
  };
  std::vector<glm::vec4> last;
  const auto expect_same = [&](const char *after) {
    live.set_settings(settings);
    const std::vector<glm::vec4> picture = picture_of(live);
    SceneRenderer fresh(*device, scene, {24, 16}, settings);
    EXPECT_TRUE(picture == picture_of(fresh)) << after;
    EXPECT_FALSE(picture == last) << after << ": no effect";
    last = picture;
  };
  expect_same("start");
  scene.edit(emitter, [](scene::Material &material) { material.emissive *= 2.0F; });
  expect_same("brighter");
  scene.set_transform(square, glm::scale(glm::translate(glm::dmat4(1.0), {0.3, 0, 1}), glm::dvec3(half_edge)));
  expect_same("the square is moved");
  scene.set_transform(plate, glm::scale(glm::translate(glm::dmat4(1.0), {0.2, 0, 0.5}), glm::dvec3(0.4)));
  expect_same("the plate is moved");
  settings.seed = 1;
  expect_same("other points");
  settings.emissive_point_count = 2;
  expect_same("fewer points");
  settings.sample_count = 3;
  expect_same("several samples");
  settings.sample_count = 1;
  expect_same("one sample");
  settings.emissive_point_count.reset();
  expect_same("not asked for");
  settings.emissive_point_count = 4;
  expect_same("asked for");
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 1.5F}, {0, 0, -1}, 1.0F);
  expect_same("a lamp before the points");
  scene.set_transform(square, glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 1}), glm::dvec3(half_edge)));
  expect_same("the square is moved back");
  scene.remove(square);
  expect_same("the square is removed");
}

TEST_F(EmissionTest, OneSampleHasTheLightOfEachOfSeveralSurfaces)
{
  // Twelve squares above the floor, which are not drawn from above. Four points are on four of them, with the power of
  // all.
  scene.remove(square);
  scene.edit(emitter, [](scene::Material &material) { material.is_double_sided = false; });
  const auto mesh = test::add_square_mesh(scene, emitter);
  for (int i = 0; i < 12; i++) {
    test::add_object(
        scene, mesh,
        glm::scale(glm::rotate(glm::translate(glm::dmat4(1.0), {i - 5.5, 0, 0.4}), pi, {1, 0, 0}), glm::dvec3(0.2)));
  }
  const scene::PlacedCamera camera = test::camera_at({0, -4, 1.9F}, {0, 0, 0}, 0.15F);
  constexpr glm::ivec2 size_px(96, 24);
  const test::Picture converged = test::Renderer(*device, scene, size_px, {.sample_count = 64}).picture(camera);
  const Settings one_sample{.emissive_point_count = 4};
  const test::Picture first = test::Renderer(*device, scene, size_px, one_sample).picture(camera);
  double error = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < first.pixels.size(); i++) {
    error += std::abs(double(first.pixels[i].r) - double(converged.pixels[i].r));
    sum += double(converged.pixels[i].r);
  }
  RecordProperty("error", std::to_string(error / sum));
  EXPECT_LT(error / sum, 0.3);
  // Lists of lights visit the same points.
  const auto lamp = test::add_lamp(scene, scene::LampKind::Point, {0, 0, 1}, {0, 0, -1}, 1.0F);
  scene.edit(lamp, [](scene::Lamp &value) { value.range = 4.0F; });
  Settings clustered = one_sample;
  clustered.clustered_lamps_min = 1;
  const test::Picture plain = test::Renderer(*device, scene, size_px, one_sample).picture(camera);
  const test::Picture listed = test::Renderer(*device, scene, size_px, clustered).picture(camera);
  for (std::size_t i = 0; i < plain.pixels.size(); i++) {
    test::expect_near(glm::vec3(listed.pixels[i]), glm::vec3(plain.pixels[i]), 1e-5F);
  }
}

TEST_F(EmissionTest, OccludersGiveShadow)
{
  // From the origin, it covers the half of the square with x > 0. The other half is seen from 1 m on.
  const auto black = test::add_material(scene, glm::vec3(0.0F));
  test::add_object(scene, test::add_square_mesh(scene, black),
                   glm::scale(glm::translate(glm::dmat4(1.0), {0.5, 0, 0.5}), glm::dvec3(0.5)));
  scene::PlacedCamera camera = test::camera_at({-3.0F, 0.0F, 1.5F}, {0.0F, 0.0F, 0.0F}, 1e-4F);
  test::Renderer renderer(*device, scene, {3, 3}, {.sample_count = 256});
  const double half = irradiance({0, 0, 0}, 0.0);
  EXPECT_NEAR(half / irradiance({0, 0, 0}), 0.5, 1e-9);
  EXPECT_NEAR(double(renderer.picture(camera).middle().r) / (radiance.r * half / pi), 1.0, 0.01);
}

TEST_F(EmissionTest, CastersCloseToTheSurfaceBlockItsLight)
{
  // 20 mm from the square, 0.7 thousandths of the scene's radius; from the middle of the floor it hides the square.
  const auto black = test::add_material(scene, glm::vec3(0.0F));
  test::add_object(scene, test::add_square_mesh(scene, black),
                   glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 0.98}), glm::dvec3(0.6)));
  EXPECT_EQ(seen(0.0, false, {.sample_count = 16}), glm::vec3(0.0F));
  EXPECT_GT(seen(0.0, true, {.sample_count = 16}).r, 0.1F);
}

TEST_F(EmissionTest, LightNearTheSurfaceIsThatOfDisks)
{
  // 128 disks of a radius r in all. At the height h = r above an endless surface, the irradiance of disks that are
  // turned to the receiver is π radiance (h / r)² log(1 + (r / h)²). One-sided, the square is not drawn from above.
  const double height = std::sqrt(1.0 / (128.0 * pi));
  scene.edit(emitter, [](scene::Material &material) { material.is_double_sided = false; });
  scene.set_transform(square, glm::scale(glm::rotate(glm::translate(glm::dmat4(1.0), {0, 0, height}), pi, {1, 0, 0}),
                                         glm::dvec3(half_edge)));
  test::Renderer renderer(*device, scene, {64, 64}, {.sample_count = 32});
  // About half a metre of the floor, over which the pattern of the points averages out.
  const test::Picture picture = renderer.picture(test::camera_at({0.01F, 0, 1.5F}, {0, 0, 0}, 0.35F));
  double mean = 0.0;
  for (const glm::vec4 &pixel : picture.pixels) {
    mean += double(pixel.r) / double(picture.pixels.size());
    // The most that all disks together can give.
    EXPECT_LE(pixel.r, 128.0F * radiance.r);
  }
  EXPECT_NEAR(mean, radiance.r * std::numbers::ln2, 0.03);
}

TEST_F(EmissionTest, MirrorsReflectTheSurfaceAndNotThePoints)
{
  const auto metal = test::add_material(scene, glm::vec3(1.0F));
  scene.edit(metal, [](scene::Material &material) {
    material.metallic = 1.0F;
    material.roughness = 0.0F;
  });
  test::add_object(scene, test::add_square_mesh(scene, metal), glm::translate(glm::dmat4(1.0), {0, 0, 0.1}));
  test::Renderer renderer(*device, scene, {8, 8}, {.sample_count = 64});
  // Around the middle of the square's reflection.
  const test::Picture picture = renderer.picture(test::camera_at({1.0F, 0.0F, 1.1F}, {0.5F, 0.0F, 0.1F}, 0.1F));
  for (const glm::vec4 &pixel : picture.pixels) {
    // Lobes of 12 of the 256 points. Without the widening, most pixels are nearly black and some above 10.
    EXPECT_NEAR(pixel.r, radiance.r, 0.2);
  }
}

TEST_F(EmissionTest, FollowsTheMaterialAndTheObject)
{
  test::Renderer renderer(*device, scene, {3, 3}, {.sample_count = 64});
  const scene::PlacedCamera camera = camera_at_floor(1.0);
  const glm::vec3 before = renderer.picture(camera).middle();
  scene.edit(emitter, [](scene::Material &material) { material.emissive *= 2.0F; });
  renderer.sync();
  const glm::vec3 twice = renderer.picture(camera).middle();
  // The same points.
  test::expect_near(twice, 2.0F * before, 1e-5F);
  scene.set_transform(square, glm::scale(glm::translate(glm::dmat4(1.0), {1, 0, 1}), glm::dvec3(half_edge)));
  renderer.sync();
  EXPECT_NEAR(double(renderer.picture(camera).middle().r), 2.0 * radiance.r * irradiance({0, 0, 0}) / pi, 0.02);
  scene.edit(emitter, [](scene::Material &material) { material.emissive = glm::vec3(0.0F); });
  renderer.sync();
  EXPECT_EQ(renderer.picture(camera).middle(), glm::vec4(0, 0, 0, 1));
}

TEST_F(EmissionTest, IsFiniteForExtremeStrengthsAndContact)
{
  // A box that stands on the floor, with an edge in the picture.
  test::add_object(scene, test::add_box_mesh(scene, emitter),
                   glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 0.1}), glm::dvec3(0.1)));
  const auto metal = test::add_material(scene, glm::vec3(1.0F));
  scene.edit(metal, [](scene::Material &material) {
    material.metallic = 1.0F;
    material.roughness = 0.0F;
  });
  test::add_object(scene, test::add_square_mesh(scene, metal),
                   glm::scale(glm::translate(glm::dmat4(1.0), {0.3, 0, 0.001}), glm::dvec3(0.2)));
  for (const float strength : {1e-30F, 1e6F, float(scene::light_max)}) {
    scene.edit(emitter, [&](scene::Material &material) { material.emissive = glm::vec3(strength); });
    test::Renderer renderer(*device, scene, {24, 16}, {.sample_count = 4});
    const test::Picture picture = renderer.picture(test::camera_at({0.6F, 0.0F, 0.4F}, {0.1F, 0.0F, 0.0F}));
    EXPECT_EQ(picture.non_finite_count(), 0U) << strength;
    if (strength == 1e6F) {
      for (const glm::vec4 &pixel : picture.pixels) {
        // No surface sends out more than the brightest that it can see.
        EXPECT_LE(pixel.r, 4e6F);
      }
    }
  }
}

TEST_F(EmissionTest, PartsOfTheLightAndRangesOfSamplesSumToThePicture)
{
  const scene::PlacedCamera camera = test::camera_at({3.0F, 0.0F, 1.5F}, {0.0F, 0.0F, 0.0F});
  constexpr glm::ivec2 size_px(12, 8);
  const test::Picture whole = test::Renderer(*device, scene, size_px, {.sample_count = 8}).picture(camera);
  std::vector<glm::vec4> sum(whole.pixels.size(), glm::vec4(0.0F));
  for (const auto &[first, end] : {std::pair(0, 3), std::pair(3, 8)}) {
    test::Renderer renderer(*device, scene, size_px, {.sample_count = 8, .sample_first = first, .sample_end = end});
    const test::Picture part = renderer.picture(camera);
    const auto share = float(renderer.engine.sample_share(renderer.viewport));
    for (std::size_t i = 0; i < sum.size(); i++) {
      sum[i] += share * part.pixels[i];
    }
  }
  const test::Picture emission =
      test::Renderer(*device, scene, size_px, {.light = {LightComponent::Kind::Emission}, .sample_count = 8})
          .picture(camera);
  const test::Picture world =
      test::Renderer(*device, scene, size_px, {.light = {LightComponent::Kind::World}, .sample_count = 8})
          .picture(camera);
  for (std::size_t i = 0; i < sum.size(); i++) {
    // Roundings of the sums.
    test::expect_near(glm::vec3(sum[i]), glm::vec3(whole.pixels[i]), 1e-6F);
    EXPECT_EQ(emission.pixels[i], whole.pixels[i]);
    EXPECT_EQ(glm::vec3(world.pixels[i]), glm::vec3(0.0F));
  }
}

}  // namespace
}  // namespace gnomon::eevee
