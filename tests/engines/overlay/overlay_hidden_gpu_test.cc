// SPDX-License-Identifier: MIT
// Nodes that one viewport leaves out and the scene keeps: draw::View::hidden in the engines and in overlays.
#include "overlay.hh"

#include "engines/eevee/eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "gpu_read.hh"
#include "render_camera.hh"
#include "unlit_engine.hh"

#include <glm/gtc/matrix_transform.hpp>

namespace gnomon::overlay {
namespace {

using Nodes = std::vector<scene::Handle<scene::Node>>;

/** A floor, and before it a box with a child, a square that blends and a box that masks, lit from above. */
class HiddenNodesTest : public test::GpuDeviceTest {
 protected:
  static constexpr glm::ivec2 size_px{60, 40};

  HiddenNodesTest()
  {
    const auto material = test::add_material(scene, {0.8F, 0.5F, 0.2F});
    const auto blended = test::add_material(scene, {0.2F, 0.5F, 0.8F});
    scene.edit(blended, [](scene::Material &one) {
      one.alpha_mode = scene::AlphaMode::Blend;
      one.alpha = 0.5F;
    });
    const auto at = [](const glm::dvec3 &position, const glm::dvec3 &size) {
      return glm::scale(glm::translate(glm::dmat4(1), position), size);
    };
    const auto mesh = test::add_box_mesh(scene, material);
    floor = test::add_object(scene, mesh, at({0, -1.2, 0}, {4, 0.2, 4}));
    box = test::add_object(scene, mesh, at({-1, 0, 0}, glm::dvec3(0.5)));
    child = scene.add(
        scene::Node{.name = "child", .parent_from_node = at({0, 1.5, 0}, glm::dvec3(0.4)), .meshes = {mesh}}, box);
    glass = test::add_object(scene, test::add_square_mesh(scene, blended), at({1, 0, 0.5}, glm::dvec3(0.7)));
    test::add_lamp(scene, scene::LampKind::Point, {0, 4, 2}, {0, -1, 0}, 60.0F);
  }
  /** A picture in a renderer of its own. */
  test::Picture picture(const Nodes &hidden = {}, const Nodes &isolated = {})
  {
    eevee::SceneRenderer renderer(*device, scene, size_px, settings);
    renderer.sync();
    renderer.set_hidden(hidden, isolated);
    renderer.draw(camera);
    return {size_px, renderer.read_picture()};
  }
  /** For all nodes: a viewport shows the shadows of nodes that it hides. */
  void cast_no_shadows()
  {
    for (const auto node : {floor, box, child, glass}) {
      scene.edit(node, [](scene::Node &one) { one.casts_shadow = false; });
    }
  }
  /** The picture of the scene in which \a nodes are invisible. */
  test::Picture without(const Nodes &nodes)
  {
    for (const auto node : nodes) {
      scene.edit(node, [](scene::Node &one) { one.is_visible = false; });
    }
    test::Picture result = picture();
    for (const auto node : nodes) {
      scene.edit(node, [](scene::Node &one) { one.is_visible = true; });
    }
    return result;
  }

  static float difference(const test::Picture &a, const test::Picture &b)
  {
    float largest = 0.0F;
    for (std::size_t i = 0; i < a.pixels.size(); i++) {
      for (int channel = 0; channel < 4; channel++) {
        largest = std::max(largest, std::abs(a.pixels[i][channel] - b.pixels[i][channel]));
      }
    }
    return largest;
  }

  scene::Scene scene;
  scene::Handle<scene::Node> floor, box, child, glass;
  scene::PlacedCamera camera = test::camera_at({0, 2, 6}, {0, 0, 0});
  eevee::Settings settings{.sample_count = 2};
};

TEST_F(HiddenNodesTest, APictureWithoutNodesIsThatOfASceneWithoutThemIfTheyCastNoShadow)
{
  cast_no_shadows();
  // Depths are measured from a point near to the scene with its hidden nodes, so that their rounding differs.
  constexpr float rounding = 1e-6F;
  EXPECT_LT(difference(picture({box}), without({box, child})), rounding) << "with its child";
  EXPECT_LT(difference(picture({child}), without({child})), rounding);
  EXPECT_LT(difference(picture({glass}), without({glass})), rounding);
  EXPECT_LT(difference(picture({}, {box}), without({floor, glass})), rounding) << "isolated";
  EXPECT_LT(difference(picture({child}, {box}), without({floor, glass, child})), rounding) << "isolated, but the child";
  EXPECT_EQ(difference(picture({floor, box, glass}), test::Picture{size_px, std::vector<glm::vec4>(60 * 40)}), 0.0F);
  EXPECT_EQ(difference(picture({floor}, {floor}), test::Picture{size_px, std::vector<glm::vec4>(60 * 40)}), 0.0F);
  EXPECT_GT(difference(picture({box}), picture()), 0.1F);
}

TEST_F(HiddenNodesTest, HiddenNodesCastTheirShadowsAndTheSceneIsAsItWas)
{
  const scene::Revision revision = scene.revision();
  const test::Picture whole = picture();
  const test::Picture hidden = picture({box});
  EXPECT_EQ(scene.revision(), revision);
  scene.edit(box, [](scene::Node &one) { one.casts_shadow = false; });
  scene.edit(child, [](scene::Node &one) { one.casts_shadow = false; });
  const test::Picture unshadowed = picture({box});
  // A pixel that does not show the box has its value; some lie in its shadow.
  int same = 0;
  int in_shadow = 0;
  for (std::size_t i = 0; i < whole.pixels.size(); i++) {
    same += hidden.pixels[i] == whole.pixels[i] ? 1 : 0;
    in_shadow += hidden.pixels[i].x < 0.5F * unshadowed.pixels[i].x ? 1 : 0;
  }
  EXPECT_GT(same, size_px.x * size_px.y / 2);
  EXPECT_GT(in_shadow, 20);
}

TEST_F(HiddenNodesTest, AChangeOfTheHiddenNodesStartsThePictureAgainAlsoWithinATimeBudget)
{
  // Cascades that are fitted to the seen surfaces depend on the nodes.
  settings.shadow.is_fitted_to_depth = true;
  test::add_lamp(scene, scene::LampKind::Sun, {0, 4, 0}, {0.3F, -1, -0.2F}, 2.0F);
  eevee::SceneRenderer renderer(*device, scene, size_px, settings);
  const auto complete = [&](const Nodes &hidden, const Nodes &isolated) {
    renderer.set_hidden(hidden, isolated);
    for (int i = 0; i < 1000 && !renderer.draw_within(0.01, camera); i++) {
    }
    return renderer.read_picture();
  };
  const std::vector<glm::vec4> whole = complete({}, {});
  EXPECT_EQ(complete({box}, {}), picture({box}).pixels);
  EXPECT_EQ(complete({}, {glass}), picture({}, {glass}).pixels);
  EXPECT_EQ(complete({}, {}), whole);
  // The same nodes again restart nothing.
  const std::uint64_t restarts = renderer.viewport().restart_count();
  renderer.set_hidden({});
  EXPECT_TRUE(renderer.draw_within(0.01, camera));
  EXPECT_EQ(renderer.viewport().restart_count(), restarts);
}

TEST_F(HiddenNodesTest, TwoViewportsOfOneEngineHideOtherNodes)
{
  for (const bool is_unlit : {false, true}) {
    render_scene::RenderScene shared(*device, scene);
    shared.update();
    std::unique_ptr<draw::Engine> engine;
    if (is_unlit) {
      engine = std::make_unique<unlit::Engine>(shared);
    }
    else {
      engine = std::make_unique<eevee::Engine>(shared, eevee::Settings{.sample_count = 1});
    }
    const std::array<draw::Engine *, 1> engines = {engine.get()};
    const draw::View view = render_scene::view_of(camera, size_px, shared.origin_ws());
    const auto drawn = [&](draw::Viewport &viewport, const draw::View &seen) {
      const draw::TargetTexture texture(*device, "target", gpu::Format::RGBA32F, size_px);
      viewport.draw(engines, seen, texture.target());
      return gpu::read_as<glm::vec4>(*device, texture.texture());
    };
    draw::Viewport all(*device, size_px);
    draw::Viewport some(*device, size_px);
    all.sync(engines, shared.objects());
    some.sync(engines, shared.objects());
    const std::vector<glm::vec4> whole = drawn(all, view);
    const draw::View less = view.with_hidden(shared.hidden_objects(std::array{box, glass}));
    const std::vector<glm::vec4> hidden = drawn(some, less);
    EXPECT_NE(hidden, whole) << engine->name();
    EXPECT_EQ(drawn(all, view), whole) << engine->name();
    EXPECT_EQ(drawn(some, less), hidden) << engine->name();
    EXPECT_EQ(drawn(some, view), whole) << engine->name();
    // The overlay finds the node behind a hidden one.
    Overlay overlay(shared);
    int seen_box = 0;
    int seen_floor = 0;
    for (int x = 0; x < size_px.x; x++) {
      const std::optional<Hit> hit = overlay.pick(view, size_px, {x, size_px.y / 2});
      const std::optional<Hit> behind = overlay.pick(less, size_px, {x, size_px.y / 2});
      seen_box += hit && (hit->node == box || hit->node == glass) ? 1 : 0;
      EXPECT_TRUE(!behind || behind->node == floor) << x;
      seen_floor += behind ? 1 : 0;
    }
    EXPECT_GT(seen_box, 10);
    EXPECT_GT(seen_floor, seen_box);
  }
}

TEST_F(HiddenNodesTest, OverlaysLeaveHiddenNodesOut)
{
  render_scene::RenderScene shared(*device, scene);
  shared.update();
  Overlay overlay(shared);
  const draw::View view = render_scene::view_of(camera, size_px, shared.origin_ws());
  const draw::View less = view.with_hidden(shared.hidden_objects({}, std::array{glass, child}));
  const auto everywhere = rectangle({0, 0}, glm::dvec2(size_px));
  EXPECT_EQ(overlay.select(less, size_px, everywhere, Reach::Through), (Nodes{child, glass}));
  EXPECT_EQ(overlay.select(view, size_px, everywhere, Reach::Through).size(), 4U);
  const auto outline_pixels = [&](const draw::View &seen) {
    const draw::TargetTexture texture(*device, "target", gpu::Format::RGBA32F, size_px);
    gpu::CommandList clear;
    clear.begin_pass("clear", *std::get<const gpu::Framebuffer *>(texture.target().framebuffer), {});
    clear.end_pass();
    device->submit(clear);
    overlay.draw_outline(seen, size_px, {&box, 1}, glm::vec4(1.0F), texture.target());
    const auto pixels = gpu::read_as<glm::vec4>(*device, texture.texture());
    return std::ranges::count_if(pixels, [](const glm::vec4 &pixel) { return pixel.a > 0.0F; });
  };
  EXPECT_GT(outline_pixels(view), 20);
  EXPECT_EQ(outline_pixels(less), 0);
  // Objects that are removed or unknown are no part of a set.
  EXPECT_EQ(shared.hidden_objects(std::array{scene::Handle<scene::Node>()}), draw::ObjectSet());
  scene.remove(glass);
  shared.update();
  EXPECT_EQ(shared.hidden_objects(std::array{glass}), draw::ObjectSet());
}

}  // namespace
}  // namespace gnomon::overlay
