// SPDX-License-Identifier: MIT
// Shadow maps that hold only the part that the picture looks up.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "gpu_read.hh"
#include "shadows/shadows.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <cmath>

namespace gnomon::eevee {
namespace {

using test::Picture;

constexpr glm::ivec2 crop_picture_px(48, 36);

struct CropLamp {
  const char *name;
  scene::LampKind kind;
  float radius = 0.0F;
};

void PrintTo(const CropLamp &lamp, std::ostream *stream)
{
  *stream << lamp.name;
}

/** Boxes on a ground, of which cameras see a part. */
class ShadowCropGpuTest : public test::SharedDeviceTest, public testing::WithParamInterface<CropLamp> {
 protected:
  ShadowCropGpuTest()
  {
    const auto plain = test::add_material(scene, glm::vec3(0.8F));
    const auto box = test::add_box_mesh(scene, plain);
    test::add_object(scene, test::add_square_mesh(scene, plain), glm::scale(glm::dmat4(1), glm::dvec3(20)));
    for (int i = 0; i < 49; i++) {
      const glm::dvec3 place(1.3 * (i % 7 - 3), 1.3 * (i / 7 - 3), 0.3);
      test::add_object(scene, box, glm::scale(glm::translate(glm::dmat4(1), place), glm::dvec3(0.3)));
    }
    const CropLamp &param = GetParam();
    const auto lamp = test::add_lamp(scene, param.kind, {1, -2, 5}, {-0.1F, 0.2F, -0.97F}, 60.0F);
    scene.edit(lamp, [&](scene::Lamp &edited) {
      edited.radius = param.radius;
      edited.area_size_x = edited.area_size_y = 2.0F * param.radius;
    });
  }
  static Settings settings(int edge_px, bool is_fitted)
  {
    return {.shadow = {.cube_size_px = edge_px, .map_size_px = edge_px, .is_fitted_to_depth = is_fitted},
            .sample_count = 16};
  }
  Picture picture(const Settings &with)
  {
    return test::Renderer(*device, scene, crop_picture_px, with).picture(camera);
  }

  scene::Scene scene;
  scene::PlacedCamera camera = test::camera_at({2.0F, -3, 4}, {2.0F, 0.5F, 0}, 0.25F);
};

double crop_rmse(const Picture &picture, const Picture &truth)
{
  double sum = 0.0;
  for (std::size_t i = 0; i < picture.pixels.size(); i++) {
    const glm::vec4 delta = picture.pixels[i] - truth.pixels[i];
    sum += double(glm::dot(delta, delta));
  }
  return std::sqrt(sum / double(picture.pixels.size()));
}

TEST_P(ShadowCropGpuTest, HasTheErrorOfLargerMaps)
{
  const Picture truth = picture(settings(4096, false));
  const Picture cropped = picture(settings(128, true));
  const Picture whole = picture(settings(128, false));
  EXPECT_EQ(cropped.non_finite_count(), 0U);
  EXPECT_LT(crop_rmse(cropped, truth), 0.4 * crop_rmse(whole, truth));
}

TEST_P(ShadowCropGpuTest, PicturesOfTwoViewportsAreThoseOfEach)
{
  const scene::PlacedCamera other = test::camera_at({-3.0F, -3, 2}, {-1.0F, 2.0F, 0}, 0.5F);
  const Settings with = settings(64, true);
  const std::array<scene::PlacedCamera, 2> cameras{camera, other};
  render_scene::RenderScene render_scene(*device, scene);
  Engine engine(render_scene, with);
  const std::array<draw::Engine *, 1> engines = {&engine};
  std::array<draw::Viewport, 2> viewports{draw::Viewport(*device, crop_picture_px),
                                          draw::Viewport(*device, crop_picture_px)};
  render_scene.update();
  for (draw::Viewport &viewport : viewports) {
    viewport.sync(engines, render_scene.objects());
    viewport.restart();
  }
  // Samples of both in turn: each crops the maps of the lamp, which they share.
  for (int sample = 0; sample < with.sample_count + 1; sample++) {
    for (std::size_t i = 0; i < 2; i++) {
      viewports[i].draw(engines, view_of(render_scene.relative(cameras[i]), crop_picture_px));
    }
  }
  for (std::size_t i = 0; i < 2; i++) {
    SceneRenderer alone(*device, scene, crop_picture_px, with);
    alone.sync();
    alone.draw(cameras[i]);
    EXPECT_EQ(gpu::read_as<glm::vec4>(*device, engine.radiance(viewports[i])), alone.read_picture()) << i;
  }
}

/** A cube has layers only for the faces that the picture looks up, unless pictures before it looked up others. */
TEST_P(ShadowCropGpuTest, PicturesDoNotDependOnTheLayersOfPicturesBeforeThem)
{
  // Few samples, as the points of lamps with a size may look up further faces.
  Settings with = settings(64, true);
  with.sample_count = 2;
  SceneRenderer renderer(*device, scene, crop_picture_px, with);
  const auto draw = [&](const scene::PlacedCamera &from) {
    renderer.sync();
    renderer.draw(from);
    return renderer.read_picture();
  };
  const std::vector<glm::vec4> alone = draw(camera);
  const gpu::Texture &cubes = renderer.inspect().shadows().scene().cubes();
  const int alone_count = cubes ? cubes.desc().layers : 0;
  // From the ground, past the lamp.
  draw(test::camera_at({-9, -9, 0.2F}, {9, 9, 2}, 1.5F));
  EXPECT_EQ(draw(camera), alone);
  if (cubes) {
    EXPECT_LT(alone_count, 6);
    EXPECT_EQ(cubes.desc().layers, 6) << "the case that is to be tested";
  }
}

const CropLamp crop_lamps[] = {{"Point", scene::LampKind::Point},
                               {"Spot", scene::LampKind::Spot},
                               {"SizedPoint", scene::LampKind::Point, 0.3F},
                               {"SizedSpot", scene::LampKind::Spot, 0.3F},
                               {"Area", scene::LampKind::Area, 0.3F}};
INSTANTIATE_TEST_SUITE_P(Each, ShadowCropGpuTest, testing::ValuesIn(crop_lamps),
                         [](const testing::TestParamInfo<CropLamp> &test) { return std::string(test.param.name); });

}  // namespace
}  // namespace gnomon::eevee
