// SPDX-License-Identifier: MIT
// Parts of pictures: crops of larger pictures, regions, and ranges of samples.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace gnomon::eevee {
namespace {

using test::Picture;

constexpr glm::ivec2 whole_size_px(40, 30);
constexpr int margin_px = 12;
constexpr double vertical_angle = 0.7;

class PicturePartsTest : public test::SharedDeviceTest {
 protected:
  PicturePartsTest()
  {
    const auto plain = test::add_material(scene, {0.8F, 0.5F, 0.2F});
    const auto box = test::add_box_mesh(scene, plain);
    test::add_object(scene, test::add_square_mesh(scene, plain), glm::scale(glm::dmat4(1), glm::dvec3(20)));
    // Edges everywhere, at the rim of the picture too.
    for (int i = 0; i < 49; i++) {
      const glm::dvec3 place(1.3 * (i % 7 - 3), 1.3 * (i / 7 - 3), 0.3);
      test::add_object(scene, box, glm::scale(glm::translate(glm::dmat4(1), place), glm::dvec3(0.3)));
    }
    test::add_lamp(scene, scene::LampKind::Point, {1, -2, 6}, {0, 0, -1}, 60.0F);
  }
  Picture picture(glm::ivec2 size, bool is_perspective)
  {
    scene::PlacedCamera camera = test::camera_at({0.3F, -5, 6}, {0, 0, 0}, float(vertical_angle));
    const double height = double(size.y) / double(whole_size_px.y);
    if (is_perspective) {
      camera.vertical_angle = float(2.0 * std::atan(height * std::tan(0.5 * vertical_angle)));
    }
    else {
      camera.kind = scene::CameraKind::Orthographic;
      camera.far = 40.0F;
      camera.half_height = float(2.5 * height);
      camera.half_width = camera.half_height * float(size.x) / float(size.y);
    }
    test::Renderer renderer(*device, scene, size, {.shadow = {.cube_size_px = 256}, .sample_count = 8});
    return renderer.picture(camera);
  }

  scene::Scene scene;
};

/** Root of the mean square of the differences at a distance from the edge of the picture. */
double difference(const Picture &picture, const Picture &larger, int distance_px)
{
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y < whole_size_px.y; y++) {
    for (int x = 0; x < whole_size_px.x; x++) {
      if (std::min({x, y, whole_size_px.x - 1 - x, whole_size_px.y - 1 - y}) == distance_px) {
        const glm::vec4 delta = picture.at(x, y) - larger.at(x + margin_px, y + margin_px);
        sum += double(glm::dot(delta, delta));
        count++;
      }
    }
  }
  return std::sqrt(sum / double(count));
}

TEST_F(PicturePartsTest, APictureIsTheCropOfALargerOneWithTheSamePixels)
{
  for (const bool is_perspective : {true, false}) {
    const Picture small = picture(whole_size_px, is_perspective);
    const Picture large = picture(whole_size_px + 2 * margin_px, is_perspective);
    EXPECT_EQ(small.non_finite_count(), 0U);
    for (int distance_px = 0; distance_px < whole_size_px.y / 2; distance_px++) {
      // Roundings of two projections move edges by 1e-5 of a pixel. Without a guard band the rim differs by 0.05.
      EXPECT_LE(difference(small, large, distance_px), 2e-3)
          << distance_px << " px from the edge, " << (is_perspective ? "perspective" : "orthographic");
    }
  }
}

TEST_F(PicturePartsTest, RegionsAreBitForBitThoseOfTheWholePicture)
{
  // A sun whose cascades are fitted to the depths of the whole picture, too.
  test::add_lamp(scene, scene::LampKind::Sun, {4, 3, 8}, {-0.4, -0.3, -0.8}, 2.0F);
  const scene::PlacedCamera camera = test::camera_at({0.3F, -5, 6}, {0, 0, 0}, float(vertical_angle));
  for (const auto &[is_fitted, has_glass] : {std::pair(true, false), {false, false}, {false, true}}) {
    if (has_glass) {
      // It shows pixels far from its own.
      const auto glass = test::add_material(scene, glm::vec3(0.9F));
      scene.edit(glass, [](scene::Material &material) {
        material.transmission = material.thickness = 1.0F;
        material.roughness = 0.8F;
      });
      test::add_object(scene, test::add_box_mesh(scene, glass),
                       glm::scale(glm::translate(glm::dmat4(1), {0, -1, 1.5}), glm::dvec3(1.2)));
    }
    const Settings settings{.shadow = {.cube_size_px = 128, .map_size_px = 128, .is_fitted_to_depth = is_fitted},
                            .sample_count = 3};
    SceneRenderer renderer(*device, scene, whole_size_px, settings);
    renderer.sync();
    renderer.draw(camera);
    const std::vector<glm::vec4> whole = renderer.read_picture();
    for (const gpu::Rectangle region : {gpu::Rectangle{{0, 0}, {40, 7}}, gpu::Rectangle{{0, 7}, {17, 23}},
                                        gpu::Rectangle{{17, 7}, {23, 23}}, gpu::Rectangle{{39, 29}, {1, 1}}}) {
      SceneRenderer part(*device, scene, whole_size_px, settings);
      part.sync();
      part.viewport().set_region(region);
      part.draw(camera);
      const std::vector<glm::vec4> drawn = part.read_picture();
      std::size_t differing_count = 0;
      for (int y = region.origin_px.y; y < region.origin_px.y + region.size_px.y; y++) {
        for (int x = region.origin_px.x; x < region.origin_px.x + region.size_px.x; x++) {
          const std::size_t i = std::size_t(y * whole_size_px.x + x);
          differing_count += drawn[i] == whole[i] ? 0 : 1;
        }
      }
      EXPECT_EQ(differing_count, 0U) << region.origin_px.x << ", " << region.origin_px.y << ", fitted: " << is_fitted;
    }
  }
}

TEST_F(PicturePartsTest, RangesOfSamplesAddUpToTheWholePicture)
{
  scene::PlacedCamera camera = test::camera_at({0.3F, -5, 6}, {0, 0, 0}, float(vertical_angle));
  scene.edit(test::handle_at(scene.lamps(), 0), [](scene::Lamp &lamp) { lamp.radius = 0.4F; });
  // A sun whose cascades are fitted to the depths that the first sample sees.
  test::add_lamp(scene, scene::LampKind::Sun, {4, 3, 8}, {-0.4, -0.3, -0.8}, 2.0F);
  Settings settings{
      .shadow = {.cube_size_px = 128, .map_size_px = 128, .is_fitted_to_depth = true}, .sample_count = 16, .seed = 3};
  SceneRenderer renderer(*device, scene, whole_size_px, settings);
  renderer.sync();
  renderer.draw(camera);
  const std::vector<glm::vec4> whole = renderer.read_picture();
  EXPECT_NEAR(renderer.engine().sample_share(renderer.viewport()), 1.0, 1e-9);
  std::vector<glm::vec4> sum(whole.size(), glm::vec4(0.0F));
  double share = 0.0;
  for (int part = 0; part < 4; part++) {
    settings.sample_first = 4 * part;
    settings.sample_end = 4 * part + 4;
    renderer.set_settings(settings);
    renderer.sync();
    EXPECT_EQ(renderer.draw(camera), 4);
    const std::vector<glm::vec4> picture = renderer.read_picture();
    for (int i = 0; part == 0 && i < 16; i++) {
      renderer.draw_sample(camera);
    }
    EXPECT_TRUE(part > 0 || renderer.read_picture() == picture) << "a host goes on drawing";
    const double part_share = renderer.engine().sample_share(renderer.viewport());
    for (std::size_t i = 0; i < sum.size(); i++) {
      sum[i] += float(part_share) * picture[i];
    }
    share += part_share;
  }
  EXPECT_NEAR(share, 1.0, 1e-9);
  float largest = 0.0F;
  for (std::size_t i = 0; i < sum.size(); i++) {
    largest = std::max(largest, glm::distance(sum[i], whole[i]) / (glm::length(whole[i]) + 1e-3F));
  }
  EXPECT_LE(largest, 1e-5F) << "relative difference: roundings of the sums";
}

TEST_F(PicturePartsTest, PartsOutsideOfThePictureAreErrors)
{
  SceneRenderer renderer(*device, scene, whole_size_px);
  for (const gpu::Rectangle region : {gpu::Rectangle{{0, 0}, {41, 1}}, gpu::Rectangle{{-1, 0}, {4, 4}},
                                      gpu::Rectangle{{3, 3}, {0, 4}}, gpu::Rectangle{{3, 30}, {1, 1}}}) {
    EXPECT_THROW(renderer.viewport().set_region(region), gpu::Error);
  }
  for (const auto &[first, end] : {std::pair(-1, 2), std::pair(2, 2), std::pair(3, 9), std::pair(8, 0)}) {
    renderer.set_settings({.sample_count = 8, .sample_first = first, .sample_end = end});
    EXPECT_THROW(renderer.sync(), gpu::Error) << first << " to " << end;
  }
}

}  // namespace
}  // namespace gnomon::eevee
