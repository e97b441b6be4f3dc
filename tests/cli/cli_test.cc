// SPDX-License-Identifier: MIT
// Exit statuses, messages and files of the command line, without a driver.
#include "cli_cryptomatte.hh"
#include "cli_explain.hh"
#include "cli_output.hh"
#include "cli_picture.hh"
#include "cli_process.hh"
#include "cli_values.hh"

#include "eevee_frame_text.hh"
#include "eevee_picture_layers.hh"

#include <nlohmann/json.hpp>

#include <OpenImageIO/imageio.h>

#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <utility>

namespace gnomon {
namespace {

using test::example;
using test::Finished;
using test::values_in;
using test::write_values;

class CliTest : public test::ProgramTest {};

TEST_F(CliTest, HelpAndVersionSucceed)
{
  EXPECT_EQ(run("--help").status, 0);
  EXPECT_EQ(run("render --help").status, 0);
  EXPECT_EQ(run("--version").out, "gnomon 0.1.0\n");
}

TEST_F(CliTest, HelpOfAPlanNamesItsOwnOptionsOnly)
{
  const std::string help = run("plan --help").out;
  const std::size_t footer = help.find("Options that do not go together:");
  ASSERT_NE(footer, std::string::npos) << help;
  EXPECT_NE(help.find("--debug excludes --aov.", footer), std::string::npos) << help;
  for (std::size_t at = footer; (at = help.find("--", at)) != help.npos; at++) {
    const std::string option = help.substr(at, help.find_first_of(" ,.", at) - at);
    EXPECT_LT(help.find("  " + option + " "), footer) << option;
  }
  EXPECT_NE(run("merge --help").out.find("gnomon plan"), std::string::npos);
}

TEST_F(CliTest, StartsWithoutTheHundredsOfLibrariesOfAnImageLibrary)
{
  // The loader lists all libraries, those of libraries too, and runs nothing.
  ASSERT_EQ(std::system(("LD_TRACE_LOADED_OBJECTS=1 '" GNOMON_PROGRAM "' > '" + folder.string() + "/list'").c_str()),
            0);
  const std::string list = read("list");
  EXPECT_NE(list.find("libEGL"), std::string::npos) << list;
  EXPECT_EQ(list.find("libOpenImageIO"), std::string::npos) << list;
  EXPECT_LT(std::ranges::count(list, '\n'), 60) << list;
}

TEST_F(CliTest, WrongUsageHasStatusTwoAndAReason)
{
  for (const std::string arguments : {"",
                                      "paint",
                                      "render",
                                      "render x.glb",
                                      "render x.glb -o x.jpg",
                                      "render x.glb -o x.png --size 64",
                                      "render x.glb -o x.png --size 0x9",
                                      "render x.glb -o x.png --size 64x64x",
                                      "render x.glb -o x.png --size 4294967297x1",
                                      "render x.glb -o x.png --exposure nan",
                                      "render x.glb -o x.png --samples 0",
                                      "render x.glb -o x.png --samples many",
                                      "render x.glb -o x.png --shadow soft",
                                      "render x.glb -o x.png --specular double",
                                      "render x.glb -o x.png --what",
                                      "render x.glb -o x.png --backend metal",
                                      "render x.glb -o x.png --tile ''",
                                      "render x.glb -o x.png --frames=",
                                      "render x.glb -o x.png --json ''",
                                      "render '' -o x.png",
                                      "merge x.exr '' -o y.exr",
                                      "shaders check --manifest ''",
                                      "plan x.glb -o jobs --backend null",
                                      "report x.glb -o out --backend null",
                                      "stability -o out --backend null",
                                      "view --backend null",
                                      "render x.glb -o x.png --shadow-size -4",
                                      "render x.glb -o x.png --cascade-lambda nan",
                                      "bench",
                                      "bench lunch",
                                      "bench shadows --rounds 0"}) {
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.status, 2) << arguments;
    EXPECT_TRUE(finished.err.starts_with("gnomon")) << finished.err;
    EXPECT_EQ(std::ranges::count(finished.err, '\n'), 1) << finished.err;
  }
}

TEST_F(CliTest, APictureBeyondTheLimitOfTheDeviceIsWrongUsage)
{
  const std::string scene = example("plaza") + " --backend null --size ";
  for (const std::string command : {"render --samples 1 -o x.exr ", "bench memory "}) {
    for (const std::string size : {"16385x1", "1x16385", "2147483647x2147483647"}) {
      const Finished finished = run(command + scene + size);
      EXPECT_EQ(finished.status, 2) << command << size;
      EXPECT_EQ(finished.err, "gnomon: --size '" + size +
                                  "' is not from 1x1 to 16384x16384 pixels, the largest picture of the device\n");
    }
    EXPECT_EQ(run(command + scene + "16384x1").status, 0);
  }
}

TEST_F(CliTest, AnUnknownNameIsNamedWithSimilarOnes)
{
  for (const auto &[arguments, reason] :
       {std::pair("rend x.glb", "gnomon: there is no command 'rend' (similar: render); 'gnomon --help'"),
        {"bench lunch", "gnomon bench: there is no command 'lunch'; 'gnomon bench --help'"},
        {"x.glb -o x.png", "gnomon: there is no command 'x.glb'; "},
        {"render x.glb -o x.png --sampels 4", "gnomon render: there is no option '--sampels' (similar: --samples); "},
        {"render x.glb -o x.png --tex=4", "gnomon render: there is no option '--tex' (similar: --texture-size-max); "},
        {"render x.glb -o x.png --width 4", "gnomon render: there is no option '--width'; "},
        {"compare a.exr b.exr c.exr", "gnomon compare: 'c.exr' is one argument too many; "}}) {
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.status, 2) << arguments;
    EXPECT_TRUE(finished.err.starts_with(reason)) << finished.err;
  }
}

TEST_F(CliTest, LayersThatThereAreNotAreNamedWithThoseThatThereAre)
{
  const Finished png = run("render a.glb -o a.png --aov depth");
  EXPECT_EQ(png.status, 2);
  EXPECT_NE(png.err.find("a PNG has none"), std::string::npos) << png.err;
  for (const std::string name : {"motion", "", "depth.Sun", "combined.", "lights"}) {
    const Finished unknown = run("render a.glb -o a.exr --aov albedo," + name);
    EXPECT_EQ(unknown.status, 2) << name;
    EXPECT_NE(unknown.err.find("no layer '" + name + "'; there are: combined, depth,"), std::string::npos)
        << unknown.err;
  }
  const std::string render = "render " + example("plaza") + " -o a.exr --backend null --size 8x8 --aov ";
  const Finished lamp = run(render + "light.NOBODY");
  EXPECT_EQ(lamp.status, 1);
  EXPECT_NE(lamp.err.find("no lamp 'NOBODY'; visible lamps: POINT, SUN"), std::string::npos) << lamp.err;
  EXPECT_EQ(run(render + "light,visibility.SUN,crypto_object").status, 0);
}

TEST_F(CliTest, EachLayerOfAFileIsAcceptedAndDescribed)
{
  std::ifstream file(GNOMON_SOURCE "/doc/layers.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  std::string all;
  for (const eevee::PictureLayer &layer : eevee::picture_layers) {
    const std::string name(layer.name);
    const bool is_in_files = layer.source != eevee::LayerSource::Ids;
    EXPECT_EQ(page.find('`' + name + '`') != std::string::npos, is_in_files) << name;
    if (is_in_files) {
      all += (all.empty() ? "" : ",") + name;
    }
    if (is_in_files && !layer.channels.empty() && layer.source != eevee::LayerSource::Picture) {
      const std::string channel = name + (layer.has_lamps() ? ".LAMP." : ".") + layer.channels.front();
      EXPECT_NE(page.find('`' + channel + '`'), std::string::npos) << channel;
    }
  }
  EXPECT_EQ(run("render " + example("plaza") + " -o a.exr --backend null --size 8x8 --aov " + all).status, 0) << all;
}

// ---- Cryptomatte ----

TEST(Cryptomatte, HashesAndIdsAreThoseOfTheSpecification)
{
  EXPECT_EQ(eevee::murmur_hash3(""), 0U);
  EXPECT_EQ(eevee::murmur_hash3("hello"), 0x248BFA47U);
  EXPECT_EQ(eevee::murmur_hash3("The quick brown fox jumps over the lazy dog"), 0x2E4FF723U);
  EXPECT_FLOAT_EQ(eevee::cryptomatte_id("hello"), 6.0705627102400005616e-17F);
  EXPECT_FLOAT_EQ(eevee::cryptomatte_id("cube"), -4.08461912519e+15F);
  EXPECT_FLOAT_EQ(eevee::cryptomatte_id("sphere"), 2.79018604383e+15F);
  EXPECT_FLOAT_EQ(eevee::cryptomatte_id("plane"), 3.66557617593e-11F);
  // A hash with an exponent of infinities and NaN.
  ASSERT_EQ(eevee::murmur_hash3("454"), 0xFFBFFB25U);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(eevee::cryptomatte_id("454")), 0xFF3FFB25U);
}

TEST(Cryptomatte, RanksAreByCoverageAndEqualNamesAreOneThing)
{
  const std::vector<std::string> names = {"", "cube", "sphere", "cube", "a", "b", "c", "d", "e"};
  const std::vector<std::vector<eevee::Coverage>> pixels = {
      {{2, 0.5F}, {1, 0.3F}, {3, 0.25F}},
      {},
      {{1, 0.3F}, {2, 0.2F}, {4, 0.15F}, {5, 0.1F}, {6, 0.09F}, {7, 0.08F}, {8, 0.01F}}};
  const cli::Cryptomatte matte = cli::make_cryptomatte("CryptoObject", pixels, names);
  ASSERT_EQ(matte.layers.size(), 3U);
  EXPECT_EQ(matte.layers[2].name, "CryptoObject02");
  EXPECT_EQ(matte.layers[0].channels, "RGBA");
  const float cube = eevee::cryptomatte_id("cube");
  const float sphere = eevee::cryptomatte_id("sphere");
  EXPECT_EQ(matte.layers[0].values,
            (std::vector<float>{cube, 0.55F, sphere, 0.5F, 0, 0, 0, 0, cube, 0.3F, sphere, 0.2F}));
  EXPECT_EQ(matte.layers[2].values[11], 0.08F) << "the seventh thing is left out";
  const auto entry = [&](const std::string &name) {
    // The first seven digits of the hash of CryptoObject.
    const auto found =
        std::ranges::find(matte.metadata, "cryptomatte/3ae39a5/" + name, &std::pair<std::string, std::string>::first);
    return found == matte.metadata.end() ? "" : found->second;
  };
  EXPECT_EQ(entry("name"), "CryptoObject");
  EXPECT_EQ(entry("hash"), "MurmurHash3_32");
  EXPECT_EQ(entry("conversion"), "uint32_to_float32");
  const auto manifest = nlohmann::json::parse(entry("manifest"));
  EXPECT_EQ(manifest.size(), 7U);
  EXPECT_EQ(manifest["cube"], fmt::format("{:08x}", std::bit_cast<std::uint32_t>(cube)));
}

TEST_F(CliTest, MissingSceneIsNamedAndFails)
{
  for (const std::string command : {"info nowhere.glb", "render nowhere.glb -o out.png --backend null"}) {
    const Finished finished = run(command);
    EXPECT_EQ(finished.status, 1);
    EXPECT_NE(finished.err.find("nowhere.glb"), std::string::npos) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  }
}

TEST_F(CliTest, AMissingFolderIsFoundBeforeTheWork)
{
  const Finished finished = run("render " + example("plaza") + " -o nowhere/out.png");
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("nowhere/out.png"), std::string::npos) << finished.err;
}

TEST_F(CliTest, ANameThatAFileDoesNotHaveIsAnErrorThatListsThoseThatItHas)
{
  write("sky.hdr", "none is read");
  const std::string plaza = example("plaza");
  const std::string walk = GNOMON_SOURCE "/examples/scenes/walk.gltf";
  for (const auto &[arguments, message] :
       {std::pair(plaza + " --camera zz", "no camera 'zz'; it has: camera"),
        {plaza + " --variant zz", "has no variant 'zz'; it has none"},
        {walk + " --frames 0-1 --animation zz -o 'f_#.exr'", "no animation 'zz'; it has: "},
        {plaza + " --world sky.hdr --world-layer zz", "sky.hdr: has no layer 'zz'"},
        {plaza + " --debug shadow:zz:0", "no lamp 'zz'; lamps with a visible shadow: "}}) {
    const Finished finished = run("render --backend null " + arguments);
    EXPECT_EQ(finished.status, 1) << arguments;
    EXPECT_NE(finished.err.find(message), std::string::npos) << arguments << finished.err;
  }
}

TEST_F(CliTest, APipeOrDeviceIsRefusedWhereAFileIsRead)
{
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0666), 0);
  std::filesystem::create_symlink("fifo", folder / "link");
  write("empty.exr", "");
  const std::string scene = example("plaza");
  for (const std::string file : {"fifo", "link", "/dev/zero"}) {
    for (const std::string &command :
         std::vector<std::string>{"info " + scene + " --world @", "info @", "compare @ empty.exr", "merge @ -o out.exr",
                                  "merge --plan @", "render --part @:0", "shaders check --manifest @"}) {
      std::string arguments = command;
      arguments.replace(arguments.find('@'), 1, file);
      const Finished finished = run(arguments);
      EXPECT_EQ(finished.status, 1) << arguments << finished.err;
      EXPECT_NE(finished.err.find(file + ": "), std::string::npos) << arguments << finished.err;
    }
  }
  // The descriptor that a shell makes for `<(…)` is read.
  write("piped.sh", "#!/bin/bash\nexec '" GNOMON_PROGRAM "' \"$@\" --manifest <(echo '{')\n");
  std::filesystem::permissions(folder / "piped.sh", std::filesystem::perms::owner_all);
  EXPECT_NE(run("shaders check", folder / "piped.sh").err.find("no JSON: "), std::string::npos);
  EXPECT_NE(run("merge --plan .").err.find(".: not a plan: is a folder"), std::string::npos);
  EXPECT_NE(run("merge --plan missing.json").err.find("cannot be read: No such file or directory"), std::string::npos);
}

TEST_F(CliTest, InvalidDebugViewIsWrongUsage)
{
  for (const std::string view : {"depth", "shadow", "shadow:", "shadow::1", "shadow:SUN:", "shadow:SUN:first",
                                 "shadow:SUN:-1", "cascades:SUN", "density", "density:", "shadow:POINT:+x"}) {
    const Finished finished = run("render " + example("plaza") + " --backend null --debug " + view);
    EXPECT_EQ(finished.status, 2) << view;
    EXPECT_NE(finished.err.find("--debug '" + view + "'"), std::string::npos) << finished.err;
  }
}

TEST_F(CliTest, UnknownDebugViewNamesTheExistingOnes)
{
  const auto error = [&](const std::string &arguments) {
    const Finished finished = run("render " + arguments + " --backend null --size 64x36 --shadow-size 64");
    EXPECT_EQ(finished.status, 1) << arguments;
    return finished.err;
  };
  const auto expect_error = [&](const std::string &arguments, const std::string &text) {
    const std::string err = error(arguments);
    EXPECT_NE(err.find(text), std::string::npos) << err;
  };
  expect_error(example("plaza") + " --debug shadow:LAMP", "no lamp 'LAMP'; lamps with a visible shadow: POINT, SUN");
  expect_error(example("plaza") + " --debug shadow:POINT:6", "no layer '6'; it has, from 0: +X, -X, +Y, -Y, +Z, -Z");
  expect_error(example("plaza") + " --debug shadow:SUN:octahedral --cascades 2",
               "no layer 'octahedral'; it has, from 0: cascade 0 of 2, cascade 1 of 2");
  expect_error(example("plaza") + " --debug shadow:POINT:1 --shadow esm", "no layer '1'; it has, from 0: octahedral");
  expect_error(example("plaza") + " --debug shadow:SUN --shadow none",
               "lamp 'SUN' has no visible shadow; lamps with a visible shadow: none");
  expect_error(example("spots") + " --debug cascades", "no sun has a shadow");
  expect_error(example("plaza") + " --debug density:LAMP", "no lamp 'LAMP'; lamps with a visible shadow: POINT, SUN");
  expect_error(example("plaza") + " --debug density:SUN --shadow none",
               "lamp 'SUN' has no visible shadow; lamps with a visible shadow: none");
  for (const std::string view : {"shadow:SUN:0", "shadow:SUN:all", "shadow:POINT:5", "shadow:POINT:-Z", "cascades",
                                 "density:SUN", "density:POINT"}) {
    const Finished finished =
        run("render " + example("plaza") + " --backend null --size 64x36 --shadow-size 64 --debug " + view);
    EXPECT_EQ(finished.status, 0) << view << ": " << finished.err;
  }
}

TEST_F(CliTest, InfoPrintsTheContentsOfAScene)
{
  const Finished finished = run("info " + example("plaza"));
  EXPECT_EQ(finished.status, 0) << finished.err;
  // shared/tools/reference_scene.py: a ground and 14 objects; 420 W over 4π sr, and 2 W/m².
  EXPECT_NE(finished.out.find("15 objects of 15 meshes"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("lamp 'POINT', point, 33.4225 W/sr"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("lamp 'SUN', sun, 2 W/m²"), std::string::npos) << finished.out;
}

TEST_F(CliTest, AScenesOwnWorldIsUsedAndOptionsOverrideIt)
{
  const auto write_scene = [this](const std::string &world) {
    write("scene.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"extras": {"gnomon_world": )" + world + "}}]}");
  };
  const auto info = [this](const std::string &options) {
    const Finished finished = run("info scene.gltf " + options);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return finished.out + finished.err;
  };
  write_scene("[0.25, 0.5, 1]");
  EXPECT_NE(info("").find("  world, 0.25, 0.5, 1 W/(sr m²)\n"), std::string::npos) << info("");
  EXPECT_NE(info("--world-strength 2").find("world, 0.5, 1, 2 W"), std::string::npos);
  EXPECT_NE(info("--world 1,2,3").find("world, 1, 2, 3 W"), std::string::npos);
  EXPECT_EQ(info("--world none").find("world,"), std::string::npos);
  std::vector<float> texels(4 * 8, 0.5F);
  cli::write_exr(folder / "sky.exr", {4, 2}, texels, {});
  write_scene("\"sky.exr\"");
  EXPECT_NE(info("").find("world, picture 'sky.exr', 4x2"), std::string::npos) << info("");
  EXPECT_EQ(run("render scene.gltf --backend null --size 16x9 --samples 1").status, 0);
  // The second texel of the last row, which is the first of the file's.
  texels[4] = std::numeric_limits<float>::quiet_NaN();
  cli::write_exr(folder / "sky.exr", {4, 2}, texels, {});
  EXPECT_NE(info("").find("world: its picture: 1 of 8 texels not a number (the first at 1, 1 from the top left)"),
            std::string::npos)
      << info("");
  // Each but the strength is within the limit.
  texels[4] = 1e30F;
  cli::write_exr(folder / "sky.exr", {4, 2}, texels, {});
  EXPECT_EQ(info("").find("warning: world"), std::string::npos) << info("");
  const std::string beyond =
      "world: its picture: 1 of 8 texels above 1e+30 by its color and strength (the first at 1, 1 from the top left)";
  EXPECT_NE(info("--world-strength 10").find(beyond), std::string::npos) << info("--world-strength 10");
  EXPECT_NE(info("--world sky.exr --world-strength 10").find(beyond), std::string::npos);
  EXPECT_NE(info("--world 1e30,1,1 --world-strength 10").find("world: its color times its strength is 1e+31, 10, 10"),
            std::string::npos);
  write("sky.exr", "no picture");
  EXPECT_NE(info("").find("scene: its world is left out: sky.exr: "), std::string::npos) << info("");
  for (const char *command : {"info", "render --backend null"}) {
    const Finished finished = run(std::string(command) + " scene.gltf --world nowhere.hdr");
    EXPECT_EQ(finished.status, 1) << command;
    EXPECT_NE(finished.err.find("nowhere.hdr: "), std::string::npos) << finished.err;
  }
  const Finished bench = run("bench start scene.gltf --rounds 1 --backend null --world nowhere.hdr");
  EXPECT_EQ(bench.status, 1);
  EXPECT_NE(bench.err.find("info scene.gltf --world-strength 1 --world-rotation 0 --world nowhere.hdr: failed"),
            std::string::npos)
      << bench.err;
}

TEST_F(CliTest, NullBackendReportsThatItWritesNoPicture)
{
  const Finished finished = run("render " + example("plaza") + " -o out.png --backend null --size 32x32 --samples 2");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.err.find("no picture is written"), std::string::npos);
  EXPECT_EQ(file_count(), 0U);
}

TEST_F(CliTest, JsonHasTimesCountersAndTheFrameTree)
{
  const Finished finished =
      run("render " + example("room") + " --backend null --size 64x32 --samples 2 --repeat 3 --json run.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const nlohmann::json json = nlohmann::json::parse(read("run.json"));
  EXPECT_EQ(json["frame_seconds"].size(), 3U);
  for (const nlohmann::json &seconds : json["frame_seconds"]) {
    EXPECT_GE(seconds.get<double>(), 0.0);
  }
  // Four point lamps with six faces each, in the first frame only.
  EXPECT_EQ(json["frames"][0]["lamps_updated"], 4);
  EXPECT_EQ(json["frames"][0]["faces_drawn"], 24);
  EXPECT_EQ(json["frames"][1]["lamps_updated"], 0);
  EXPECT_EQ(json["limits"].size(), 0U);
  EXPECT_EQ(json["non_finite"], 0);
  EXPECT_GT(json["counters"]["draws"].get<int>(), 0);
  for (const char *list : {"made", "left_out"}) {
    EXPECT_FALSE(json[list].empty());
    for (const nlohmann::json &part : json[list]) {
      EXPECT_FALSE(part["what"].get<std::string>().empty());
      EXPECT_FALSE(part["why"].get<std::string>().empty());
    }
  }
}

TEST_F(CliTest, RepeatedPicturesCanDrawTheirShadowsAnew)
{
  const Finished finished =
      run("render " + example("room") + " --backend null --size 64x32 --repeat 3 --redraw-shadows --json run.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  for (const nlohmann::json &frame : nlohmann::json::parse(read("run.json"))["frames"]) {
    EXPECT_EQ(frame["faces_drawn"], 24);
  }
}

/** A glTF file with \a count point lamps and no other content. */
std::string lamps_gltf(int count)
{
  nlohmann::json nodes = nlohmann::json::array();
  nlohmann::json roots = nlohmann::json::array();
  for (int i = 0; i < count; i++) {
    nodes.push_back({{"name", "lamp" + std::to_string(i)},
                     {"translation", {0.1 * i, 1.0, 0.0}},
                     {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    roots.push_back(i);
  }
  const nlohmann::json gltf = {
      {"asset", {{"version", "2.0"}}},
      {"extensionsUsed", {"KHR_lights_punctual"}},
      {"extensions", {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}, {"intensity", 683}}}}}}}},
      {"nodes", nodes},
      {"scenes", {{{"nodes", roots}}}},
      {"scene", 0}};
  return gltf.dump();
}

TEST_F(CliTest, TraceHasTheTimesOfTheParts)
{
  const Finished finished =
      run("render " + example("plaza") + " --backend null --size 8x8 --shadow-size 64 --trace trace.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const nlohmann::json events = nlohmann::json::parse(read("trace.json"))["traceEvents"];
  std::map<std::string, nlohmann::json> by_name;
  for (const nlohmann::json &event : events) {
    EXPECT_EQ(event["ph"], "X");
    EXPECT_GE(event["ts"].get<double>(), 0.0) << event;
    EXPECT_GE(event["dur"].get<double>(), 0.0) << event;
    by_name[event["name"]] = event;
  }
  for (const char *name :
       {"process start and options", "import", "read and parse", "device", "sync", "picture", "deferred_lit"}) {
    EXPECT_TRUE(by_name.contains(name)) << name;
  }
  EXPECT_EQ(by_name["import"]["args"]["of"], "plaza.glb");
  EXPECT_NE(by_name["import"]["tid"], by_name["device"]["tid"]) << "the scene is imported beside the device's creation";
  const auto end = [](const nlohmann::json &event) { return event["ts"].get<double>() + event["dur"].get<double>(); };
  EXPECT_GE(by_name["device"]["ts"], end(by_name["process start and options"]));
  EXPECT_GE(by_name["picture"]["ts"], end(by_name["import"]));
  EXPECT_GE(end(by_name["picture"]), end(by_name["deferred_lit"]));
}

TEST_F(CliTest, ALimitIsNamedAndFailsOnlyWhenStrict)
{
  write("lamps.gltf", lamps_gltf(300));
  const std::string render = "render lamps.gltf --backend null --size 8x8 --shadow-size 16";
  const Finished lax = run(render);
  EXPECT_EQ(lax.status, 0) << lax.err;
  EXPECT_NE(lax.err.find("limit: 45 lamps lost their shadow"), std::string::npos) << lax.err;
  EXPECT_NE(lax.err.find("'lamp255', "), std::string::npos) << lax.err;
  EXPECT_NE(lax.err.find("and 35 more"), std::string::npos) << lax.err;
  const Finished strict = run(render + " --strict");
  EXPECT_EQ(strict.status, 4) << strict.err;
}

TEST_F(CliTest, ExplainPrintsTheFrameTreeWithReasons)
{
  const Finished finished =
      run("render " + example("plaza") + " --backend null --size 8x8 --shadow-size 64 --explain --json run.json");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.out.find("\n+ frame "), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("\n|-+ programs "), std::string::npos) << finished.out;
  const auto line_of = [&](const std::string &what) {
    const std::size_t at = finished.out.find(what);
    return finished.out.substr(at, finished.out.find('\n', at) - at);
  };
  EXPECT_NE(line_of("-- USE_SPECULAR ").find("every material is Lambertian"), std::string::npos) << finished.out;
  EXPECT_NE(line_of("-+ shadow_cubes ").find(" 96.0 KiB "), std::string::npos) << "64x64x6 of 4 bytes";
  EXPECT_NE(line_of("-- textures ").find("no material has one"), std::string::npos) << finished.out;
  const nlohmann::json json = nlohmann::json::parse(read("run.json"));
  const nlohmann::json &tree = json["frame_tree"];
  EXPECT_EQ(tree["what"], "frame");
  EXPECT_EQ(tree["bytes"], json["memory_bytes"]);
  std::vector<std::string> names;
  for (const nlohmann::json &child : tree["children"]) {
    names.push_back(child["what"]);
    EXPECT_FALSE(child["why"].get<std::string>().empty());
  }
  EXPECT_EQ(names, (std::vector<std::string>{"programs", "passes", "targets", "blocks", "meshes", "textures", "shadows",
                                             "draws"}));
}

TEST_F(CliTest, UnitsAreReadable)
{
  EXPECT_EQ(eevee::bytes_text(1023), "1023 B");
  EXPECT_EQ(eevee::bytes_text(1024), "1.0 KiB");
  EXPECT_EQ(eevee::bytes_text(std::uint64_t(59) << 20U), "59.0 MiB");
  EXPECT_EQ(eevee::seconds_text(0.0123), "12.3 ms");
  EXPECT_EQ(eevee::seconds_text(12e-6), "12 us");
  EXPECT_EQ(eevee::seconds_text(2.5), "2.50 s");
}

TEST_F(CliTest, EveryNonFiniteValueIsCountedAndTheFirstFound)
{
  std::vector<float> rgba(std::size_t(3) * 2 * 4, 1e30F);
  EXPECT_EQ(cli::find_non_finite({3, 2}, rgba).count, 0U);
  // Rows from the bottom: the second row in memory is the upper one.
  rgba[4] = std::numeric_limits<float>::infinity();
  rgba[4 * 5 + 2] = std::numeric_limits<float>::quiet_NaN();
  rgba[4 * 5 + 3] = -std::numeric_limits<float>::infinity();
  const cli::NonFinite found = cli::find_non_finite({3, 2}, rgba);
  EXPECT_EQ(found.count, 3U);
  EXPECT_EQ(found.first_px, glm::ivec2(2, 0));
}

TEST_F(CliTest, ExrKeepsFloatsRowsAndMetadata)
{
  // A picture of 2 x 2 pixels, rows from the bottom. The first value identifies the pixel.
  const std::vector<float> rgba = {1e-6F, 0, 0, 9, 2, 0, 0, 9, 3, 0, 0, 9, 65536.5F, 7, 8, 9};
  const std::filesystem::path path = folder / "image.exr";
  cli::write_exr(path, {2, 2}, rgba, {{"gnomon:seed", "5"}});
  const auto input = OIIO::ImageInput::open(path.string());
  ASSERT_TRUE(input) << OIIO::geterror();
  EXPECT_EQ(input->spec().nchannels, 3);
  EXPECT_EQ(input->spec().format, OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(input->spec().get_string_attribute("gnomon:seed"), "5");
  EXPECT_EQ(input->spec().get_string_attribute("Software"), "gnomon 0.1.0");
  std::vector<float> read(12);
  ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, read.data()));
  EXPECT_EQ(read, (std::vector<float>{3, 0, 0, 65536.5F, 7, 8, 1e-6F, 0, 0, 2, 0, 0}));
}

TEST_F(CliTest, LayersOfAnExrAreNamedByLayerAndChannel)
{
  // One column, rows from the bottom.
  const std::vector<float> rgba = {1, 2, 3, 4, 5, 6, 7, 8};
  const std::vector<cli::Layer> layers = {{"light.Lamp.001", "RGB", {11, 12, 13, 14, 15, 16}},
                                          {"depth", "Z", {21, 22}}};
  cli::write_exr(folder / "a.exr", {1, 2}, rgba, {}, cli::Alpha::Written, layers);
  const auto input = OIIO::ImageInput::open((folder / "a.exr").string());
  ASSERT_TRUE(input) << OIIO::geterror();
  const OIIO::ImageSpec &spec = input->spec();
  ASSERT_EQ(spec.nchannels, 8);
  std::vector<float> read(16);
  ASSERT_TRUE(input->read_image(0, 0, 0, 8, OIIO::TypeDesc::FLOAT, read.data()));
  const auto top = [&](const std::string &name) { return read[std::size_t(spec.channelindex(name))]; };
  EXPECT_EQ(top("R"), 5.0F);
  EXPECT_EQ(top("A"), 8.0F);
  EXPECT_EQ(top("light.Lamp.001.R"), 14.0F);
  EXPECT_EQ(top("light.Lamp.001.B"), 16.0F);
  EXPECT_EQ(top("depth.Z"), 22.0F);
  EXPECT_EQ(cli::read_picture(folder / "a.exr").pixels[0], glm::vec4(1, 2, 3, 1)) << "others read the picture";
}

// ---- Pictures: OpenImageIO is another reader and writer of the same formats ----

TEST_F(CliTest, ExrKeepsTheBitsOfEveryFloat)
{
  constexpr glm::ivec2 size_px(37, 41);
  std::mt19937 random(1);
  std::vector<float> rgba(std::size_t(4) * 37 * 41);
  for (float &value : rgba) {
    do {
      value = std::bit_cast<float>(std::uint32_t(random()));
    } while (std::isnan(value));
  }
  rgba[0] = -0.0F;
  rgba[1] = std::numeric_limits<float>::denorm_min();
  cli::write_exr(folder / "a.exr", size_px, rgba, {});
  const std::vector<float> ours = values_in(cli::read_picture(folder / "a.exr"));
  const std::vector<float> others = values_in<float>(folder / "a.exr");
  ASSERT_EQ(ours.size(), others.size());
  for (std::size_t i = 0; i < ours.size(); i++) {
    const std::size_t row = 40 - i / 3 / 37;
    const auto expected = std::bit_cast<std::uint32_t>(rgba[4 * (row * 37 + i / 3 % 37) + i % 3]);
    ASSERT_EQ(std::bit_cast<std::uint32_t>(ours[i]), expected) << i;
    ASSERT_EQ(std::bit_cast<std::uint32_t>(others[i]), expected) << i;
  }
}

TEST_F(CliTest, PicturesOfOtherProgramsAreReadAsAnotherLibraryReadsThem)
{
  constexpr int width = 40;
  constexpr int height = 23;
  std::mt19937 random(2);
  std::vector<float> floats(std::size_t(4) * width * height);
  std::ranges::generate(floats, [&] { return float(random() % 4096) / 1024.0F; });
  OIIO::ImageSpec spec(width, height, 4, OIIO::TypeDesc::HALF);
  // The first pixel is not at 0, 0.
  spec.x = spec.full_x = 7;
  spec.y = spec.full_y = -3;
  for (const char *compression : {"none", "rle", "zips", "piz", "dwaa"}) {
    spec.attribute("compression", compression);
    write_values(folder / "a.exr", spec, floats);
    EXPECT_EQ(values_in(cli::read_picture(folder / "a.exr")), values_in<float>(folder / "a.exr")) << compression;
  }
  spec = OIIO::ImageSpec(width, height, 4, OIIO::TypeDesc::HALF);
  spec.tile_width = spec.tile_height = 16;
  write_values(folder / "tiles.exr", spec, floats);
  EXPECT_EQ(values_in(cli::read_picture(folder / "tiles.exr")), values_in<float>(folder / "tiles.exr"));

  std::vector<float> rgb(std::size_t(3) * width * height);
  std::ranges::generate(rgb, [&] { return float(random() % 4096) / 1024.0F; });
  write_values(folder / "a.tif", OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::FLOAT), rgb);
  write_values(folder / "same.exr", OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::FLOAT),
               values_in<float>(folder / "a.tif"));
  EXPECT_EQ(run("compare a.tif same.exr --max-rmse 1e-30").status, 0) << "by the module";

  const auto linear = [](float coded) {
    return coded <= 0.04045F ? coded / 12.92F : std::pow((coded + 0.055F) / 1.055F, 2.4F);
  };
  std::vector<std::uint16_t> deep(std::size_t(3) * width * height);
  std::ranges::generate(deep, [&] { return std::uint16_t(random()); });
  for (const auto &[name, type] : {std::pair("8.png", OIIO::TypeDesc::UINT8),
                                   {"16.png", OIIO::TypeDesc::UINT16},
                                   // Both decode with the same library.
                                   {"a.jpg", OIIO::TypeDesc::UINT8}}) {
    write_values(folder / name, OIIO::ImageSpec(width, height, 3, type), deep);
    const std::vector<float> ours = values_in(cli::read_picture(folder / name));
    const std::vector<float> others = values_in<float>(folder / name);
    ASSERT_EQ(ours.size(), others.size());
    for (std::size_t i = 0; i < ours.size(); i++) {
      ASSERT_NEAR(ours[i], linear(others[i]), 1e-6F) << name << ' ' << i;
    }
  }
}

TEST_F(CliTest, PngKeepsBytesAndMetadata)
{
  const std::vector<std::uint8_t> rgba = {1, 2, 3, 9, 4, 5, 6, 9, 7, 8, 9, 9, 10, 11, 255, 9};
  cli::write_png(folder / "a.png", {2, 2}, rgba, {{"gnomon:camera", "Größe"}, {"gnomon:scene", ""}});
  EXPECT_EQ(values_in<std::uint8_t>(folder / "a.png"),
            (std::vector<std::uint8_t>{7, 8, 9, 10, 11, 255, 1, 2, 3, 4, 5, 6}));
  const auto input = OIIO::ImageInput::open((folder / "a.png").string());
  ASSERT_TRUE(input);
  EXPECT_EQ(input->spec().nchannels, 3);
  EXPECT_EQ(input->spec().get_string_attribute("gnomon:camera"), "Größe");
  EXPECT_EQ(input->spec().get_string_attribute("Software"), "gnomon 0.1.0");
}

TEST_F(CliTest, AlphaIsWrittenAsEachFormatStoresItAndReadAsOverBlack)
{
  // One column, rows from the bottom.
  const std::vector<std::uint8_t> coded = {188, 0, 255, 51, 1, 2, 3, 255};
  cli::write_png(folder / "a.png", {1, 2}, coded, {}, cli::Alpha::Written);
  const std::vector<float> linear = {0.5F, 0.0F, 0.25F, 0.5F, 1.0F, 2.0F, 3.0F, 1.0F};
  cli::write_exr(folder / "a.exr", {1, 2}, linear, {}, cli::Alpha::Written);
  OIIO::ImageSpec as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  const auto png = OIIO::ImageInput::open((folder / "a.png").string(), &as_stored);
  const auto exr = OIIO::ImageInput::open((folder / "a.exr").string());
  ASSERT_TRUE(png && exr);
  EXPECT_EQ(png->spec().channelnames, (std::vector<std::string>{"R", "G", "B", "A"}));
  EXPECT_EQ(exr->spec().channelnames, (std::vector<std::string>{"R", "G", "B", "A"}));
  std::vector<std::uint8_t> bytes(8);
  ASSERT_TRUE(png->read_image(0, 0, 0, 4, OIIO::TypeDesc::UINT8, bytes.data()));
  EXPECT_EQ(bytes, (std::vector<std::uint8_t>{1, 2, 3, 255, 188, 0, 255, 51}));
  std::vector<float> values(8);
  ASSERT_TRUE(exr->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, values.data()));
  EXPECT_EQ(values, (std::vector<float>{1.0F, 2.0F, 3.0F, 1.0F, 0.5F, 0.0F, 0.25F, 0.5F}));

  const cli::Picture over_black = cli::read_picture(folder / "a.png");
  EXPECT_NEAR(over_black.pixels[0].r, 0.2F * 0.50289F, 1e-5F);
  EXPECT_NEAR(over_black.pixels[0].b, 0.2F, 1e-6F);
  EXPECT_EQ(over_black.pixels[0].a, 1.0F);
  EXPECT_EQ(cli::read_picture(folder / "a.exr").pixels[0], glm::vec4(0.5F, 0.0F, 0.25F, 1.0F));
}

TEST_F(CliTest, DamagedPicturesAreNamedOrRead)
{
  constexpr glm::ivec2 size_px(31, 17);
  std::mt19937 random(3);
  std::vector<float> rgba(std::size_t(4) * 31 * 17);
  std::ranges::generate(rgba, [&] { return float(random() % 1000); });
  cli::write_exr(folder / "a.exr", size_px, rgba, {});
  cli::write_png(folder / "a.png", size_px, std::vector<std::uint8_t>(rgba.begin(), rgba.end()), {});
  write_values(folder / "a.jpg", OIIO::ImageSpec(31, 17, 3, OIIO::TypeDesc::UINT8), rgba);
  write_values(folder / "a.hdr", OIIO::ImageSpec(31, 17, 3, OIIO::TypeDesc::FLOAT), rgba);
  for (const std::string name : {"a.exr", "a.png", "a.jpg", "a.hdr"}) {
    const std::string whole = read(name);
    for (std::size_t size = 0; size + 16 < whole.size(); size += 1 + whole.size() / 50) {
      write(name, whole.substr(0, size));
      try {
        (void)cli::read_picture(folder / name);
        ADD_FAILURE() << name << " of " << size << " bytes of " << whole.size() << " was read";
      }
      catch (const std::runtime_error &error) {
        EXPECT_TRUE(std::string(error.what()).starts_with((folder / name).string())) << error.what();
      }
    }
    for (int i = 0; i < 60; i++) {
      std::string damaged = whole;
      for (int k = 0; k < 4; k++) {
        damaged[random() % (i % 2 == 0 ? std::min<std::size_t>(whole.size(), 64) : whole.size())] = char(random());
      }
      write(name, damaged);
      try {
        (void)cli::read_picture(folder / name);
      }
      catch (const std::runtime_error &) {
      }
    }
  }
  write_values(folder / "a.tif", OIIO::ImageSpec(31, 17, 3, OIIO::TypeDesc::FLOAT), rgba);
  write("cut.tif", read("a.tif").substr(0, 20));
  for (const std::string name : {"cut.tif", "text.exr"}) {
    write("text.exr", "not a picture");
    const auto result = run("compare " + name + " " + name);
    EXPECT_EQ(result.status, 1);
    EXPECT_TRUE(result.err.starts_with("gnomon: " + name + ": ")) << result.err;
  }
  OIIO::ImageSpec depth(31, 17, 1, OIIO::TypeDesc::FLOAT);
  depth.channelnames = {"Z"};
  write_values(folder / "depth.exr", depth, rgba);
  EXPECT_NE(run("compare depth.exr depth.exr").err.find("depth.exr: has no channels R, G and B"), std::string::npos);
}

TEST_F(CliTest, AMissingModuleIsNamed)
{
  const std::filesystem::path alone = std::filesystem::path(GNOMON_PROGRAM).parent_path() / "alone" / "gnomon";
  std::filesystem::create_directories(alone.parent_path());
  std::filesystem::remove(alone);
  std::filesystem::create_hard_link(GNOMON_PROGRAM, alone);
  write_values(folder / "a.tif", OIIO::ImageSpec(2, 2, 3, OIIO::TypeDesc::FLOAT), std::vector<float>(12, 1.0F));
  const Finished result = run("compare a.tif a.tif", alone);
  EXPECT_EQ(result.status, 1);
  EXPECT_TRUE(result.err.starts_with("gnomon: a.tif: ")) << result.err;
  EXPECT_NE(result.err.find("libgnomon_oiio.so"), std::string::npos) << result.err;
  EXPECT_EQ(run("--version", alone).status, 0);
}

TEST_F(CliTest, APictureThatCannotBeWrittenIsNamed)
{
  const std::vector<float> rgba(4 * 4, 1.0F);
  for (const auto &write_file : {std::function([&](const std::filesystem::path &path) {
                                   cli::write_exr(path, {2, 2}, rgba, {});
                                 }),
                                 std::function([&](const std::filesystem::path &path) {
                                   cli::write_png(path, {2, 2}, std::vector<std::uint8_t>(16), {});
                                 })}) {
    const std::filesystem::path path = folder / "absent" / "a.exr";
    try {
      write_file(path);
      ADD_FAILURE();
    }
    catch (const std::runtime_error &error) {
      EXPECT_NE(std::string(error.what()).find(path.string() + ": cannot be written"), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace gnomon
