// SPDX-License-Identifier: MIT
// `gnomon render --frames`.
#include "cli_moving_scene.hh"
#include "cli_process.hh"
#include "gpu_device_fixture.hh"

#include <nlohmann/json.hpp>

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <random>

namespace gnomon {
namespace {

using test::Finished;

class FramesTest : public test::ProgramTest {
 protected:
  void SetUp() override
  {
    if (!test::testing_gl_device()) {
      GTEST_SKIP() << "no device to render with";
    }
    // It has left the picture at 1 s.
    write("moving.gltf", test::moving_triangle_gltf({100, 0, 0}));
  }

  [[nodiscard]] float brightest(const std::string &name) const
  {
    std::vector<float> values(std::size_t(16) * 9 * 3);
    const auto input = OIIO::ImageInput::open((folder / name).string());
    if (!input || !input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, values.data())) {
      return -1.0F;
    }
    return *std::ranges::max_element(values);
  }
  Finished render(const std::string &arguments)
  {
    return run("render moving.gltf --size 16x9 --samples 1 " + arguments);
  }
};

TEST_F(FramesTest, EachFrameIsAFileOfItsTime)
{
  const Finished finished = render("-o frame_###.exr --frames 0-2 --fps 2 --animation leave");
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(file_count(), 4U) << "the scene and three frames";
  EXPECT_GT(brightest("frame_000.exr"), 0.1F);
  EXPECT_EQ(brightest("frame_002.exr"), 0.0F);
  const auto last = OIIO::ImageInput::open((folder / "frame_002.exr").string());
  ASSERT_TRUE(last);
  EXPECT_EQ(last->spec().get_string_attribute("gnomon:seconds"), "1");
}

TEST_F(FramesTest, AShutterBlursWhatMovesAlsoInTiles)
{
  const std::string moving = "render moving.gltf --size 16x9 --frames 0 --fps 10 --samples 8 ";
  ASSERT_EQ(run(moving + "-o sharp.exr").status, 0);
  const std::string open = moving + "--shutter 2 ";
  const Finished whole = run(open + "-o whole.exr");
  ASSERT_EQ(whole.status, 0) << whole.err;
  const Finished difference = run("compare whole.exr sharp.exr --max-rmse 0.01");
  EXPECT_EQ(difference.status, 1) << difference.out;
  for (const char *tile : {"1", "2"}) {
    ASSERT_EQ(run(open + "-o tile_" + tile + ".exr --tile " + tile + "/2").status, 0);
  }
  ASSERT_EQ(run("merge tile_1.exr tile_2.exr -o merged.exr").status, 0);
  EXPECT_EQ(run("compare whole.exr merged.exr --max-rmse 0").status, 0);
  EXPECT_EQ(run(open + "-o layers.exr --aov depth").status, 2);
  EXPECT_EQ(render("-o f.exr --shutter 1").status, 2) << "without --frames";
}

TEST_F(FramesTest, APlaceForANumberNeedsFrames)
{
  for (const char *name : {"f_####.png", "f#.exr"}) {
    const Finished finished = render(std::string("-o ") + name);
    EXPECT_EQ(finished.status, 2) << finished.err;
    EXPECT_NE(finished.err.find("needs --frames"), std::string::npos) << finished.err;
  }
  EXPECT_EQ(file_count(), 1U) << "the scene";
}

TEST_F(FramesTest, ResumeRendersWhatIsMissingOrCutShort)
{
  const std::string frames = "-o f#.exr --frames 1-3 --fps 10 --json run.json";
  ASSERT_EQ(render(frames).status, 0);
  const std::filesystem::path cut = folder / "f2.exr";
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
  std::filesystem::remove(folder / "f3.exr");
  const Finished finished = render(frames + " --resume");
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(nlohmann::json::parse(read("run.json"))["skipped_frames"], 1);
  for (const char *name : {"f1.exr", "f2.exr", "f3.exr"}) {
    EXPECT_GE(brightest(name), 0.0F) << name;
  }
  EXPECT_EQ(render(frames + " --resume").status, 0) << "nothing is left to render";
  EXPECT_EQ(nlohmann::json::parse(read("run.json"))["skipped_frames"], 3);
}

TEST_F(FramesTest, ResumeRemovesTheFilesOfKilledProcesses)
{
  // No process has this number: Linux has at most 4194304.
  std::array<char, 65> host{};
  ASSERT_EQ(gethostname(host.data(), host.size() - 1), 0);
  const std::string killed = std::string(".exr.") + host.data() + ".4194999-0";
  const std::string running = std::string(".exr.") + host.data() + "." + std::to_string(getpid()) + "-0";
  for (const std::string &name : {".f1" + killed, ".f2" + killed, ".f2" + running, ".g2" + killed, ".f4" + killed}) {
    write(name, "part");
  }
  const std::string frames = "-o f#.exr --frames 1-2";
  ASSERT_EQ(render(frames).status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / (".f1" + killed))) << "without --resume, nothing is removed";
  ASSERT_EQ(render(frames + " --resume").status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / (".f1" + killed)));
  EXPECT_FALSE(std::filesystem::exists(folder / (".f2" + killed)));
  EXPECT_TRUE(std::filesystem::exists(folder / (".f2" + running))) << "another process writes it";
  EXPECT_TRUE(std::filesystem::exists(folder / (".g2" + killed))) << "of another sequence";
  EXPECT_TRUE(std::filesystem::exists(folder / (".f4" + killed))) << "of another range";
}

/** As the power or a scheduler ends a process: nothing of it runs any more. */
class SlowFramesTest : public FramesTest {};

TEST_F(SlowFramesTest, FramesOfProcessesThatWereKilledAreWholeAndResumedToTheEnd)
{
  // Pictures whose writing takes a part of the time that is worth hitting.
  const std::string frames = "render moving.gltf --size 320x180 --samples 1 --frames 0-99 --fps 60 -o ";
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run(frames + "whole_##.exr").status, 0);
  const double whole_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto pixels = [&](const std::string &name) {
    std::vector<float> values(std::size_t(320) * 180 * 4);
    const auto input = OIIO::ImageInput::open((folder / name).string());
    const bool is_read = input && input->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, values.data());
    return is_read ? values : std::vector<float>(1);
  };
  std::mt19937 random(1);
  int kills = 0;
  std::array<bool, 100> is_whole{};
  bool is_done = false;
  while (!is_done && kills < 200) {
    // From before the first frame is drawn to many frames later. The first run compiled programs: others take a half of
    // its time.
    const double seconds = std::uniform_real_distribution<double>(0.05, 0.5)(random) * whole_seconds;
    const std::string command = "cd '" + folder.string() + "' && timeout -s KILL " + std::to_string(seconds) + " '" +
                                GNOMON_PROGRAM + "' " + frames + "killed_##.exr --resume > stdout.txt 2> stderr.txt";
    is_done = std::system(command.c_str()) == 0;
    kills += is_done ? 0 : 1;
    for (std::size_t i = 0; i < is_whole.size(); i++) {
      const std::string number = (i < 10 ? "0" : "") + std::to_string(i) + ".exr";
      if (!is_whole[i] && (is_done || std::filesystem::exists(folder / ("killed_" + number)))) {
        const std::vector<float> killed = pixels("killed_" + number);
        const std::vector<float> whole = pixels("whole_" + number);
        ASSERT_EQ(killed.size(), whole.size()) << number << " after " << kills << " kills";
        double difference = 0.0;
        for (std::size_t k = 0; k < whole.size(); k++) {
          difference += std::abs(double(killed[k]) - double(whole[k])) / double(whole.size());
        }
        // Positions are relative to the first frame of a process, so that some pixels at edges may differ.
        EXPECT_LE(difference, 1e-3) << number << " after " << kills << " kills";
        is_whole[i] = true;
      }
    }
  }
  EXPECT_TRUE(is_done);
  EXPECT_GT(kills, 0);
}

TEST_F(FramesTest, AnAnimationThatCannotBePlayedIsNamedWithTheReason)
{
  nlohmann::json gltf = nlohmann::json::parse(test::moving_triangle_gltf({100, 0, 0}));
  // Its values are its times.
  nlohmann::json &sampler = gltf["animations"][0]["samplers"][0];
  sampler["output"] = sampler["input"];
  write("moving.gltf", gltf.dump());
  const Finished finished = render("-o f#.exr --frames 0-1");
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("the scene has none that can be played; animation 'leave': channel left out: "),
            std::string::npos)
      << finished.err;
}

TEST_F(FramesTest, WrongUseIsNamed)
{
  for (const char *range : {"3-1", "-1-2", "1-", "a", "1-2x"}) {
    const Finished finished = render(std::string("-o f#.exr --frames=") + range);
    EXPECT_EQ(finished.status, 2) << range;
    EXPECT_NE(finished.err.find("--frames '"), std::string::npos) << finished.err;
  }
  const Finished without_place = render("-o f.exr --frames 1-2");
  EXPECT_EQ(without_place.status, 2);
  EXPECT_NE(without_place.err.find("has no #"), std::string::npos) << without_place.err;
  const Finished unknown = render("-o f#.exr --frames 1-2 --animation walk");
  EXPECT_EQ(unknown.status, 1);
  EXPECT_NE(unknown.err.find("no animation 'walk'; it has: leave"), std::string::npos) << unknown.err;
  EXPECT_EQ(file_count(), 1U) << "nothing was written";
}

}  // namespace
}  // namespace gnomon
