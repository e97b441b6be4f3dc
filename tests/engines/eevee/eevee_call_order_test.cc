// SPDX-License-Identifier: MIT
// Calls in a wrong order are errors that name the missing call, and leave everything as it was.
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"

#include "gltf_export.hh"
#include "gltf_import.hh"
#include "gpu/gpu_testing.hh"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>

namespace gnomon::eevee {
namespace {

using test::error_of;
using test::expect_contains;

constexpr glm::ivec2 size_px{16, 12};

class CallOrderTest : public testing::Test {
 protected:
  CallOrderTest()
  {
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    node = test::add_object(scene, test::add_box_mesh(scene, material), glm::dmat4(1.0));
    test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 10.0F);
  }
  void move()
  {
    scene.set_transform(node, glm::translate(scene.nodes()[node].parent_from_node, {0.1, 0, 0}));
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  scene::Handle<scene::Node> node;
  scene::PlacedCamera camera = test::camera_at({0, -3, 6}, {0, 0, 0});
};

TEST_F(CallOrderTest, OfASceneRenderer)
{
  const std::string sync = "call SceneRenderer::sync before a draw";
  const std::string draw = "call SceneRenderer::draw or draw_sample before read_picture";
  SceneRenderer renderer(*device, scene, size_px);
  const auto draw_error = [&] {
    expect_contains(error_of([&] { renderer.draw(camera); }), sync);
    expect_contains(error_of([&] { renderer.draw_sample(camera); }), sync);
    // A camera that is so far away that the origin follows it is no sync.
    const scene::PlacedCamera far = test::camera_at({1e5F, 0, 6}, {0, 0, 0});
    return error_of([&] { renderer.draw_sample(far); });
  };
  const auto read_error = [&] { return error_of([&] { static_cast<void>(renderer.read_picture()); }); };
  expect_contains(draw_error(), sync);
  expect_contains(read_error(), draw);
  renderer.sync();
  expect_contains(read_error(), draw);
  renderer.draw(camera);
  EXPECT_EQ(read_error(), "");
  const auto expect_stale = [&](auto &&change) {
    change();
    expect_contains(draw_error(), sync);
    renderer.sync();
    renderer.draw(camera);
    EXPECT_EQ(read_error(), "");
  };
  expect_stale([&] { move(); });
  expect_stale([&] { renderer.set_settings({.sample_count = 2}); });
  expect_stale([&] { renderer.resize({24, 8}); });
  // After a sync that changes the picture, the old one is not the picture of the scene.
  move();
  renderer.sync();
  expect_contains(read_error(), draw);
  // These sync themselves.
  move();
  gpu::Packet packet;
  renderer.prepare(packet, camera);
  device->submit(packet);
  move();
  renderer.draw_within(10.0, camera);
}

TEST_F(CallOrderTest, OfAViewport)
{
  render_scene::RenderScene shared(*device, scene);
  Engine engine(shared, {});
  draw::Viewport viewport(*device, size_px);
  const std::array<draw::Engine *, 1> engines = {&engine};
  const auto sync = [&] { viewport.sync(engines, shared.objects()); };
  const auto draw = [&] { viewport.draw(engines, view_of(camera, size_px)); };
  const auto write = [&] { viewport.write(engines, {}); };
  const std::string no_sync = "call draw::Viewport::sync before draw";
  expect_contains(error_of(draw), no_sync);
  expect_contains(error_of(write), no_sync);
  expect_contains(error_of([&] { static_cast<void>(engine.radiance(viewport)); }), "call draw::Viewport::draw");
  shared.update();
  sync();
  expect_contains(error_of(write), "call draw::Viewport::draw before write");
  draw();
  write();
  move();
  expect_contains(error_of(draw), "call RenderScene::update and draw::Viewport::sync before draw");
  shared.update();
  expect_contains(error_of(draw), no_sync);
  sync();
  draw();
  engine.set_settings({.sample_count = 2});
  expect_contains(error_of(draw), no_sync);
  sync();
  draw();
  viewport.resize({24, 8});
  expect_contains(error_of(draw), no_sync);
  sync();
  draw();
  // Another viewport's sync is not that of this one.
  draw::Viewport other(*device, size_px);
  move();
  shared.update();
  other.sync(engines, shared.objects());
  expect_contains(error_of(draw), no_sync);
}

/** An engine with a broken precondition. */
class BrokenEngine final : public draw::Engine {
 public:
  [[nodiscard]] std::string_view name() const override
  {
    return "broken";
  }
  void init(draw::Viewport & /*viewport*/) override {}
  void cache_init(draw::Viewport & /*viewport*/) override {}
  void cache_populate(draw::Viewport & /*viewport*/, const draw::ObjectBuffer & /*objects*/,
                      draw::ObjectIndex /*object*/) override
  {
  }
  void cache_finish(draw::Viewport & /*viewport*/) override {}
  void draw_scene(draw::Viewport &viewport, const draw::View & /*view*/) override
  {
    buffer = viewport.device().create_buffer({"made before", gpu::BufferKind::Uniform, 16});
    static_cast<void>(draw::orthographic(0.0F, 1.0F, 1.0F, 2.0F));
  }

  gpu::Buffer buffer;
};

TEST_F(CallOrderTest, AfterAnInternalErrorTheSceneCanBeSavedAndANewRendererDraws)
{
  {
    render_scene::RenderScene shared(*device, scene);
    shared.update();
    Engine engine(shared, {});
    BrokenEngine broken;
    draw::Viewport viewport(*device, size_px);
    const std::array<draw::Engine *, 2> engines = {&engine, &broken};
    viewport.sync(engines, shared.objects());
    for (int i = 0; i < 2; i++) {
      test::expect_internal_error([&] { viewport.draw(engines, view_of(camera, size_px)); },
                                  "draw_view.cc:[0-9]+: half_width != 0.*half size 0x1");
    }
    // The viewport itself goes on without the engine.
    const std::array<draw::Engine *, 1> sound = {&engine};
    viewport.draw(sound, view_of(camera, size_px));
  }
  SceneRenderer renderer(*device, scene, size_px);
  renderer.sync();
  renderer.draw(camera);
  EXPECT_FALSE(renderer.read_picture().empty());
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "after_an_error.glb";
  gltf::export_gltf(scene, path);
  EXPECT_EQ(gltf::import_gltf(path).objects().size(), scene.objects().size());
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace gnomon::eevee
