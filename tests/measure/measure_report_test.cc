// SPDX-License-Identifier: MIT
#include "measure_report.hh"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace gnomon::measure {
namespace {

PictureReport picture(int sample_count, double seconds, double rmse)
{
  PictureReport one;
  one.sample_count = sample_count;
  one.seconds = {seconds};
  one.error.rmse = rmse;
  return one;
}

/** Adds pictures of the first technique of the grid. */
SceneReport scene_of(std::vector<PictureReport> pictures)
{
  SceneReport scene;
  scene.name = "scene";
  scene.techniques.emplace_back();
  scene.techniques[0].technique = report_techniques().front();
  scene.techniques[0].pictures = std::move(pictures);
  return scene;
}

TEST(Report, MedianAndSpread)
{
  EXPECT_EQ(median({}), 0.0);
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_EQ(spread({5.0}), 0.0);
  // Quartiles 2 and 4 around 3.
  EXPECT_DOUBLE_EQ(spread({5.0, 1.0, 3.0, 2.0, 4.0}), 1.0 / 3.0);
}

TEST(Report, FrontHasTheUndominatedPictures)
{
  SceneReport scene = scene_of(
      {picture(1, 1.0, 0.5), picture(2, 2.0, 0.6), picture(3, 2.0, 0.3), picture(4, 3.0, 0.3), picture(5, 4.0, 0.1)});
  // The fastest picture is not finite, so it is not on the front.
  scene.techniques[0].pictures.push_back(picture(6, 0.1, 0.0));
  scene.techniques[0].pictures.back().error.rmse = std::nan("");
  find_front(scene);
  std::vector<bool> is_on_front;
  for (const PictureReport &one : scene.techniques[0].pictures) {
    is_on_front.push_back(one.is_on_front);
  }
  EXPECT_EQ(is_on_front, (std::vector<bool>{true, false, true, false, true, false}));
}

TEST(Report, ConvergenceOrderIsThePower)
{
  std::vector<glm::dvec2> points;
  for (const double x : {256.0, 512.0, 1024.0}) {
    points.emplace_back(x, 7.0 * std::pow(x, -1.25));
  }
  ASSERT_TRUE(convergence_order(points));
  EXPECT_NEAR(*convergence_order(points), 1.25, 1e-12);
  points[1].y = 0.0;
  EXPECT_FALSE(convergence_order(points));
  EXPECT_FALSE(convergence_order({{1.0, 1.0}}));
}

TEST(Report, AllLampsAreWeightedByTheirPixels)
{
  std::vector<LampError> lamps(2);
  lamps[0].error.facing_count = 300;
  lamps[0].error.wrong_count = 3;
  lamps[0].error.mean_absolute_error = 0.1;
  lamps[0].error.edge_offset_max = 2.0;
  lamps[1].error.facing_count = 100;
  lamps[1].error.mean_absolute_error = 0.5;
  const reference::VisibilityError all = all_lamps(lamps);
  EXPECT_EQ(all.facing_count, 400U);
  EXPECT_DOUBLE_EQ(all.wrong_fraction, 3.0 / 400.0);
  EXPECT_DOUBLE_EQ(all.mean_absolute_error, 0.2);
  EXPECT_EQ(all.edge_offset_max, 2.0);
  EXPECT_EQ(all_lamps({}).wrong_fraction, 0.0);
}

TEST(Report, TechniquesHaveUniqueLabels)
{
  std::set<std::string> labels;
  std::set<std::string> files;
  for (const Technique &technique : report_techniques()) {
    EXPECT_TRUE(labels.insert(label(technique)).second) << label(technique);
    EXPECT_TRUE(files.insert(picture_file(scene_of({}), technique, 1)).second) << label(technique);
    EXPECT_FALSE(technique.sample_counts.empty()) << label(technique);
  }
}

TEST(Report, JsonHasAllThatContinuingARunNeeds)
{
  RunReport run;
  run.program = "gnomon";
  run.commit = "abc";
  run.device = "device";
  run.machine = "machine";
  run.date = "today";
  run.size_px = {640, 360};
  run.rounds = 3;
  run.build = "fedc";
  run.reference_samples = 64;
  run.has_multiscatter = true;
  run.seconds = 12.5;
  run.scenes.push_back(scene_of({picture(1, 0.5, 0.25), picture(4, 2.0, 0.125), picture(16, 8.0, 0.0625)}));
  SceneReport &scene = run.scenes[0];
  scene.path = "folder/scene.glb";
  scene.fingerprint = "0123";
  scene.reference_noise = 0.001;
  scene.warnings = {"a warning"};
  TechniqueReport &technique = scene.techniques[0];
  technique.pictures[1].error.rmse = std::numeric_limits<double>::quiet_NaN();
  technique.pictures[1].error.non_finite_count = 5;
  technique.step_seconds = {{{"lit", 0.1}, {"shadows", 0.2}}};
  technique.lamps = {{"lamp", {}}};
  technique.lamps[0].error.wrong_count = 9;
  technique.limits = {"a limit"};
  technique.lost_shadow_count = 2;
  technique.memory_bytes = 1234;
  const nlohmann::json json = to_json(run);
  const RunReport again = run_from_json(nlohmann::json::parse(json.dump()));
  EXPECT_EQ(to_json(again), json);
  EXPECT_TRUE(again.has_multiscatter);
  EXPECT_TRUE(std::isnan(again.scenes[0].techniques[0].pictures[1].error.rmse));
  EXPECT_EQ(again.scenes[0].techniques[0].technique.sample_counts, technique.technique.sample_counts);
  EXPECT_THROW(static_cast<void>(run_from_json(nlohmann::json::object())), std::exception);

  // Inconsistent data is refused, so that no later code reads past its end.
  const auto throws = [&json](const std::string &path, const nlohmann::json &value) {
    nlohmann::json broken = json;
    broken[nlohmann::json::json_pointer("/scenes/0/techniques/0/" + path)] = value;
    EXPECT_THROW(static_cast<void>(run_from_json(broken)), std::exception) << path;
  };
  throws("pictures/0/samples", 2);
  throws("pictures/0/seconds", {1.0, 2.0});
  throws("pictures/3", json["scenes"][0]["techniques"][0]["pictures"][0]);
  throws("technique", "none of them");
  nlohmann::json rounds = json;
  rounds["rounds"] = 0;
  EXPECT_THROW(static_cast<void>(run_from_json(rounds)), std::exception);
}

TEST(Report, CsvHasOneRowPerPictureAndEqualColumns)
{
  RunReport run;
  run.scenes.push_back(scene_of({picture(1, 0.5, 0.25), picture(4, 2.0, 0.125)}));
  run.scenes[0].name = "say \"cheese\"";
  const std::string csv = to_csv(run);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 3);
  // Names of techniques are quoted, because some contain a comma; the first does not.
  EXPECT_EQ(std::ranges::count(csv, ','), 3 * 24);
  EXPECT_NE(csv.find("\n\"say \"\"cheese\"\"\",\"no shadow\",0,1,"), std::string::npos) << csv;
}

}  // namespace
}  // namespace gnomon::measure
