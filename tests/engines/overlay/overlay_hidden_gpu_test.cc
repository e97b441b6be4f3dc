// SPDX-License-Identifier: MIT
// Nodes that one viewport leaves out and the scene keeps: draw::View::hidden in the engines and in overlays.
#include "overlay.hh"

#include "draw_target.hh"
#include "engines/eevee/eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "gpu_read.hh"
#include "render_camera.hh"
#include "unlit_engine.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <limits>
#include <map>

namespace gnomon::overlay {
namespace {

using Nodes = std::vector<scene::Handle<scene::Node>>;

/** A floor, and before it a box with a child, a square that blends and a box that masks, lit from above. */
class HiddenNodesTest : public test::SharedDeviceTest {
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

/** The same scene, cut by planes. */
class ClipPlanesTest : public HiddenNodesTest {
 protected:
  struct Pictures {
    std::vector<glm::vec4> whole;
    std::vector<glm::vec4> clipped;
    std::vector<glm::vec4> whole_again;
    std::uint64_t programs_made = 0;
  };
  draw::View view(const std::vector<glm::dvec4> &planes)
  {
    return render_scene::view_of(camera, size_px, shared->origin_ws()).with_clip_planes(shared->relative(planes));
  }
  /** Pictures of one engine without planes, with them, and without them. */
  Pictures pictures(draw::Engine &engine, const std::vector<glm::dvec4> &planes)
  {
    draw::Engine *one = &engine;
    draw::Viewport viewport(*device, size_px);
    viewport.sync(std::span(&one, 1), shared->objects());
    const auto drawn = [&](const draw::View &seen) {
      const draw::TargetTexture texture(*device, "target", gpu::Format::RGBA32F, size_px);
      draw::Target target = texture.target();
      target.encoding = draw::Encoding::SceneLinear;
      viewport.draw(std::span(&one, 1), seen, target);
      return gpu::read_as<glm::vec4>(*device, texture.texture());
    };
    Pictures made;
    made.whole = drawn(view({}));
    const std::uint64_t programs = device->counters().shaders_made;
    made.clipped = drawn(view(planes));
    made.programs_made = device->counters().shaders_made - programs;
    made.whole_again = drawn(view({}));
    EXPECT_EQ(device->counters().shaders_made, programs + made.programs_made);
    return made;
  }
  /** Calls \a test with each engine, for materials of both ways of lighting. */
  template <typename Test>
  void for_each_engine(Test &&test)
  {
    for (const bool is_textured : {false, true}) {
      if (is_textured) {
        const auto texture = test::add_texture(scene, 1, {200, 150, 100, 255});
        const auto material = scene.meshes()[scene.nodes()[box].meshes.front()].material;
        scene.edit(material, [&](scene::Material &one) { one.base_color_texture = texture; });
      }
      shared.emplace(*device, scene);
      shared->update();
      eevee::Engine eevee(*shared, eevee::Settings{.sample_count = 1});
      unlit::Engine unlit(*shared);
      for (draw::Engine *engine : std::array<draw::Engine *, 2>{&eevee, &unlit}) {
        SCOPED_TRACE(fmt::format("{}{}", engine->name(), is_textured ? ", textured" : ""));
        test(*engine);
      }
    }
  }

  std::optional<render_scene::RenderScene> shared;
};

TEST_F(ClipPlanesTest, PlanesAroundARectangleLeaveWhatItShows)
{
  shared.emplace(*device, scene);
  shared->update();
  Overlay overlay(*shared);
  for (const bool is_far : {false, true}) {
    if (is_far) {
      // The planes are those of the scene's world space, and not of the device's.
      shared->set_origin({3.0, -2.0, 5.0});
      shared->update();
    }
    // In any order of the corners.
    const auto planes = overlay.planes_around(view({}), size_px, {40.0, 9.0}, {12.0, 29.5});
    ASSERT_EQ(planes.size(), 4U);
    int hits = 0;
    for (glm::ivec2 pixel(0); pixel.y < size_px.y; pixel.y++) {
      for (pixel.x = 0; pixel.x < size_px.x; pixel.x++) {
        const bool is_inside = pixel.x >= 12 && pixel.x < 40 && pixel.y >= 9 && pixel.y < 30;
        const std::optional<Hit> whole = overlay.pick(view({}), size_px, pixel);
        const std::optional<Hit> cut = overlay.pick(view(planes), size_px, pixel);
        ASSERT_EQ(cut ? cut->node : scene::Handle<scene::Node>(),
                  whole && is_inside ? whole->node : scene::Handle<scene::Node>())
            << pixel.x << ' ' << pixel.y;
        hits += cut ? 1 : 0;
      }
    }
    EXPECT_GT(hits, 20);
  }
  EXPECT_THROW(static_cast<void>(overlay.planes_around(view({}), size_px, {0.0, std::nan("")}, {1.0, 1.0})),
               gpu::Error);
}

TEST_F(ClipPlanesTest, EnginesAndPickingShowTheSamePartsOfSurfaces)
{
  set_up_on_new_device();
  scene.edit(glass, [](scene::Node &one) { one.is_visible = false; });
  const std::vector<glm::dvec4> planes = {{0.8, 0, -0.6, 0.9}, {0, -1, 0, 0.8}};
  // Above all planes by more than rounding; below one; between.
  const auto side_of = [&](const glm::dvec3 &p) {
    double least = 1.0;
    for (const glm::dvec4 &plane : planes) {
      least = std::min(least, glm::dot(plane, glm::dvec4(p, 1.0)));
    }
    return least > 1e-3 ? 1 : least < -1e-3 ? -1 : 0;
  };
  for_each_engine([&](draw::Engine &engine) {
    const Pictures made = pictures(engine, planes);
    EXPECT_EQ(made.whole_again, made.whole);
    EXPECT_GT(made.programs_made, 0U);
    Overlay overlay(*shared);
    // The content of a pixel whose neighbours have the same content, so that the pixel filter mixes in nothing else.
    enum class Shown { Mixed, Nothing, Kept, Revealed, Emptied };
    std::vector<Shown> shown;
    for (int i = 0; i < size_px.x * size_px.y; i++) {
      const glm::ivec2 pixel(i % size_px.x, i / size_px.x);
      const std::optional<Hit> hit = overlay.pick(view({}), size_px, pixel);
      const std::optional<Hit> clipped = overlay.pick(view(planes), size_px, pixel);
      ASSERT_TRUE(!clipped || side_of(clipped->position_ws) >= 0) << pixel.x << ' ' << pixel.y;
      const int side = hit ? side_of(hit->position_ws) : 1;
      ASSERT_TRUE(!hit || side <= 0 || (clipped && clipped->node == hit->node)) << pixel.x << ' ' << pixel.y;
      shown.push_back(side == 0  ? Shown::Mixed
                      : !hit     ? Shown::Nothing
                      : side > 0 ? Shown::Kept
                      : clipped  ? Shown::Revealed
                                 : Shown::Emptied);
    }
    std::map<Shown, int> counts;
    for (int y = 2; y < size_px.y - 2; y++) {
      for (int x = 2; x < size_px.x - 2; x++) {
        const auto i = std::size_t(y * size_px.x + x);
        bool is_alone = true;
        for (int k = 0; k < 25; k++) {
          is_alone &= shown[i + std::size_t((k / 5 - 2) * size_px.x + k % 5 - 2)] == shown[i];
        }
        if (!is_alone) {
          continue;
        }
        counts[shown[i]]++;
        if (shown[i] == Shown::Kept) {
          ASSERT_EQ(made.clipped[i], made.whole[i]) << "also in the shadow of what is cut off: " << x << ' ' << y;
        }
        else if (shown[i] == Shown::Revealed) {
          ASSERT_NEAR(made.clipped[i].a, 1.0F, 1e-5F) << x << ' ' << y;
        }
        else if (shown[i] == Shown::Emptied) {
          ASSERT_EQ(made.clipped[i], glm::vec4(0.0F)) << x << ' ' << y;
        }
      }
    }
    EXPECT_GT(counts[Shown::Kept], 200);
    EXPECT_GT(counts[Shown::Revealed], 2);
    EXPECT_GT(counts[Shown::Emptied], 30);
  });
}

TEST_F(ClipPlanesTest, CutBlendedSurfacesAndSelection)
{
  for_each_engine([&](draw::Engine &engine) {
    // The square of glass reaches from 0.3 to 1.7, and nothing else to 0.2, but the floor.
    const Pictures without_glass = pictures(engine, {{-1, 0, 0, 0.25}});
    const Pictures half = pictures(engine, {{-1, 0, 0, 1.0}});
    scene.edit(glass, [](scene::Node &one) { one.is_visible = false; });
    shared->update();
    EXPECT_EQ(pictures(engine, {{-1, 0, 0, 0.25}}).clipped, without_glass.clipped);
    const Pictures no_glass = pictures(engine, {{-1, 0, 0, 1.0}});
    scene.edit(glass, [](scene::Node &one) { one.is_visible = true; });
    shared->update();
    Overlay overlay(*shared);
    int with_glass = 0;
    for (std::size_t i = 0; i < half.clipped.size(); i++) {
      const glm::ivec2 pixel(int(i) % size_px.x, int(i) / size_px.x);
      const std::optional<Hit> hit = overlay.pick(view({{-1, 0, 0, 1.0}}), size_px, pixel);
      const bool is_glass = hit && hit->node == glass;
      // The pixel filter of eevee mixes neighbours in.
      if (engine.name() == "unlit" || is_glass) {
        EXPECT_EQ(half.clipped[i] != no_glass.clipped[i], is_glass) << pixel.x << ' ' << pixel.y;
      }
      with_glass += is_glass ? 1 : 0;
    }
    EXPECT_GT(with_glass, 30);
  });
  Overlay overlay(*shared);
  const auto everywhere = rectangle({0, 0}, glm::dvec2(size_px));
  EXPECT_EQ(overlay.select(view({{-1, 0, 0, 0.25}}), size_px, everywhere, Reach::Through), (Nodes{floor, box, child}));
  EXPECT_EQ(overlay.select(view({{0, 1, 0, -0.85}}), size_px, everywhere, Reach::Through), Nodes{child});
}

TEST_F(ClipPlanesTest, DepthOfAPictureOfSeveralSamplesIsCutToo)
{
  eevee::SceneRenderer renderer(*device, scene, size_px, {.sample_count = 4});
  renderer.sync();
  const auto depths = [&](std::vector<glm::dvec4> planes) {
    renderer.set_clip_planes(std::move(planes));
    const draw::TargetTexture texture(*device, "target", gpu::Format::RGBA32F, size_px);
    const gpu::Texture depth = device->create_texture(
        {.name = "target_depth", .format = gpu::Format::Depth32F, .width = size_px.x, .height = size_px.y});
    const gpu::Framebuffer framebuffer =
        device->create_framebuffer({.name = "target_fb", .colors = {{&texture.texture()}}, .depth = {&depth}});
    draw::Target target = texture.target();
    target.framebuffer = &framebuffer;
    target.depth = draw::HostDepth{.clip_from_view = renderer.view_of(camera).clip_from_view(), .is_zero_to_one = true};
    renderer.draw(camera, {}, target);
    return gpu::read_as<float>(*device, depth);
  };
  const std::vector<float> whole = depths({});
  const std::vector<float> none = depths({{0, 0, 0, -1}});
  EXPECT_EQ(std::ranges::count(none, none.front()), std::ptrdiff_t(none.size()));
  EXPECT_GT(std::ranges::count_if(whole, [&](float depth) { return depth != none.front(); }), 500);
  EXPECT_THROW(renderer.set_clip_planes(std::vector<glm::dvec4>(7)), gpu::Error);
  EXPECT_THROW(renderer.set_clip_planes({{0, 0, 1, std::numeric_limits<double>::infinity()}}), gpu::Error);
  EXPECT_EQ(renderer.view_of(camera).clip_planes().size(), 1U) << "the planes of before";
}

}  // namespace
}  // namespace gnomon::overlay
