// SPDX-License-Identifier: MIT
// Edits of a large scene: each costs what it changed, in bytes, shadows and objects, and not what the scene holds.
#include "eevee_test_scene.hh"

#include <gtest/gtest.h>

namespace gnomon::eevee {
namespace {

using test::Renderer;

constexpr std::size_t object_bytes = sizeof(shared::ObjectData);
constexpr std::size_t material_bytes = sizeof(shared::MaterialData);
/**
 * What lamps and shadows may upload at an edit: their blocks, whole, and the draws of casters. Far below the block of
 * all objects.
 */
constexpr std::size_t lamps_bytes =
    sizeof(shared::LightBlock) + sizeof(shared::ShadowBlock) + 50 * sizeof(shared::ShadowRenderBlock) + 32768;

/** 10 000 boxes of four meshes on a grid of 2 m, and 50 point lamps that each reach a few boxes. */
class EditTest : public testing::Test {
 protected:
  static constexpr std::size_t object_count = 10000;
  static constexpr int lamp_count = 50;

  EditTest()
  {
    for (int i = 0; i < 4; i++) {
      const auto material = test::add_material(scene, glm::vec3(0.2F * float(i + 1)));
      materials.push_back(material);
      if (i == 3) {
        const auto texture = test::add_texture(scene, 1, {255, 0, 0, 255});
        scene.edit(material, [&](scene::Material &value) {
          value.base_color_texture = texture;
          value.alpha_mode = scene::AlphaMode::Mask;
        });
      }
      meshes.push_back(test::add_box_mesh(scene, material));
    }
    for (int i = 0; i < int(object_count); i++) {
      objects.push_back(test::add_object(scene, meshes[std::size_t(i % 4)], box_at(2.0 * (i % 100), 2.0 * (i / 100))));
    }
    for (int i = 0; i < lamp_count; i++) {
      lamps.push_back(test::add_lamp(scene, scene::LampKind::Point, lamp_place(i), {0, 0, -1}, 1.0F));
      scene.edit(lamps.back(), [](scene::Lamp &lamp) { lamp.range = 4.0F; });
    }
    for (const scene::PlacedLamp &lamp : scene.placed_lamps()) {
      lamp_nodes.push_back(lamp.node);
    }
  }
  static glm::dmat4 box_at(double x, double y)
  {
    return glm::scale(glm::translate(glm::dmat4(1.0), {x, y, 0}), glm::dvec3(0.4));
  }
  static glm::vec3 lamp_place(int lamp)
  {
    return {20.0F * float(lamp % 10) + 9.0F, 40.0F * float(lamp / 10) + 9.0F, 2.0F};
  }

  /** What an edit, a sync and a picture cost. */
  struct Cost {
    /** More than a picture of a still scene uploads: its view, and its draws and instances. */
    std::uint64_t upload_bytes = 0;
    ShadowCounters shadows;
    std::uint64_t textures_made = 0;
    std::uint64_t shaders_made = 0;
    std::uint64_t pass_recordings = 0;
  };
  template <typename Change>
  Cost cost_of(Change &&change)
  {
    const gpu::Counters before = device->counters();
    const ShadowCounters shadows = renderer->engine.shadows(renderer->viewport).counters();
    const std::uint64_t recordings = renderer->engine.report(renderer->viewport).pass_recordings;
    change();
    renderer->sync();
    renderer->draw(camera);
    const gpu::Counters edited = device->counters();
    const ShadowCounters after = renderer->engine.shadows(renderer->viewport).counters();
    renderer->draw(camera);
    const std::uint64_t still_bytes = device->counters().upload_bytes - edited.upload_bytes;
    return {edited.upload_bytes - before.upload_bytes - still_bytes,
            {after.lamps_updated - shadows.lamps_updated, after.faces_drawn - shadows.faces_drawn, 0, 0},
            edited.textures_made - before.textures_made,
            edited.shaders_made - before.shaders_made,
            renderer->engine.report(renderer->viewport).pass_recordings - recordings};
  }
  /** The first picture, of the whole scene. */
  Cost start()
  {
    renderer.emplace(*device, scene, glm::ivec2(64, 64),
                     Settings{.shadow = {.kind = scene::ShadowKind::Hard, .cube_size_px = 16}});
    return cost_of([] {});
  }
  static void expect_no_shadow_is_drawn(const Cost &cost)
  {
    EXPECT_EQ(cost.shadows.lamps_updated, 0U);
    EXPECT_EQ(cost.shadows.faces_drawn, 0U);
  }
  /** \a changed: objects that an edit may upload. */
  static void expect_small(const Cost &cost, std::size_t changed)
  {
    EXPECT_LE(cost.upload_bytes, changed * object_bytes + lamps_bytes);
    EXPECT_EQ(cost.textures_made, 0U);
    EXPECT_EQ(cost.shaders_made, 0U);
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  std::vector<scene::Handle<scene::Material>> materials;
  std::vector<scene::Handle<scene::Mesh>> meshes;
  std::vector<scene::Handle<scene::Node>> objects;
  std::vector<scene::Handle<scene::Lamp>> lamps;
  std::vector<scene::Handle<scene::Node>> lamp_nodes;
  scene::PlacedCamera camera = test::camera_at({100, 100, 300}, {100, 100, 0});
  std::optional<Renderer> renderer;
};

TEST_F(EditTest, NothingAndAnotherCameraUploadTheViewAndTheDrawsAlone)
{
  const Cost first = start();
  EXPECT_GT(first.upload_bytes, object_count * object_bytes);
  EXPECT_EQ(first.shadows.lamps_updated, std::uint64_t(lamp_count));
  const Cost still = cost_of([] {});
  EXPECT_EQ(still.upload_bytes, 0U);
  expect_no_shadow_is_drawn(still);
  const Cost moved = cost_of([&] { camera = test::camera_at({101, 99, 300}, {100, 100, 0}); });
  EXPECT_EQ(moved.upload_bytes, 0U);
  expect_no_shadow_is_drawn(moved);
}

TEST_F(EditTest, NamesAndValuesThatAreThereAlreadyCostNothing)
{
  start();
  const Cost cost = cost_of([&] {
    scene.edit(objects[5], [](scene::Node &value) { value.name = "renamed"; });
    scene.edit(meshes[0], [](scene::Mesh &value) { value.name = "renamed"; });
    scene.edit(materials[0], [](scene::Material &value) { value.name = "renamed"; });
    scene.set_transform(objects[7], scene.world_from_node(objects[7]));
  });
  EXPECT_EQ(cost.upload_bytes, 0U);
  expect_no_shadow_is_drawn(cost);
}

TEST_F(EditTest, AMovedObjectCostsItselfAndTheLampsThatReachIt)
{
  start();
  // Lamp 0 is at (9, 9); lamps are 20 m apart.
  const std::size_t near_lamp = 4 * 100 + 4;
  const Cost near = cost_of([&] { scene.set_transform(objects[near_lamp], box_at(8.5, 8.0)); });
  expect_small(near, 1);
  EXPECT_EQ(near.shadows.lamps_updated, 1U);
  const std::size_t far_from_lamps = 9 * 100 + 9;
  const Cost far = cost_of([&] { scene.set_transform(objects[far_from_lamps], box_at(18.5, 18.5)); });
  expect_small(far, 1);
  expect_no_shadow_is_drawn(far);
}

TEST_F(EditTest, ObjectsThatComeAndGoFarFromLampsCostThemselves)
{
  start();
  const std::size_t far_from_lamps = 9 * 100 + 9;
  for (const bool is_visible : {false, true}) {
    const Cost cost = cost_of(
        [&] { scene.edit(objects[far_from_lamps], [&](scene::Node &value) { value.is_visible = is_visible; }); });
    expect_small(cost, 1);
    expect_no_shadow_is_drawn(cost);
  }
  scene::Handle<scene::Node> added;
  const Cost add = cost_of([&] { added = test::add_object(scene, meshes[1], box_at(19, 21)); });
  // The block of objects may have to grow.
  EXPECT_LE(add.upload_bytes, (object_count + 2) * object_bytes + lamps_bytes);
  expect_no_shadow_is_drawn(add);
  const Cost remove = cost_of([&] { scene.remove(added); });
  expect_small(remove, 0);
  expect_no_shadow_is_drawn(remove);
  const Cost other_mesh =
      cost_of([&] { scene.edit(objects[far_from_lamps], [&](scene::Node &value) { value.meshes = {meshes[2]}; }); });
  expect_small(other_mesh, 1);
  expect_no_shadow_is_drawn(other_mesh);
}

TEST_F(EditTest, AMaterialsFactorCostsItsEntry)
{
  start();
  const Cost cost = cost_of([&] {
    scene.edit(materials[1], [](scene::Material &value) { value.base_color = {0.1F, 0.9F, 0.3F}; });
  });
  EXPECT_EQ(cost.upload_bytes, material_bytes);
  expect_no_shadow_is_drawn(cost);
}

TEST_F(EditTest, AMasksCutoffAndImageDrawTheShadowsThatItCuts)
{
  start();
  const Cost cutoff =
      cost_of([&] { scene.edit(materials[3], [](scene::Material &value) { value.alpha_cutoff = 0.25F; }); });
  EXPECT_LE(cutoff.upload_bytes, lamps_bytes + material_bytes);
  EXPECT_EQ(cutoff.shadows.lamps_updated, std::uint64_t(lamp_count));
  const Cost image =
      cost_of([&] { scene.edit(scene.images().first(), [](scene::Image &value) { value.texels[3] = 100; }); });
  EXPECT_LE(image.upload_bytes, lamps_bytes + 4);
  EXPECT_EQ(image.textures_made, 1U);
  EXPECT_EQ(image.shadows.lamps_updated, std::uint64_t(lamp_count));
}

TEST_F(EditTest, ALampThatMovesIsDrawnAlone)
{
  start();
  const Cost cost = cost_of(
      [&] { scene.set_transform(lamp_nodes[10], glm::translate(glm::dmat4(1.0), glm::dvec3(lamp_place(10)) + 0.25)); });
  expect_small(cost, 0);
  EXPECT_EQ(cost.shadows.lamps_updated, 1U);
}

TEST_F(EditTest, ALampThatIsDimmedOrRenamedOrAddedOrRemoved)
{
  start();
  const auto dim = [&] { scene.edit(lamps[10], [](scene::Lamp &lamp) { lamp.intensity = 0.5F; }); };
  const auto rename = [&] { scene.edit(lamps[10], [](scene::Lamp &lamp) { lamp.name = "renamed"; }); };
  for (const Cost &cost : {cost_of(dim), cost_of(rename), cost_of([&] { scene.remove(lamps[10]); })}) {
    expect_small(cost, 0);
    expect_no_shadow_is_drawn(cost);
    EXPECT_EQ(cost.pass_recordings, 0U);
  }
  const Cost added = cost_of([&] {
    const auto lamp = test::add_lamp(scene, scene::LampKind::Point, {29, 31, 2}, {0, 0, -1}, 1.0F);
    scene.edit(lamp, [](scene::Lamp &value) { value.range = 4.0F; });
  });
  EXPECT_LE(added.upload_bytes, lamps_bytes);
  EXPECT_EQ(added.shadows.lamps_updated, 1U);
  EXPECT_EQ(added.pass_recordings, 0U);
}

TEST_F(EditTest, PassesAreRecordedOnlyWhereObjectsOrMaterialsNeedIt)
{
  start();
  const auto recordings = [&](auto &&change) { return cost_of(change).pass_recordings; };
  EXPECT_EQ(recordings([] {}), 0U);
  EXPECT_EQ(recordings([&] { scene.set_transform(objects[7], box_at(14.2, 0.1)); }), 0U);
  EXPECT_EQ(recordings([&] { scene.set_transform(lamp_nodes[3], glm::dmat4(1.0)); }), 0U);
  EXPECT_EQ(recordings([&] {
              scene.edit(materials[0], [](scene::Material &material) { material.base_color = glm::vec3(0.1F); });
            }),
            0U);
  EXPECT_EQ(recordings([&] { scene.remove(objects[8]); }), 1U);
  EXPECT_EQ(recordings(
                [&] { scene.edit(materials[0], [](scene::Material &material) { material.is_double_sided = false; }); }),
            1U);
}

TEST_F(EditTest, AnotherSizeKeepsSceneAndShadows)
{
  start();
  const Cost cost = cost_of([&] { renderer->viewport.resize({32, 48}); });
  expect_small({cost.upload_bytes, cost.shadows, 0, cost.shaders_made, 0}, 0);
  // Depth, radiance and film.
  EXPECT_EQ(cost.textures_made, 3U);
  expect_no_shadow_is_drawn(cost);
  EXPECT_EQ(renderer->engine.radiance(renderer->viewport).desc().width, 32);
}

}  // namespace
}  // namespace gnomon::eevee
