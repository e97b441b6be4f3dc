// SPDX-License-Identifier: MIT
// `gnomon --backend vulkan` on the driver.
#include "cli_process.hh"
#include "gltf/gltf_builder.hh"
#include "gpu_device_fixture.hh"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <span>
#include <vector>

namespace gnomon {
namespace {

using nlohmann::json;
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
  /** The program on a device that seems to lack \a masks of VULKAN_MASKS. */
  std::filesystem::path masked_program(const std::string &masks)
  {
    return program_with("LD_LIBRARY_PATH='" GNOMON_VULKAN_FAULTS "' VULKAN_MASKS=" + masks);
  }
  /** Lamps without shadows that reach 8 m, and glass triangles, above a plate. */
  static std::string crowd_gltf(int lamp_count, int glass_triangle_count)
  {
    test::GltfBuilder builder;
    builder.document["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_transmission"};
    builder.document["materials"] = {
        {{"doubleSided", true}},
        {{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1.0}}}}}},
    };
    const int positions = builder.positions({-10, 0, -10, 10, 0, -10, 10, 0, 10, -10, 0, 10});
    const auto add_mesh = [&](int material, const std::vector<std::uint32_t> &corners, double size) {
      const json primitive{{"attributes", {{"POSITION", positions}}},
                           {"indices", builder.accessor(corners, test::Uint32, "SCALAR")},
                           {"material", material}};
      builder.node(
          {{"mesh", builder.mesh(primitive)}, {"scale", {size, size, size}}, {"translation", {0, 1 - size, 0}}});
    };
    add_mesh(0, {0, 2, 1, 0, 3, 2}, 1);
    std::vector<std::uint32_t> corners;
    for (int i = 0; i < glass_triangle_count; i++) {
      corners.insert(corners.end(), {0, 2, 1});
    }
    if (!corners.empty()) {
      add_mesh(1, corners, 0.1);
    }
    for (int i = 0; i < lamp_count; i++) {
      const double of_ring = std::sqrt((i + 0.5) / lamp_count);
      const double angle = 2.4 * i;
      builder.light({{"type", "point"}, {"intensity", 683.0 / lamp_count}, {"range", 8}}, {{"gnomon_shadow", "none"}},
                    {{"translation", {9 * of_ring * std::cos(angle), 2.0, 9 * of_ring * std::sin(angle)}}});
    }
    return builder.gltf();
  }
  /** Expect that pictures of SwiftShader and of OpenGL with \a arguments differ by at most \a bound: vulkan.exr,
   * gl.exr. */
  void expect_of_opengl(const std::string &arguments, double bound)
  {
    for (const std::string backend : {"gl", "vulkan"}) {
      const Finished finished = run("render " + arguments + " --backend " + backend + " -o " + backend + ".exr",
                                    program_with("VK_DRIVER_FILES='" + test::swiftshader_driver() + "'"));
      ASSERT_EQ(finished.status, 0) << finished.err;
    }
    EXPECT_LE(rms_difference("gl.exr", "vulkan.exr"), bound);
  }
  /** The place of the red light in each square of 30x30 pixels, from 10 pixels to the right of the left edge on: their
   * mean. */
  glm::dvec2 mean_place_px(const std::string &name)
  {
    OIIO::ImageBuf picture((folder / name).string());
    EXPECT_TRUE(picture.read(0, 0, true));
    std::map<std::pair<int, int>, glm::dvec3> sums;
    for (OIIO::ImageBuf::ConstIterator<float> pixel(picture); !pixel.done(); ++pixel) {
      const glm::ivec2 place(pixel.x() - 10, pixel.y());
      sums[{place.x / 30, place.y / 30}] += double(pixel[0]) * glm::dvec3(place.x % 30, place.y % 30, 1.0);
    }
    std::erase_if(sums, [](const auto &entry) { return entry.second.z == 0.0; });
    EXPECT_EQ(sums.size(), 60U);
    glm::dvec2 mean(0.0);
    for (const auto &[square, sum] : sums) {
      mean += glm::dvec2(sum) / sum.z / double(sums.size());
    }
    return mean;
  }
  /** Root of the mean square difference between the pictures in two files. */
  double rms_difference(const std::string &first, const std::string &second)
  {
    OIIO::ImageBuf a((folder / first).string());
    OIIO::ImageBuf b((folder / second).string());
    // Not from the cache, in which a file that is written twice within a second is the first one.
    EXPECT_TRUE(a.read(0, 0, true) && b.read(0, 0, true));
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
  const json trace = json::parse(read("vulkan.trace"));
  for (const json &span : trace["traceEvents"]) {
    if (span["name"] == "make pipeline") {
      pipelines[span["args"]["of"]]++;
      pipeline_count++;
    }
  }
  EXPECT_FALSE(pipelines.empty());
  EXPECT_EQ(json::parse(read("vulkan.json"))["counters"]["pipelines_made"], pipeline_count);
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
    const auto seconds = json::parse(read("out.json"))["frame_seconds"].get<std::vector<double>>();
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

// Devices may have four sets of bindings, 16 inputs of vertices, texel buffers of 65 536 texels, and offsets of 256
// bytes.
TEST_F(CliVulkanTest, TheLeastLimitsOfVulkanGiveTheSamePictureAndExplainNamesTheSizes)
{
  write("crowd.gltf", crowd_gltf(1000, 12));
  for (const std::string &scene : {example("plaza"), std::string("crowd.gltf")}) {
    std::map<std::string, Finished> of_masks;
    for (const std::string masks : {"none", "limits", "shaderOutputLayer", "shaderOutputLayer,geometryShader,limits"}) {
      const Finished finished =
          run("render " + scene + " --size 64x36 --samples 1 --shadow-size 128 --lamp-units raw " +
                  "--backend vulkan --explain --json run.json -o " + masks + ".exr",
              masked_program(masks));
      ASSERT_EQ(finished.status, 0) << finished.err;
      EXPECT_EQ(finished.err.find("exceeded: "), std::string::npos) << finished.err;
      EXPECT_EQ(json::parse(read("run.json"))["limits"], json::array()) << masks;
      EXPECT_EQ(rms_difference("none.exr", masks + ".exr"), 0.0) << scene << " without " << masks;
      of_masks[masks] = finished;
    }
    const auto expect_part = [&](const std::string &masks, const std::string &part) {
      EXPECT_NE(of_masks[masks].out.find(part), std::string::npos) << masks << part << of_masks[masks].out;
    };
    if (scene == "crowd.gltf") {
      // The lists hold each lamp once for each part of the view that it reaches. Fewer parts leave the light the same.
      const auto list_texels = [&](const std::string &masks) {
        std::smatch match;
        EXPECT_TRUE(std::regex_search(of_masks[masks].out, match, std::regex("light_lists  .* ([0-9]+)x1 R32F")));
        return std::stoi(match.str(1));
      };
      EXPECT_GT(list_texels("none"), 65536);
      EXPECT_LE(list_texels("limits"), 65536);
    }
    else {
      expect_part("none", "-+ eevee_shadow_layered ");
      expect_part("limits", "-+ eevee_shadow_layered ");
      expect_part("shaderOutputLayer", "-+ eevee_shadow_geometry ");
      expect_part("shaderOutputLayer,geometryShader,limits", "-+ eevee_shadow ");
    }
  }
}

TEST_F(CliVulkanTest, WhatDoesNotFitIntoSmallTexelBuffersIsNamed)
{
  // Seven texels for each lamp, and eight for each triangle.
  write("crowd.gltf", crowd_gltf(10000, 9000));
  const std::string render = "render crowd.gltf --size 16x9 --samples 1 --shadow none --backend vulkan -o out.exr";
  EXPECT_EQ(run(render + " --strict", masked_program("none")).status, 0);
  const Finished finished = run(render, masked_program("limits"));
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.err.find("exceeded: "), std::string::npos) << finished.err;
  for (const char *part : {"limit: 638 of 10000 lamps give no light", "limit: 9000 triangles transmit light"}) {
    EXPECT_NE(finished.err.find(part), std::string::npos) << finished.err;
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
    return;
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

// SwiftShader interpolates from all three corners after it moves them. A lamp of 0.1 m height above a ground of 200 m
// sees corners near its horizon, and the ground shadowed itself in 253 of 4096 pixels, with a difference of 7e-4.
TEST_F(CliVulkanTest, OnACoarseGridOfVerticesAGroundDoesNotShadowItselfFromALowLamp)
{
  if (!test::testing_device("swiftshader")) {
    return;
  }
  test::GltfBuilder builder;
  builder.document["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.document["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 4}, {"ymag", 4}, {"znear", 0.1}, {"zfar", 100}}}}};
  const json plate{
      {"attributes", {{"POSITION", builder.positions({-100, 0, -100, 100, 0, -100, 100, 0, 100, -100, 0, 100})}}},
      {"indices", builder.accessor(std::vector<std::uint32_t>{0, 2, 1, 0, 3, 2}, test::Uint32, "SCALAR")}};
  builder.node({{"mesh", builder.mesh(plate)}});
  builder.node({{"camera", 0}, {"translation", {0, 10, 0}}, {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}});
  builder.light({{"type", "point"}, {"intensity", 6.83}}, {}, {{"translation", {0.3, 0.1, 0.2}}});
  write("ground.gltf", builder.gltf());
  expect_of_opengl("ground.gltf --size 64x64 --samples 1", 1e-6);
}

// The centres of pixels are points of the grid, so that edges along its rows and columns were half a cell beside their
// place in the mean: 0.028 and 0.030 pixels.
TEST_F(CliVulkanTest, OnACoarseGridOfVerticesEdgesAlongItStayInPlace)
{
  if (!test::testing_device("swiftshader")) {
    return;
  }
  test::GltfBuilder builder;
  builder.document["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 10.6667}, {"ymag", 6}, {"znear", 0.1}, {"zfar", 100}}}}};
  builder.document["materials"] = {{{"doubleSided", true}, {"emissiveFactor", {1, 1, 1}}}};
  const json plate{{"attributes", {{"POSITION", builder.positions({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0})}}},
                   {"indices", builder.accessor(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}, test::Uint32, "SCALAR")},
                   {"material", 0}};
  const int mesh = builder.mesh(plate);
  const auto spread = [](int i, double step) { return std::fmod(i * step, 1.0) - 0.5; };
  for (int i = 0; i < 60; i++) {
    builder.node(
        {{"mesh", mesh},
         {"translation",
          {-9 + 2 * (i % 10) + 0.6 * spread(i, 0.7548776662), -5 + 2 * (i / 10) + 0.6 * spread(i, 0.5698402910), 0}},
         {"scale", {0.5 + 0.2 * spread(i, 0.6180339887), 0.5 + 0.2 * spread(i, 0.4142135624), 1}}});
  }
  builder.node({{"camera", 0}, {"translation", {0, 0, 10}}});
  write("plates.gltf", builder.gltf());
  // Edges of single plates are still moved by up to half a cell.
  expect_of_opengl("plates.gltf --size 320x180 --samples 16 --shadow none", 0.03);
  const glm::dvec2 moved_px = mean_place_px("vulkan.exr") - mean_place_px("gl.exr");
  // The error of the mean of 60 plates is 0.001.
  EXPECT_LE(std::abs(moved_px.x), 0.01);
  EXPECT_LE(std::abs(moved_px.y), 0.01);
}

// Triangles without area had one after their corners were moved, and of plates behind each other the wrong one was
// seen.
TEST_F(CliVulkanTest, OnACoarseGridOfVerticesTrianglesAndDepthsAreStable)
{
  if (!test::testing_device("swiftshader")) {
    return;
  }
  for (const char *group : {"rendered triangles", "rendered camera"}) {
    const Finished finished = run(std::string("stability --backend vulkan -o stability --group '") + group + "'",
                                  program_with("VK_DRIVER_FILES='" + test::swiftshader_driver() + "'"));
    EXPECT_EQ(finished.status, 0) << finished.err;
  }
}

}  // namespace
}  // namespace gnomon
