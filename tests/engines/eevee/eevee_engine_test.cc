// SPDX-License-Identifier: MIT
#include "eevee_test_scene.hh"

#include "shader_check_reflection.hh"
#include "shader_files.hh"
#include "slots_shared.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace gnomon::eevee {
namespace {

using test::Renderer;

class EngineTest : public testing::Test {
 protected:
  EngineTest()
  {
    mesh = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F)));
    test::add_object(scene, mesh, glm::mat4(1.0F));
  }
  static bool is_made(const Report &report, const std::string &what)
  {
    const auto item = std::ranges::find(report.items, what, &FrameItem::what);
    EXPECT_NE(item, report.items.end()) << what;
    EXPECT_FALSE(item->why.empty()) << what;
    return item->is_made;
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  scene::Handle<scene::Mesh> mesh;
  scene::PlacedCamera camera = test::camera_at({0, 0, 4}, {0, 0, 0});
};

TEST_F(EngineTest, CreatesNothingWithoutLamps)
{
  Renderer renderer(*device, scene, {16, 16});
  renderer.draw(camera);
  const Report report = renderer.inspect().report();
  for (const char *what : {"light_block", "shadow_cubes", "shadow_maps", "shadow_pass", "depth_pass_cull",
                           "specular in eevee_lit", "tonemap"}) {
    EXPECT_FALSE(is_made(report, what)) << what;
  }
  // depth, radiance, film; the programs depth, lit and film.
  EXPECT_EQ(device->counters().textures_made, 3U);
  EXPECT_EQ(device->counters().shaders_made, 3U);
  EXPECT_EQ(device->counters().passes, 3U);
  for (const std::string &resource : device->live_resources()) {
    EXPECT_EQ(resource.find("shadow"), std::string::npos) << resource;
    EXPECT_EQ(resource.find("light_block"), std::string::npos) << resource;
  }
}

TEST_F(EngineTest, CreatesTheResourcesThatTheSceneNeeds)
{
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 2}, {0, 0, -1}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0, 0, -1}, 1.0F);
  test::add_object(scene, test::add_square_mesh(scene, scene.add(scene::Material())), glm::mat4(1.0F));
  Settings settings;
  settings.shadow.cube_size_px = 32;
  settings.shadow.map_size_px = 32;
  const draw::TargetTexture display(*device, "display", gpu::Format::RGBA8, {16, 16});
  Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(camera, display.target());
  const Report report = renderer.inspect().report();
  for (const char *what :
       {"light_block", "shadow_cubes", "shadow_pass", "gbuffer_pass", "specular in eevee_lit", "film", "tonemap"}) {
    EXPECT_TRUE(is_made(report, what)) << what;
  }
  EXPECT_FALSE(is_made(report, "shadow_maps")) << "flat to the sun, the square darkens nothing";
  // The square is in one face of the point lamp, and flat to the sun: a face cleared and drawn; G-buffer, deferred lit,
  // film, tonemap.
  EXPECT_EQ(device->counters().passes, 6U);
}

TEST_F(EngineTest, DrawsShadowsOnceForAStillScene)
{
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 2}, {0, 0, -1}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0, 0.2F, -1}, 1.0F);
  test::add_object(scene, mesh, glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, 1)));
  Settings settings;
  settings.sample_count = 8;
  settings.shadow.cube_size_px = 32;
  settings.shadow.map_size_px = 32;
  Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(camera);
  EXPECT_EQ(renderer.inspect().report().shadow_counters.lamps_updated, 2U);
  renderer.draw(camera);
  EXPECT_EQ(renderer.inspect().report().shadow_counters.lamps_updated, 2U);
}

TEST_F(EngineTest, MeshesAreUploadedOnceHoweverManyObjectsShareThem)
{
  for (int i = 0; i < 50; i++) {
    test::add_object(scene, mesh, glm::translate(glm::mat4(1.0F), glm::vec3(0.01F * float(i), 0, 0)));
  }
  Renderer renderer(*device, scene, {16, 16});
  renderer.draw(camera);
  const std::vector<std::string> live = device->live_resources();
  EXPECT_EQ(std::ranges::count(live, "batch 'square'"), 1);
  // One instanced draw each in prepass and lit pass, and the film's triangle.
  EXPECT_EQ(device->counters().draws, 3U);
  EXPECT_EQ(device->counters().instances, 51U + 51U + 1U);
}

TEST_F(EngineTest, CullsObjectsOutsideOfTheView)
{
  test::add_object(scene, mesh, glm::translate(glm::mat4(1.0F), glm::vec3(100, 0, 0)));
  test::add_object(scene, mesh, glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, 10)));
  Renderer renderer(*device, scene, {16, 16});
  renderer.draw(camera);
  EXPECT_EQ(device->counters().instances, 1U + 1U + 1U);
}

TEST_F(EngineTest, AnEmptySceneIsDrawn)
{
  scene = {};
  Renderer renderer(*device, scene, {16, 16});
  renderer.draw(camera);
  EXPECT_EQ(device->counters().passes, 1U) << "the film's clear alone";
  EXPECT_EQ(device->counters().instances, 0U);
}

TEST_F(EngineTest, TwoViewportsKeepTheirOwn)
{
  Renderer first(*device, scene, {16, 16});
  Renderer second(*device, scene, {32, 8});
  first.draw(camera);
  second.draw(camera);
  EXPECT_EQ(first.engine.radiance(first.viewport).desc().width, 16);
  EXPECT_EQ(second.engine.radiance(second.viewport).desc().width, 32);
}

TEST_F(EngineTest, IsMadeByTheRegistry)
{
  draw::EngineRegistry registry;
  render_scene::RenderScene render_scene(*device, scene);
  registry.add(engine_type(render_scene, {}));
  EXPECT_EQ(registry.create("eevee")->name(), "eevee");
}

TEST_F(EngineTest, FreesAllResources)
{
  {
    test::add_lamp(scene, scene::LampKind::Point, {0, 0, 2}, {0, 0, -1}, 1.0F);
    const draw::TargetTexture display(*device, "display", gpu::Format::RGBA8, {16, 16});
    Renderer renderer(*device, scene, {16, 16}, {.is_timed = true});
    renderer.draw(camera, display.target());
    EXPECT_FALSE(device->live_resources().empty());
  }
  EXPECT_EQ(device->live_resources(), std::vector<std::string>());
}

TEST_F(EngineTest, PassesPrintWhatWasRecorded)
{
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0, 0, -1}, 1.0F);
  Renderer renderer(*device, scene, {16, 16}, {.shadow = {.map_size_px = 16}});
  renderer.draw(camera);
  const std::string text = renderer.inspect().serialize_passes();
  EXPECT_NE(text.find("shadow_pass [write_depth depth_nearer_equal depth_clamp]\n  group eevee_shadow_layered\n"),
            std::string::npos);
  EXPECT_NE(text.find(fmt::format("    uniform shadow_render_block -> {} by reference\n", SHADOW_RENDER_BLOCK_SLOT)),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(fmt::format("    uniform light_block -> {} = light_block\n", LIGHT_BLOCK_SLOT)),
            std::string::npos)
      << text;
}

/**
 * Objects without a texture, with a texture, with the texture as a mask, and with a mask that is below its cutoff
 * everywhere.
 */
scene::Scene textured_scene()
{
  scene::Scene scene;
  const auto texture = test::add_texture(scene, 1, {255, 0, 0, 200, 0, 255, 0, 10});
  test::add_texture(scene, 1, {1, 2, 3, 4});
  for (int i = 0; i < 4; i++) {
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    scene.edit(material, [&](scene::Material &value) {
      value.base_color_texture = i == 0 ? scene::Handle<scene::Texture>() : texture;
      value.alpha_mode = i >= 2 ? scene::AlphaMode::Mask : scene::AlphaMode::Opaque;
      value.alpha = i == 3 ? 0.25F : 1.0F;
    });
    const auto mesh = test::add_square_mesh(scene, material);
    test::add_object(scene, mesh, glm::translate(glm::mat4(1.0F), glm::vec3(0.1F * float(i), 0, 0)));
    test::add_object(scene, mesh, glm::translate(glm::mat4(1.0F), glm::vec3(0.1F * float(i), 0.1F, 0)));
  }
  return scene;
}

TEST_F(EngineTest, TexturesAreMadeOnceAndForLightOrMasksOnly)
{
  scene = textured_scene();
  const auto images = [&] {
    Renderer renderer(*device, scene, {16, 16}, {.shadow = {.kind = scene::ShadowKind::None}});
    renderer.draw(camera);
    EXPECT_EQ(is_made(renderer.inspect().report(), "base colour textures"),
              std::ranges::count(device->live_resources(), "texture 'image'") > 0);
    return std::ranges::count(device->live_resources(), "texture 'image'");
  };
  // The texture of the mask; no material reads the other image.
  EXPECT_EQ(images(), 1);
  test::edit_material(scene, 2, [&](scene::Material &material) { material.alpha_mode = scene::AlphaMode::Opaque; });
  EXPECT_EQ(images(), 0);
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 1.0F);
  EXPECT_EQ(images(), 1);
}

TEST_F(EngineTest, OpaqueObjectsKeepTheirDepthProgramWhateverTheirTexture)
{
  scene = textured_scene();
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 1.0F);
  Renderer renderer(*device, scene, {16, 16}, {.shadow = {.map_size_px = 16}});
  renderer.draw(camera);
  const std::string text = renderer.inspect().serialize_passes();
  const auto count = [](const std::string &where, const std::string &what) {
    int found = 0;
    for (std::size_t at = where.find(what); at != where.npos; at = where.find(what, at + 1)) {
      found++;
    }
    return found;
  };
  // One for the opaque and one for the mask, in shadow pass and prepass. In the lit pass the two textured ones do not
  // share, because alpha weighs the colours of the mip levels of one alone.
  EXPECT_EQ(count(text, "group eevee_shadow_layered\n"), 2) << text;
  EXPECT_EQ(count(text, "group eevee_depth\n"), 2) << text;
  EXPECT_EQ(count(text, "group eevee_lit\n"), 3) << text;
  EXPECT_EQ(count(text, "base_color_texture -> 32"), 4) << text;
}

TEST_F(EngineTest, FullyCutOutObjectsAreNotDrawn)
{
  scene = textured_scene();
  Renderer renderer(*device, scene, {16, 16});
  renderer.draw(camera);
  // Six of eight objects, in prepass and lit pass, and the film's triangle.
  EXPECT_EQ(device->counters().instances, 6U + 6U + 1U);
}

TEST_F(EngineTest, DrawAfterAFailedSyncIsAnErrorUntilASyncSucceeds)
{
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 2}, {0, 0, -1}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Point, {1, 0, 2}, {0, 0, -1}, 1.0F);
  Renderer renderer(*device, scene, {16, 16}, {.shadow = {.cube_size_px = 16}});
  renderer.draw(camera);
  // Shadows refuse the kernel, after the limits of all numbers are checked.
  renderer.engine.set_settings({.shadow = {.cube_size_px = 16, .pcf = {.width = 2}}});
  EXPECT_THROW(renderer.sync(), gpu::Error);
  EXPECT_THROW(renderer.draw(camera), gpu::Error);
  renderer.engine.set_settings({.shadow = {.cube_size_px = 16}});
  renderer.sync();
  renderer.draw(camera);
}

TEST_F(EngineTest, ShadowsAreDrawnAgainWithReloadedShaders)
{
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 2}, {0, 0, -1}, 1.0F);
  Renderer renderer(*device, scene, {16, 16}, {.shadow = {.cube_size_px = 16}});
  renderer.draw(camera);
  const std::uint64_t before = renderer.inspect().report().shadow_counters.lamps_updated;
  EXPECT_TRUE(renderer.engine.reload_shaders(renderer.viewport, shaders::file, shader_check::reflect).empty());
  renderer.sync();
  renderer.draw(camera);
  EXPECT_EQ(renderer.inspect().report().shadow_counters.lamps_updated, before + 1);
}

/** The pool contains another mesh's uvs at its position. */
TEST_F(EngineTest, AMeshWithoutUvsIsDrawnWithoutItsTextureAndNamed)
{
  scene = {};
  const auto material = test::add_material(scene, glm::vec3(0.5F));
  test::add_object(scene, test::add_square_mesh(scene, material), glm::dmat4(1.0));
  test::add_lamp(scene, scene::LampKind::Hemi, {0, 0, 2}, {0, 0, -1}, 1.0F);
  const auto texture = test::add_texture(scene, 1, {255, 0, 0, 255});
  scene.edit(material, [&](scene::Material &edited) { edited.base_color_texture = texture; });
  ASSERT_TRUE(scene.meshes()[scene.meshes().first()].uvs.empty());
  Renderer renderer(*device, scene, {16, 16});
  renderer.draw(camera);
  EXPECT_EQ(std::ranges::count(device->live_resources(), "texture 'image'"), 0);
  const std::vector<std::string> warnings = renderer.inspect().report().warnings;
  EXPECT_EQ(warnings,
            std::vector<std::string>{"mesh 'square': it has no uvs; its material's base_color_texture is not drawn"});
}

TEST_F(EngineTest, StaleHandlesAreNamed)
{
  scene.remove(scene.materials().first());
  Renderer renderer(*device, scene, {16, 16});
  renderer.draw(camera);
  const std::vector<std::string> warnings = renderer.inspect().report().warnings;
  EXPECT_EQ(warnings, std::vector<std::string>{"mesh 'square': its material was removed"});
}

/** Sizes as `gnomon render --help` and doc/shadows.md state them. */
TEST(OfflineSettings, ShadowsAreAsFineAsTheSamplesShow)
{
  const auto sizes = [](int sample_count) {
    const ShadowSettings shadow = offline_settings(sample_count).shadow;
    return std::array{shadow.cube_size_px, shadow.map_size_px, shadow.esm.size_px};
  };
  EXPECT_EQ(sizes(1), (std::array{768, 1024, 512}));
  EXPECT_EQ(sizes(2), (std::array{1024, 2048, 512}));
  EXPECT_EQ(sizes(15), sizes(2));
  EXPECT_EQ(sizes(16), (std::array{2048, 4096, 1024}));
  EXPECT_EQ(sizes(0), sizes(16)) << "no limit";
  for (const int count : {0, 1, 2, 15, 16, 64}) {
    const Settings settings = offline_settings(count);
    EXPECT_EQ(settings.sample_count, count);
    EXPECT_EQ(settings.shadow.is_fitted_to_depth, count == 0 || count >= 16) << count;
    EXPECT_EQ(settings.shadow.can_have_short_maps, count <= 1 || count >= 16) << count;
    EXPECT_TRUE(settings.shadow.cascades.can_resize);
  }
  // Decision 0023: 0.8 pixels over the square root of the samples, and at least texel_in_pixels.
  EXPECT_EQ(offline_settings(16).shadow.cascades.texel_in_pixels_enlarged, 0.2);
  EXPECT_EQ(offline_settings(64).shadow.cascades.texel_in_pixels_enlarged, texel_in_pixels);
  EXPECT_EQ(offline_settings(0).shadow.cascades.texel_in_pixels_enlarged, texel_in_pixels);
}

}  // namespace
}  // namespace gnomon::eevee
