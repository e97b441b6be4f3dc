// SPDX-License-Identifier: MIT
// An edit of the scene redraws only the layers whose texels it changes.
#include "eevee_shadow_fixture.hh"

#include "eevee_test_scene.hh"
#include "shadows/shadow_octahedral.hh"
#include "shadows/shadows.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <map>

namespace gnomon::eevee {
namespace {

class ShadowEditsTest : public ShadowsTest {
 protected:
  ShadowEditsTest()
  {
    // Shows everything around the origin.
    view = draw::View(glm::translate(glm::mat4(1.0F), {0, 0, -60}), draw::perspective(1.0F, 1.0F, 0.1F, 2000.0F));
    casters = {box_at({0, 0, 0}, 8.0F)};
    settings.cube_size_px = 64;
    settings.map_size_px = 128;
    settings.cascades.count = 1;
  }
  /** Layers drawn by a sync and an update. */
  std::uint64_t drawn_layers()
  {
    const std::uint64_t before = shadows.counters().faces_drawn;
    sync(settings);
    update();
    return shadows.counters().faces_drawn - before;
  }
  /** A lamp of each kind that casts, twice. */
  void add_lamps()
  {
    for (int i = 0; i < 2; i++) {
      add_lamp(scene::LampKind::Point, "point", {float(i), 12, 0});
      add_lamp(scene::LampKind::Spot, "spot", {float(i), 0, 20});
      add_lamp(scene::LampKind::Sun, "sun");
      add_lamp(scene::LampKind::Point, "esm", {float(i), 0, 12}).shadow.kind = scene::ShadowKind::Esm;
    }
  }
  scene::PlacedLamp &lamp_at(std::size_t index)
  {
    return placed[index];
  }
};

TEST_F(ShadowEditsTest, DimmingRenamingAndFilteringDrawNothing)
{
  add_lamps();
  EXPECT_GT(drawn_layers(), 0U);
  for (scene::PlacedLamp &lamp : placed) {
    lamp.intensity *= 0.5F;
    lamp.color = {0.2F, 0.3F, 0.4F};
    lamp.name += " renamed";
    lamp.radius = 0.1F;
    lamp.shadow.bias = 2.0F;
  }
  EXPECT_EQ(drawn_layers(), 0U);
  lamp_at(0).shadow.kind = scene::ShadowKind::Pcf;
  EXPECT_EQ(drawn_layers(), 0U) << "the filter is the lookup's";
  EXPECT_EQ(shadows.block_data().cubes[0].faces_and_filter >> SHADOW_CUBE_FACE_BITS, SHADOW_FILTER_PCF);
  EXPECT_EQ(shadows.block_data().cubes[0].bias, 2.0F);
}

TEST_F(ShadowEditsTest, ALampThatComesOrGoesDrawsNoOtherAgain)
{
  add_lamps();
  drawn_layers();
  const auto places = [&] {
    std::map<std::uint64_t, int> first_layers;
    for (int i = 0; i < lamps.light_count(); i++) {
      const shared::LightData &light = lamps.lights[std::size_t(i)];
      first_layers[placed[lamps.lamp_index[std::size_t(i)]].node.key()] = shadows.layers(light)->first_layer;
    }
    return first_layers;
  };
  for (std::size_t i = 0; i < 8; i++) {
    const auto before = places();
    scene::PlacedLamp removed = placed.front();
    remove_lamp(0);
    EXPECT_EQ(drawn_layers(), 0U) << "without " << removed.name;
    for (const auto &[key, layer] : places()) {
      EXPECT_EQ(layer, before.at(key)) << "without " << removed.name;
    }
    removed.node = {next_node++, 1};
    placed.push_back(removed);
    const std::uint64_t updated_before = shadows.counters().lamps_updated;
    EXPECT_GT(drawn_layers(), 0U);
    EXPECT_EQ(shadows.counters().lamps_updated, updated_before + 1) << "with " << removed.name << " again";
  }
}

TEST_F(ShadowEditsTest, AShadowOfAnotherSizeMovesNoTexelsOfTheOthers)
{
  add_lamps();
  drawn_layers();
  lamp_at(0).shadow.size = 256;
  const std::uint64_t updated_before = shadows.counters().lamps_updated;
  EXPECT_GT(drawn_layers(), 0U);
  EXPECT_EQ(scene_shadows.cubes().desc().width, 256);
  EXPECT_EQ(shadows.counters().lamps_updated, updated_before + 1);
}

TEST_F(ShadowEditsTest, AnotherNumberOfCascadesDrawsNoSpotAgain)
{
  settings.cascades.count = 0;
  // From above.
  add_lamp(scene::LampKind::Sun, "sun").world_from_lamp =
      glm::rotate(glm::dmat4(1.0), -1.57079633, glm::dvec3(1, 0, 0));
  add_lamp(scene::LampKind::Spot, "spot", {0, 0, 20});
  // Away from the camera, so that near slices are much smaller than the whole.
  casters = {box_at({0, 0, 0}, 8.0F), box_at({0, 0, -200}, 8.0F), box_at({0, 0, -400}, 8.0F)};
  std::vector<int> counts;
  for (const float distance : {600.0F, 12.0F, 600.0F, 12.0F}) {
    view = draw::View(glm::translate(glm::mat4(1.0F), {0, 0, -distance}), view.clip_from_view());
    sync(settings);
    gpu::CommandList list;
    shadows.update(*device, view, distance > 100.0F ? 1.0F : 1e-3F, pass, list);
    device->submit(list);
    shadows.submitted();
    counts.push_back(shadows.layers(lamps.lights[0])->count);
    const bool is_first = counts.size() == 1;
    EXPECT_EQ(list.serialize(*device).find("shadow of spot") != std::string::npos, is_first)
        << "view " << counts.size();
  }
  EXPECT_NE(counts[0], counts[1]) << "the case that is to be tested";
}

TEST_F(ShadowEditsTest, AMovedObjectDrawsTheLayersThatItTouches)
{
  casters = {box_at({0, 0, -6}, 1.0F), box_at({6, 0, 0}, 1.0F), box_at({0, 6, 0}, 1.0F), box_at({0, 0, 6}, 1.0F)};
  add_lamp(scene::LampKind::Point, "point");
  EXPECT_EQ(drawn_layers(), 4U);
  casters[1] = box_at({6.5F, 0, 0}, 1.0F);
  EXPECT_EQ(drawn_layers(), 1U) << "the face at +X";
  casters[2] = box_at({0, -6, 0}, 1.0F);
  EXPECT_EQ(drawn_layers(), 1U) << "the face at -Y";
  EXPECT_EQ(shadows.block_data().cubes[0].faces_and_filter, 1 << 0 | 1 << 3 | 1 << 4 | 1 << 5) << "and none at +Y";
}

TEST_F(ShadowEditsTest, AFarObjectDrawsNoExponentialShadowThatDoesNotReachIt)
{
  casters = {box_at({0, 0, 0}, 8.0F), box_at({500, 0, 0}, 1.0F)};
  settings.kind = scene::ShadowKind::Esm;
  for (int i = 0; i < 10; i++) {
    add_lamp(scene::LampKind::Point, "near", {float(i), 0, 12}).range = 30.0F;
  }
  add_lamp(scene::LampKind::Point, "unlimited", {0, 0, 12});
  EXPECT_GT(drawn_layers(), 0U);
  const std::uint64_t before = shadows.counters().lamps_updated;
  for (const float x : {501.0F, 800.0F, 30.0F + 500.0F}) {
    casters[1] = box_at({x, 0, 0}, 1.0F);
    sync(settings);
    update();
  }
  EXPECT_EQ(shadows.counters().lamps_updated, before + 3) << "the lamp without a range, each time";
}

TEST(EsmRange, ChangesInStepsWithTheScene)
{
  ShadowLamp lamp;
  const float range = esm_range(lamp, box_at({0, 0, 0}, 10.0F));
  EXPECT_GE(range, std::sqrt(300.0F));
  EXPECT_LE(range, 1.01F * std::exp2(0.25F) * std::sqrt(300.0F));
  EXPECT_EQ(esm_range(lamp, box_at({0.1F, 0, 0}, 10.0F)), range);
  EXPECT_GT(esm_range(lamp, box_at({0, 0, 0}, 100.0F)), range);
  lamp.range = 5.0F;
  EXPECT_EQ(esm_range(lamp, box_at({0, 0, 0}, 10.0F)), 5.0F);
  lamp.range = 0.0F;
  EXPECT_GT(esm_range(lamp, {}), 0.0F) << "a scene of nothing";
}

TEST_F(ShadowEditsTest, AnEditedMaskDrawsItsShadowAgain)
{
  scene::Scene garden;
  const auto texture = test::add_texture(garden, 2, {255, 255, 255, 0, 255, 255, 255, 255});
  const auto material = test::add_material(garden, glm::vec3(0.5F));
  garden.edit(material, [&](scene::Material &edited) {
    edited.base_color_texture = texture;
    edited.alpha_mode = scene::AlphaMode::Mask;
  });
  test::add_object(garden, test::add_square_mesh(garden, material), glm::dmat4(1.0));
  test::add_lamp(garden, scene::LampKind::Point, {0, 0, 3}, {0, 0, -1}, 20.0F);
  test::Renderer renderer(*device, garden, {16, 16});
  const auto updated_lamps = [&] {
    const std::uint64_t before = renderer.inspect().shadows().counters().lamps_updated;
    renderer.sync();
    renderer.draw(test::camera_at({0, -4, 4}, {0, 0, 0}));
    return renderer.inspect().shadows().counters().lamps_updated - before;
  };
  EXPECT_EQ(updated_lamps(), 1U);
  EXPECT_EQ(updated_lamps(), 0U);
  const auto image = garden.textures()[texture].image;
  garden.edit(image, [](scene::Image &edited) { edited.texels[3] = 255; });
  EXPECT_EQ(updated_lamps(), 1U) << "texels";
  garden.edit(texture, [](scene::Texture &edited) { edited.magnified = scene::TextureFilter::Linear; });
  EXPECT_EQ(updated_lamps(), 1U) << "filter";
  garden.edit(material, [](scene::Material &edited) { edited.alpha_mode = scene::AlphaMode::Opaque; });
  updated_lamps();
  garden.edit(image, [](scene::Image &edited) { edited.texels[3] = 128; });
  EXPECT_EQ(updated_lamps(), 0U) << "no mask";
}

TEST_F(ShadowEditsTest, LayersThatWereNotSubmittedAreRecordedAgain)
{
  add_lamps();
  sync(settings);
  gpu::CommandList lost;
  shadows.update(*device, view, 0.001F, pass, lost);
  ASSERT_FALSE(lost.commands().empty());
  EXPECT_EQ(shadows.counters().faces_drawn, 0U);
  for (const ShadowState &state : shadows.states()) {
    EXPECT_EQ(state.drawn | state.up_to_date | state.drawn_now, 0U);
  }
  const std::string text = update();
  EXPECT_EQ(text, lost.serialize(*device));
  EXPECT_GT(shadows.counters().faces_drawn, 0U);
  EXPECT_EQ(update(), "");
}

TEST_F(ShadowEditsTest, AFaceThatWasNotSubmittedIsNotLookedUp)
{
  casters = {box_at({0, 0, 0}, 3.0F)};
  add_lamp(scene::LampKind::Point, "point");
  sync(settings);
  view = draw::View(glm::mat4(1.0F), draw::perspective(0.1F, 0.1F, 0.5F, 100.0F));
  gpu::CommandList lost;
  shadows.update(*device, view, 0.001F, pass, lost);
  ASSERT_EQ(shadows.block_data().cubes[0].faces_and_filter, 1 << 5);
  view = draw::View(glm::rotate(glm::mat4(1.0F), 3.14159265F, {0, 1, 0}), view.clip_from_view());
  update();
  EXPECT_EQ(shadows.block_data().cubes[0].faces_and_filter, 1 << 4);
}

TEST_F(ShadowEditsTest, TheTrianglesAroundLampsAreVisitedOnce)
{
  scene::Mesh terrain;
  for (int i = 0; i < 400; i++) {
    terrain.positions.emplace_back(float(i % 20), 0.0F, float(i / 20));
  }
  for (std::uint32_t i = 0; i + 21 < 400; i++) {
    terrain.indices.insert(terrain.indices.end(), {i, i + 1, i + 20});
  }
  mesh = &terrain;
  casters = {box_at({0, 0, 0}, 100.0F)};
  for (int i = 0; i < 50; i++) {
    add_lamp(scene::LampKind::Point, "lamp", {0.1F * float(i), 3, 1});
  }
  sync(settings);
  EXPECT_EQ(scene_shadows.triangles_visited(), 50U * terrain.indices.size() / 3);
  const std::uint64_t visited = scene_shadows.triangles_visited();
  sync(settings);
  EXPECT_EQ(scene_shadows.triangles_visited(), visited) << "nothing is drawn yet, and nothing changed";
  update();
  casters.push_back(box_at({50, 0, 0}, 1.0F));
  mesh = nullptr;
  sync(settings);
  mesh = &terrain;
  EXPECT_EQ(scene_shadows.triangles_visited(), visited) << "another caster";
  lamp_at(7).world_from_lamp[3].y = 4.0F;
  sync(settings);
  EXPECT_LE(scene_shadows.triangles_visited(), visited + 2 * terrain.indices.size() / 3) << "the moved lamp's alone";
}

TEST_F(ShadowEditsTest, AGivenNearPlaneVisitsNoTriangle)
{
  scene::Mesh triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.indices = {0, 1, 2};
  mesh = &triangle;
  add_lamp(scene::LampKind::Point, "lamp", {0, 0, 1}).shadow.clip_start = 0.25F;
  sync(settings);
  update();
  EXPECT_EQ(scene_shadows.triangles_visited(), 0U);
  EXPECT_EQ(shadows.block_data().cubes[0].near, 0.25F);
}

}  // namespace
}  // namespace gnomon::eevee
