// SPDX-License-Identifier: MIT
// Division of pictures into parts.
#include "cli_work_plan.hh"

#include "cli.hh"

#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <sstream>

namespace gnomon::cli {
namespace {

/** Two whole numbers with a character between them, or one that stands for both. */
std::pair<int, int> pair_of(const std::string &text)
{
  std::istringstream stream(text);
  int first = 0;
  char separator = 0;
  stream >> first;
  int second = first;
  stream >> separator >> second;
  return {first, second};
}

WorkPlan plan_of(const WorkOfScene &work, double target_seconds, int frame_step = 1)
{
  WorkPlan plan{
      .program = "gnomon", .folder = ".", .scenes = {{"s.glb", "f", work.pictures}}, .frame_step = frame_step};
  plan.part_seconds = add_parts(plan, work, target_seconds);
  return plan;
}

TEST(WorkPlanTest, EachSampleOfEachPixelOfEachFrameIsInOnePart)
{
  std::mt19937 random(7);
  const auto number = [&](int min, int max) { return std::uniform_int_distribution<int>(min, max)(random); };
  for (int i = 0; i < 300; i++) {
    const int first = number(0, 9);
    const int step = number(1, 4);
    WorkOfScene work{.is_animated = true,
                     .first_frame = first,
                     .last_frame = first + number(0, 30),
                     .sample_count = number(1, 64),
                     .tile_count = number(1, 4),
                     .can_divide_pictures = number(0, 3) > 0,
                     .pictures = "a/f_##.exr",
                     .cost = {number(0, 20) * 0.1, number(1, 100) * 0.01}};
    const double target_seconds = number(1, 200) * 0.1;
    const WorkPlan plan = plan_of(work, target_seconds, step);
    std::map<int, double> shares;
    std::set<std::string> outputs;
    double longest_seconds = 0.0;
    for (const WorkPart &part : plan.parts) {
      const auto [frame, last] = pair_of(part.frames);
      const double tiles = part.tile.empty() ? 1.0 : pair_of(part.tile).second;
      const auto [sample, last_sample] =
          part.samples.empty() ? std::pair(0, work.sample_count - 1) : pair_of(part.samples);
      EXPECT_TRUE(work.can_divide_pictures || !part.is_of_picture());
      for (int k = frame; k <= last; k += step) {
        shares[k] += (last_sample - sample + 1.0) / work.sample_count / tiles;
      }
      for (const std::string &file : files_of(plan, part)) {
        EXPECT_TRUE(outputs.insert(file).second) << file << " is written by two parts";
      }
      const double seconds = work.cost.start_seconds + work.cost.sample_seconds * (last_sample - sample + 1) / tiles *
                                                           ((last - frame) / step + 1);
      EXPECT_LE(seconds, plan.part_seconds + 1e-9);
      longest_seconds = std::max(longest_seconds, seconds);
    }
    EXPECT_NEAR(longest_seconds, plan.part_seconds, 1e-9);
    // The time that was asked for, unless a single sample or whole pictures take longer.
    const double sample_seconds = work.cost.sample_seconds / (work.can_divide_pictures ? work.tile_count : 1);
    const double shortest = work.can_divide_pictures ? sample_seconds : sample_seconds * work.sample_count;
    EXPECT_LE(plan.part_seconds, std::max(target_seconds, 2.0 * work.cost.start_seconds) + shortest + 1e-9);
    std::size_t frame_count = 0;
    for (int k = work.first_frame; k <= work.last_frame; k += step, frame_count++) {
      EXPECT_NEAR(shares[k], 1.0, 1e-9) << "frame " << k;
    }
    EXPECT_EQ(shares.size(), frame_count);
  }
}

TEST(WorkPlanTest, ShortFramesAreGroupedAndLongOnesDivided)
{
  WorkOfScene work{.is_animated = true,
                   .last_frame = 9,
                   .sample_count = 10,
                   .pictures = "f_####.exr",
                   .cost = {.start_seconds = 1.0, .sample_seconds = 0.1}};
  // 1 s a frame: 1 s of the start and three frames take 4 s.
  WorkPlan plan = plan_of(work, 4.0);
  ASSERT_EQ(plan.parts.size(), 4U);
  EXPECT_EQ(plan.parts[1].frames, "3-5");
  EXPECT_EQ(plan.parts[3].frames, "9");
  EXPECT_EQ(files_of(plan, plan.parts[1]), (std::vector<std::string>{"f_0003.exr", "f_0004.exr", "f_0005.exr"}));
  EXPECT_DOUBLE_EQ(plan.part_seconds, 4.0);
  // 40 s a frame: ranges of 3 s, but no shorter than samples of 4 s.
  work.cost.sample_seconds = 4.0;
  plan = plan_of(work, 4.0);
  ASSERT_EQ(plan.parts.size(), 100U);
  EXPECT_EQ(plan.parts[11].frames, "1");
  EXPECT_EQ(plan.parts[11].samples, "1-1");
  EXPECT_EQ(plan.parts[11].output, "f_0001.samples1-1.exr");
  EXPECT_EQ(picture_of(plan, plan.parts[11]), "f_0001.exr");
  work.tile_count = 2;
  plan = plan_of(work, 21.0);
  ASSERT_EQ(plan.parts.size(), 20U);
  EXPECT_EQ(plan.parts[1].tile, "2/2");
  EXPECT_EQ(plan.parts[1].output, "f_0000.tile2of2.exr");
}

TEST(WorkPlanTest, NamesOfPartsAndPictures)
{
  EXPECT_EQ(PartName("a:b/plan.json:12").plan, "a:b/plan.json");
  EXPECT_EQ(PartName("a:b/plan.json:12").index, 12U);
  for (const char *wrong : {"plan.json", "plan.json:", "plan.json:x", "plan.json:-1", "plan.json:1x", ""}) {
    EXPECT_THROW(static_cast<void>(PartName(wrong)), UsageError) << wrong;
  }
  EXPECT_EQ(frame_name("a#/b##c###.exr", 7), "a#/b##c007.exr");
  EXPECT_EQ(frame_name("b.exr", 7), "b.exr");
  EXPECT_EQ(scene_name("out/{scene}/{scene}_#.exr", "../in/a.b.glb"), "out/a.b/a.b_#.exr");
  EXPECT_EQ(frame_name(scene_name("##_{scene}.exr", "take#2.glb"), 7), "07_take_2.exr");
}

// A division by 0, and a list of all memory.
TEST(WorkPlanTest, FramesOfAPlanAreChecked)
{
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("gnomon_plan." + std::to_string(::getpid()));
  const auto expect_refused = [&](const std::string &frames, int step, const std::string &reason) {
    write_plan(path, {.program = "gnomon",
                      .folder = ".",
                      .scenes = {{"s.glb", "f", "f_#.exr"}},
                      .frame_step = step,
                      .parts = {{.scene = 0, .frames = frames, .output = "f_#.exr"}}});
    try {
      static_cast<void>(read_plan(path, "gnomon"));
      ADD_FAILURE() << frames << ' ' << step;
    }
    catch (const std::runtime_error &error) {
      EXPECT_NE(std::string(error.what()).find(path.string() + ": not a plan: " + reason), std::string::npos)
          << error.what();
    }
  };
  expect_refused("0-9", 0, "--step 0 is not 1 or more");
  expect_refused("0-9", -1, "--step -1 is not 1 or more");
  expect_refused("0-2147483647", 1, "--frames '0-2147483647' are more than 16777216 frames");
  expect_refused("9-0", 1, "--frames '9-0' is neither");
  std::filesystem::remove(path);
}

TEST(WorkPlanTest, NamesOfAPlanAreUtf8)
{
  try {
    write_plan("plan.json", {.program = "gnomon", .folder = ".", .scenes = {{"w\xE4lk.glb", "f", "f.exr"}}});
    FAIL();
  }
  catch (const std::runtime_error &error) {
    EXPECT_EQ(std::string(error.what()).rfind("plan.json: cannot be written: ", 0), 0U) << error.what();
  }
  EXPECT_FALSE(std::filesystem::exists("plan.json"));
}

TEST(WorkPlanTest, APlanIsReadAsItWasWrittenAndRefusedWhenEdited)
{
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("plan" + std::to_string(getpid()) + ".json");
  WorkPlan plan = plan_of({.is_animated = true,
                           .last_frame = 5,
                           .sample_count = 2,
                           .tile_count = 2,
                           .pictures = "f#.exr",
                           .cost = {0.5, 1.0}},
                          10.0);
  plan.arguments = {"--size=8x8", "--strict"};
  write_plan(path, plan);
  const WorkPlan read = read_plan(path, "gnomon");
  EXPECT_EQ(read.id(), plan.id());
  EXPECT_EQ(read.arguments, plan.arguments);
  ASSERT_EQ(read.parts.size(), plan.parts.size());
  EXPECT_EQ(read.parts.back().output, plan.parts.back().output);
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  for (const auto &[before, after] :
       {std::pair("--size=8x8", "--size=8x9"), {"1/2", "2/2"}, {"\"parts\"", "\"part\""}, {"{", "["}, {"f1", "f2"}}) {
    std::string edited = text.str();
    edited.replace(edited.find(before), std::string(before).size(), after);
    std::ofstream(path) << edited;
    try {
      static_cast<void>(read_plan(path, "gnomon"));
      ADD_FAILURE() << after;
    }
    catch (const std::runtime_error &error) {
      EXPECT_EQ(std::string(error.what()).rfind(path.string() + ": not a plan: ", 0), 0U) << error.what();
    }
  }
  std::ofstream(path) << R"({"program": "gnomon 0.0.1"})";
  try {
    static_cast<void>(read_plan(path, "gnomon"));
    ADD_FAILURE() << "a plan of another version, with other members";
  }
  catch (const std::runtime_error &error) {
    EXPECT_EQ(error.what(), path.string() + ": is a plan of gnomon 0.0.1, and this is gnomon");
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace gnomon::cli
