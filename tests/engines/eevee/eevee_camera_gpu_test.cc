// SPDX-License-Identifier: MIT
// Pictures of cameras, on the driver.
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "reference_light.hh"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>

namespace gnomon::eevee {
namespace {

using CameraGpuTest = test::SharedDeviceTest;

constexpr glm::ivec2 size_px(64, 48);

/** Number of pixels of \a mirrored that differ from those of \a picture with left and right, or up and down exchanged.
 */
int different_count(const std::vector<glm::vec4> &picture, const std::vector<glm::vec4> &mirrored, bool is_x, bool is_y)
{
  // The filter of the film spreads a pixel that differs over its neighbours.
  constexpr float tolerance = 0.1F;
  int count = 0;
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      const int from_x = is_x ? size_px.x - 1 - x : x;
      const int from_y = is_y ? size_px.y - 1 - y : y;
      const glm::vec4 difference =
          picture[std::size_t(from_y * size_px.x + from_x)] - mirrored[std::size_t(y * size_px.x + x)];
      count += glm::length(difference) > tolerance ? 1 : 0;
    }
  }
  return count;
}

TEST_F(CameraGpuTest, NegativeHalfSizesMirrorThePicture)
{
  scene::Scene scene;
  const auto box = test::add_box_mesh(scene, test::add_material(scene, {0.8F, 0.3F, 0.2F}));
  const auto square = test::add_square_mesh(scene, test::add_material(scene, {0.2F, 0.7F, 0.3F}));
  const auto two_sided = test::add_material(scene, {0.3F, 0.3F, 0.9F});
  scene.edit(two_sided, [](scene::Material &material) { material.is_double_sided = true; });
  const auto sheet = test::add_square_mesh(scene, two_sided);
  const auto glass = test::add_material(scene, {0.9F, 0.9F, 0.1F});
  scene.edit(glass, [](scene::Material &material) {
    material.alpha_mode = scene::AlphaMode::Blend;
    material.alpha = 0.5F;
  });
  const auto place = [](const glm::dvec3 &at, double angle, const glm::dvec3 &scale) {
    return glm::scale(glm::rotate(glm::translate(glm::dmat4(1.0), at), angle, glm::dvec3(0.3, 1.0, 0.1)), scale);
  };
  test::add_object(scene, box, place({-1.1, 0.4, 0}, 0.5, glm::dvec3(0.4)));
  test::add_object(scene, box, place({0.9, -0.6, 0}, 0.9, {0.3, -0.5, 0.4}));
  test::add_object(scene, square, place({0, 0, -1.5}, 0.0, glm::dvec3(3)));
  // From behind.
  test::add_object(scene, sheet, place({0.8, 0.8, 0}, 2.8, glm::dvec3(0.4)));
  test::add_object(scene, square, place({-0.2, 0.9, 0}, 2.8, glm::dvec3(0.3)));
  test::add_object(scene, test::add_square_mesh(scene, glass), place({0.1, -0.3, 0.8}, 0.2, glm::dvec3(0.4)));
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0.3F, -0.5F, -1.0F}, 2.0F);
  test::add_lamp(scene, scene::LampKind::Point, {1, 1, 2}, {0, 0, -1}, 20.0F);
  scene::PlacedCamera camera = test::camera_at({0.1F, 0.2F, 8}, {0, 0, 0}, 0.5F);
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = 2.0F;
  camera.half_height = 1.5F;
  const reference::Tracer tracer(scene);
  test::Renderer renderer(*device, scene, size_px, {});
  // Shadow maps of mirrored views are cropped to other texels.
  test::Renderer unshadowed(*device, scene, size_px, {.shadow = {.kind = scene::ShadowKind::None}});
  const std::vector<glm::vec4> picture = unshadowed.picture(camera).pixels;
  EXPECT_GT(different_count(picture, picture, true, false), 1000) << "the scene is not its own mirror image";
  for (const glm::vec2 sign : {glm::vec2(-1, 1), glm::vec2(1, -1), glm::vec2(-1, -1)}) {
    scene::PlacedCamera mirror = camera;
    mirror.half_width *= sign.x;
    mirror.half_height *= sign.y;
    const std::vector<glm::vec4> mirrored = unshadowed.picture(mirror).pixels;
    const std::vector<glm::vec4> shadowed = renderer.picture(mirror).pixels;
    const std::vector<glm::vec4> reference = reference::direct_light(tracer, mirror, size_px, {}).pixels;
    // Edges through the middle of a pixel belong to another pixel.
    constexpr int edge_max = size_px.x * size_px.y / 100;
    EXPECT_LE(different_count(picture, mirrored, sign.x < 0, sign.y < 0), edge_max) << sign.x << ' ' << sign.y;
    // The reference takes other samples of edges.
    EXPECT_LE(different_count(reference, shadowed, false, false), 15 * edge_max) << sign.x << ' ' << sign.y;
  }
}

/** The share of the light in \a picture that is within \a radius_px of \a middle_px. */
double share_within(const std::vector<glm::vec4> &picture, const glm::dvec2 &middle_px, double radius_px)
{
  double within = 0.0;
  double sum = 0.0;
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      const double light = picture[std::size_t(y * size_px.x + x)].r;
      sum += light;
      within += glm::distance(glm::dvec2(x, y) + 0.5, middle_px) <= radius_px ? light : 0.0;
    }
  }
  return within / sum;
}

TEST_F(CameraGpuTest, APointOutOfFocusIsADiskOfTheCircleOfConfusion)
{
  // A small emissive square at twice the distance in focus.
  scene::Scene scene;
  const auto white = test::add_material(scene, glm::vec3(0.0F));
  scene.edit(white, [](scene::Material &material) { material.emissive = glm::vec3(100.0F); });
  test::add_object(scene, test::add_square_mesh(scene, white), glm::scale(glm::dmat4(1.0), glm::dvec3(0.1)));
  scene::PlacedCamera camera = test::camera_at({0, 0, 8}, {0, 0, 0});
  camera.focus_distance = 4.0F;
  camera.aperture_radius = 2.0F;
  Settings settings = offline_settings(256);
  settings.emissive_point_count = 0;
  test::Renderer renderer(*device, scene, size_px, settings);
  const std::vector<glm::vec4> picture = renderer.picture(camera).pixels;
  const double px_per_slope = 0.5 * size_px.y / std::tan(0.5 * double(camera.vertical_angle));
  const double radius_px = px_per_slope * 2.0 * (1.0 / 4.0 - 1.0 / 8.0);
  const glm::dvec2 middle = 0.5 * glm::dvec2(size_px);
  for (const double part : {0.5, 0.75}) {
    EXPECT_NEAR(share_within(picture, middle, part * radius_px), part * part, 0.04) << radius_px;
  }
  EXPECT_GT(share_within(picture, middle, radius_px + 1.5), 0.99);
  double light = 0.0;
  for (const glm::vec4 &pixel : picture) {
    light += double(pixel.r);
  }
  camera.aperture_radius = 0.0F;
  double sharp_light = 0.0;
  for (const glm::vec4 &pixel : renderer.picture(camera).pixels) {
    sharp_light += double(pixel.r);
  }
  // Each sample sees one to four centres of pixels in the square, so that 256 samples have an error of about 3 %.
  EXPECT_NEAR(light, sharp_light, 0.05 * sharp_light);
}

TEST_F(CameraGpuTest, ALensWithShadowsAgreesWithTheReference)
{
  scene::Scene scene;
  const auto box = test::add_box_mesh(scene, test::add_material(scene, {0.8F, 0.3F, 0.2F}));
  const auto ground = test::add_square_mesh(scene, test::add_material(scene, {0.4F, 0.6F, 0.5F}));
  test::add_object(scene, ground, glm::scale(glm::dmat4(1.0), glm::dvec3(8)));
  for (const glm::dvec3 &at : {glm::dvec3(-0.8, 1.5, 0.4), glm::dvec3(0.3, -0.2, 0.4), glm::dvec3(0.9, -2.2, 0.4)}) {
    test::add_object(scene, box, glm::scale(glm::translate(glm::dmat4(1.0), at), glm::dvec3(0.4)));
  }
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0.4, 0.3, -1}, 3.0F);
  test::add_lamp(scene, scene::LampKind::Point, {-1, -1, 2}, {0, 0, -1}, 4.0F);
  scene::PlacedCamera camera = test::camera_at({0, -5, 2}, {0, 0, 0.3});
  camera.focus_distance = 5.0F;
  camera.aperture_radius = 0.15F;
  camera.aperture_blades = 5;
  camera.shift_x = 0.1F;
  const reference::Tracer tracer(scene);
  const auto truth = reference::direct_light(tracer, camera, size_px, {.sample_count = 256}).pixels;
  const auto error = [&](int sample_count) {
    test::Renderer renderer(*device, scene, size_px, offline_settings(sample_count));
    const std::vector<glm::vec4> picture = renderer.picture(camera).pixels;
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); i++) {
      const glm::dvec3 difference(glm::vec3(picture[i] - truth[i]));
      sum += glm::dot(difference, difference) / 3.0;
    }
    return std::sqrt(sum / double(truth.size()));
  };
  const double error_16 = error(16);
  const double error_128 = error(128);
  EXPECT_LT(error_128, 0.006);
  EXPECT_LT(error_128, 0.5 * error_16);
}

TEST_F(CameraGpuTest, AMovingBarCoversPixelsForThePartOfTheTimeThatItIsThere)
{
  scene::Scene scene;
  const auto white = test::add_material(scene, glm::vec3(0.0F));
  scene.edit(white, [](scene::Material &material) { material.emissive = glm::vec3(1.0F); });
  const auto bar = test::add_square_mesh(scene, white);
  test::add_object(scene, bar, glm::scale(glm::dmat4(1.0), glm::dvec3(4)));
  scene::PlacedCamera camera = test::camera_at({0, 0, 8}, {0, 0, 0});
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = 0.5F * float(size_px.x);
  camera.half_height = 0.5F * float(size_px.y);
  SceneRenderer renderer(*device, scene, size_px, offline_settings(64));
  const auto pose = [&](double place) {
    scene.set_transform(
        test::handle_at(scene.nodes(), 0),
        glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(24.0 * place - 12.0, 0, 0)), glm::dvec3(4)));
    return camera;
  };
  ASSERT_EQ(renderer.draw_moving(pose), 64);
  const std::vector<glm::vec4> picture = renderer.read_picture();
  for (int x = 0; x < size_px.x; x++) {
    const double from_middle = std::abs(double(x) + 0.5 - 0.5 * size_px.x);
    const double covered = std::clamp((16.0 - from_middle) / 24.0, 0.0, 1.0 / 3.0);
    EXPECT_NEAR(picture[std::size_t(size_px.y / 2 * size_px.x + x)].r, covered, 0.03) << x;
  }
}

TEST_F(CameraGpuTest, AMovingPictureIsTheMeanOfItsSamples)
{
  scene::Scene scene;
  const auto box = test::add_box_mesh(scene, test::add_material(scene, {0.8F, 0.3F, 0.2F}));
  const auto ground = test::add_square_mesh(scene, test::add_material(scene, {0.4F, 0.6F, 0.5F}));
  test::add_object(scene, ground, glm::scale(glm::dmat4(1.0), glm::dvec3(8)));
  test::add_object(scene, box, glm::scale(glm::dmat4(1.0), glm::dvec3(0.4)));
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0.4, 0.3, -1}, 3.0F);
  test::add_lamp(scene, scene::LampKind::Point, {-1, -1, 2}, {0, 0, -1}, 4.0F);
  const auto pose = [&](double place) {
    scene.set_transform(
        test::handle_at(scene.nodes(), 1),
        glm::scale(glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(place - 0.5, 0, 0.6)), place, {0, 0.6, 0.8}),
                   glm::dvec3(0.4)));
    return test::camera_at(glm::vec3(float(place), -5, 2), {0, 0, 0.3F});
  };
  constexpr int count = 8;
  std::vector<double> places;
  SceneRenderer renderer(*device, scene, size_px, offline_settings(count));
  renderer.draw_moving([&](double place) {
    places.push_back(place);
    return pose(place);
  });
  const std::vector<glm::vec4> picture = renderer.read_picture();
  std::vector<glm::dvec4> mean(picture.size(), glm::dvec4(0.0));
  for (int i = 0; i < count; i++) {
    Settings settings = offline_settings(count);
    settings.sample_first = i;
    settings.sample_end = i + 1;
    const scene::PlacedCamera camera = pose(places[std::size_t(i)]);
    SceneRenderer fresh(*device, scene, size_px, settings);
    fresh.sync();
    fresh.draw(camera);
    const std::vector<glm::vec4> part = fresh.read_picture();
    const double share = fresh.engine().sample_share(fresh.viewport());
    for (std::size_t j = 0; j < part.size(); j++) {
      mean[j] += share * glm::dvec4(part[j]);
    }
  }
  double largest = 0.0;
  for (std::size_t j = 0; j < picture.size(); j++) {
    largest = std::max(largest, glm::length(mean[j] - glm::dvec4(picture[j])));
  }
  EXPECT_LT(largest, 1e-5);
  std::ranges::sort(places);
  for (int i = 0; i < count; i++) {
    EXPECT_GE(places[std::size_t(i)], double(i) / count);
    EXPECT_LT(places[std::size_t(i)], double(i + 1) / count);
  }

  // Objects that stand still are drawn as without a shutter, and the next picture begins anew.
  const scene::PlacedCamera still = pose(0.5);
  renderer.draw_moving([&](double) { return still; });
  const std::vector<glm::vec4> standing = renderer.read_picture();
  renderer.draw(still);
  EXPECT_EQ(standing, renderer.read_picture());
}

}  // namespace
}  // namespace gnomon::eevee
