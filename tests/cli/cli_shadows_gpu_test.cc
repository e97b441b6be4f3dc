// SPDX-License-Identifier: MIT
// `gnomon render` and its options for shadows, on the driver.
#include "cli_process.hh"
#include "gltf/gltf_builder.hh"
#include "gpu_device_fixture.hh"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>

namespace gnomon {
namespace {

using test::example;
using test::Finished;
using test::json;

class CliShadowsTest : public test::ProgramTest {
 protected:
  void SetUp() override
  {
    const auto device = test::testing_gl_device();
    if (!device) {
      GTEST_SKIP() << "no device to render with";
    }
    has_vertex_layer = device->limits().has_vertex_layer;
  }
  /** A ground of 40 m with \a count point lamps above it that have this shadow setting. */
  static std::string lamps_gltf(int count, const std::string &kind)
  {
    test::GltfBuilder builder;
    builder.document["extensionsUsed"] = {"KHR_lights_punctual"};
    const int positions = builder.positions({-20, 0, -20, 20, 0, -20, 20, 0, 20, -20, 0, 20});
    const int indices = builder.accessor(std::vector<std::uint16_t>{0, 2, 1, 0, 3, 2}, test::Uint16, "SCALAR");
    builder.append("materials", {{"doubleSided", true}});
    builder.node(
        {{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", 0}})}});
    // A caster below each lamp, all with the same mesh.
    for (int i = 0; i < 9; i++) {
      builder.node({{"mesh", 0}, {"scale", {0.02, 1, 0.02}}, {"translation", {-16 + 4 * i, 0.5, -16 + 4 * i}}});
    }
    for (int i = 0; i < count; i++) {
      builder.light({{"type", "point"}, {"intensity", 683.0 / count}}, {{"gnomon_shadow", kind}},
                    {{"name", "lamp" + std::to_string(i)},
                     {"translation", {-18 + 36.0 * (i % 37) / 37, 2.0, -18 + 36.0 * (i / 37) / 28}}});
    }
    return builder.gltf();
  }
  json run_json() const
  {
    return json::parse(read("run.json"));
  }
  /** RGB, rows from the top. */
  std::vector<float> pixels(const std::string &name) const
  {
    const auto input = OIIO::ImageInput::open((folder / name).string());
    std::vector<float> values(input ? std::size_t(input->spec().width) * std::size_t(input->spec().height) * 3 : 0);
    EXPECT_TRUE(input && input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, values.data()));
    return values;
  }

  bool has_vertex_layer = false;
};

TEST_F(CliShadowsTest, ThreeCubePassesGiveTheSamePicture)
{
  if (!has_vertex_layer) {
    GTEST_SKIP() << "the device has no GL_ARB_shader_viewport_layer_array";
  }
  for (const char *scene : {"plaza", "room", "spots"}) {
    json six;
    for (const std::string way : {"six", "geometry", "layered"}) {
      const Finished finished = run("render " + example(scene) + " -o " + way + ".exr --size 64x36 --samples 1 " +
                                    "--shadow-size 128 --cube-pass " + way + " --json run.json");
      ASSERT_EQ(finished.status, 0) << finished.err;
      const json frame = run_json()["frames"][0];
      six = way == "six" ? frame : six;
      EXPECT_EQ(pixels(way + ".exr"), pixels("six.exr")) << scene << ", " << way;
      EXPECT_EQ(frame["faces_drawn"], six["faces_drawn"]);
      EXPECT_EQ(frame["caster_draws"], six["caster_draws"]);
      EXPECT_GT(frame["faces_drawn"], 0);
    }
  }
}

TEST_F(CliShadowsTest, WithoutVertexLayersLayeredIsOneErrorAndBestIsGeometry)
{
  ASSERT_EQ(run("render " + example("plaza") + " -o six.exr --size 48x27 --samples 1 --cube-pass six").status, 0);
  setenv("MESA_EXTENSION_OVERRIDE", "-GL_ARB_shader_viewport_layer_array", 1);
  const Finished layered =
      run("render " + example("plaza") + " -o out.exr --size 48x27 --samples 1 --cube-pass layered");
  const Finished best = run("render " + example("plaza") + " -o best.exr --size 48x27 --samples 1");
  unsetenv("MESA_EXTENSION_OVERRIDE");
  if (layered.status == 0) {
    GTEST_SKIP() << "the driver is not Mesa: its extensions cannot be hidden";
  }
  EXPECT_EQ(layered.status, 1);
  EXPECT_NE(layered.err.find("GL_ARB_shader_viewport_layer_array"), std::string::npos) << layered.err;
  EXPECT_EQ(std::count(layered.err.begin(), layered.err.end(), '\n'), 1) << layered.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "out.exr"));
  EXPECT_EQ(best.status, 0) << best.err;
  EXPECT_EQ(pixels("best.exr"), pixels("six.exr"));
}

TEST_F(CliShadowsTest, AStillSceneUpdatesNoLampInTheSecondFrame)
{
  for (const char *method : {"hard", "pcf", "esm"}) {
    const Finished finished = run("render " + example("plaza") + " -o out.exr --size 48x27 --samples 2 --repeat 3 " +
                                  "--shadow-size 128 --json run.json --shadow " + method);
    ASSERT_EQ(finished.status, 0) << finished.err;
    const json frames = run_json()["frames"];
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(frames[0]["lamps_updated"], 2) << "plaza's point lamp and sun, " << method;
    for (const std::size_t later : {1, 2}) {
      for (const char *counter : {"lamps_updated", "faces_drawn", "faces_skipped", "caster_draws"}) {
        EXPECT_EQ(frames[later][counter], 0) << counter << ", " << method;
      }
    }
  }
}

// hazards.md: more lamps than slots, a shadow is lost silently; the array is read past its end.
TEST_F(CliShadowsTest, LampsAboveTheLimitAreNamedAndTheOthersAreDrawn)
{
  write("lamps.gltf", lamps_gltf(1000, "hard"));
  const std::string render = "render lamps.gltf -o out.exr --size 24x24 --samples 1 --shadow-memory 8 --json run.json";
  const Finished lax = run(render);
  EXPECT_EQ(lax.status, 0) << lax.err;
  EXPECT_NE(lax.err.find("limit: 745 lamps lost their shadow"), std::string::npos) << lax.err;
  // The first 255 have shadows. Ten of the others are named.
  EXPECT_EQ(lax.err.find("'lamp254'"), std::string::npos);
  EXPECT_NE(lax.err.find("'lamp255'"), std::string::npos);
  EXPECT_NE(lax.err.find("'lamp264' and 735 more"), std::string::npos) << lax.err;
  EXPECT_EQ(run_json()["non_finite"], 0);
  EXPECT_EQ(run_json()["limits"].size(), 2U) << run_json()["limits"];
  for (const float value : pixels("out.exr")) {
    EXPECT_TRUE(std::isfinite(value));
  }
  const Finished strict = run(render + " --strict");
  EXPECT_EQ(strict.status, 4) << strict.err;
}

TEST_F(CliShadowsTest, FortyThreeLampsKeepTheirShadow)
{
  write("lamps.gltf", lamps_gltf(43, "hard"));
  const Finished finished =
      run("render lamps.gltf -o out.exr --size 24x24 --samples 1 --shadow-size 64 --strict --json run.json");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_TRUE(run_json()["limits"].empty()) << run_json()["limits"];
  EXPECT_EQ(run_json()["frames"][0]["lamps_updated"], 43);
  const Finished none = run("render lamps.gltf -o none.exr --size 24x24 --samples 1 --shadow none");
  EXPECT_EQ(none.status, 0) << none.err;
  EXPECT_NE(pixels("out.exr"), pixels("none.exr"));
}

TEST_F(CliShadowsTest, MemoryBudgetReducesSizesWithAMessage)
{
  write("lamps.gltf", lamps_gltf(5, "pcf"));
  const std::string render =
      "render lamps.gltf -o out.exr --size 24x24 --samples 1 --shadow-size 1024 --shadow-memory ";
  // Five cubes of six faces of 1024² floats: 120 MiB.
  const Finished enough = run(render + "120 --strict");
  EXPECT_EQ(enough.status, 0) << enough.err;
  const Finished little = run(render + "30 --strict");
  EXPECT_EQ(little.status, 4) << little.err;
  EXPECT_NE(
      little.err.find("the shadows of 5 lamps need 120.0 MiB, and may take 30.0: their sizes are lowered to 50 %"),
      std::string::npos)
      << little.err;
}

}  // namespace
}  // namespace gnomon
