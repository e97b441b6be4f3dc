// SPDX-License-Identifier: MIT
// Accumulation over draws, and passes that a target needs, on the null backend.
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

namespace gnomon::eevee {
namespace {

constexpr glm::ivec2 size_px(16, 12);

class TargetTest : public testing::Test {
 protected:
  TargetTest()
  {
    object = test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F))),
                              glm::mat4(1.0F));
    test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0, 0, -1}, 1.0F);
  }
  /** Passes by name that \a action runs. */
  template <typename Action>
  gpu::PassCounts passes_of(Action &&action)
  {
    const gpu::PassCounts before = device->pass_counts();
    action();
    gpu::PassCounts passes;
    for (const auto &[name, count] : device->pass_counts()) {
      const auto earlier = before.find(name);
      const std::uint64_t runs = count - (earlier == before.end() ? 0 : earlier->second);
      if (runs > 0) {
        passes[name] = runs;
      }
    }
    return passes;
  }

  using Passes = gpu::PassCounts;
  const Passes sample = {{"gbuffer", 1}, {"deferred_lit", 1}, {"film", 1}, {"tonemap", 1}};
  const Passes no_sample = {{"tonemap", 1}};

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  scene::Handle<scene::Node> object;
  scene::PlacedCamera camera = test::camera_at({0, 0, 4}, {0, 0, 0});
  draw::Target target{.framebuffer = gpu::HostFramebuffer{1, size_px}};
};

TEST_F(TargetTest, ASampleIsDrawnForEachDrawUntilThePictureIsComplete)
{
  SceneRenderer renderer(*device, scene, size_px, {.sample_count = 3});
  renderer.sync();
  for (const bool is_last : {false, false, true}) {
    EXPECT_EQ(passes_of([&] { EXPECT_EQ(renderer.draw_sample(camera, target), is_last); }), sample);
  }
  for (int i = 0; i < 3; i++) {
    // Like a host that syncs in each frame.
    renderer.sync();
    EXPECT_EQ(passes_of([&] { EXPECT_TRUE(renderer.draw_sample(camera, target)); }), no_sample);
  }
  EXPECT_EQ(passes_of([&] { renderer.draw_sample(camera); }), Passes());
  EXPECT_EQ(passes_of([&] { renderer.draw(camera); }), (Passes{{"gbuffer", 3}, {"deferred_lit", 3}, {"film", 3}}))
      << "a whole picture, which is drawn anew";
}

TEST_F(TargetTest, APictureWithoutALimitEndsWhenTheHostEndsIt)
{
  SceneRenderer renderer(*device, scene, size_px, {.sample_count = 0});
  renderer.sync();
  renderer.engine().finish(renderer.viewport());
  for (int i = 0; i < 300; i++) {
    ASSERT_FALSE(renderer.draw_sample(camera));
  }
  // A sample at the centre of its pixel, which is the unit, has 7 % more weight than the mean of all samples.
  EXPECT_NEAR(renderer.engine().radiance_scale(renderer.viewport()) * 300.0, 1.07, 0.01);
  renderer.engine().finish(renderer.viewport());
  EXPECT_EQ(passes_of([&] { EXPECT_TRUE(renderer.draw_sample(camera, target)); }), no_sample);
  camera = test::camera_at({0, 1, 4}, {0, 0, 0});
  EXPECT_EQ(passes_of([&] { EXPECT_FALSE(renderer.draw_sample(camera, target)); }), sample) << "another picture";

  // The callback ends it, and the picture is written without another sample.
  const auto stop_at_5 = [](int samples_drawn) { return samples_drawn < 5; };
  EXPECT_EQ(passes_of([&] { EXPECT_EQ(renderer.draw(camera, {.progress = stop_at_5}, target), 5); }),
            (Passes{{"gbuffer", 5}, {"deferred_lit", 5}, {"film", 5}, {"tonemap", 1}}));
  EXPECT_EQ(renderer.draw(camera, {.seconds_max = 0.0}), 1) << "no time at all: one sample";
  EXPECT_THROW(renderer.draw(camera), gpu::Error) << "it would never end";
}

TEST_F(TargetTest, ThePictureOfAKnownCountCanBeEndedEarly)
{
  SceneRenderer renderer(*device, scene, size_px, {.sample_count = 8});
  renderer.sync();
  const auto stop_at_3 = [](int samples_drawn) { return samples_drawn < 3; };
  EXPECT_EQ(passes_of([&] { EXPECT_EQ(renderer.draw(camera, {.progress = stop_at_3}, target), 3); }),
            (Passes{{"gbuffer", 3}, {"deferred_lit", 3}, {"film", 3}, {"tonemap", 1}}));
  EXPECT_GT(renderer.engine().radiance_scale(renderer.viewport()), 1.5F);
  EXPECT_EQ(renderer.draw(camera), 8);
  EXPECT_EQ(renderer.engine().radiance_scale(renderer.viewport()), 1.0F);
}

TEST_F(TargetTest, EachChangeBeginsThePictureAnewAndNothingElseDoes)
{
  SceneRenderer renderer(*device, scene, size_px, {.sample_count = 4});
  renderer.sync();
  const auto is_begun_anew = [&](const std::function<void()> &change) {
    while (!renderer.draw_sample(camera, target)) {
    }
    change();
    renderer.sync();
    return !renderer.draw_sample(camera, target);
  };
  EXPECT_FALSE(is_begun_anew([] {}));
  EXPECT_FALSE(is_begun_anew([&] { scene.edit(object, [](scene::Node &node) { node.name = "renamed"; }); }));
  EXPECT_TRUE(is_begun_anew([&] { camera = test::camera_at({0, 1, 4}, {0, 0, 0}); }));
  EXPECT_TRUE(is_begun_anew([&] {
    scene.edit(object, [](scene::Node &node) { node.parent_from_node = glm::translate(glm::dmat4(1), {1, 0, 0}); });
  }));
  EXPECT_TRUE(
      is_begun_anew([&] { scene.edit(scene.lamps().first(), [](scene::Lamp &lamp) { lamp.intensity = 2.0F; }); }));
  EXPECT_TRUE(is_begun_anew([&] {
    test::edit_material(scene, 0, [](scene::Material &material) { material.base_color = glm::vec3(0.1F); });
  }));
  EXPECT_TRUE(is_begun_anew([&] {
    Settings settings = renderer.settings();
    settings.seed = 5;
    renderer.set_settings(settings);
  }));
  EXPECT_TRUE(is_begun_anew([&] {
    renderer.resize({8, 12});
    target.framebuffer = gpu::HostFramebuffer{1, {8, 12}};
  }));
  EXPECT_TRUE(is_begun_anew([&] { scene.edit(object, [](scene::Node &node) { node.is_visible = false; }); }));
}

TEST_F(TargetTest, OnlyATargetWithDepthTakesDepth)
{
  SceneRenderer renderer(*device, scene, size_px, {.sample_count = 2});
  renderer.sync();
  const auto has = [&](std::string_view name) {
    const std::vector<std::string> live = device->live_resources();
    return std::ranges::count(live, fmt::format("texture '{}'", name)) > 0;
  };
  renderer.draw_sample(camera, target);
  EXPECT_FALSE(has("picture_depth"));
  target.depth.emplace().clip_from_view = glm::perspective(0.8, 1.0, 0.1, 100.0);
  // The depth of the same picture is drawn once, without a sample's offset.
  Passes with_depth = sample;
  with_depth["picture_depth"] = 1;
  EXPECT_EQ(passes_of([&] { renderer.draw_sample(camera, target); }), with_depth);
  EXPECT_TRUE(has("picture_depth"));
  EXPECT_EQ(passes_of([&] { renderer.draw_sample(camera, target); }), no_sample);
  const FrameNode tree = renderer.inspect().report().tree;
  EXPECT_TRUE(find(*find(tree, "targets"), "target")->is_made);
  EXPECT_TRUE(find(*find(tree, "passes"), "picture_depth")->is_made);
  camera = test::camera_at({0, 1, 4}, {0, 0, 0});
  EXPECT_EQ(passes_of([&] { renderer.draw_sample(camera, target); }), with_depth) << "of another picture";

  SceneRenderer single(*device, scene, size_px);
  single.sync();
  EXPECT_EQ(passes_of([&] { single.draw_sample(camera, target); }), sample) << "the sample's depth is the picture's";
}

TEST_F(TargetTest, OverWithoutVisibleObjectsChangesNothing)
{
  SceneRenderer renderer(*device, scene, size_px);
  renderer.sync();
  camera = test::camera_at({0, 0, 4}, {0, 0, 8});
  EXPECT_EQ(passes_of([&] { renderer.draw_sample(camera, target); }), (Passes{{"film", 1}, {"tonemap", 1}}));
  target.composition = draw::Composition::Over;
  EXPECT_EQ(passes_of([&] { renderer.draw_sample(camera, target); }), Passes());
  EXPECT_EQ(device->counters().shaders_made, 0U);
}

TEST_F(TargetTest, APictureThatDoesNotFitIsRefusedAndNothingIsDrawn)
{
  SceneRenderer renderer(*device, scene, size_px);
  renderer.sync();
  target.origin_px = {1, 0};
  EXPECT_EQ(passes_of([&] { EXPECT_THROW(renderer.draw_sample(camera, target), gpu::Error); }), Passes());
  target.origin_px = {0, 0};
  EXPECT_EQ(passes_of([&] { renderer.draw_sample(camera, target); }), sample);
}

}  // namespace
}  // namespace gnomon::eevee
