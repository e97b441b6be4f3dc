// SPDX-License-Identifier: MIT
// Adaptive sampling as the driver draws it, compared with pictures whose pixels all get all samples.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "internal/eevee_adaptive.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::eevee {
namespace {

constexpr glm::ivec2 adaptive_size_px(61, 43);
constexpr int adaptive_samples = 16;

/** Boxes on a ground that ends within the picture, under a point lamp and a sun. */
class AdaptiveGpuTest : public test::SharedDeviceTest {
 protected:
  enum class Path { Deferred, Forward, Both };

  void add_objects(Path path)
  {
    const auto add = [&](const glm::vec3 &albedo, bool is_forward) {
      const auto material = test::add_material(scene, albedo);
      scene.edit(material, [&](scene::Material &edited) {
        edited.is_double_sided = true;
        if (is_forward) {
          edited.base_color_texture = test::add_texture(scene, 1, {255, 255, 255, 255});
        }
      });
      return material;
    };
    test::add_object(scene, test::add_square_mesh(scene, add({0.6F, 0.6F, 0.5F}, path == Path::Forward)),
                     glm::scale(glm::dmat4(1.0), glm::dvec3(1.8)));
    const auto box = test::add_box_mesh(scene, add({0.7F, 0.3F, 0.2F}, path != Path::Deferred));
    for (int i = 0; i < 3; i++) {
      const glm::dmat4 place = glm::translate(glm::dmat4(1.0), glm::dvec3(1.1 * i - 1.0, 0.3 * i - 0.4, 0.4));
      test::add_object(scene, box, glm::scale(glm::rotate(place, 0.5 * i, glm::dvec3(1, 0.3, 0.5)), glm::dvec3(0.3)));
    }
  }

  void add_lamps()
  {
    test::add_lamp(scene, scene::LampKind::Point, {1.5F, -1, 3}, {0, 0, -1}, 40.0F);
    test::add_lamp(scene, scene::LampKind::Sun, {}, {0.3F, 0.5F, -1}, 1.5F);
  }

  test::Picture render(float threshold)
  {
    Settings settings = with_small_shadows;
    settings.noise_threshold = threshold;
    test::Renderer renderer(*device, scene, adaptive_size_px, settings);
    test::Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture;
  }

  scene::Scene scene;
  scene::PlacedCamera camera = test::camera_at({0.4F, -5, 3.5F}, {0, 0, 0.2F}, 0.7F);
  Settings with_small_shadows{.shadow = {.cube_size_px = 256, .map_size_px = 256}, .sample_count = adaptive_samples};
};

float largest_difference(const glm::vec4 &a, const glm::vec4 &b)
{
  const glm::vec4 difference = glm::abs(a - b);
  return std::max({difference.r, difference.g, difference.b, difference.a});
}

/** The largest difference among a pixel and its eight neighbours. The threshold is compared with it. */
float relative_difference(const test::Picture &picture, glm::ivec2 pixel)
{
  glm::vec4 low = picture.at(pixel.x, pixel.y);
  glm::vec4 high = low;
  for (int y = std::max(pixel.y - 1, 0); y <= std::min(pixel.y + 1, adaptive_size_px.y - 1); y++) {
    for (int x = std::max(pixel.x - 1, 0); x <= std::min(pixel.x + 1, adaptive_size_px.x - 1); x++) {
      low = glm::min(low, picture.at(x, y));
      high = glm::max(high, picture.at(x, y));
    }
  }
  const glm::vec4 difference = high - low;
  const float brightest = std::max({high.r, high.g, high.b, 1e-30F});
  return std::max(std::max({difference.r, difference.g, difference.b}) / std::sqrt(brightest), difference.a);
}

TEST_F(AdaptiveGpuTest, PixelsThatDifferFromTheirNeighboursAreThoseOfAllSamples)
{
  std::uint64_t forward_depths = 0;
  for (const Path path : {Path::Deferred, Path::Forward, Path::Both}) {
    for (const bool is_fitted : {false, true}) {
      SCOPED_TRACE(testing::Message() << int(path) << is_fitted);
      scene = {};
      add_objects(path);
      add_lamps();
      with_small_shadows.shadow.is_fitted_to_depth = is_fitted;
      with_small_shadows.background = {.kind = is_fitted ? Background::Kind::Color : Background::Kind::None,
                                       .color = {0.2F, 0.4F, 0.9F}};
      const test::Picture whole = render(0.0F);
      constexpr float threshold = 0.02F;
      const std::uint64_t tests = runs("adaptive_test");
      const test::Picture adaptive = render(threshold);
      EXPECT_EQ(runs("adaptive_test"), tests + 1);
      EXPECT_EQ(runs("adaptive_forward_depth") > forward_depths, path == Path::Both);
      forward_depths = runs("adaptive_forward_depth");
      int equal = 0;
      int other = 0;
      for (int y = 0; y < adaptive_size_px.y; y++) {
        for (int x = 0; x < adaptive_size_px.x; x++) {
          const float difference = largest_difference(whole.at(x, y), adaptive.at(x, y));
          // A picture of four samples and one of 16 differ where the threshold decides, by about half of it.
          if (relative_difference(whole, {x, y}) > 2.0F * threshold) {
            // The order of the sums differs.
            ASSERT_LT(difference, 2e-6F) << x << ", " << y;
            equal++;
          }
          else {
            ASSERT_LT(difference, threshold) << x << ", " << y;
            other += difference > 2e-6F ? 1 : 0;
          }
        }
      }
      EXPECT_GT(equal, 300);
      EXPECT_GT(other, 5) << "pixels with fewer samples, whose mean differs";
    }
  }
}

TEST_F(AdaptiveGpuTest, PixelsWithoutAnyDifferenceKeepTheirMeanAtEachSample)
{
  // The sun lights all of the picture evenly.
  test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, {0.5F, 0.4F, 0.3F})),
                   glm::scale(glm::dmat4(1.0), glm::dvec3(100)));
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 1.5F);
  Settings settings = with_small_shadows;
  settings.noise_threshold = 0.01F;
  SceneRenderer renderer(*device, scene, adaptive_size_px, settings);
  renderer.sync();
  for (int i = 0; i < adaptive_samples; i++) {
    EXPECT_EQ(renderer.draw_sample(camera), i == adaptive_samples - 1);
    for (const glm::vec4 &pixel : renderer.read_picture()) {
      ASSERT_NEAR(pixel.a, 1.0F, 3e-6F) << "after sample " << i;
    }
  }
  EXPECT_EQ(runs("adaptive_film"), std::uint64_t(adaptive_samples - adaptive_first_samples(adaptive_samples)));
  EXPECT_EQ(runs("film"), std::uint64_t(adaptive_first_samples(adaptive_samples)));
}

TEST_F(AdaptiveGpuTest, PartsOfASampleAreThoseOfTheWholePicture)
{
  add_objects(Path::Deferred);
  add_lamps();
  const test::Picture whole = render(0.02F);
  Settings settings = with_small_shadows;
  settings.noise_threshold = 0.02F;
  SceneRenderer renderer(*device, scene, adaptive_size_px, settings);
  renderer.sync();
  renderer.viewport().set_rows_max(17);
  int calls = 1;
  while (calls < 100 && !renderer.draw_sample(camera)) {
    calls++;
  }
  EXPECT_EQ(calls, 3 * adaptive_samples) << "45 rows with the guard band";
  EXPECT_TRUE(renderer.read_picture() == whole.pixels);
}

TEST_F(AdaptiveGpuTest, AnotherPictureFindsItsOwnPixels)
{
  add_objects(Path::Deferred);
  add_lamps();
  Settings settings = with_small_shadows;
  settings.noise_threshold = 0.02F;
  SceneRenderer renderer(*device, scene, adaptive_size_px, settings);
  renderer.sync();
  renderer.draw(test::camera_at({3, -2, 1.5F}, {0, 0, 0.2F}, 0.7F));
  renderer.draw(camera);
  const test::Picture adaptive = render(0.02F);
  EXPECT_TRUE(renderer.read_picture() == adaptive.pixels);
  const auto draw = [&](float threshold) {
    settings.noise_threshold = threshold;
    renderer.set_settings(settings);
    renderer.sync();
    renderer.draw(camera);
    return renderer.read_picture();
  };
  EXPECT_TRUE(draw(0.0F) == render(0.0F).pixels);
  EXPECT_TRUE(draw(0.02F) == adaptive.pixels);
  renderer.resize({33, 20});
  renderer.sync();
  renderer.draw(camera);
  renderer.resize(adaptive_size_px);
  EXPECT_TRUE(draw(0.02F) == adaptive.pixels);
}

TEST_F(AdaptiveGpuTest, APictureThatIsEndedEarlyIsTheMeanOfItsSamples)
{
  add_objects(Path::Deferred);
  add_lamps();
  for (const int count : {0, adaptive_samples}) {
    Settings settings = with_small_shadows;
    settings.sample_count = count;
    std::vector<std::vector<glm::vec4>> pictures;
    // The least threshold holds pixels that do not differ at all.
    for (const float threshold : {1e-30F, 0.02F}) {
      settings.noise_threshold = threshold;
      SceneRenderer renderer(*device, scene, adaptive_size_px, settings);
      renderer.sync();
      renderer.draw(camera, {.progress = [](int samples_drawn) { return samples_drawn < 9; }});
      pictures.push_back(renderer.read_picture());
    }
    for (std::size_t i = 0; i < pictures[0].size(); i++) {
      ASSERT_LT(largest_difference(pictures[0][i], pictures[1][i]), 0.02F) << count << " samples, pixel " << i;
    }
  }
}

}  // namespace
}  // namespace gnomon::eevee
