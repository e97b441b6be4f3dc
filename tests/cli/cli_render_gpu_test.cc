// SPDX-License-Identifier: MIT
// `gnomon render` on the driver.
#include "cli_picture.hh"
#include "cli_process.hh"
#include "gpu_device_fixture.hh"

#include <nlohmann/json.hpp>

#include <OpenImageIO/imageio.h>

#include <sys/resource.h>
#include <sys/stat.h>
#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace gnomon {
namespace {

using test::example;
using test::Finished;

/** Page faults of all processes that have ended. */
long pages_of_children()
{
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  return used.ru_minflt;
}

class CliRenderTest : public test::ProgramTest {
 protected:
  void SetUp() override
  {
    if (!test::testing_gl_device()) {
      GTEST_SKIP() << "no device to render with";
    }
  }
};

TEST_F(CliRenderTest, WritesAPictureWithItsMetadata)
{
  const Finished finished = run("render " + example("plaza") + " -o out.exr --size 64x36 --samples 2 --seed 3");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const auto input = OIIO::ImageInput::open((folder / "out.exr").string());
  ASSERT_TRUE(input);
  EXPECT_EQ(input->spec().width, 64);
  EXPECT_EQ(input->spec().height, 36);
  EXPECT_EQ(input->spec().format, OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(input->spec().get_string_attribute("gnomon:camera"), "camera");
  EXPECT_EQ(input->spec().get_string_attribute("gnomon:samples"), "2");
  EXPECT_EQ(input->spec().get_string_attribute("gnomon:seed"), "3");
  EXPECT_EQ(input->spec().get_string_attribute("gnomon:units"), "scene-linear radiance, W/(sr m^2)");
  EXPECT_EQ(file_count(), 1U) << "nothing but the picture is left";
  EXPECT_NE(finished.out.find((folder / "out.exr").string()), std::string::npos) << "where it is: " << finished.out;
}

TEST_F(CliRenderTest, PngIsUpright)
{
  ASSERT_EQ(run("render " + example("plaza") + " -o out.png --size 64x36").status, 0);
  const auto input = OIIO::ImageInput::open((folder / "out.png").string());
  ASSERT_TRUE(input);
  ASSERT_EQ(input->spec().nchannels, 4);
  std::vector<unsigned char> pixels(std::size_t(64) * 36 * 4);
  ASSERT_TRUE(input->read_image(0, 0, 0, 4, OIIO::TypeDesc::UINT8, pixels.data()));
  // The upper left shows the background beyond the ground's far corner; the lower left shows the ground.
  EXPECT_EQ(int(pixels[0]), 0);
  EXPECT_EQ(int(pixels[3]), 0);
  EXPECT_GT(int(pixels[std::size_t(64) * 35 * 4]), 50);
  EXPECT_EQ(int(pixels[std::size_t(64) * 35 * 4 + 3]), 255);
}

TEST_F(CliRenderTest, APictureHasAlphaUnlessItHasABackground)
{
  const std::string render = "render " + example("plaza") + " --size 48x27 --samples 4 ";
  ASSERT_EQ(run(render + "-o a.exr").status, 0);
  ASSERT_EQ(run(render + "-o black.exr --background 0,0,0").status, 0);
  ASSERT_EQ(run(render + "-o black.png --background 0,0,0").status, 0);
  const auto channels = [&](const std::string &name) {
    return OIIO::ImageInput::open((folder / name).string())->spec().nchannels;
  };
  EXPECT_EQ(channels("a.exr"), 4);
  EXPECT_EQ(channels("black.exr"), 3);
  EXPECT_EQ(channels("black.png"), 3);
  EXPECT_EQ(run("compare a.exr black.exr --max-rmse 1e-7").status, 0) << "colours are multiplied by alpha";
}

TEST_F(CliRenderTest, AScenesOwnWorldIsSeenBehindItAndAnotherOnlyLights)
{
  write("scene.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"extras": {"gnomon_world": [0.25, 0.5, 1]}}]})");
  const auto expect_pixel = [&](const std::string &options, const std::vector<float> &expected) {
    SCOPED_TRACE(options);
    EXPECT_EQ(run("render scene.gltf -o out.exr --size 4x4 --samples 2 " + options).status, 0);
    const auto input = OIIO::ImageInput::open((folder / "out.exr").string());
    std::vector<float> values(std::size_t(16) * std::size_t(input->spec().nchannels));
    EXPECT_TRUE(input->read_image(0, 0, 0, input->spec().nchannels, OIIO::TypeDesc::FLOAT, values.data()));
    ASSERT_EQ(std::size_t(input->spec().nchannels), expected.size());
    for (std::size_t i = 0; i < expected.size(); i++) {
      // The mean of samples is rounded.
      EXPECT_FLOAT_EQ(values[i], expected[i]);
    }
  };
  const std::vector<float> transparent(4, 0.0F);
  expect_pixel("", {0.25F, 0.5F, 1.0F});
  expect_pixel("--world-strength 2", {0.5F, 1.0F, 2.0F});
  expect_pixel("--background none", transparent);
  expect_pixel("--world 1,2,3", transparent);
  expect_pixel("--world 1,2,3 --background world", {1.0F, 2.0F, 3.0F});
  expect_pixel("--world none", transparent);
}

TEST_F(CliRenderTest, AShadowsPictureIsGreyAndColouredAndItsExrIsInMetres)
{
  const std::string render = "render " + example("plaza") + " --size 64x36 --shadow-size 64 --debug shadow:POINT -o ";
  ASSERT_EQ(run(render + "out.png").status, 0);
  ASSERT_EQ(run(render + "out.exr").status, 0);
  const auto png = OIIO::ImageInput::open((folder / "out.png").string());
  const auto exr = OIIO::ImageInput::open((folder / "out.exr").string());
  ASSERT_TRUE(png && exr);
  ASSERT_EQ(png->spec().width, 4 * 64);
  ASSERT_EQ(png->spec().height, 3 * 64);
  EXPECT_EQ(exr->spec().get_string_attribute("gnomon:units"), "metres, 0 where nothing was drawn");
  EXPECT_EQ(exr->spec().get_string_attribute("gnomon:debug"), "shadow:POINT");
  constexpr std::size_t count = std::size_t(4) * 64 * 3 * 64;
  std::vector<unsigned char> shown(3 * count);
  std::vector<float> metres(3 * count);
  ASSERT_TRUE(png->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, shown.data()));
  ASSERT_TRUE(exr->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, metres.data()));
  std::size_t distances = 0;
  for (std::size_t i = 0; i < count; i++) {
    const bool is_grey = shown[3 * i] == shown[3 * i + 1] && shown[3 * i] == shown[3 * i + 2] && shown[3 * i] > 0;
    EXPECT_EQ(is_grey, metres[3 * i] > 0.0F) << i;
    distances += metres[3 * i] > 0.0F;
  }
  // The lower third shows only the ground; the first row shows only the background.
  EXPECT_GT(distances, std::size_t(64) * 64);
  EXPECT_EQ(metres[3 * 96], 0.0F);
  EXPECT_GT(metres[3 * (256 * 160 + 96)], 0.0F);
}

TEST_F(CliRenderTest, TexelDensityColoursAPngAndIsTheValueOfAnExr)
{
  const std::string render = "render " + example("plaza") + " --size 64x36 --shadow-size 64 --debug density:POINT -o ";
  ASSERT_EQ(run(render + "out.png").status, 0);
  ASSERT_EQ(run(render + "out.exr").status, 0);
  const auto png = OIIO::ImageInput::open((folder / "out.png").string());
  const auto exr = OIIO::ImageInput::open((folder / "out.exr").string());
  ASSERT_TRUE(png && exr);
  EXPECT_EQ(exr->spec().get_string_attribute("gnomon:units"),
            "shadow texels along the edge of a pixel, 0 where there is no shadow");
  EXPECT_EQ(exr->spec().nchannels, 3);
  constexpr std::size_t count = std::size_t(64) * 36;
  std::vector<unsigned char> shown(3 * count);
  std::vector<float> density(3 * count);
  ASSERT_TRUE(png->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, shown.data()));
  ASSERT_TRUE(exr->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, density.data()));
  std::size_t covered = 0;
  for (std::size_t i = 0; i < count; i++) {
    const bool is_grey = shown[3 * i] == shown[3 * i + 1] && shown[3 * i] == shown[3 * i + 2];
    EXPECT_EQ(is_grey, density[3 * i] == 0.0F) << i;
    // Far below the scale's end, it is red.
    EXPECT_TRUE(density[3 * i] == 0.0F || density[3 * i] > 0.2F || shown[3 * i] > 2 * shown[3 * i + 1]) << i;
    covered += density[3 * i] > 0.0F;
  }
  EXPECT_GT(covered, count / 3);
  EXPECT_LT(covered, count);
}

TEST_F(CliRenderTest, EqualSeedsGiveEqualPictures)
{
  for (const std::string name : {"a", "b"}) {
    ASSERT_EQ(run("render " + example("spots") + " -o " + name + ".exr --size 48x27 --samples 3 --seed 4").status, 0);
  }
  const auto pixels = [&](const std::string &name) {
    std::vector<float> values(std::size_t(48) * 27 * 3);
    OIIO::ImageInput::open((folder / name).string())->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, values.data());
    return values;
  };
  EXPECT_EQ(pixels("a.exr"), pixels("b.exr"));
}

/** All values of a picture. */
std::vector<float> values_of(const std::filesystem::path &path)
{
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) {
    return {};
  }
  const OIIO::ImageSpec &spec = input->spec();
  std::vector<float> values(std::size_t(spec.width) * std::size_t(spec.height) * std::size_t(spec.nchannels));
  input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data());
  return values;
}

TEST_F(CliRenderTest, LayersAreThoseOfThePicture)
{
  const Finished finished = run("render " + example("plaza") +
                                " --size 32x18 --samples 2 --world 0.1,0.2,0.3 --background world -o out.exr --aov "
                                "light,world,emission,depth,position,normal,albedo,roughness,visibility,crypto_object,"
                                "crypto_material");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const auto input = OIIO::ImageInput::open((folder / "out.exr").string());
  ASSERT_TRUE(input);
  const OIIO::ImageSpec &spec = input->spec();
  const std::vector<float> values = values_of(folder / "out.exr");
  const auto at = [&](const std::string &channel, std::size_t pixel) {
    EXPECT_GE(spec.channelindex(channel), 0) << channel;
    return values[pixel * std::size_t(spec.nchannels) + std::size_t(std::max(spec.channelindex(channel), 0))];
  };
  std::vector<std::string> lights;
  for (const std::string &name : spec.channelnames) {
    if (name.ends_with(".R") && (name.starts_with("light.") || name == "world.R" || name == "emission.R")) {
      lights.push_back(name);
    }
  }
  ASSERT_GE(lights.size(), 4U);
  int sky_count = 0;
  for (std::size_t pixel = 0; pixel < std::size_t(32) * 18; pixel++) {
    float sum = 0.0F;
    for (const std::string &name : lights) {
      sum += at(name, pixel);
    }
    EXPECT_NEAR(at("R", pixel), sum, 1e-5F * sum) << pixel;
    const bool is_sky = at("normal.X", pixel) == 0.0F && at("normal.Y", pixel) == 0.0F && at("normal.Z", pixel) == 0.0F;
    sky_count += is_sky ? 1 : 0;
    EXPECT_EQ(at("depth.Z", pixel) == 1e10F, is_sky) << pixel;
    // The largest coverage of a pixel is the first, and all of them are at most 1.
    const float first = at("CryptoObject00.G", pixel);
    const float second = at("CryptoObject00.A", pixel);
    EXPECT_GE(first, second);
    EXPECT_LE(first + second, 1.0F + 1e-5F);
  }
  EXPECT_GT(sky_count, 2);
  EXPECT_LT(sky_count, 16 * 18);
}

TEST_F(CliRenderTest, ATimeLimitKeepsTheLimitOfSamples)
{
  const std::string render = "render " + example("plaza") + " --size 16x8 --time-limit 100 --json out.json -o out.exr";
  ASSERT_EQ(run(render + " --samples 3").status, 0);
  std::ifstream file(folder / "out.json");
  EXPECT_EQ(nlohmann::json::parse(file).at("samples"), 3);
  EXPECT_EQ(run(render + " --samples 3 --tile 1/2").status, 2);
}

TEST_F(CliRenderTest, ANoiseThresholdIsOfWholePictures)
{
  const std::string render = "render " + example("plaza") + " --size 16x8 --samples 4 --noise-threshold 0.1 -o out.exr";
  EXPECT_EQ(run(render + " --json out.json").status, 0);
  std::ifstream file(folder / "out.json");
  EXPECT_NE(nlohmann::json::parse(file).at("frame_tree").dump().find("pixels that differ little from others"),
            std::string::npos);
  for (const char *part : {" --tile 1/2", " --sample-range 0-1", " --aov depth"}) {
    EXPECT_EQ(run(render + part).status, 2) << part;
  }
  EXPECT_EQ(run("render " + example("plaza") + " --noise-threshold -1 -o out.exr").status, 2);
}

TEST_F(CliRenderTest, MergedTilesAreTheWholePictureBitForBit)
{
  const std::string render = "render " + example("plaza") + " --size 64x35 --samples 2 -o ";
  ASSERT_EQ(run(render + "whole.exr").status, 0);
  for (const std::string tile : {"1", "2", "3"}) {
    ASSERT_EQ(run(render + "part" + tile + ".exr --tile " + tile + "/3").status, 0);
  }
  EXPECT_EQ(values_of(folder / "part1.exr").size(), values_of(folder / "whole.exr").size() * 11 / 35);
  const Finished merged = run("merge part3.exr part1.exr part2.exr -o merged.exr");
  ASSERT_EQ(merged.status, 0) << merged.err;
  EXPECT_EQ(values_of(folder / "merged.exr"), values_of(folder / "whole.exr"));

  const Finished incomplete = run("merge part3.exr part1.exr -o incomplete.exr");
  EXPECT_EQ(incomplete.status, 1);
  EXPECT_NE(incomplete.err.find("the parts have 1472 pixels, and the picture has 64x35: a part is missing"),
            std::string::npos)
      << incomplete.err;
  const Finished doubled = run("merge part1.exr part2.exr part3.exr part2.exr -o doubled.exr");
  EXPECT_EQ(doubled.status, 1);
  EXPECT_NE(doubled.err.find("part2.exr and part2.exr contain the same samples"), std::string::npos) << doubled.err;
  ASSERT_EQ(run("render " + example("plaza") + " --size 64x35 --samples 2 --seed 7 -o other.exr --tile 2/3").status, 0);
  const Finished other = run("merge part1.exr other.exr part3.exr -o mixed.exr");
  EXPECT_EQ(other.status, 1);
  EXPECT_NE(other.err.find("other.exr: not a part of the same picture as part1.exr: gnomon:seed is '7', not '0'"),
            std::string::npos)
      << other.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "mixed.exr"));
}

TEST_F(CliRenderTest, MergedRangesOfSamplesAreTheWholePictureToRounding)
{
  const std::string render = "render " + example("plaza") + " --size 64x36 --samples 6 -o ";
  ASSERT_EQ(run(render + "whole.exr").status, 0);
  ASSERT_EQ(run(render + "low.exr --sample-range 0-1").status, 0);
  ASSERT_EQ(run(render + "high.exr --sample-range 2-5").status, 0);
  const Finished merged = run("merge low.exr high.exr -o merged.exr");
  ASSERT_EQ(merged.status, 0) << merged.err;
  const std::vector<float> parts = values_of(folder / "merged.exr");
  const std::vector<float> whole = values_of(folder / "whole.exr");
  ASSERT_EQ(parts.size(), whole.size());
  float largest = 0.0F;
  for (std::size_t i = 0; i < whole.size(); i++) {
    largest = std::max(largest, std::abs(parts[i] - whole[i]) / (std::abs(whole[i]) + 1e-3F));
  }
  EXPECT_LE(largest, 1e-5F);
  EXPECT_NE(values_of(folder / "low.exr"), whole);
}

TEST_F(CliRenderTest, PartsWithOtherSettingsAreNotMerged)
{
  write("metal.gltf", test::variants_gltf);
  const std::string render = "render metal.gltf --size 16x16 --samples 2 ";
  ASSERT_EQ(run(render + "-o low.exr --tile 1/2 --variant red --light-threshold 0").status, 0);
  ASSERT_EQ(run(render + "-o high.exr --tile 2/2 --variant blue --light-threshold 0").status, 0);
  const std::string named = run("merge low.exr high.exr -o mixed.exr").err;
  EXPECT_NE(named.find("gnomon:settings is '--variant blue', not '--variant red'\n"), std::string::npos) << named;
  for (const std::string other :
       {"--variant blue", "", "--variant red --texture-size-max 64", "--variant red --world 1,1,1",
        "--variant red --shadow none", "--variant red --light-threshold 0.5", "--variant red --emissive-points 3",
        "--variant red --exposure 1", "--variant red --casters back", "--variant red --background 1,0,0"}) {
    ASSERT_EQ(run(render + "-o high.exr --tile 2/2 " + other).status, 0) << other;
    const Finished merged = run("merge low.exr high.exr -o mixed.exr");
    EXPECT_EQ(merged.status, 1) << other;
    EXPECT_NE(merged.err.find("high.exr: not a part of the same picture as low.exr"), std::string::npos) << merged.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "mixed.exr"));
  }
  // Defaults that are given, other spellings of numbers, and what does not change the picture.
  ASSERT_EQ(
      run(render + "-o high.exr --tile 2/2 --variant red --shadow hard --light-threshold 0.00 --only-below . --explain "
                   "--json run.json --strict --pcf 3x3")
          .status,
      0);
  const Finished merged = run("merge low.exr high.exr -o whole.exr");
  EXPECT_EQ(merged.status, 0) << merged.err;
  // The values that settings have if no option gives them. The scene's only camera is the one that the import adds.
  for (const std::string same : {"--emissive-points 4", "--emissive-points auto", "--camera default", "--aperture 0.0",
                                 "--exposure -0", "--cascade-range view"}) {
    ASSERT_EQ(run(render + "-o high.exr --tile 2/2 --variant red --light-threshold 0 " + same).status, 0) << same;
    const Finished again = run("merge low.exr high.exr -o whole.exr");
    EXPECT_EQ(again.status, 0) << same << ": " << again.err;
  }
  ASSERT_EQ(run(render + "-o high.exr --tile 2/2 --variant red --light-threshold 1e-7").status, 0);
  EXPECT_EQ(run("merge low.exr high.exr -o whole.exr").status, 1) << "all digits count";
}

TEST_F(CliRenderTest, NamesInMessagesHaveNoControlCharacters)
{
  const std::string name = R"name("$(printf 'a\033[31m\ngnomon: \302\233.gltf')")name";
  const auto has_none = [](const std::string &text) {
    return text.find('\x1b') == text.npos && text.find('\x9b') == text.npos && text.find("\ngnomon:") == text.npos;
  };
  for (const std::string &arguments : {"render " + name + " -o o.exr", "info " + name, "render s.gltf --no" + name,
                                       "render s.gltf -o " + name, "compare " + name + " b.exr", name}) {
    const Finished finished = run(arguments);
    EXPECT_NE(finished.status, 0);
    EXPECT_TRUE(has_none(finished.err)) << finished.err;
  }
}

TEST_F(CliRenderTest, PartsOfOtherContentUnderTheSameNamesAreNotMerged)
{
  const auto write_scene = [&](const std::string &color) {
    std::string gltf = test::variants_gltf;
    const std::string before = R"({"doubleSided":true})";
    write("s.gltf", gltf.replace(gltf.find(before), before.size(),
                                 R"({"doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":)" + color + "}}"));
  };
  const auto write_world = [&](float radiance) {
    cli::write_exr(folder / "w.exr", {2, 1}, std::vector<float>(8, radiance), {});
  };
  write_scene("[1,0,0,1]");
  write_world(1.0F);
  const std::string render = "render s.gltf --size 16x16 --samples 2 --world ";
  ASSERT_EQ(run(render + "w.exr -o low.exr --tile 1/2").status, 0);
  const auto status = [&] {
    EXPECT_EQ(run(render + (folder / "w.exr").string() + " -o high.exr --tile 2/2").status, 0);
    return run("merge low.exr high.exr -o both.exr").status;
  };
  EXPECT_EQ(status(), 0) << "the folder of the world may differ";
  write_world(2.0F);
  EXPECT_EQ(status(), 1);
  write_world(1.0F);
  write_scene("[0,1,0,1]");
  EXPECT_EQ(status(), 1);
}

TEST_F(CliRenderTest, FaultsThatThePictureFindsAreNamed)
{
  write("s.surface.glsl", "void surface(SurfaceInputs inputs, inout StandardSurface result)\n{\n  nonsense;\n}\n");
  std::string gltf = test::variants_gltf;
  const std::string before = R"({"doubleSided":true})";
  write("s.gltf", gltf.replace(gltf.find(before), before.size(),
                               R"({"doubleSided":true,"extras":{"gnomon_surface":"s.surface.glsl"}})"));
  for (const char *layers : {"", " --aov depth", " --aov albedo,emission"}) {
    const Finished finished = run(std::string("render s.gltf -o o.exr --size 16x16 --samples 1") + layers);
    EXPECT_EQ(finished.status, 0) << layers;
    const std::string warning = "its surface function is broken, and magenta is drawn instead: s.surface.glsl:3";
    const std::size_t found = finished.err.find(warning);
    EXPECT_NE(found, std::string::npos) << layers << finished.err;
    EXPECT_EQ(finished.err.find(warning, found + 1), std::string::npos) << layers << finished.err;
  }
}

TEST_F(CliRenderTest, OnlyBelowLeavesOutFilesElsewhere)
{
  std::filesystem::create_directories(folder / "scene" / "inner");
  std::filesystem::create_directories(folder / "scenery");
  const std::array<float, 9> triangle{-1, 0, -1, 1, 0, -1, 0, 0, 1};
  const std::string positions(reinterpret_cast<const char *>(triangle.data()), sizeof(triangle));
  for (const char *path : {"outside.bin", "scene/inside.bin", "scenery/beside.bin"}) {
    write(path, positions);
  }
  std::filesystem::create_symlink("../outside.bin", folder / "scene" / "out_link.bin");
  std::filesystem::create_symlink("../inside.bin", folder / "scene" / "inner" / "in_link.bin");
  std::filesystem::create_directory_symlink("scene", folder / "alias");
  const auto status = [&](const std::string &uri, const std::string &options) {
    write("scene/s.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"uri":")" + uri + R"(","byteLength":36}],
      "bufferViews":[{"buffer":0,"byteLength":36}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,0,-1],"max":[1,0,1]}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0})");
    const Finished finished = run("info scene/s.gltf " + options);
    EXPECT_TRUE(finished.status == 0 || finished.err.find(uri) != std::string::npos) << finished.err;
    return finished.status;
  };
  for (const char *uri : {"inside.bin", "inner/../inside.bin", "inner/in_link.bin", "../scene/inside.bin"}) {
    EXPECT_EQ(status(uri, ""), 0) << uri;
    EXPECT_EQ(status(uri, "--only-below scene"), 0) << uri;
    EXPECT_EQ(status(uri, "--only-below alias"), 0) << uri;
    EXPECT_EQ(status(uri, "--only-below '" + (folder / "scene").string() + "/'"), 0) << uri;
  }
  for (const char *uri : {"../outside.bin", "inner/../../outside.bin", "out_link.bin", "../scenery/beside.bin"}) {
    EXPECT_EQ(status(uri, ""), 0) << uri;
    EXPECT_EQ(status(uri, "--only-below scene"), 1) << uri;
  }
  EXPECT_EQ(status("../absent.bin", "--only-below scene"), 1);
  EXPECT_EQ(run("info scene/s.gltf").err.find("is not below"), std::string::npos);
  for (const char *folder_name : {"absent", "''", "outside.bin"}) {
    EXPECT_EQ(run(std::string("info scene/s.gltf --only-below ") + folder_name).status, 2) << folder_name;
  }
  EXPECT_EQ(status("inside.bin", "--only-below scene/inner"), 1);
  // Only regular files are opened.
  ASSERT_EQ(mkfifo((folder / "scene" / "fifo.bin").c_str(), 0666), 0);
  std::filesystem::create_symlink("/dev/zero", folder / "scene" / "zero.bin");
  for (const char *uri : {"fifo.bin", "zero.bin", "inner"}) {
    EXPECT_EQ(status(uri, ""), 1) << uri;
  }
}

TEST_F(CliRenderTest, BrightestAcceptedLampGivesAFinitePicture)
{
  write("bright.gltf", R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_lights_punctual"],
    "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":1e12}]}},
    "buffers":[{"uri":"data:application/octet-stream;base64,AACAvwAAAAAAAIA/AACAPwAAAAAAAIA/AAAAAAAAAAAAAIC/","byteLength":36}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,0,-1],"max":[1,0,1]}],
    "materials":[{"doubleSided":true}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
    "nodes":[{"mesh":0},{"translation":[0,1e-7,0],"extensions":{"KHR_lights_punctual":{"light":0}}}],
    "scenes":[{"nodes":[0,1]}],"scene":0})");
  const Finished finished = run("render bright.gltf -o out.exr --size 32x32 --json run.json");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(nlohmann::json::parse(read("run.json"))["non_finite"], 0);
}

TEST_F(CliRenderTest, AWhiteMetalIsWhiteInAWhiteWorldWithMultipleScattering)
{
  write("metal.gltf", test::rough_metal_gltf);
  const std::string render = "render metal.gltf --size 32x32 --samples 1 ";
  /** The most that the world adds to a pixel. */
  const auto by_world = [&](const std::string &specular) {
    EXPECT_EQ(run(render + specular + " -o both.exr --world 1,1,1").status, 0);
    EXPECT_EQ(run(render + specular + " -o sun.exr --world none").status, 0);
    const std::vector<float> both = values_of(folder / "both.exr");
    const std::vector<float> sun = values_of(folder / "sun.exr");
    float largest = 0.0F;
    for (std::size_t i = 0; i < both.size(); i++) {
      largest = std::max(largest, both[i] - sun.at(i));
    }
    return largest;
  };
  EXPECT_NEAR(by_world("--specular multi"), 1.0F, 1e-4F);
  EXPECT_LT(by_world(""), 0.6F);
  // Parts of both are not parts of one picture.
  ASSERT_EQ(run(render + "-o low.exr --tile 1/2").status, 0);
  ASSERT_EQ(run(render + "-o high.exr --tile 2/2 --specular multi").status, 0);
  const Finished merged = run("merge low.exr high.exr -o mixed.exr");
  EXPECT_EQ(merged.status, 1);
  EXPECT_NE(merged.err.find("--specular multi"), std::string::npos) << merged.err;
}

TEST_F(CliRenderTest, AWarmFrameTakesNoMemoryFromTheSystem)
{
  /** Pages that the system gave to a process which draws \a frame_count frames. */
  const auto pages = [&](int frame_count) {
    const auto before = pages_of_children();
    const Finished finished =
        run("render '" GNOMON_TEST_DATA "/scenes/forest.glb' -o out.exr --size 640x360 --samples 1 --repeat " +
            std::to_string(frame_count));
    EXPECT_EQ(finished.status, 0) << finished.err;
    return pages_of_children() - before;
  };
  pages(1);  // The next processes load compiled programs.
  // Starts of equal processes differ by up to 2600 pages. With default settings of the C library, a frame takes 2000
  // pages in most processes.
  constexpr int more_frames = 20;
  EXPECT_LT(pages(2 + more_frames) - pages(2), more_frames * 500);
}

TEST_F(CliRenderTest, WithoutADriverTheErrorNamesEachAttempt)
{
  const std::string hide =
      "env -u DISPLAY -u WAYLAND_DISPLAY __EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent VK_ICD_FILENAMES=/nonexistent "
      "VK_DRIVER_FILES=/nonexistent '" GNOMON_PROGRAM "' ";
  const std::string command =
      "cd '" + folder.string() + "' && " + hide + "render " + example("plaza") + " -o out.png 2> stderr.txt";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 5);
  const std::string err = read("stderr.txt");
  for (const char *way : {"EGL surfaceless", "EGL device", "hidden window", "Vulkan"}) {
    EXPECT_NE(err.find(way), std::string::npos) << err;
  }
}

TEST_F(CliRenderTest, TheShaderCacheChangesNoPictureWhateverIsInIt)
{
  setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1);
  const auto from_cache = [&] {
    const Finished finished =
        run("render " + example("plaza") + " -o out.exr --size 32x18 --samples 1 --json run.json");
    EXPECT_EQ(finished.status, 0) << finished.err;
    return nlohmann::json::parse(read("run.json"))["counters"]["shaders_from_cache"].get<int>();
  };
  const auto pixels = [&] {
    std::vector<float> values(std::size_t(32) * 18 * 3);
    OIIO::ImageInput::open((folder / "out.exr").string())->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, values.data());
    return values;
  };
  EXPECT_EQ(from_cache(), 0);
  const std::vector<float> cold = pixels();
  EXPECT_EQ(from_cache(), 4) << "depth, shadow, lit and film";
  EXPECT_EQ(pixels(), cold);

  const std::filesystem::path cache = folder / "cache" / "gnomon";
  for (const auto &entry : std::filesystem::directory_iterator(cache)) {
    std::ofstream(entry.path()) << "garbage";
  }
  EXPECT_EQ(from_cache(), 0);
  EXPECT_EQ(pixels(), cold);
  EXPECT_EQ(from_cache(), 4) << "garbage was replaced";

  // A file in place of the folder stands for missing permission, because root may write everywhere.
  for (const std::filesystem::perms mode : {std::filesystem::perms::none, std::filesystem::perms::owner_read}) {
    std::filesystem::permissions(cache, mode);
    from_cache();
    EXPECT_EQ(pixels(), cold);
    std::filesystem::permissions(cache, std::filesystem::perms::owner_all);
  }
  std::filesystem::remove_all(cache);
  std::ofstream(cache) << "in the way";
  EXPECT_EQ(from_cache(), 0);
  EXPECT_EQ(pixels(), cold);
}

/** All models of Debian's assimp-testmodels, including the malformed ones. */
TEST_F(CliRenderTest, TestModelsAreRenderedOrRefusedWithAMessage)
{
  const std::filesystem::path models = "/usr/share/assimp/models";
  if (!std::filesystem::exists(models)) {
    ASSERT_EQ(std::getenv("CI"), nullptr) << "assimp-testmodels is not installed";
    GTEST_SKIP() << "assimp-testmodels is not installed";
  }
  // The other files of glTF 2.0 can be drawn, and must be.
  const std::set<std::string> faulty = {"BoxWithInfinites-glTF-Binary",
                                        "IndexOutOfRange",
                                        "MissingBin",
                                        "RecursiveNodes",
                                        "SchemaFailures",
                                        "TestNoRootNode",
                                        "wrongTypes"};
  int done = 0;
  const auto expect_done = [&](const std::string &command, const std::filesystem::path &path, bool is_faulty) {
    const Finished finished = run(command);
    EXPECT_TRUE(finished.status == 0 || (finished.status == 1 && is_faulty)) << command << ": " << finished.err;
    if (finished.status == 1) {
      EXPECT_NE(finished.err.find(path.filename().string()), std::string::npos) << finished.err;
    }
    done += finished.status == 0;
    return finished.status == 0;
  };
  const std::string options = " --size 64x36 --samples 2";
  // Files that must be drawn, by the names of their pictures: a process draws all files of a group, because it takes
  // longer to start than to draw one.
  std::vector<std::map<std::string, std::string>> groups;
  for (const char *kind : {"glTF", "glTF2"}) {
    for (const auto &entry : std::filesystem::recursive_directory_iterator(models / kind)) {
      const std::filesystem::path &path = entry.path();
      if (path.extension() != ".gltf" && path.extension() != ".glb") {
        continue;
      }
      const std::string file = "'" + path.string() + "'";
      const bool is_faulty = std::string_view(kind) == "glTF" || faulty.contains(path.parent_path().filename());
      expect_done("info " + file, path, is_faulty);
      if (!is_faulty) {
        auto group =
            std::ranges::find_if(groups, [&](const auto &files) { return !files.contains(path.stem().string()); });
        group = group == groups.end() ? groups.emplace(group) : group;
        group->emplace(path.stem().string(), file);
      }
      else if (expect_done("render " + file + " -o out.png --json run.json" + options, path, is_faulty)) {
        EXPECT_EQ(nlohmann::json::parse(read("run.json"))["non_finite"], 0) << file;
      }
    }
  }
  for (const auto &files : groups) {
    std::string render = "render";
    for (const auto &[name, file] : files) {
      render += " " + file;
      std::filesystem::remove(folder / (name + ".json"));
    }
    const Finished finished = run(render + " -o '{scene}.png' --json '{scene}.json'" + options);
    EXPECT_EQ(finished.status, 0) << finished.err;
    for (const auto &[name, file] : files) {
      ASSERT_TRUE(std::filesystem::exists(folder / (name + ".json"))) << file << ": " << finished.err;
      EXPECT_EQ(nlohmann::json::parse(read(name + ".json"))["non_finite"], 0) << file;
      done++;
    }
  }
  EXPECT_GT(done, 40);
}

}  // namespace
}  // namespace gnomon
