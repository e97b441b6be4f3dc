// SPDX-License-Identifier: MIT
#include "measure_error_time.hh"

#include "measure_image_error.hh"
#include "measure_reference.hh"
#include "measure_scene.hh"

#include "gpu_device_fixture.hh"

#include <cmath>

namespace gnomon::measure {
namespace {

using ErrorTimeTest = test::SharedDeviceTest;

/** A square over another, and a lamp with a size: shadows have penumbrae. */
scene::Scene penumbra_scene()
{
  scene::Scene scene;
  const scene::Handle<scene::Mesh> square = add_square_mesh(scene, add_material(scene, glm::vec3(0.8F)));
  for (const double scale : {4.0, 0.7}) {
    scene::Node node;
    node.parent_from_node =
        glm::scale(glm::translate(glm::dmat4(1.0), {0.0, 0.0, scale < 1.0 ? 1.0 : 0.0}), glm::dvec3(scale));
    node.meshes = {square};
    scene.add(std::move(node));
  }
  scene::Node node;
  node.parent_from_node = glm::translate(glm::dmat4(1.0), {0.5, 0.0, 3.0});
  node.lamp = scene.add(scene::Lamp{.intensity = 20.0F, .radius = 0.3F});
  scene.add(std::move(node));
  return scene;
}

TEST(ErrorTime, NumbersOfSamplesRiseToTheLargest)
{
  EXPECT_EQ(rising_sample_counts(1), std::vector<int>({1}));
  EXPECT_EQ(rising_sample_counts(2), std::vector<int>({1, 2}));
  EXPECT_EQ(rising_sample_counts(11), std::vector<int>({1, 2, 4, 8, 11}));
  EXPECT_EQ(rising_sample_counts(std::numeric_limits<int>::max()).size(), 32U);
}

TEST_F(ErrorTimeTest, ErrorsAreThoseOfThePicturesWithoutTheirBackground)
{
  const scene::Scene scene = penumbra_scene();
  const scene::PlacedCamera camera = camera_at({0, -5, 4}, {0, 0, 0.3F});
  const glm::ivec2 size_px(48, 32);
  eevee::Settings settings{.sample_count = 6};
  settings.background = {eevee::Background::Kind::Color, glm::vec3(5.0F)};
  std::vector<TimedError> points;
  double share = 0.0;
  ErrorTimeHost host;
  host.progress = [&](double share_done) {
    EXPECT_GE(share_done, share);
    share = share_done;
    return true;
  };
  host.take = [&](const TimedError &point) { points.push_back(point); };
  measure_error_time(*device, scene, camera, size_px, settings, host);
  EXPECT_EQ(share, 1.0);
  ASSERT_EQ(points.size(), 4U);

  const reference::Tracer tracer(scene);
  const ReferencePicture reference = reference_picture(tracer, camera, size_px, 64);
  settings.background = {};
  for (std::size_t i = 0; i < points.size(); i++) {
    settings.sample_count = rising_sample_counts(6)[i];
    EXPECT_EQ(points[i].sample_count, settings.sample_count);
    EXPECT_GT(points[i].seconds, 0.0);
    Renderer renderer(*device, scene, size_px, settings);
    const ImageError error = image_error(size_px, renderer.picture(camera).pixels, reference.picture.pixels);
    // The reference's own noise adds to the error of the whole picture.
    const double expected = std::sqrt(error.rmse * error.rmse - reference.noise * reference.noise);
    EXPECT_NEAR(points[i].error.rmse, expected, 4.0 * points[i].error.standard_error) << settings.sample_count;
    EXPECT_LT(points[i].error.standard_error, 0.2 * expected) << "otherwise the check above says little";
  }
  EXPECT_LT(points.back().error.rmse, points.front().error.rmse);
}

TEST_F(ErrorTimeTest, ItsHostCancelsItAnywhere)
{
  const scene::Scene scene = penumbra_scene();
  // Before all, while rays are traced, and while pictures are drawn. Without a cancellation, the last picture would
  // take hours.
  for (const double share_max : {-1.0, 0.1, 0.25}) {
    ErrorTimeHost host;
    host.progress = [&](double share_done) { return share_done <= share_max; };
    EXPECT_THROW(measure_error_time(*device, scene, camera_at({0, -5, 4}, {0, 0, 0.3F}), {12, 12},
                                    {.sample_count = 1 << 20}, host),
                 Cancelled)
        << share_max;
  }
}

}  // namespace
}  // namespace gnomon::measure
