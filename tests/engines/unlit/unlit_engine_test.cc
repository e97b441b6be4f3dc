// SPDX-License-Identifier: MIT
#include "unlit_engine.hh"

#include "unlit_depth_camera.hh"
#include "unlit_interfaces.hh"
#include "unlit_programs.hh"

#include "eevee_engine.hh"
#include "engines/eevee/eevee_test_scene.hh"
#include "render_camera.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

namespace gnomon::unlit {
namespace {

class UnlitTest : public testing::Test {
 protected:
  void SetUp() override
  {
    const auto plain = test::add_material(scene, {0.5F, 0.5F, 0.5F});
    test::add_object(scene, test::add_square_mesh(scene, plain), glm::dmat4(1.0));
    test::add_object(scene, test::add_box_mesh(scene, plain), glm::scale(glm::dmat4(1), glm::dvec3(0.2)));
    test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0.3F, 0, -1}, 1.0F);
  }
  void draw(draw::Viewport &viewport)
  {
    render_scene.update();
    const std::array<draw::Engine *, 1> engines = {&engine};
    viewport.sync(engines, render_scene.objects());
    viewport.draw(engines, view);
  }
  [[nodiscard]] std::uint64_t depth_passes() const
  {
    const auto found = device->pass_counts().find("unlit depth camera");
    return found == device->pass_counts().end() ? 0 : found->second;
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  render_scene::RenderScene render_scene{*device, scene};
  Engine engine{render_scene};
  draw::View view = render_scene::view_of(test::camera_at({0, -4, 4}, {0, 0, 0}), {16, 12});
};

TEST_F(UnlitTest, TheDepthCameraRendersWithinTheViewportsPassAndOnlyWhenItSeesSomethingElse)
{
  draw::Viewport viewport(*device, {16, 12});
  draw(viewport);
  EXPECT_EQ(device->pass_counts().at("unlit"), 2U) << "suspended by the push, and resumed by the pop";
  EXPECT_EQ(depth_passes(), 1U);

  scene.edit(test::handle_at(scene.materials(), 0), [](scene::Material &one) { one.base_color.r = 0.1F; });
  scene.edit(test::handle_at(scene.lamps(), 0), [](scene::Lamp &lamp) { lamp.intensity = 7.0F; });
  draw(viewport);
  EXPECT_EQ(viewport.samples_drawn(), 1);
  EXPECT_EQ(device->pass_counts().at("unlit"), 3U);
  EXPECT_EQ(depth_passes(), 1U);

  draw::Viewport other(*device, {8, 8});
  draw(other);
  EXPECT_EQ(depth_passes(), 1U) << "one picture of the depth camera serves all viewports";

  // Within the bounds of the scene, so that the depth camera stays where it is.
  scene.set_transform(scene.objects().back().node,
                      glm::scale(glm::translate(glm::dmat4(1), {0.3, 0, 0}), glm::dvec3(0.2)));
  draw(viewport);
  EXPECT_EQ(depth_passes(), 2U);
  scene.set_transform(scene.placed_lamps().front().node, glm::dmat4(1));
  draw(viewport);
  EXPECT_EQ(depth_passes(), 3U);
}

TEST_F(UnlitTest, AStillViewportDrawsNothingMore)
{
  draw::Viewport viewport(*device, {16, 12});
  draw(viewport);
  const std::uint64_t draws = device->counters().draws;
  const std::uint64_t bytes = device->counters().upload_bytes;
  draw(viewport);
  EXPECT_EQ(device->counters().draws, draws);
  EXPECT_EQ(device->counters().upload_bytes, bytes);
}

TEST_F(UnlitTest, WithoutADepthCameraNothingOfItIsMade)
{
  engine.set_settings({.has_shadow = false});
  draw::Viewport viewport(*device, {16, 12});
  draw(viewport);
  EXPECT_EQ(depth_passes(), 0U);
  EXPECT_EQ(engine.depth_camera_texture(), nullptr);
  for (const gpu::LiveResource &live : device->live()) {
    EXPECT_EQ(live.name.find("depth_camera"), std::string::npos) << live.name;
    EXPECT_EQ(live.detail.find("USE_DEPTH_CAMERA"), std::string::npos) << live.name;
  }
}

TEST_F(UnlitTest, BadSettingsAreNamed)
{
  engine.set_settings({.depth_size_px = {0, 5}});
  draw::Viewport viewport(*device, {16, 12});
  EXPECT_THROW(draw(viewport), gpu::Error);
}

/** Actions of a host's menu of engines. */
TEST_F(UnlitTest, EnginesAreMadeByNameAndSwitchedForAViewport)
{
  draw::EngineRegistry registry;
  registry.add(eevee::engine_type(render_scene, {.shadow = {.map_size_px = 16}, .sample_count = 2}));
  registry.add(engine_type(render_scene));
  EXPECT_EQ(registry.names(), (std::vector<std::string>{"eevee", "unlit"}));
  const auto lit = registry.create("eevee");
  const auto plain = registry.create("unlit");
  draw::Viewport viewport(*device, {16, 12});
  render_scene.update();
  const auto draw_with = [&](draw::Engine &chosen) {
    const std::array<draw::Engine *, 1> engines = {&chosen};
    viewport.sync(engines, render_scene.objects());
    viewport.draw(engines, view);
  };
  draw_with(*lit);
  draw_with(*lit);
  EXPECT_EQ(viewport.samples_drawn(), 2);
  const std::uint64_t batches = std::ranges::count(device->live(), gpu::ResourceKind::Batch, &gpu::LiveResource::kind);
  draw_with(*plain);
  EXPECT_EQ(viewport.samples_drawn(), 1) << "another engine's picture begins anew";
  EXPECT_EQ(std::ranges::count(device->live(), gpu::ResourceKind::Batch, &gpu::LiveResource::kind), batches)
      << "meshes belong to the render scene";
  draw_with(*lit);
  EXPECT_EQ(viewport.samples_drawn(), 1);
}

TEST(DepthCamera, OfASunSeesAllOfTheScene)
{
  scene::Bounds bounds;
  bounds.extend({-3, 1, 2});
  bounds.extend({4, 8, 5});
  scene::PlacedLamp sun;
  sun.kind = scene::LampKind::Sun;
  sun.world_from_lamp = glm::inverse(glm::lookAt(glm::dvec3(100, 7, 3), glm::dvec3(101, 6, 1), glm::dvec3(0, 1, 0)));
  const auto camera = depth_camera_of(sun, bounds);
  ASSERT_TRUE(camera);
  const draw::View view = render_scene::view_of(*camera, {480, 320});
  for (int corner = 0; corner < 8; corner++) {
    const glm::vec4 point((corner & 1) != 0 ? bounds.max.x : bounds.min.x,
                          (corner & 2) != 0 ? bounds.max.y : bounds.min.y,
                          (corner & 4) != 0 ? bounds.max.z : bounds.min.z, 1.0F);
    for (const glm::vec4 &plane : view.frustum_planes_ws()) {
      EXPECT_GE(glm::dot(plane, point), 0.0F) << corner;
    }
  }
}

TEST(DepthCamera, OfASpotIsItsConeAndAHemiLampHasNone)
{
  scene::Bounds bounds;
  bounds.extend({-1, -1, -1});
  bounds.extend({1, 1, 1});
  scene::PlacedLamp lamp;
  lamp.kind = scene::LampKind::Spot;
  lamp.spot_outer_angle = 0.3F;
  EXPECT_FLOAT_EQ(depth_camera_of(lamp, bounds)->vertical_angle, 0.6F);
  EXPECT_EQ(depth_camera_of(lamp, bounds)->world_from_camera, lamp.world_from_lamp);
  lamp.kind = scene::LampKind::Hemi;
  EXPECT_FALSE(depth_camera_of(lamp, bounds));
  lamp.kind = scene::LampKind::Point;
  EXPECT_TRUE(depth_camera_of(lamp, bounds)) << "in the middle of the bounds";
  EXPECT_FALSE(depth_camera_of(lamp, scene::Bounds()));
}

TEST(UnlitPrograms, HaveAnInterfaceForEachVariant)
{
  ASSERT_EQ(interface_tables().size(), shader_declarations().size());
  for (std::size_t i = 0; i < shader_declarations().size(); i++) {
    EXPECT_EQ(std::size_t(shader_declarations()[i].id), i);
    EXPECT_EQ(interface_tables()[i].name, shader_declarations()[i].name);
    EXPECT_EQ(interface_tables()[i].variants.size(), shader_variants(shader_declarations()[i]).size());
  }
}

TEST_F(UnlitTest, CallsInAWrongOrderAreErrorsThatNameTheMissingOne)
{
  const auto expect_error = [](auto &&call, const std::string &missing) {
    try {
      call();
      ADD_FAILURE() << "no error: " << missing;
    }
    catch (const gpu::Error &error) {
      EXPECT_NE(std::string(error.what()).find(missing), std::string::npos) << error.what();
    }
  };
  const std::string no_sync = "call draw::Viewport::sync before draw";
  draw::Viewport viewport(*device, {16, 12});
  const std::array<draw::Engine *, 1> engines = {&engine};
  const auto draw_only = [&] { viewport.draw(engines, view); };
  expect_error(draw_only, no_sync);
  expect_error([&] { static_cast<void>(engine.radiance(viewport)); }, "call draw::Viewport::draw before radiance");
  draw(viewport);
  scene.edit(test::handle_at(scene.materials(), 0), [](scene::Material &one) { one.base_color.r = 0.1F; });
  expect_error(draw_only, "call RenderScene::update and draw::Viewport::sync before draw");
  render_scene.update();
  expect_error(draw_only, no_sync);
  draw(viewport);
  engine.set_settings({.has_shadow = false});
  expect_error(draw_only, no_sync);
  draw(viewport);
  viewport.resize({8, 8});
  expect_error(draw_only, no_sync);
  draw(viewport);
}

}  // namespace
}  // namespace gnomon::unlit
