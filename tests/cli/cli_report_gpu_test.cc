// SPDX-License-Identifier: MIT
// `gnomon report`, and `gnomon render` with a choice from its results.
#include "cli_process.hh"
#include "gpu_device_fixture.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace gnomon {
namespace {

using json = nlohmann::json;
using test::example;
using test::Finished;

class CliReportTest : public test::ProgramTest {
 protected:
  void SetUp() override
  {
    if (!test::testing_gl_device()) {
      GTEST_SKIP() << "no device to render with";
    }
  }
  Finished report(const std::string &options)
  {
    return run("report " + example("spots") +
               " -o out --size 48x27 --reference-samples 2 --technique 'hard 512' --technique 'esm 4 256' " + options);
  }
  json report_json() const
  {
    return json::parse(read("out/report.json"));
  }
};

TEST_F(CliReportTest, WritesTheMeasurements)
{
  const Finished finished = report("--rounds 2");
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  const json scene = report_json().at("scenes").at(0);
  EXPECT_EQ(scene.at("scene"), "spots");
  ASSERT_EQ(scene.at("techniques").size(), 2U);
  std::size_t front = 0;
  for (const json &technique : scene.at("techniques")) {
    EXPECT_EQ(technique.at("step_seconds").size(), 2U);
    EXPECT_EQ(technique.at("lost_shadows"), 0);
    EXPECT_GT(technique.at("memory_bytes"), 256 * 256 * 4);
    EXPECT_GT(technique.at("visibility").at("facing"), 100);
    // Three numbers of samples; more samples are nearer to the reference.
    ASSERT_EQ(technique.at("pictures").size(), 3U);
    EXPECT_GT(technique.at("pictures").at(0).at("rmse"), technique.at("pictures").at(1).at("rmse"));
    for (const json &picture : technique.at("pictures")) {
      EXPECT_EQ(picture.at("seconds").size(), 2U);
      EXPECT_EQ(picture.at("non_finite"), 0);
      EXPECT_GT(picture.at("flip"), 0.0);
      EXPECT_LT(picture.at("rmse"), 0.1);
      front += picture.at("front").get<bool>() ? 1 : 0;
    }
  }
  EXPECT_GE(front, 2U);
  const std::string csv = read("out/report.csv");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 6);
  const std::string html = read("out/index.html");
  EXPECT_NE(html.find("Pareto front"), std::string::npos);
  EXPECT_NE(html.find("data:image/png;base64,"), std::string::npos);
  EXPECT_EQ(read("out/report.txt"), finished.out.substr(0, read("out/report.txt").size()));
  // Pictures of the front, the reference, and the four files above; no other file.
  const auto files = std::filesystem::directory_iterator(folder / "out");
  EXPECT_EQ(std::size_t(std::distance(begin(files), end(files))), front + 5);
  // The figures match the pictures.
  EXPECT_EQ(std::system(("'" GNOMON_SOURCE "/scripts/check_report' '" + (folder / "out").string() + "' > '" +
                         (folder / "stdout.txt").string() + "'")
                            .c_str()),
            0)
      << read("stdout.txt");
}

TEST_F(CliReportTest, ContinuesAnInterruptedRun)
{
  ASSERT_EQ(report("--rounds 2").status, 0);
  json before = report_json();
  // The report becomes that of a run that was interrupted before the second technique of the second round.
  json &technique = before.at("scenes").at(0).at("techniques").at(1);
  technique.at("step_seconds").erase(1);
  for (json &picture : technique.at("pictures")) {
    picture.at("seconds").erase(1);
    picture.at("seconds").at(0) = 123.0;
  }
  write("out/report.json", before.dump());
  std::filesystem::remove(folder / "out/index.html");
  // An interrupted run has all pictures; a complete run has only those of the front.
  for (const char *name : {"hard_512", "esm_4_256"}) {
    for (const int n : {1, 4, 16}) {
      std::filesystem::copy_file(folder / "out/spots-reference.exr",
                                 folder / fmt::format("out/spots-{}-{}.exr", name, n),
                                 std::filesystem::copy_options::skip_existing);
    }
  }
  const Finished finished = report("--rounds 2");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json after = report_json();
  const json &again = after.at("scenes").at(0).at("techniques").at(1);
  // Existing measurements are kept, and only the missing ones are made.
  EXPECT_EQ(after.at("scenes").at(0).at("techniques").at(0), before.at("scenes").at(0).at("techniques").at(0));
  EXPECT_EQ(again.at("step_seconds").size(), 2U);
  EXPECT_EQ(again.at("pictures").at(0).at("seconds").at(0), 123.0);
  EXPECT_LT(again.at("pictures").at(0).at("seconds").at(1), 123.0);
  EXPECT_FALSE(read("out/index.html").empty());
}

TEST_F(CliReportTest, RunWithOtherSettingsStartsAgain)
{
  ASSERT_EQ(report("--rounds 1").status, 0);
  const Finished finished = report("--rounds 2");
  EXPECT_EQ(finished.status, 0);
  EXPECT_NE(finished.err.find("starting again"), std::string::npos) << finished.err;
  EXPECT_EQ(report_json().at("rounds"), 2);
  write("out/report.json", "no json");
  EXPECT_NE(report("--rounds 1").err.find("out/report.json: cannot be continued"), std::string::npos);
}

TEST_F(CliReportTest, EmptySceneIsMeasuredWithAWarning)
{
  write("empty.gltf", R"({"asset": {"version": "2.0"}})");
  const Finished finished = run("report empty.gltf -o out --size 8x8 --rounds 1 --technique 'hard 512'");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.err.find("warning: empty: "), std::string::npos) << finished.err;
  EXPECT_FALSE(report_json().at("scenes").at(0).at("warnings").empty());
}

/** The reference's noise is 0.08. Without the world, the reference or the pictures would lack 0.7. */
TEST_F(CliReportTest, TheWorldOfTheOptionsLightsPicturesAndReference)
{
  const Finished finished = run("report " + example("spots") +
                                " -o out --size 48x27 --reference-samples 16 --technique 'hard 512' --rounds 1 "
                                "--world 0.5,0.5,0.5 --world-strength 2");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json scene = report_json().at("scenes").at(0);
  EXPECT_EQ(scene.at("world"), "1, 1, 1 W/(sr m²)");
  EXPECT_NE(finished.out.find("spots, world: 1, 1, 1 W"), std::string::npos) << finished.out;
  const json &pictures = scene.at("techniques").at(0).at("pictures");
  EXPECT_LT(pictures.at(2).at("rmse"), 0.12);
  EXPECT_EQ(pictures.at(2).at("non_finite"), 0);
}

TEST_F(CliReportTest, MultipleScatteringIsInPicturesAndReference)
{
  write("metal.gltf", test::rough_metal_gltf);
  const std::string options = " -o out --size 32x18 --reference-samples 16 --technique 'no shadow' --rounds 1 ";
  for (const std::string specular : {"single", "multi"}) {
    ASSERT_EQ(run("report metal.gltf" + options + "--specular " + specular).status, 0);
    EXPECT_EQ(report_json().at("specular"), specular);
    EXPECT_NE(read("out/report.txt").find("--specular " + specular), std::string::npos);
    // The edges of the plane. With the other model, the surface would differ by 0.2 or more.
    EXPECT_LT(report_json().at("scenes").at(0).at("techniques").at(0).at("pictures").at(2).at("rmse"), 0.02);
  }
  const Finished finished = run("render metal.gltf -o a.exr --size 32x18 --max-error 0.1 --report out --json run.json");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.err.find("--specular multi"), std::string::npos) << finished.err;
}

TEST_F(CliReportTest, DeletedPictureIsRenderedAgain)
{
  ASSERT_EQ(report("--rounds 1").status, 0);
  ASSERT_TRUE(std::filesystem::remove(folder / "out/spots-reference.exr"));
  EXPECT_EQ(report("--rounds 1").status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/spots-reference.exr"));
}

TEST_F(CliReportTest, WrongUsage)
{
  Finished finished = report("--technique soft");
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.err.find("'soft' is not one of 'no shadow', 'hard 512'"), std::string::npos) << finished.err;
  EXPECT_EQ(run("report " + example("spots") + " -o out --reference-samples 3").status, 2);
  finished = run("report missing.glb -o out");
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("missing.glb"), std::string::npos) << finished.err;
  finished = report("--world nowhere.hdr");
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("nowhere.hdr: "), std::string::npos) << finished.err;
  EXPECT_NE(report("--world 1,1").err.find("it is no radiance: three finite numbers"), std::string::npos);
  EXPECT_EQ(run("report " + example("spots") + " " + example("spots") + " -o out").status, 1);
}

TEST_F(CliReportTest, RenderChoosesFromAReport)
{
  ASSERT_EQ(report("--rounds 1").status, 0);
  const std::string render = "render " + example("spots") + " -o a.exr --json run.json --report out ";
  Finished finished = run(render + "--size 48x27 --max-error 0.03");
  ASSERT_EQ(finished.status, 0) << finished.err;
  json choice = json::parse(read("run.json")).at("choice");
  EXPECT_EQ(choice.at("source"), "report out");
  EXPECT_EQ(choice.at("met"), true);
  EXPECT_LE(choice.at("predicted_rmse"), 0.03);
  EXPECT_LE(choice.at("measured_rmse"), 0.03);
  EXPECT_NE(finished.out.find("expected RMSE"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("measured: RMSE"), std::string::npos) << finished.out;

  // No technique is so exact: the nearest is chosen, and the failure is reported.
  finished = run(render + "--size 48x27 --max-error 0.00001 --strict");
  EXPECT_EQ(finished.status, 4);
  EXPECT_NE(finished.err.find("limit: RMSE 1e-05 required"), std::string::npos) << finished.err;
  EXPECT_EQ(json::parse(read("run.json")).at("choice").at("met"), false);

  EXPECT_EQ(run(render + "--max-error 0.1 --samples 4").status, 2);
  EXPECT_EQ(run(render + "--max-time 4 --shadow-memory 10").status, 2);
  EXPECT_EQ(run(render + "--max-error 0.1 --max-time 4").status, 2);
  EXPECT_EQ(run(render).status, 2);
  finished = run("render " + example("spots") + " -o a.exr --max-error 0.1 --report nowhere");
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("nowhere/report.json"), std::string::npos) << finished.err;
}

TEST_F(CliReportTest, RenderChoosesFromAPilot)
{
  Finished finished = run("render " + example("spots") + " -o a.exr --size 48x27 --json run.json --max-error 0.05");
  ASSERT_EQ(finished.status, 0) << finished.err;
  json choice = json::parse(read("run.json")).at("choice");
  EXPECT_NE(choice.at("source").get<std::string>().find("a pilot of"), std::string::npos);
  EXPECT_LE(choice.at("measured_rmse"), 0.05);
  EXPECT_EQ(choice.at("samples"), 1);
}

}  // namespace
}  // namespace gnomon
