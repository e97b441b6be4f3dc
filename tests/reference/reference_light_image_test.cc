// SPDX-License-Identifier: MIT
// Ray traced direct light against Cycles' renders of the examples.
#include "reference_light.hh"
#include "scene_gltf.hh"

#include <OpenImageIO/imagebuf.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gnomon {
namespace {

struct Case {
  const char *scene;
  const char *truth;
  /** Of the reference picture, RMSE (tests/data/scenes/eevee.tsv). */
  double noise;
};

void PrintTo(const Case &c, std::ostream *stream)
{
  *stream << c.scene;
}

class CyclesTest : public testing::TestWithParam<Case> {};

TEST_P(CyclesTest, DifferenceIsWithinCyclesNoise)
{
  const Case c = GetParam();
  OIIO::ImageBuf truth(std::string(GNOMON_TEST_DATA) + "/scenes/" + c.truth);
  ASSERT_TRUE(truth.read(0, 0, true, OIIO::TypeDesc::FLOAT)) << truth.geterror();
  const glm::ivec2 size_px{truth.spec().width, truth.spec().height};
  const scene::Scene scene = scene::import_gltf(std::string(GNOMON_SOURCE) + "/examples/scenes/" + c.scene + ".glb");
  const reference::Tracer tracer(scene);
  const int samples = std::getenv("R_SAMPLES") ? atoi(std::getenv("R_SAMPLES")) : 2;
  const reference::Picture a =
      direct_light(tracer, scene.cameras.front(), size_px, {.sample_count = samples, .seed = 1});
  const reference::Picture b =
      direct_light(tracer, scene.cameras.front(), size_px, {.sample_count = samples, .seed = 2});
  double product = 0.0;
  double own = 0.0;
  double sum = 0.0;
  OIIO::ImageBuf difference(OIIO::ImageSpec(size_px.x, size_px.y, 3, OIIO::TypeDesc::FLOAT));
  OIIO::ImageBuf ours(OIIO::ImageSpec(size_px.x, size_px.y, 3, OIIO::TypeDesc::FLOAT));
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      const std::size_t i = std::size_t(size_px.y - 1 - y) * std::size_t(size_px.x) + std::size_t(x);
      float d[3];
      float m[3];
      for (int channel = 0; channel < 3; channel++) {
        const double t = truth.getchannel(x, y, 0, channel);
        const double da = a.pixels[i][channel] - t;
        const double db = b.pixels[i][channel] - t;
        product += da * db;
        own += (da - db) * (da - db);
        sum += 0.25 * (da + db) * (da + db);
        d[channel] = float(std::abs(0.5 * (da + db)) * 20.0);
        m[channel] = float(0.5 * (da + db) + t);
      }
      difference.setpixel(x, y, d);
      ours.setpixel(x, y, m);
    }
  }
  const double n = 3.0 * size_px.x * size_px.y;
  fmt::print("{}: rmse without own noise {:.6f} (cycles' noise {}), own noise of the mean {:.6f}, plain rmse {:.6f}\n",
             c.scene, std::sqrt(std::max(0.0, product / n)), c.noise, std::sqrt(own / n / 4), std::sqrt(sum / n));
  difference.write(fmt::format("/tmp/r_{}_diff.png", c.scene));
  ours.write(fmt::format("/tmp/r_{}.exr", c.scene));
}

INSTANTIATE_TEST_SUITE_P(Examples, CyclesTest,
                         testing::Values(Case{"plaza", "plaza.cycles-1024.exr", 0.00085},
                                         Case{"spots", "spots.cycles-1024.exr", 0.00116},
                                         Case{"room", "room.cycles-4096.exr", 0.00026}),
                         [](const auto &test) { return std::string(test.param.scene); });

}  // namespace
}  // namespace gnomon
