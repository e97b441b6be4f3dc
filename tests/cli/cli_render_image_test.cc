// SPDX-License-Identifier: MIT
// The examples against Cycles' renders of them.
#include "eevee_camera.hh"
#include "eevee_engine.hh"
#include "gltf_import.hh"
#include "gpu_device_fixture.hh"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace gnomon {
namespace {

struct Case {
  const char *scene;
  const char *reference;
  int samples;
  /** Largest RMSE over R, G, B: that of Blender EEVEE 3.4.1 with this number of samples. */
  double rmse_max;
  /**
   * Largest fraction of pixels with an error above 0.05 in a channel, at edges. Twice the value measured with Mesa
   * 22.3.6's rasteriser, as a margin for other drivers' rounding.
   */
  double outliers_max;
};

void PrintTo(const Case &c, std::ostream *stream)
{
  *stream << c.scene << " at " << c.samples << " samples";
}

class ReferenceTest : public testing::TestWithParam<Case> {};

/** RGB, rows from the top. */
std::vector<float> render(gpu::Device &device, const scene::Scene &scene, glm::ivec2 size_px, int samples)
{
  render_scene::RenderScene render_scene(device, scene);
  eevee::Engine engine(render_scene, {.sample_count = samples});
  draw::Viewport viewport(device, size_px);
  const std::array<draw::Engine *, 1> engines = {&engine};
  render_scene.update();
  viewport.sync(engines, render_scene.objects());
  for (int i = 0; i < samples; i++) {
    viewport.draw(engines, eevee::view_of(render_scene.relative(scene.placed_cameras().front()), size_px));
  }
  const std::vector<std::byte> bytes = device.read(engine.radiance(viewport));
  std::vector<float> rgb;
  for (int y = size_px.y - 1; y >= 0; y--) {
    for (int x = 0; x < size_px.x; x++) {
      std::array<float, 4> pixel{};
      std::memcpy(pixel.data(), bytes.data() + (std::size_t(y) * std::size_t(size_px.x) + std::size_t(x)) * 16, 16);
      rgb.insert(rgb.end(), pixel.begin(), pixel.begin() + 3);
    }
  }
  return rgb;
}

TEST_P(ReferenceTest, ErrorIsBelowBlenderEevees)
{
  const auto device = test::testing_device(test::testing_backend());
  if (!device) {
    return;
  }
  const Case c = GetParam();
  OIIO::ImageBuf truth(std::string(GNOMON_TEST_DATA) + "/scenes/" + c.reference);
  ASSERT_TRUE(truth.read(0, 0, true, OIIO::TypeDesc::FLOAT)) << truth.geterror();
  const glm::ivec2 size_px{truth.spec().width, truth.spec().height};
  const scene::Scene scene = gltf::import_gltf(std::string(GNOMON_SOURCE) + "/examples/scenes/" + c.scene + ".glb");
  const std::vector<float> rgb = render(*device, scene, size_px, c.samples);
  ASSERT_TRUE(std::ranges::all_of(rgb, [](float value) { return std::isfinite(value); }));

  double sum = 0.0;
  int outliers = 0;
  OIIO::ImageBuf difference(OIIO::ImageSpec(size_px.x, size_px.y, 3, OIIO::TypeDesc::FLOAT));
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      std::array<float, 3> d{};
      for (int channel = 0; channel < 3; channel++) {
        const std::size_t i = (std::size_t(y) * std::size_t(size_px.x) + std::size_t(x)) * 3 + std::size_t(channel);
        d[std::size_t(channel)] = std::abs(rgb[i] - truth.getchannel(x, y, 0, channel));
        sum += double(d[std::size_t(channel)]) * double(d[std::size_t(channel)]);
      }
      outliers += *std::ranges::max_element(d) > 0.05F;
      difference.setpixel(x, y, d.data());
    }
  }
  const double pixel_count = double(size_px.x) * size_px.y;
  const double rmse = std::sqrt(sum / (3.0 * pixel_count));
  RecordProperty("rmse", std::to_string(rmse));
  RecordProperty("outliers", std::to_string(outliers / pixel_count));
  fmt::print("{} at {}: RMSE {:.5f}, outliers {:.5f}\n", c.scene, c.samples, rmse, outliers / pixel_count);
  EXPECT_LE(rmse, c.rmse_max);
  EXPECT_LE(outliers / pixel_count, c.outliers_max);
  if (HasFailure()) {
    const auto folder = std::filesystem::current_path();
    OIIO::ImageBuf ours(OIIO::ImageSpec(size_px.x, size_px.y, 3, OIIO::TypeDesc::FLOAT),
                        const_cast<float *>(rgb.data()));
    const std::string stem = (folder / fmt::format("{}-{}", c.scene, c.samples)).string();
    ours.write(stem + ".exr");
    OIIO::ImageBufAlgo::mul(difference, 20.0F).write(stem + ".difference-x20.png");
    ADD_FAILURE() << "picture and difference: " << stem << ".exr, .difference-x20.png";
  }
}

INSTANTIATE_TEST_SUITE_P(Examples, ReferenceTest,
                         testing::Values(Case{"plaza", "plaza.cycles-1024.exr", 1, 0.01583, 0.033},
                                         Case{"spots", "spots.cycles-1024.exr", 1, 0.01082, 0.022},
                                         Case{"room", "room.cycles-4096.exr", 1, 0.00690, 0.009},
                                         Case{"plaza", "plaza.cycles-1024.exr", 16, 0.00626, 0.0052},
                                         Case{"spots", "spots.cycles-1024.exr", 16, 0.00361, 0.0008},
                                         Case{"room", "room.cycles-4096.exr", 16, 0.00148, 0.0001}),
                         [](const auto &test) { return fmt::format("{}{}", test.param.scene, test.param.samples); });

}  // namespace
}  // namespace gnomon
