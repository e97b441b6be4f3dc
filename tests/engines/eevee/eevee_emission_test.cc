// SPDX-License-Identifier: MIT
// Resources and passes of the light of emissive surfaces, by their names in the backend.
#include "eevee_emission.hh"
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>

namespace gnomon::eevee {
namespace {

/** The resources and passes of a picture of a square with that emission, under a sun. */
std::set<std::string> names_of(const glm::vec3 &emissive, const Settings &settings)
{
  scene::Scene scene;
  const auto material = test::add_material(scene, glm::vec3(1.0F));
  scene.edit(material, [&](scene::Material &value) { value.emissive = emissive; });
  test::add_object(scene, test::add_square_mesh(scene, material), glm::dmat4(1.0));
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0.2F, 0.1F, -1}, 1.0F);
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  test::Renderer renderer(*device, scene, {8, 8}, settings);
  renderer.draw(test::camera_at({0, -1, 3}, {0, 0, 0}));
  std::set<std::string> names;
  for (const gpu::LiveResource &live : device->live()) {
    names.insert(live.name + " " + live.detail);
  }
  for (const auto &[name, count] : device->pass_counts()) {
    names.insert(name);
  }
  return names;
}

TEST(Emission, WithoutPointsIsThatOfASceneWithoutEmission)
{
  const glm::vec3 black(0.0F);
  const glm::vec3 bright(2.0F);
  EXPECT_EQ(names_of(bright, {.sample_count = 1}), names_of(black, {.sample_count = 1}));
  EXPECT_EQ(names_of(bright, {.sample_count = 4, .emissive_point_count = 0}), names_of(black, {.sample_count = 4}));
  // Several samples have points, and one has if it is asked for them.
  for (const Settings &settings :
       {Settings{.sample_count = 4}, Settings{.sample_count = 1, .emissive_point_count = 4}}) {
    const std::set<std::string> all = names_of(bright, settings);
    EXPECT_NE(all, names_of(black, settings)) << settings.sample_count;
    EXPECT_TRUE(std::ranges::any_of(all, [](const std::string &name) { return name.starts_with("shadow_cubes"); }));
  }
}

TEST(Emission, ShadowsOfThePointsOfOneSampleAreKept)
{
  scene::Scene scene;
  const auto white = test::add_material(scene, glm::vec3(1.0F));
  const auto bright = test::add_material(scene, glm::vec3(1.0F));
  scene.edit(bright, [](scene::Material &value) { value.emissive = glm::vec3(2.0F); });
  test::add_object(scene, test::add_square_mesh(scene, white), glm::scale(glm::dmat4(1.0), glm::dvec3(4.0)));
  const auto box = test::add_object(scene, test::add_box_mesh(scene, white),
                                    glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 0.5}), glm::dvec3(0.25)));
  test::add_object(scene, test::add_square_mesh(scene, bright), glm::translate(glm::dmat4(1.0), {0, 0, 2}));
  const auto lamp = test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0.2F, 0.1F, -1}, 1.0F);
  scene.edit(lamp, [](scene::Lamp &value) { value.shadow.kind = scene::ShadowKind::None; });
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  SceneRenderer renderer(*device, scene, {32, 24}, {.emissive_point_count = 3});
  scene::PlacedCamera camera = test::camera_at({0, -4, 3}, {0, 0, 0});
  std::uint64_t before = 0;
  const auto faces_drawn = [&] {
    renderer.sync();
    renderer.draw(camera);
    const std::uint64_t now = renderer.inspect().shadow_counters().faces_drawn;
    return now - std::exchange(before, now);
  };
  EXPECT_GE(faces_drawn(), 3U);
  camera = test::camera_at({0.1F, -4, 3}, {0, 0, 0});
  EXPECT_EQ(faces_drawn(), 0U) << "another view";
  scene.edit(lamp, [](scene::Lamp &value) { value.intensity = 2.0F; });
  EXPECT_EQ(faces_drawn(), 0U) << "another light of the lamp";
  scene.edit(bright, [](scene::Material &value) { value.emissive = glm::vec3(3.0F); });
  EXPECT_EQ(faces_drawn(), 0U) << "more light from the same points";
  scene.set_transform(box, glm::scale(glm::translate(glm::dmat4(1.0), {0.2, 0, 0.5}), glm::dvec3(0.25)));
  EXPECT_GE(faces_drawn(), 3U) << "a moved caster";
}

TEST(Emission, TheTableIsMadeAgainOnlyForWhatEmits)
{
  scene::Scene scene;
  const auto dark = test::add_material(scene, glm::vec3(1.0F));
  const auto bright = test::add_material(scene, glm::vec3(1.0F));
  scene.edit(bright, [&](scene::Material &value) { value.emissive = glm::vec3(2.0F); });
  const auto floor = test::add_object(scene, test::add_square_mesh(scene, dark), glm::dmat4(1.0));
  const auto emitter = test::add_object(scene, test::add_square_mesh(scene, bright), glm::dmat4(1.0));
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  render_scene::RenderScene rendered(*device, scene);
  SceneEmission emission;
  std::uint64_t revision = 0;
  const auto is_made_again = [&] {
    rendered.update();
    emission.update(rendered, true);
    const std::uint64_t before = std::exchange(revision, emission.revision());
    return before != revision;
  };
  const auto place = [](double x) { return glm::translate(glm::dmat4(1.0), {x, 0, 0}); };
  EXPECT_TRUE(is_made_again());
  EXPECT_FALSE(is_made_again());
  const auto surfaces = emission.surfaces();
  scene.set_transform(floor, place(1.0));
  EXPECT_FALSE(is_made_again());
  EXPECT_EQ(emission.surfaces(), surfaces);
  scene.set_transform(emitter, place(1.0));
  EXPECT_TRUE(is_made_again());
  const glm::dvec3 before = emission.surfaces()->at(glm::dvec3(0.5)).position;
  rendered.set_origin({1024.0, 0.0, 0.0});
  EXPECT_TRUE(is_made_again());
  EXPECT_NEAR(emission.surfaces()->at(glm::dvec3(0.5)).position.x, before.x - 1024.0, 1e-9);
  scene.remove(emitter);
  EXPECT_TRUE(is_made_again());
  EXPECT_EQ(emission.surfaces(), nullptr);
  scene.set_transform(floor, place(2.0));
  EXPECT_FALSE(is_made_again());
}

TEST(Emission, EnginesThatShareProgramsShareTheTable)
{
  scene::Scene scene;
  const auto bright = test::add_material(scene, glm::vec3(1.0F));
  const auto set_strength = [&](float strength) {
    scene.edit(bright, [&](scene::Material &value) { value.emissive = glm::vec3(strength); });
  };
  set_strength(2.0F);
  test::add_object(scene, test::add_square_mesh(scene, bright), glm::dmat4(1.0));
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  render_scene::RenderScene rendered(*device, scene);
  Engine first(rendered, {.sample_count = 4});
  draw::Viewport first_viewport(*device, {8, 8});
  const auto revision_after_sync = [&](Engine &engine, draw::Viewport &viewport) {
    draw::Engine *one = &engine;
    rendered.update();
    viewport.sync(std::span(&one, 1), rendered.objects());
    return Inspection(engine, viewport).report().emission_revision;
  };
  const std::uint64_t before = revision_after_sync(first, first_viewport);
  set_strength(3.0F);
  const std::uint64_t after = revision_after_sync(first, first_viewport);
  EXPECT_EQ(after, before + 1);
  Engine second(first, {.sample_count = 1, .emissive_point_count = 4});
  draw::Viewport second_viewport(*device, {8, 8});
  EXPECT_EQ(revision_after_sync(second, second_viewport), after) << "the same table";
  set_strength(4.0F);
  EXPECT_EQ(revision_after_sync(second, second_viewport), after + 1);
  EXPECT_EQ(revision_after_sync(first, first_viewport), after + 1) << "made once";
}

TEST(Emission, ChecksTheNumberOfPoints)
{
  EXPECT_THROW(names_of(glm::vec3(1.0F), {.sample_count = 4, .emissive_point_count = -1}), gpu::Error);
  EXPECT_THROW(names_of(glm::vec3(1.0F), {.sample_count = 4, .emissive_point_count = emissive_point_max + 1}),
               gpu::Error);
}

}  // namespace
}  // namespace gnomon::eevee
