// SPDX-License-Identifier: MIT
// Time budgets without a driver: the clock is the tests'.
#include "eevee_budgeted_picture.hh"
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"

#include "gpu/gpu_testing.hh"

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace gnomon::eevee {
namespace {

using test::error_of;
using test::expect_contains;

class BudgetTest : public testing::Test {
 protected:
  BudgetTest()
  {
    const auto plain = test::add_material(scene, glm::vec3(0.5F));
    test::add_object(scene, test::add_square_mesh(scene, plain), glm::dmat4(1));
    test::add_lamp(scene, scene::LampKind::Point, {0, 0, 3}, {0, 0, -1}, 10.0F);
  }
  bool draw(double budget_seconds)
  {
    draw::Engine *one = &engine;
    picture.begin(budget_seconds);
    render_scene.update();
    viewport.sync(std::span(&one, 1), render_scene.objects());
    return picture.draw(view_of(camera, {64, 48}, render_scene.origin_ws()), target.target());
  }
  [[nodiscard]] BudgetReport::Kind kind() const
  {
    return picture.report().kind;
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  scene::PlacedCamera camera = test::camera_at({0, -2, 3}, {0, 0, 0});
  render_scene::RenderScene render_scene{*device, scene};
  Settings settings{.sample_count = 8};
  Engine engine{render_scene, settings};
  draw::Viewport viewport{*device, {64, 48}};
  draw::TargetTexture target{*device, "target", gpu::Format::RGBA8, {64, 48}};
  double part_seconds = 0.004;
  double seconds = 0.0;
  BudgetedPicture picture{render_scene, engine, viewport, [this] {
                            seconds += 0.5 * part_seconds;
                            return seconds;
                          }};
};

TEST_F(BudgetTest, AnEditShowsAPreviewAndLaterCallsCompleteThePicture)
{
  EXPECT_FALSE(draw(0.01));
  EXPECT_EQ(kind(), BudgetReport::Kind::Preview);
  EXPECT_EQ(picture.report().drawn_size_px, glm::ivec2(16, 12));
  EXPECT_EQ(picture.report().shadow_divisor, 2);
  expect_contains(picture.report().text(), "16x12 of 64x48 px, shadows 1/2");
  int calls = 0;
  int samples = 0;
  while (!draw(0.01) && calls < 400) {
    EXPECT_GE(picture.report().samples_drawn, samples);
    EXPECT_TRUE(samples == 0 || kind() == BudgetReport::Kind::Refining);
    samples = picture.report().samples_drawn;
    calls++;
  }
  EXPECT_EQ(kind(), BudgetReport::Kind::Complete);
  EXPECT_EQ(picture.report().samples_drawn, 8);
  // Set-up and at most 16 parts a sample.
  EXPECT_LE(calls, 17 * 8);
  EXPECT_GT(calls, 8);
  // A complete picture is written again, and nothing else is drawn.
  const std::uint64_t draws = device->counters().draws;
  EXPECT_TRUE(draw(0.01));
  EXPECT_EQ(device->counters().draws, draws + 1);
}

TEST_F(BudgetTest, AnEditAmidASampleStartsAgain)
{
  draw(0.01);
  while (picture.report().samples_drawn < 2) {
    draw(0.01);
  }
  draw(0.01);
  scene.edit(test::handle_at(scene.lamps(), 0), [](scene::Lamp &lamp) { lamp.intensity = 5.0F; });
  EXPECT_FALSE(draw(0.01));
  EXPECT_EQ(kind(), BudgetReport::Kind::Preview);
  EXPECT_EQ(picture.report().samples_drawn, 0);
  camera = test::camera_at({0, -2.5, 3}, {0, 0, 0});
  EXPECT_FALSE(draw(0.01));
  EXPECT_EQ(kind(), BudgetReport::Kind::Preview);
  Settings other = settings;
  other.sample_count = 2;
  engine.set_settings(other);
  EXPECT_FALSE(draw(0.01));
  EXPECT_EQ(kind(), BudgetReport::Kind::Preview);
  int calls = 0;
  while (!draw(0.01) && calls < 100) {
    calls++;
  }
  EXPECT_EQ(picture.report().samples_drawn, 2);
}

TEST_F(BudgetTest, WhatTakesLittleTimeIsDrawnWithoutAPreview)
{
  part_seconds = 1e-5;
  draw(0.033);
  EXPECT_TRUE(draw(0.033)) << "all samples fit into one call";
  scene.edit(test::handle_at(scene.lamps(), 0), [](scene::Lamp &lamp) { lamp.intensity = 5.0F; });
  EXPECT_FALSE(draw(0.033));
  EXPECT_EQ(kind(), BudgetReport::Kind::Refining);
  EXPECT_EQ(picture.report().samples_drawn, 1);
}

TEST_F(BudgetTest, ACallOfAPictureWithoutEndEnds)
{
  Settings endless = settings;
  endless.sample_count = 0;
  engine.set_settings(endless);
  part_seconds = 0.0;
  draw(0.01);
  draw(0.01);
  for (int i = 1; i < 4; i++) {
    EXPECT_FALSE(draw(0.01));
    EXPECT_EQ(picture.report().samples_drawn, 64 * (i + 1));
  }
  engine.finish(viewport);
  EXPECT_TRUE(draw(0.01));
}

TEST_F(BudgetTest, TheSetUpOfASampleIsDividedIntoLayersOfShadowsThatFit)
{
  for (int i = 0; i < 4; i++) {
    test::add_lamp(scene, scene::LampKind::Spot, {float(i) - 1.5F, 0, 3}, {0, 0, -1}, 10.0F);
  }
  const auto faces_drawn = [](Engine &used_engine, draw::Viewport &used_viewport) {
    return int(Inspection(used_engine, used_viewport).report().shadow_counters.faces_drawn);
  };
  SceneRenderer whole(*device, scene, {64, 48}, settings);
  whole.sync();
  whole.draw(camera);
  const int all_faces = faces_drawn(whole.engine(), whole.viewport());
  ASSERT_GE(all_faces, 5);
  // Each part takes longer than the budget, so that a call has one.
  part_seconds = 0.02;
  int faces = 0;
  for (int calls = 0; !draw(0.01) && calls < 400; calls++) {
    const int before = std::exchange(faces, faces_drawn(engine, viewport));
    EXPECT_LE(faces - before, 1);
    EXPECT_TRUE(faces == all_faces || kind() == BudgetReport::Kind::Preview) << "lit without all layers";
  }
  EXPECT_EQ(kind(), BudgetReport::Kind::Complete);
  EXPECT_EQ(faces_drawn(engine, viewport), all_faces);
}

/** Size of what is shown, and of its shadows; above all previews are samples. */
std::array<int, 3> quality_of(const BudgetReport &report)
{
  return {report.samples_drawn, report.drawn_size_px.x * report.drawn_size_px.y, -report.shadow_divisor};
}

TEST_F(BudgetTest, APictureOfWhichNothingChangesGetsBetterAtAnySpeed)
{
  for (int i = 0; i < 30; i++) {
    test::add_lamp(scene, scene::LampKind::Point, {float(i % 6) - 2.5F, float(i / 6) - 2.5F, 3}, {0, 0, -1}, 10.0F);
  }
  int previews = 0;
  for (const double speed : {0.0, 1e-5, 1e-4, 1e-3, 4e-3, 0.02, 0.1, 1.0, 100.0}) {
    part_seconds = speed;
    scene.edit(test::handle_at(scene.lamps(), 0), [](scene::Lamp &lamp) { lamp.intensity += 1.0F; });
    bool is_complete = draw(0.033);
    std::array<int, 3> shown = quality_of(picture.report());
    int calls = 0;
    int unchanged = 0;
    for (; !is_complete && calls < 1000; calls++) {
      const bool was_preview = kind() == BudgetReport::Kind::Preview;
      previews += was_preview ? 1 : 0;
      is_complete = draw(0.033);
      const std::array<int, 3> before = std::exchange(shown, quality_of(picture.report()));
      ASSERT_GE(shown, before) << speed << " s a part";
      unchanged = shown > before ? 0 : unchanged + 1;
      // A sample takes its beginning, and 16 calls each for shadows and rows.
      ASSERT_LE(unchanged, was_preview && shown[1] < 64 * 48 ? BudgetedPicture::stalled_calls_max : 33)
          << speed << " s a part";
    }
    EXPECT_TRUE(is_complete) << speed;
    EXPECT_LE(calls, 8 * 33 + 11) << speed;
  }
  EXPECT_GE(previews, 30);
}

TEST_F(BudgetTest, ThePreviewSharesThePrograms)
{
  EXPECT_FALSE(draw(0.01));
  EXPECT_EQ(kind(), BudgetReport::Kind::Preview);
  while (!draw(0.01)) {
  }
  std::multiset<std::pair<std::string, std::string>> programs;
  for (const gpu::LiveResource &resource : device->live()) {
    if (resource.kind == gpu::ResourceKind::Shader) {
      programs.emplace(resource.name, resource.detail);
    }
  }
  EXPECT_GE(programs.size(), 4U);
  for (const auto &program : programs) {
    EXPECT_EQ(programs.count(program), 1U) << program.first << ' ' << program.second << " was compiled twice";
  }
}

TEST_F(BudgetTest, ABudgetOutOfTheRangeIsAnError)
{
  for (const double invalid :
       {0.0, -1.0, 1e-5, 11.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    expect_contains(error_of([&] { draw(invalid); }), "eevee: a budget of");
  }
}

TEST_F(BudgetTest, ADrawWithoutABudgetCompletesTheSampleThatHasBegun)
{
  draw(0.01);
  while (!viewport.has_begun_sample()) {
    draw(0.01);
  }
  draw::Engine *one = &engine;
  viewport.draw(std::span(&one, 1), view_of(camera, {64, 48}, render_scene.origin_ws()));
  EXPECT_FALSE(viewport.has_begun_sample());
  EXPECT_EQ(viewport.samples_drawn(), 1);
  draw(0.01);
  EXPECT_EQ(kind(), BudgetReport::Kind::Refining);
}

TEST_F(BudgetTest, ASceneRendererDrawsWithinABudget)
{
  SceneRenderer renderer(*device, scene, {64, 48}, settings);
  int calls = 1;
  while (!renderer.draw_within(10.0, camera, target.target()) && calls < 100) {
    calls++;
  }
  EXPECT_LE(calls, 4);
  EXPECT_EQ(renderer.budget_report().kind, BudgetReport::Kind::Complete);
  EXPECT_EQ(renderer.budget_report().samples_drawn, 8);
}

}  // namespace
}  // namespace gnomon::eevee
