// SPDX-License-Identifier: MIT
// Resources of debug views, which exist only on request.
#include "eevee_test_scene.hh"

#include <gtest/gtest.h>

#include <algorithm>

namespace gnomon::eevee {
namespace {

using test::Renderer;

class DebugViewTest : public testing::Test {
 protected:
  DebugViewTest()
  {
    const auto mesh = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F)));
    test::add_object(scene, mesh, glm::scale(glm::mat4(1.0F), glm::vec3(10.0F)));
    test::add_object(scene, mesh, glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, 1)));
    settings.shadow.cube_size_px = 32;
    settings.shadow.map_size_px = 32;
    settings.shadow.cascades.count = 2;
  }
  bool has_live(const std::string &what) const
  {
    return std::ranges::any_of(device->live_resources(),
                               [&](const std::string &name) { return name.find(what) != std::string::npos; });
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  Settings settings;
  scene::PlacedCamera camera = test::camera_at({0, -8, 4}, {0, 0, 0});
};

TEST_F(DebugViewTest, NothingIsCreatedWithoutARequest)
{
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0, 0.2F, -1}, 1.0F);
  Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(camera);
  EXPECT_FALSE(has_live("shadow_picture"));
  EXPECT_FALSE(has_live("eevee_debug"));
  EXPECT_FALSE(has_live("surface_"));
  EXPECT_FALSE(has_live("eevee_surfaces"));
  EXPECT_FALSE(renderer.inspect().tinted_sun());
}

TEST_F(DebugViewTest, TexelDensityTakesOneProgramAndThreeTexturesAndDrawsNoShadowAgain)
{
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 1.0F);
  // The second renderer has the programs of the first.
  Renderer plain(*device, scene, {16, 16}, settings);
  gpu::Counters before = device->counters();
  plain.draw(camera);
  const std::uint64_t plain_textures = device->counters().textures_made - before.textures_made;
  settings.has_surfaces = true;
  Renderer renderer(*device, scene, {16, 16}, settings);
  before = device->counters();
  renderer.draw(camera);
  EXPECT_EQ(device->counters().shaders_made - before.shaders_made, 1U);
  EXPECT_EQ(device->counters().textures_made - before.textures_made, plain_textures + 3);
  const draw::View view = view_of(camera, {16, 16}, renderer.render_scene.origin_ws());
  before = device->counters();
  for (int i = 0; i < 2; i++) {
    EXPECT_TRUE(renderer.inspect().texel_density(view, 0));
  }
  EXPECT_EQ(device->counters().shaders_made, before.shaders_made);
  EXPECT_EQ(device->counters().textures_made, before.textures_made);
  EXPECT_EQ(device->counters().passes, before.passes + 4) << "depths and surfaces, twice";
  EXPECT_EQ(renderer.inspect().report().shadow_counters.lamps_updated, 1U);
}

TEST_F(DebugViewTest, APictureOfAShadowTakesOneProgramAndOneTexture)
{
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 1.0F);
  Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(camera);
  const gpu::Counters before = device->counters();
  EXPECT_EQ(renderer.inspect().shadow_picture(0, 3).desc().width, 32);
  EXPECT_EQ(renderer.inspect().shadow_picture(0, 5).desc().width, 32);
  EXPECT_EQ(device->counters().shaders_made, before.shaders_made + 1);
  EXPECT_EQ(device->counters().textures_made, before.textures_made + 1);
  EXPECT_EQ(device->counters().passes, before.passes + 2);
  EXPECT_EQ(renderer.inspect().report().shadow_counters.lamps_updated, 1U) << "no shadow is drawn again";
}

TEST_F(DebugViewTest, LayersLargerThanAScreenAreThinned)
{
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 1.0F);
  settings.shadow.cube_size_px = 3000;
  Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(camera);
  const auto size_px = [&](std::optional<std::size_t> layer) {
    const gpu::TextureDesc &desc = renderer.inspect().shadow_picture(0, layer).desc();
    return glm::ivec2(desc.width, desc.height);
  };
  EXPECT_EQ(size_px(0), glm::ivec2(2048, 2048));
  EXPECT_EQ(size_px(std::nullopt), glm::ivec2(2048, 1536));
}

TEST_F(DebugViewTest, LayerNamesFollowTheLampsTechnique)
{
  using Names = std::vector<std::string>;
  const Names cube = {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 1.0F);
  scene.edit(test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 1.0F),
             [](scene::Lamp &lamp) { lamp.shadow.kind = scene::ShadowKind::None; });
  scene.edit(test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 1.0F),
             [](scene::Lamp &lamp) { lamp.shadow.kind = scene::ShadowKind::Esm; });
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 0.0F);
  scene.edit(test::add_lamp(scene, scene::LampKind::Spot, {0, 0, 4}, {0, 0, -1}, 1.0F),
             [](scene::Lamp &lamp) { lamp.spot_outer_angle = 0.5F; });
  scene.edit(test::add_lamp(scene, scene::LampKind::Spot, {0, 0, 4}, {0, 0, -1}, 1.0F),
             [](scene::Lamp &lamp) { lamp.spot_outer_angle = 1.5F; });
  Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(camera);
  const auto names = [&](std::size_t lamp) { return renderer.inspect().shadow_layers(lamp); };
  EXPECT_EQ(names(0), cube);
  EXPECT_EQ(names(1), Names{});
  EXPECT_EQ(names(2), Names{"octahedral"});
  EXPECT_EQ(names(3), Names{}) << "gives no light";
  EXPECT_EQ(names(4), Names{"map"});
  EXPECT_EQ(names(5), cube) << "too wide for a map";
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0, 0.2F, -1}, 1.0F);
  renderer.sync();
  renderer.draw(camera);
  EXPECT_EQ(names(6), Names{"cascade 0 of 1"}) << "one map covers all that the square darkens";
  EXPECT_EQ(find_layer(cube, "-Y"), std::optional<std::size_t>(3));
  EXPECT_EQ(find_layer(cube, "5"), std::optional<std::size_t>(5));
  EXPECT_EQ(find_layer(names(6), "cascade 0 of 1"), std::optional<std::size_t>(0));
  for (const char *unknown : {"6", "-1", "+x", "", "00", "+X "}) {
    EXPECT_FALSE(find_layer(cube, unknown)) << unknown;
  }
}

TEST_F(DebugViewTest, TheTintIsOfTheFirstSunWithAShadow)
{
  settings.has_cascade_tint = true;
  test::add_lamp(scene, scene::LampKind::Spot, {0, 0, 4}, {0, 0, -1}, 1.0F);
  Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(camera);
  EXPECT_FALSE(renderer.inspect().tinted_sun());
  EXPECT_FALSE(has_live("eevee_debug")) << "a spot's map is no cascade";

  scene.edit(test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0, 0.2F, -1}, 1.0F),
             [](scene::Lamp &lamp) { lamp.shadow.kind = scene::ShadowKind::None; });
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0, 0.2F, -1}, 1.0F);
  renderer.sync();
  renderer.draw(camera);
  EXPECT_EQ(renderer.inspect().tinted_sun(), std::optional<std::size_t>(2));
  EXPECT_TRUE(has_live("eevee_debug_cascades"));
}

}  // namespace
}  // namespace gnomon::eevee
