// SPDX-License-Identifier: MIT
// Several viewports of one scene and engine: shared and separate resources.
#include "eevee_test_scene.hh"

#include "shadows/shadows.hh"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <optional>

namespace gnomon::eevee {
namespace {

/** A box under a point lamp, a spot, a sun and a lamp with an exponential shadow. */
class ViewportsTest : public testing::Test {
 protected:
  ViewportsTest()
  {
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    box = test::add_object(scene, test::add_box_mesh(scene, material), glm::dmat4(1.0));
    test::add_object(scene, test::add_square_mesh(scene, material),
                     glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, -1}), glm::dvec3(8.0)));
    test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 10.0F);
    test::add_lamp(scene, scene::LampKind::Spot, {3, 0, 4}, {-0.6F, 0, -0.8F}, 10.0F);
    const auto esm = test::add_lamp(scene, scene::LampKind::Point, {0, 3, 4}, {0, 0, -1}, 10.0F);
    scene.edit(esm, [](scene::Lamp &lamp) { lamp.shadow.kind = scene::ShadowKind::Esm; });
    sun = test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0, 0.6F, -0.8F}, 1.0F);
    settings.shadow = {.cube_size_px = 32, .map_size_px = 64, .esm = {.size_px = 32}};
    settings.shadow.cascades.count = 1;
    render_scene.emplace(*device, scene);
    engine.emplace(*render_scene, settings);
  }
  void draw(draw::Viewport &viewport, const scene::PlacedCamera &camera)
  {
    const std::array<draw::Engine *, 1> engines = {&*engine};
    render_scene->update();
    viewport.sync(engines, render_scene->objects());
    viewport.restart();
    viewport.draw(engines, view_of(render_scene->relative(camera), viewport.size_px()));
  }
  /** Bytes of shared resources: meshes, programs, lights and shadows, without pictures and view blocks. */
  std::map<std::string, std::size_t> shared_bytes() const
  {
    std::map<std::string, std::size_t> bytes;
    for (const gpu::LiveResource &live : device->live()) {
      const bool is_of_a_viewport = live.name == "film" || live.name == "depth" || live.name == "radiance" ||
                                    live.name == "view_block" || live.name == "shadow_block";
      if (!is_of_a_viewport) {
        bytes[live.name] += live.size_bytes;
      }
    }
    return bytes;
  }
  std::uint64_t layers_drawn(draw::Viewport &viewport)
  {
    return Inspection(*engine, viewport).shadow_counters().faces_drawn;
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  scene::Handle<scene::Node> box;
  scene::Handle<scene::Lamp> sun;
  Settings settings;
  std::optional<render_scene::RenderScene> render_scene;
  std::optional<Engine> engine;
  scene::PlacedCamera above = test::camera_at({0, -1, 12}, {0, 0, 0});
  scene::PlacedCamera beside = test::camera_at({-9, -9, 9}, {0, 0, 0});
};

TEST_F(ViewportsTest, ShadowsThatFollowNoViewAreDrawnAndKeptOnce)
{
  scene.remove(sun);
  draw::Viewport first(*device, {16, 16});
  draw(first, above);
  const auto with_one = shared_bytes();
  EXPECT_GT(with_one.at("shadow_cubes"), 0U);
  EXPECT_GT(with_one.at("shadow_maps"), 0U);
  EXPECT_TRUE(with_one.contains("shadow_esm") || with_one.contains("shadow_esm_half"));
  const std::uint64_t drawn = layers_drawn(first);
  EXPECT_GT(drawn, 0U);

  draw::Viewport second(*device, {24, 8});
  draw(second, beside);
  draw(first, above);
  EXPECT_EQ(shared_bytes(), with_one);
  EXPECT_EQ(layers_drawn(second), 0U);
  EXPECT_EQ(layers_drawn(first), drawn);
  EXPECT_EQ(Inspection(*engine, first).shadows().block_data().cubes[0].faces_and_filter,
            Inspection(*engine, second).shadows().block_data().cubes[0].faces_and_filter);
}

TEST_F(ViewportsTest, AnEditIsDrawnByTheFirstViewportThatNeedsIt)
{
  scene.remove(sun);
  draw::Viewport first(*device, {16, 16});
  draw::Viewport second(*device, {24, 8});
  draw(first, above);
  draw(second, beside);
  const std::uint64_t drawn = layers_drawn(first);
  scene.set_transform(box, glm::translate(glm::dmat4(1.0), {0.25, 0, 0}));
  draw(second, beside);
  EXPECT_GT(layers_drawn(second), 0U);
  const std::uint64_t drawn_again = layers_drawn(second);
  draw(first, above);
  EXPECT_EQ(layers_drawn(first), drawn);
  EXPECT_EQ(layers_drawn(second), drawn_again);
}

TEST_F(ViewportsTest, CascadesBelongToAViewport)
{
  draw::Viewport first(*device, {16, 16});
  draw(first, above);
  EXPECT_EQ(Inspection(*engine, first).shadows().scene().maps().desc().layers, 2) << "the spot's and the sun's";
  const std::uint64_t drawn = layers_drawn(first);
  {
    draw::Viewport second(*device, {16, 16});
    draw(second, beside);
    EXPECT_EQ(layers_drawn(second), 1U) << "the sun's, fitted to the second view";
    EXPECT_EQ(Inspection(*engine, first).shadows().scene().maps().desc().layers, 3);
    draw(first, above);
    draw(second, beside);
    EXPECT_EQ(layers_drawn(first), drawn) << "the second's is another layer";
    EXPECT_EQ(layers_drawn(second), 1U);
    const auto layer_of = [&](draw::Viewport &viewport, std::size_t map) {
      return Inspection(*engine, viewport).shadows().block_data().maps[map].layer;
    };
    EXPECT_EQ(layer_of(first, 0), layer_of(second, 0)) << "the spot's";
    EXPECT_NE(layer_of(first, 1), layer_of(second, 1)) << "the sun's";

    scene.set_transform(box, glm::translate(glm::dmat4(1.0), {0.25, 0, 0}));
    draw(first, above);
    const std::uint64_t drawn_by_first = layers_drawn(first);
    EXPECT_GT(drawn_by_first, drawn + 1);
    draw(second, beside);
    EXPECT_EQ(layers_drawn(second), 2U) << "its own cascade alone";
    EXPECT_EQ(layers_drawn(first), drawn_by_first);
  }
  const std::uint64_t before = layers_drawn(first);
  draw(first, above);
  EXPECT_EQ(Inspection(*engine, first).shadows().scene().maps().desc().layers, 2) << "the memory returns";
  EXPECT_EQ(layers_drawn(first), before);
}

TEST_F(ViewportsTest, UnsyncedViewportUsesALampThatAnotherSynced)
{
  draw::Viewport first(*device, {16, 16});
  draw(first, above);
  const std::array<draw::Engine *, 1> engines = {&*engine};
  test::add_lamp(scene, scene::LampKind::Point, {2, 3, 4}, {0, 0, -1}, 10.0F);
  draw::Viewport second(*device, {16, 16});
  draw(second, beside);
  first.sync(engines, render_scene->objects());
  first.draw(engines, view_of(render_scene->relative(above), first.size_px()));
  EXPECT_EQ(Inspection(*engine, first).shadows().states().size(), 5U);
}

TEST_F(ViewportsTest, NothingStaysAfterTheLastViewport)
{
  {
    draw::Viewport first(*device, {16, 16});
    draw::Viewport second(*device, {16, 16});
    draw(first, above);
    draw(second, beside);
    first.remove_engine(*engine);
    EXPECT_TRUE(shared_bytes().contains("shadow_cubes"));
    second.remove_engine(*engine);
    for (const auto &[name, bytes] : shared_bytes()) {
      EXPECT_FALSE(name.starts_with("shadow_cubes") || name.starts_with("shadow_maps") || name == "light_block")
          << name;
    }
  }
  draw::Viewport third(*device, {16, 16});
  draw(third, above);
  EXPECT_GT(layers_drawn(third), 0U);
}

TEST_F(ViewportsTest, SettingRecordsPassesOnlyIfTheyDependOnIt)
{
  draw::Viewport viewport(*device, {16, 16});
  draw(viewport, above);
  const auto recordings_after = [&](void (*change)(Settings &)) {
    const std::uint64_t before = Inspection(*engine, viewport).report().pass_recordings;
    change(settings);
    engine->set_settings(settings);
    draw(viewport, above);
    return Inspection(*engine, viewport).report().pass_recordings - before;
  };
  EXPECT_EQ(recordings_after([](Settings &one) { one.seed = 3; }), 0U);
  EXPECT_EQ(recordings_after([](Settings &one) { one.background.kind = Background::Kind::Color; }), 0U);
  EXPECT_EQ(recordings_after([](Settings &one) { one.shadow.esm.bias = 2.0F; }), 0U);
  EXPECT_EQ(recordings_after([](Settings &one) { one.has_cascade_tint = true; }), 1U);
  EXPECT_EQ(recordings_after([](Settings &one) { one.has_surfaces = true; }), 1U);
  EXPECT_EQ(recordings_after([](Settings &one) { one.shadow.kind = scene::ShadowKind::Pcf; }), 1U);
  EXPECT_EQ(recordings_after([](Settings &one) { one.shadow.pcf = PcfKernel{5}; }), 1U);
}

}  // namespace
}  // namespace gnomon::eevee
