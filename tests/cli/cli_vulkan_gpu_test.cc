// SPDX-License-Identifier: MIT
// `gnomon --backend vulkan` on the driver.
#include "cli_process.hh"
#include "gpu_device_fixture.hh"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <span>
#include <vector>

namespace gnomon {
namespace {

using test::example;
using test::Finished;

class CliVulkanTest : public test::ProgramTest {
 protected:
  void SetUp() override
  {
    if (!test::testing_device("vulkan") && !HasFailure()) {
      GTEST_SKIP();
    }
  }
  /** The program with \a variables of the environment. */
  std::filesystem::path program_with(const std::string &variables)
  {
    write("program", "exec env " + variables + " '" GNOMON_PROGRAM "' \"$@\"\n");
    std::filesystem::path path = folder / "program";
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }
  /** Root of the mean square difference between the pictures in two files. */
  double rms_difference(const std::string &first, const std::string &second)
  {
    OIIO::ImageBuf a((folder / first).string());
    OIIO::ImageBuf b((folder / second).string());
    EXPECT_TRUE(a.read() && b.read());
    return OIIO::ImageBufAlgo::compare(a, b, 1.0F, 1.0F).rms_error;
  }
};

TEST_F(CliVulkanTest, ThePictureIsThatOfOpenGl)
{
  for (const std::string backend : {"gl", "vulkan"}) {
    const Finished finished = run("render " + example("plaza") + " --size 64x36 --samples 2 --backend " + backend +
                                  " -o " + backend + ".exr --json " + backend + ".json --trace " + backend + ".trace");
    ASSERT_EQ(finished.status, 0) << finished.err;
  }
  EXPECT_NE(read("vulkan.json").find("\"Vulkan 1."), std::string::npos);
  EXPECT_NE(read("gl.json").find("\"OpenGL"), std::string::npos);
  // Mesa compiles GLSL and SPIR-V in two ways, so that the last digits differ.
  EXPECT_LE(rms_difference("gl.exr", "vulkan.exr"), 1e-5);
  // The states with which a program is drawn seldom differ, so that few pipelines are made.
  std::map<std::string, int> pipelines;
  int pipeline_count = 0;
  const nlohmann::json trace = nlohmann::json::parse(read("vulkan.trace"));
  for (const nlohmann::json &span : trace["traceEvents"]) {
    if (span["name"] == "make pipeline") {
      pipelines[span["args"]["of"]]++;
      pipeline_count++;
    }
  }
  EXPECT_FALSE(pipelines.empty());
  EXPECT_EQ(nlohmann::json::parse(read("vulkan.json"))["counters"]["pipelines_made"], pipeline_count);
  for (const auto &[program, count] : pipelines) {
    EXPECT_LE(count, 2) << program;
  }
}

// lavapipe made members of uniform blocks that bound loops constants, and compiled the program again in each frame.
// From its cache on disk, which is off here, it then took 0.01 s, and 0.4 s otherwise.
TEST_F(CliVulkanTest, AProgramIsNotCompiledAgainInWarmFrames)
{
  for (const std::string lights : {"", "--world 1,1,1 "}) {
    const Finished finished = run("render " + example("plaza") + " " + lights +
                                      "--size 16x9 --samples 1 --repeat 4 --backend vulkan -o out.exr --json out.json",
                                  program_with("MESA_SHADER_CACHE_DISABLE=true"));
    ASSERT_EQ(finished.status, 0) << finished.err;
    const auto seconds = nlohmann::json::parse(read("out.json"))["frame_seconds"].get<std::vector<double>>();
    // The driver counts no compilations. The shortest of the frames is not that which something else has held up.
    EXPECT_LT(std::ranges::min(std::span(seconds).subspan(1)), 0.1 * seconds.front()) << lights;
  }
}

// Devices lack layers in vertex shaders, geometry shaders, or both.
TEST_F(CliVulkanTest, EachWayOfDrawingLayersGivesTheSamePictureAndExplainNamesIt)
{
  const std::map<std::string, std::string> programs{
      {"layered", "eevee_shadow_layered"}, {"geometry", "eevee_shadow_geometry"}, {"six", "eevee_shadow"}};
  for (const auto &[way, program] : programs) {
    const Finished finished =
        run("render " + example("plaza") + " --size 64x36 --samples 1 --shadow-size 128 --backend vulkan --explain " +
            "--cube-pass " + way + " -o " + way + ".exr");
    ASSERT_EQ(finished.status, 0) << finished.err;
    for (const auto &[other, other_program] : programs) {
      EXPECT_EQ(finished.out.find("-+ " + other_program + " ") != std::string::npos, other == way) << finished.out;
    }
    EXPECT_EQ(rms_difference("geometry.exr", way + ".exr"), 0.0) << way;
  }
}

TEST_F(CliVulkanTest, AutoTakesItWhereOpenGlDoesNotStartAndSaysWhy)
{
  const Finished finished =
      run("render " + example("plaza") + " --size 16x9 -o out.exr",
          program_with("-u DISPLAY -u WAYLAND_DISPLAY __EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent"));
  EXPECT_EQ(finished.status, 0) << finished.err;
  for (const char *part : {"gnomon: backend: Vulkan 1.", "because OpenGL does not start", "EGL surfaceless"}) {
    EXPECT_NE(finished.err.find(part), std::string::npos) << finished.err;
  }
}

TEST_F(CliVulkanTest, WithoutADriverTheErrorIsThatOfVulkanAlone)
{
  const Finished finished = run("render " + example("plaza") + " --backend vulkan -o out.exr",
                                program_with("VK_ICD_FILENAMES=/nonexistent VK_DRIVER_FILES=/nonexistent"));
  EXPECT_EQ(finished.status, 5);
  EXPECT_NE(finished.err.find("Vulkan: there is no driver"), std::string::npos) << finished.err;
  EXPECT_EQ(finished.err.find("EGL"), std::string::npos) << finished.err;
}

// SwiftShader moves vertices to a grid of 1/16 pixels. Positions from depths were off the planes of surfaces, which
// then shadowed themselves: the pictures differed by 0.058 to 0.18.
TEST_F(CliVulkanTest, OnACoarseGridOfVerticesPlanesDoNotShadowThemselves)
{
  const auto device = test::testing_device("swiftshader");
  if (!device) {
    GTEST_SKIP();
  }
  EXPECT_EQ(device->limits().subpixel_bits, 4);
  for (const std::string scene : {"spots", "room", "plaza"}) {
    std::string out;
    for (const std::string backend : {"gl", "vulkan"}) {
      const Finished finished = run("render " + example(scene) + " --size 64x36 --samples 16 --explain --backend " +
                                        backend + " -o " + backend + ".exr",
                                    program_with("VK_DRIVER_FILES='" + test::swiftshader_driver() + "'"));
      ASSERT_EQ(finished.status, 0) << finished.err;
      out = finished.out;
    }
    // It has neither layers in vertex shaders nor geometry shaders.
    EXPECT_NE(out.find("-+ eevee_shadow "), std::string::npos) << out;
    // Edges are moved by up to half of a cell: measured 0.0013 to 0.0023.
    EXPECT_LE(rms_difference("gl.exr", "vulkan.exr"), 0.005) << scene;
  }
}

}  // namespace
}  // namespace gnomon
