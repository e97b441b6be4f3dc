// SPDX-License-Identifier: MIT
// Parts of plans, early ends, statuses for schedulers, and several scenes in one process.
#include "cli_moving_scene.hh"
#include "cli_process.hh"
#include "gpu_device_fixture.hh"

#include <nlohmann/json.hpp>

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

namespace gnomon {
namespace {

namespace fs = std::filesystem;

using test::Finished;

class FarmTest : public test::ProgramTest {
 protected:
  void SetUp() override
  {
    if (!test::testing_gl_device()) {
      GTEST_SKIP() << "no device to render with";
    }
    write("moving.gltf", test::moving_triangle_gltf({10, 3, 0}));
  }

  [[nodiscard]] std::vector<float> values_of(const std::string &name) const
  {
    const auto input = OIIO::ImageInput::open((folder / name).string());
    if (!input) {
      return {};
    }
    std::vector<float> values(input->spec().image_pixels() * std::size_t(input->spec().nchannels));
    return input->read_image(0, 0, 0, input->spec().nchannels, OIIO::TypeDesc::FLOAT, values.data())
               ? values
               : std::vector<float>();
  }
  /** Renders a part, and returns the line about it. */
  nlohmann::json render_part(int index, const std::string &options = "")
  {
    const Finished finished = run("render --part jobs.json:" + std::to_string(index) + options);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return nlohmann::json::parse(finished.out, nullptr, false);
  }
  static constexpr const char *render = "render moving.gltf --size 32x18 --samples 3 ";
  static constexpr const char *plan = "plan moving.gltf --size 32x18 --samples 3 -o jobs.json --fps 10 ";
};

TEST_F(FarmTest, PartsOfFramesAreThePicturesOfOneProcess)
{
  ASSERT_EQ(run(render + std::string("--frames 2-9 --step 2 --fps 10 -o whole_#.exr")).status, 0);
  ASSERT_EQ(
      run(plan + std::string("--frames 2-9 --step 2 --seconds-per-frame 1 --target-seconds 2.1 --pictures f_#.exr"))
          .status,
      0);
  // In any order, and one twice.
  EXPECT_EQ(render_part(1)["status"], "done");
  const Finished incomplete = run("merge --plan jobs.json");
  EXPECT_EQ(incomplete.status, 1);
  EXPECT_NE(incomplete.err.find("part 0: f_2.exr: is missing"), std::string::npos) << incomplete.err;
  EXPECT_NE(incomplete.err.find("part 0: f_4.exr: is missing"), std::string::npos) << incomplete.err;
  const nlohmann::json line = render_part(0);
  EXPECT_EQ(line["pictures"], 2);
  EXPECT_EQ(line["samples"], 3);
  EXPECT_GT(line["memory_bytes"], 1 << 20);
  EXPECT_GT(line["picture_seconds"], 0.0);
  EXPECT_LT(line["picture_seconds"], line["seconds"]);
  EXPECT_EQ(render_part(1)["status"], "skipped");
  // A device is not read, which might have no end.
  fs::create_symlink("/dev/full", folder / "f_4.exr.link");
  fs::rename(folder / "f_4.exr", folder / "f_4.kept");
  fs::rename(folder / "f_4.exr.link", folder / "f_4.exr");
  EXPECT_NE(run("merge --plan jobs.json").err.find("part 0: f_4.exr: is no regular file"), std::string::npos);
  const Finished full = run("render --part jobs.json:0");
  EXPECT_EQ(full.status, 5);
  const nlohmann::json failed = nlohmann::json::parse(full.out, nullptr, false);
  EXPECT_EQ(failed["status"], "failed") << full.out;
  EXPECT_EQ(failed["pictures"], 1) << "it was drawn before the disk was full";
  fs::rename(folder / "f_4.kept", folder / "f_4.exr");
  EXPECT_EQ(run("merge --plan jobs.json").status, 0);
  for (const std::string frame : {"2", "4", "6", "8"}) {
    EXPECT_EQ(values_of("f_" + frame + ".exr"), values_of("whole_" + frame + ".exr")) << frame;
    EXPECT_FALSE(values_of("f_" + frame + ".exr").empty()) << frame;
  }
}

TEST_F(FarmTest, AFileUnderTheNameOfAnotherIsNamedAndRenderedAgain)
{
  ASSERT_EQ(run(plan + std::string("--frames 6-7 --seconds-per-frame 1 --target-seconds 1 --pictures f_#.exr")).status,
            0);
  render_part(0);
  render_part(1);
  const std::string own = read("f_6.exr");
  fs::copy_file(folder / "f_7.exr", folder / "f_6.exr", fs::copy_options::overwrite_existing);
  const Finished merged = run("merge --plan jobs.json");
  EXPECT_EQ(merged.status, 1);
  EXPECT_NE(merged.err.find("part 0: f_6.exr: is a copy of 'f_7.exr' under another name\n"), std::string::npos)
      << merged.err;
  EXPECT_EQ(render_part(0)["status"], "done");
  EXPECT_TRUE(read("f_6.exr") == own) << "a part that is rendered again has the same bytes";
  // ExrPictureTest has all bytes of a file; here some of a frame, of which the first is in a name of the header.
  for (const std::size_t byte : {own.find("displayWindow") + 1, own.find("pixelAspectRatio") + 27, own.size() - 9}) {
    std::string flipped = own;
    flipped[byte] = char(flipped[byte] ^ 2);
    write("f_6.exr", flipped);
    const Finished damaged = run("merge --plan jobs.json");
    EXPECT_EQ(damaged.status, 1) << byte;
    EXPECT_NE(damaged.err.find("part 0: f_6.exr: "), std::string::npos) << damaged.err;
  }
}

TEST_F(FarmTest, DividedPicturesAreJoinedAndDamageIsNamed)
{
  ASSERT_EQ(run(render + std::string("--frames 3 --fps 10 -o whole_#.exr")).status, 0);
  ASSERT_EQ(
      run(plan + std::string("--frames 3 --tiles 2 --seconds-per-frame 10 --target-seconds 100 --pictures f_#.exr"))
          .status,
      0);
  render_part(0);
  render_part(1);
  fs::resize_file(folder / "f_3.tile2of2.exr", fs::file_size(folder / "f_3.tile2of2.exr") - 40);
  Finished damaged = run("merge --plan jobs.json");
  EXPECT_EQ(damaged.status, 1);
  EXPECT_NE(damaged.err.find("part 1: f_3.tile2of2.exr: "), std::string::npos) << damaged.err;
  EXPECT_EQ(damaged.err.find("part 0"), std::string::npos) << damaged.err;
  EXPECT_EQ(render_part(1)["status"], "done") << "a damaged part is rendered again";
  // A part of the same place from other settings.
  ASSERT_EQ(run(render + std::string("--seed 4 --frames 3 --fps 10 --tile 1/2 -o f_3.tile1of2.exr")).status, 0);
  damaged = run("merge --plan jobs.json");
  EXPECT_EQ(damaged.status, 1);
  EXPECT_NE(damaged.err.find("part 0: f_3.tile1of2.exr: is not of this plan"), std::string::npos) << damaged.err;
  EXPECT_EQ(render_part(0)["status"], "done");
  ASSERT_EQ(run("merge --plan jobs.json").status, 0);
  EXPECT_EQ(values_of("f_3.exr"), values_of("whole_3.exr"));
  fs::remove(folder / "f_3.tile1of2.exr");
  EXPECT_EQ(run("merge --plan jobs.json").status, 0) << "the picture is complete without its parts";
  EXPECT_EQ(render_part(0)["status"], "skipped");
  fs::resize_file(folder / "f_3.exr", fs::file_size(folder / "f_3.exr") - 40);
  damaged = run("merge --plan jobs.json");
  EXPECT_NE(damaged.err.find("gnomon: f_3.exr: is damaged"), std::string::npos) << damaged.err;
  EXPECT_NE(damaged.err.find("part 0: f_3.tile1of2.exr: is missing"), std::string::npos) << damaged.err;
  EXPECT_EQ(render_part(0)["status"], "done");
}

TEST_F(FarmTest, APlanRefusesWhatItsPartsWouldRefuse)
{
  struct Refusal {
    const char *options;
    int status;
    const char *reason;
  };
  for (const auto &[options, status, reason] : {
           Refusal{"--world nowhere.exr", 1, "nowhere.exr"},
           Refusal{"--aov nothing", 2, "no layer 'nothing'"},
           Refusal{"--debug nothing", 2, "nothing"},
           Refusal{"--background nothing", 2, "nothing"},
           Refusal{"--tiles 19", 2, "the picture has 18 rows"},
           Refusal{"--tiles 2 --aov depth", 2, "--tiles divides pictures"},
           Refusal{"--target-seconds nan", 2, "--target-seconds"},
           Refusal{"--frames 0-1 --pictures out.exr", 2, "'out.exr' has no #"},
       }) {
    const Finished refused =
        run(std::string("plan moving.gltf --size 32x18 -o jobs.json --seconds-per-frame 1 ") + options);
    EXPECT_EQ(refused.status, status) << options << '\n' << refused.err;
    EXPECT_NE(refused.err.find(reason), std::string::npos) << options << '\n' << refused.err;
    EXPECT_FALSE(fs::exists(folder / "jobs.json")) << options;
  }
  EXPECT_EQ(run(plan + std::string("--frames 0 --seconds-per-frame nan")).status, 2);
  EXPECT_EQ(run("compare a.exr b.exr --max-rmse nan").status, 2) << "which no error exceeds";
}

TEST_F(FarmTest, ASceneMayHaveThePlaceholderInItsName)
{
  fs::copy(folder / "moving.gltf", folder / "v{scene}.gltf");
  ASSERT_EQ(run("plan v{scene}.gltf --size 8x8 --seconds-per-frame 1 -o jobs.json --pictures {scene}_n.exr").status, 0);
  EXPECT_EQ(render_part(0)["status"], "done");
  EXPECT_EQ(run("merge --plan jobs.json").status, 0);
  EXPECT_TRUE(fs::exists(folder / "v{scene}_n.exr"));
}

TEST_F(FarmTest, APlanIsOfOneSceneAndOneProgram)
{
  ASSERT_EQ(run(plan + std::string("--frames 0-1 --seconds-per-frame 1")).status, 0);
  fs::create_directories(folder / "other");
  const std::string program = std::string("'") + GNOMON_PROGRAM + "'";
  EXPECT_EQ(run("render --part ../jobs.json:0", "/bin/sh' -c 'cd other && \"$0\" \"$@\"' '" GNOMON_PROGRAM).status, 0)
      << "paths are relative to the plan";
  EXPECT_EQ(run("render --part jobs.json:9").status, 2);
  EXPECT_EQ(run("render --part jobs.json:0 --samples 4").status, 2);
  EXPECT_EQ(run("render --part jobs.json:0 --checkpoint").status, 2) << "no part continues it";
  EXPECT_EQ(run("render moving.gltf --part jobs.json:0").status, 2);
  fs::remove(folder / "moving_0000.exr");
  std::string text = read("moving.gltf");
  text.replace(text.find("2000.0"), 6, "2001.0");
  write("moving.gltf", text);
  const Finished changed = run("render --part jobs.json:0");
  EXPECT_EQ(changed.status, 1);
  EXPECT_NE(changed.err.find("moving.gltf: has changed since the plan was made"), std::string::npos) << changed.err;
}

TEST_F(FarmTest, APlanIsOfOneAnimationAndOneWorld)
{
  // Light from above by a Radiance picture of one texel.
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n";
  const auto write_world = [&](char value) { write("sky.hdr", header + std::string{value, value, value, char(128)}); };
  write_world(100);
  ASSERT_EQ(run(plan + std::string("--frames 0-1 --seconds-per-frame 1 --world sky.hdr")).status, 0);
  EXPECT_EQ(render_part(0)["status"], "done");
  fs::remove(folder / "moving_0000.exr");
  write("moving.gltf", test::moving_triangle_gltf({10, 3, 1}));
  EXPECT_EQ(run("render --part jobs.json:0").status, 1) << "frame 0 is the same, later frames are not";
  write("moving.gltf", test::moving_triangle_gltf({10, 3, 0}));
  write_world(101);
  EXPECT_EQ(run("render --part jobs.json:0").status, 1);
  write_world(100);
  EXPECT_EQ(render_part(0)["status"], "done");
}

TEST_F(FarmTest, APlanKeepsAllOptions)
{
  ASSERT_EQ(run(plan + std::string("--frames 1 --seconds-per-frame 1 --animation leave --animation all")).status, 0);
  const nlohmann::json document = nlohmann::json::parse(read("jobs.json"), nullptr, false);
  const std::vector<std::string> arguments = document["arguments"];
  EXPECT_EQ(std::ranges::count(arguments, "--animation=leave"), 1);
  EXPECT_EQ(std::ranges::count(arguments, "--animation=all"), 1);
  EXPECT_EQ(render_part(0)["status"], "done");
}

TEST_F(FarmTest, NoTwoScenesOfAPlanHaveOnePicture)
{
  fs::create_directories(folder / "other");
  fs::copy(folder / "moving.gltf", folder / "other/moving.gltf");
  const std::string several = "plan moving.gltf other/moving.gltf --seconds-per-frame 1 -o jobs.json --pictures ";
  const Finished same = run(several + "{scene}_0.exr");
  EXPECT_EQ(same.status, 2);
  EXPECT_NE(same.err.find("moving_0.exr"), std::string::npos) << same.err;
  EXPECT_FALSE(fs::exists(folder / "jobs.json"));
  const Finished missing = run(plan + std::string("--frames 1 --seconds-per-frame 1 --pictures missing/f.exr"));
  EXPECT_EQ(missing.status, 1) << "each part would fail";
  EXPECT_NE(missing.err.find("--pictures 'missing/f.exr': the folder 'missing' does not exist"), std::string::npos)
      << missing.err;
}

TEST_F(FarmTest, AnEarlyEndLeavesACheckpointThatIsJoinedWithTheRest)
{
  const std::string whole = "render moving.gltf --size 64x36 --samples 1000 ";
  ASSERT_EQ(run(whole + "-o whole.exr").status, 0);
  // The machine decides how long the start takes.
  Finished stopped;
  for (double seconds = 0.2; seconds < 100.0 && !fs::exists(folder / "f.checkpoint.exr"); seconds *= 1.5) {
    stopped = run(whole + "-o f.exr --checkpoint --progress --stop-after " + std::to_string(seconds));
    ASSERT_EQ(stopped.status, 6) << stopped.err;
    EXPECT_NE(stopped.err.find("gnomon: stopped by --stop-after\n"), std::string::npos) << stopped.err;
    EXPECT_FALSE(fs::exists(folder / "f.exr"));
  }
  EXPECT_EQ(stopped.err.rfind("PROGRESS 0.0%\nPROGRESS 0.1%\n", 0), 0U) << stopped.err;
  const std::string samples = "f.checkpoint.exr: samples 0 to ";
  const std::size_t at = stopped.err.find(samples);
  ASSERT_NE(at, std::string::npos) << stopped.err;
  const int next = std::stoi(stopped.err.substr(at + samples.size())) + 1;
  ASSERT_EQ(run(whole + "-o rest.exr --sample-range " + std::to_string(next) + "-999").status, 0);
  ASSERT_EQ(run("merge f.checkpoint.exr rest.exr -o joined.exr").status, 0);
  const std::vector<float> expected = values_of("whole.exr");
  const std::vector<float> joined = values_of("joined.exr");
  ASSERT_EQ(joined.size(), expected.size());
  for (std::size_t i = 0; i < joined.size(); i++) {
    // Rounding of a thousand additions.
    ASSERT_NEAR(joined[i], expected[i], 1e-4F * (std::abs(expected[i]) + 1e-3F)) << i;
  }
  ASSERT_EQ(run(whole + "-o f.exr --checkpoint").status, 0);
  EXPECT_FALSE(fs::exists(folder / "f.checkpoint.exr")) << "the picture is complete";
}

TEST_F(FarmTest, SigtermEndsAfterTheSample)
{
  const std::string command =
      "cd '" + folder.string() + "'; '" + GNOMON_PROGRAM +
      "' render moving.gltf --size 640x360 --samples 65536 -o f.exr --progress 2> err.txt & p=$!; "
      "until grep -qs 'PROGRESS 0.1' err.txt; do sleep 0.02; done; kill -TERM $p; wait $p";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 6);
  EXPECT_NE(read("err.txt").find("gnomon: stopped by SIGTERM"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "f.exr"));
}

TEST_F(FarmTest, TransientFailuresHaveAStatusOfTheirOwn)
{
  const std::string render = "render moving.gltf --size 8x8 --samples 1 -o ";
  fs::create_symlink("/dev/full", folder / "full.exr");
  EXPECT_EQ(run(render + "full.exr").status, 5);
  EXPECT_EQ(run(render + "missing/f.exr").status, 1);
  // A picture is written while the next is drawn.
  for (const std::string frame : {"0", "1", "2"}) {
    fs::create_symlink("/dev/full", folder / ("s_" + frame + ".exr"));
    EXPECT_EQ(run(render + "s_#.exr --frames 0-2 --fps 10").status, 5) << frame;
    fs::remove(folder / ("s_" + frame + ".exr"));
  }
  EXPECT_EQ(run("render missing.gltf -o f.exr").status, 1);
  setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
  const Finished without_device = run(render + "f.exr --backend gl");
  unsetenv("MESA_GL_VERSION_OVERRIDE");
  EXPECT_EQ(without_device.status, 5);
  EXPECT_NE(without_device.err.find("no OpenGL 4.5 context"), std::string::npos) << without_device.err;
}

TEST_F(FarmTest, SeveralScenesAreThePicturesOfAProcessEach)
{
  write("metal.gltf", test::rough_metal_gltf);
  write("broken.gltf", "{");
  for (const std::string scene : {"moving", "metal"}) {
    ASSERT_EQ(run("render " + scene + ".gltf --size 16x9 --samples 2 -o " + scene + "_alone.exr").status, 0);
  }
  const std::string several = "render moving.gltf broken.gltf metal.gltf moving.gltf --size 16x9 --samples 2 -o ";
  EXPECT_EQ(run(several + "f.exr").status, 2);
  EXPECT_EQ(run(several + "{scene}.exr").status, 2) << "two scenes of one name";
  const Finished finished = run("render moving.gltf broken.gltf metal.gltf --size 16x9 --samples 2 -o {scene}_0.exr");
  EXPECT_EQ(finished.status, 1) << "a scene cannot be read";
  EXPECT_NE(finished.err.find("broken.gltf: "), std::string::npos) << finished.err;
  for (const std::string scene : {"moving", "metal"}) {
    EXPECT_EQ(values_of(scene + "_0.exr"), values_of(scene + "_alone.exr")) << scene;
    EXPECT_FALSE(values_of(scene + "_0.exr").empty()) << scene;
  }
}

}  // namespace
}  // namespace gnomon
