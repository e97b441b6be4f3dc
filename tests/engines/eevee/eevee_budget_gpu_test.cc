// SPDX-License-Identifier: MIT
// Pictures within a time budget. The clock is the tests': each part of a call takes as long as they say.
#include "eevee_budgeted_picture.hh"
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>

namespace gnomon::eevee {
namespace {

constexpr glm::ivec2 budget_picture_size_px(48, 36);
constexpr double budget = 0.01;

/** A viewport whose parts take \a part_seconds each. */
struct Budgeted {
  Budgeted(render_scene::RenderScene &drawn_scene, Engine &drawing_engine, double part_seconds)
      : scene(drawn_scene),
        engine(drawing_engine),
        viewport(scene.device(), budget_picture_size_px),
        picture(scene, engine, viewport, [this, part_seconds] {
          seconds += 0.5 * part_seconds;
          return seconds;
        })
  {
  }
  bool draw(const scene::PlacedCamera &camera, const draw::Target &target = {})
  {
    draw::Engine *one = &engine;
    picture.begin(budget);
    scene.update();
    viewport.sync(std::span(&one, 1), scene.objects());
    return picture.draw(view_of(camera, budget_picture_size_px, scene.origin_ws()), target);
  }
  /** \return the number of calls */
  int refine(const scene::PlacedCamera &camera)
  {
    int calls = 1;
    while (!draw(camera) && calls < 1000) {
      calls++;
    }
    return calls;
  }
  std::vector<glm::vec4> pixels()
  {
    return gpu::read_as<glm::vec4>(scene.device(), engine.radiance(viewport));
  }

  render_scene::RenderScene &scene;
  Engine &engine;
  draw::Viewport viewport;
  double seconds = 0.0;
  BudgetedPicture picture;
};

class BudgetGpuTest : public test::SharedDeviceTest {
 protected:
  BudgetGpuTest()
  {
    const auto plain = test::add_material(scene, {0.8F, 0.5F, 0.2F});
    test::add_object(scene, test::add_square_mesh(scene, plain), glm::scale(glm::dmat4(1), glm::dvec3(100)));
    box = test::add_box_mesh(scene, plain);
    for (int i = 0; i < 5; i++) {
      test::add_object(scene, box,
                       glm::scale(glm::translate(glm::dmat4(1), {1.4 * (i - 2), 0.5 * i, 0.6}), glm::dvec3(0.5)));
    }
    test::add_lamp(scene, scene::LampKind::Point, {1, -2, 6}, {0, 0, -1}, 60.0F);
    test::add_lamp(scene, scene::LampKind::Sun, {4, 3, 8}, {-0.4, -0.3, -0.8}, 2.0F);
  }
  std::vector<glm::vec4> without_budget(const Settings &with)
  {
    SceneRenderer renderer(*device, scene, budget_picture_size_px, with);
    renderer.sync();
    renderer.draw(camera);
    return renderer.read_picture();
  }
  /** A box in front of the others whose material is \a change of a plain one. */
  void add_front(const std::function<void(scene::Material &)> &change)
  {
    const auto material = test::add_material(scene, glm::vec3(0.9F));
    scene.edit(material, change);
    test::add_object(scene, test::add_box_mesh(scene, material),
                     glm::scale(glm::translate(glm::dmat4(1), {0, -1.5, 1}), glm::dvec3(0.8)));
  }

  scene::Scene scene;
  scene::Handle<scene::Mesh> box;
  scene::PlacedCamera camera = test::camera_at({0.3F, -6, 5}, {0, 0, 0.5}, 0.7F);
  Settings settings{.shadow = {.cube_size_px = 128, .map_size_px = 128}, .sample_count = 3};
};

TEST_F(BudgetGpuTest, TheRefinedPictureIsBitForBitThatWithoutABudget)
{
  const auto compare = [&](const char *name, bool is_in_parts) {
    SCOPED_TRACE(name);
    const std::vector<glm::vec4> truth = without_budget(settings);
    render_scene::RenderScene render_scene(*device, scene);
    Engine engine(render_scene, settings);
    // Each part takes half of the budget: a sample takes several calls.
    Budgeted budgeted(render_scene, engine, 0.5 * budget);
    const int calls = budgeted.refine(camera);
    EXPECT_TRUE(calls > 2 * settings.sample_count || !is_in_parts) << calls;
    EXPECT_LT(calls, 1000);
    EXPECT_EQ(budgeted.pixels(), truth);
    // Calls in which several samples fit.
    Budgeted fast(render_scene, engine, 0.03 * budget);
    EXPECT_LE(fast.refine(camera), 6);
    EXPECT_EQ(fast.pixels(), truth);
  };
  compare("lamps without a size", true);
  settings.shadow.is_fitted_to_depth = true;
  compare("cascades that are fitted to depths", true);
  settings.shadow.is_fitted_to_depth = false;
  scene.edit(test::handle_at(scene.lamps(), 0), [](scene::Lamp &lamp) { lamp.radius = 0.4F; });
  add_front([](scene::Material &material) {
    material.alpha_mode = scene::AlphaMode::Blend;
    material.alpha = 0.5F;
  });
  compare("a lamp with a size, and a blended caster", true);
  add_front([](scene::Material &material) {
    material.transmission = material.thickness = 1.0F;
    material.roughness = 0.8F;
  });
  compare("glass", false);
}

TEST_F(BudgetGpuTest, LayersInSeveralPartsAreBitForBitThoseOfOnePart)
{
  settings.sample_count = 1;
  const auto moved = test::add_object(scene, box, glm::dmat4(1));
  render_scene::RenderScene render_scene(*device, scene);
  Engine engine(render_scene, settings);
  const auto calls_with = [&](int shadow_size_px) {
    settings.shadow.cube_size_px = settings.shadow.map_size_px = shadow_size_px;
    engine.set_settings(settings);
    // Each part takes longer than the budget, so that a call has one.
    Budgeted budgeted(render_scene, engine, 2.0 * budget);
    const int calls = budgeted.refine(camera);
    EXPECT_EQ(budgeted.pixels(), without_budget(settings)) << shadow_size_px;
    return calls;
  };
  const int calls = calls_with(1024);
  EXPECT_GT(calls_with(1448), calls) << "two parts for each layer";
  EXPECT_GT(calls_with(2000), calls) << "four parts for each layer";
  // Rows that were drawn before an edit are drawn again.
  Budgeted edited(render_scene, engine, 2.0 * budget);
  for (int calls_before = 1; calls_before < 12; calls_before++) {
    scene.set_transform(moved, glm::translate(glm::dmat4(1), {0.1 * calls_before, -0.5, 0.9}));
    for (int call = 0; call < calls_before; call++) {
      edited.draw(camera);
    }
    scene.set_transform(moved, glm::translate(glm::dmat4(1), {0.2, 0.1 * calls_before, 1.2}));
    edited.refine(camera);
    EXPECT_EQ(edited.pixels(), without_budget(settings)) << calls_before;
  }
}

TEST_F(BudgetGpuTest, PartsOfSeveralViewportsDoNotDisturbEachOther)
{
  // Points of the lamp, its shadow and the shadow of the blended box belong to one sample at a time.
  scene.edit(test::handle_at(scene.lamps(), 0), [](scene::Lamp &lamp) { lamp.radius = 0.4F; });
  add_front([](scene::Material &material) {
    material.alpha_mode = scene::AlphaMode::Blend;
    material.alpha = 0.5F;
  });
  settings.sample_count = 4;
  const std::vector<glm::vec4> truth = without_budget(settings);
  render_scene::RenderScene render_scene(*device, scene);
  Engine engine(render_scene, settings);
  Budgeted slow(render_scene, engine, 0.5 * budget);
  Budgeted other(render_scene, engine, 0.3 * budget);
  bool is_complete = false;
  for (int i = 0; i < 300 && !is_complete; i++) {
    is_complete = slow.draw(camera);
    is_complete &= other.draw(camera);
  }
  EXPECT_TRUE(is_complete);
  EXPECT_EQ(slow.pixels(), truth);
  EXPECT_EQ(other.pixels(), truth);
}

TEST_F(BudgetGpuTest, ViewportsThatDrawOneLayerACallDoNotReplaceEachOthersLayersForever)
{
  for (const float x : {-2.0F, 2.0F}) {
    const auto lamp = test::add_lamp(scene, scene::LampKind::Point, {x, 0.5F, 1.0F}, {0, 0, -1}, 10.0F);
    scene.edit(lamp, [](scene::Lamp &one) { one.radius = 0.2F; });
  }
  settings.sample_count = 2;
  const std::vector<glm::vec4> truth = without_budget(settings);
  render_scene::RenderScene render_scene(*device, scene);
  Engine engine(render_scene, settings);
  Budgeted first(render_scene, engine, 2.0 * budget);
  Budgeted second(render_scene, engine, 2.0 * budget);
  // They draw different samples, whose shadows differ.
  while (first.viewport.samples_drawn() < 1) {
    first.draw(camera);
  }
  bool is_complete = false;
  for (int i = 0; i < 300 && !is_complete; i++) {
    is_complete = first.draw(camera);
    is_complete &= second.draw(camera);
  }
  EXPECT_TRUE(is_complete);
  EXPECT_EQ(first.pixels(), truth);
  EXPECT_EQ(second.pixels(), truth);
}

TEST_F(BudgetGpuTest, TheFirstPictureAfterAnEditIsWholeAndShowsTheEdit)
{
  const draw::TargetTexture texture(*device, "target", gpu::Format::RGBA32F, budget_picture_size_px);
  draw::Target target = texture.target();
  target.encoding = draw::Encoding::SceneLinear;
  // A plate that gives much of the light: without its points, the differences below are 0.28 to 0.41.
  const auto glow = test::add_material(scene, glm::vec3(0.0F));
  scene.edit(glow, [](scene::Material &material) { material.emissive = glm::vec3(8.0F); });
  test::add_object(scene, test::add_square_mesh(scene, glow), glm::translate(glm::dmat4(1), {0, 0, 4}));
  render_scene::RenderScene render_scene(*device, scene);
  Engine engine(render_scene, settings);
  // The parts of a preview fit together.
  Budgeted budgeted(render_scene, engine, 0.2 * budget);
  // The preview shades each lamp as a whole. It has smaller shadows, and the picture's number of emissive points.
  Settings preview = settings;
  preview.sample_count = 1;
  preview.emissive_point_count = settings.emissive_points();
  double bright = 0.0;
  double dark = 0.0;
  const auto expect_whole = [&](double &sum) {
    EXPECT_FALSE(budgeted.draw(camera, target));
    EXPECT_EQ(budgeted.picture.report().kind, BudgetReport::Kind::Preview);
    EXPECT_LT(budgeted.picture.report().drawn_size_px.x, budget_picture_size_px.x);
    const std::vector<glm::vec4> truth = without_budget(preview);
    const std::vector<glm::vec4> shown = gpu::read_as<glm::vec4>(*device, texture.texture());
    double difference = 0.0;
    sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); i++) {
      // The plane is everywhere.
      ASSERT_NEAR(shown[i].a, 1.0F, 1e-6F) << i;
      difference += double(std::abs(shown[i].r - truth[i].r));
      sum += double(truth[i].r);
    }
    // Edges of boxes and of shadows are blurred over some pixels: 0.06 to 0.11 of the light was measured.
    EXPECT_LT(difference, 0.15 * sum);
  };
  expect_whole(bright);
  budgeted.draw(camera, target);
  scene.edit(test::handle_at(scene.lamps(), 0), [](scene::Lamp &lamp) { lamp.intensity = 0.0F; });
  expect_whole(dark);
  EXPECT_LT(dark, 0.8 * bright);
  budgeted.refine(camera);
  camera = test::camera_at({-2.3F, -5, 5}, {0, 0, 0.5}, 0.7F);
  expect_whole(dark);
  // Calls without a whole sample show the same picture again.
  Budgeted slow(render_scene, engine, 0.5 * budget);
  slow.draw(camera, target);
  const std::vector<glm::vec4> first = gpu::read_as<glm::vec4>(*device, texture.texture());
  slow.draw(camera, target);
  EXPECT_EQ(slow.picture.report().kind, BudgetReport::Kind::Preview);
  EXPECT_EQ(gpu::read_as<glm::vec4>(*device, texture.texture()), first);
}

TEST_F(BudgetGpuTest, AScaledPictureIsInterpolatedAndItsDepthIsThatOfThePixelWhichContainsTheCentre)
{
  settings.sample_count = 1;
  const glm::ivec2 small_px(17, 12);
  SceneRenderer renderer(*device, scene, small_px, settings);
  renderer.sync();
  const auto pictures = [&](glm::ivec2 whole_px) {
    const gpu::Texture color = device->create_texture(
        {.name = "color", .format = gpu::Format::RGBA32F, .width = whole_px.x, .height = whole_px.y});
    const gpu::Texture depth = device->create_texture(
        {.name = "depth", .format = gpu::Format::Depth32F, .width = whole_px.x, .height = whole_px.y});
    const gpu::Framebuffer framebuffer =
        device->create_framebuffer({.name = "target", .colors = {{&color}}, .depth = {&depth}});
    draw::Target target;
    target.framebuffer = &framebuffer;
    target.size_px = whole_px;
    target.encoding = draw::Encoding::SceneLinear;
    target.depth = draw::HostDepth{.clip_from_view = glm::perspective(0.7, 1.4, 0.1, 100.0)};
    renderer.draw_sample(camera, target);
    return std::pair(gpu::read_as<glm::vec4>(*device, color), gpu::read_as<float>(*device, depth));
  };
  const auto [small, small_depth] = pictures(small_px);
  for (const glm::ivec2 whole_px : {glm::ivec2(48, 36), glm::ivec2(34, 24), glm::ivec2(5, 4)}) {
    const auto [whole, whole_depth] = pictures(whole_px);
    for (int y = 0; y < whole_px.y; y++) {
      for (int x = 0; x < whole_px.x; x++) {
        const glm::dvec2 place = (glm::dvec2(x, y) + 0.5) * glm::dvec2(small_px) / glm::dvec2(whole_px);
        const glm::dvec2 low = glm::floor(place - 0.5);
        const glm::dvec2 share = place - 0.5 - low;
        glm::dvec4 expected(0.0);
        for (int corner = 0; corner < 4; corner++) {
          const glm::ivec2 step(corner % 2, corner / 2);
          const glm::ivec2 pixel = glm::clamp(glm::ivec2(low) + step, glm::ivec2(0), small_px - 1);
          const glm::dvec2 weight = glm::mix(1.0 - share, share, glm::dvec2(step));
          expected += weight.x * weight.y * glm::dvec4(small[std::size_t(pixel.y * small_px.x + pixel.x)]);
        }
        const auto i = std::size_t(y * whole_px.x + x);
        // Roundings of the shares and of three sums: 2^-24 each, of values below 4.
        EXPECT_LE(glm::length(glm::dvec4(whole[i]) - expected), 4e-6) << x << ", " << y << " of " << whole_px.x;
        const glm::ivec2 nearest(place);
        EXPECT_EQ(whole_depth[i], small_depth[std::size_t(nearest.y * small_px.x + nearest.x)]) << x << ", " << y;
      }
    }
  }
}

}  // namespace
}  // namespace gnomon::eevee
