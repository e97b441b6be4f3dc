// SPDX-License-Identifier: MIT
#include "eevee_shadow_fixture.hh"

#include "shadows/shadow_cube.hh"
#include "shadows/shadow_spot.hh"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <limits>
#include <random>

namespace gnomon::eevee {
namespace {

std::vector<glm::vec3> random_directions(int count)
{
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  std::vector<glm::vec3> directions;
  for (int i = 0; i < count; i++) {
    directions.push_back(glm::normalize(glm::vec3(normal(random), normal(random), normal(random))));
  }
  for (int axis = 0; axis < 3; axis++) {
    glm::vec3 unit(0.0F);
    unit[axis] = 1.0F;
    directions.push_back(unit);
    directions.push_back(-unit);
  }
  return directions;
}

TEST(Cubefacemat, TurnsEachAxisToMinusZ)
{
  const std::array<glm::vec3, 6> axes = {glm::vec3(1, 0, 0),  glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0),
                                         glm::vec3(0, -1, 0), glm::vec3(0, 0, 1),  glm::vec3(0, 0, -1)};
  for (std::size_t face = 0; face < 6; face++) {
    EXPECT_EQ(glm::vec3(cubefacemat[face] * glm::vec4(axes[face], 0.0F)), glm::vec3(0, 0, -1)) << "face " << face;
    EXPECT_EQ(glm::determinant(cubefacemat[face]), 1.0F) << "a rotation, face " << face;
  }
}

TEST(CubeFace, ProjectsAsItsMatrixDoes)
{
  for (const glm::vec3 &v : random_directions(1000)) {
    for (int face = 0; face < 6; face++) {
      const glm::vec3 turned(cubefacemat[std::size_t(face)] * glm::vec4(v, 0.0F));
      EXPECT_EQ(shared::cube_face_project(face, v), glm::vec3(turned.x, turned.y, -turned.z));
    }
  }
}

TEST(ShadowCubeViews, SeeEveryDirectionInTheirFace)
{
  const glm::vec3 lamp(3, -2, 1);
  const float scale = shared::cube_uv_scale(64.0F);
  const auto views = shadow_cube_views(lamp, 0.01F, 64);
  for (const glm::vec3 &v : random_directions(500)) {
    const int face = shared::cube_face(v);
    const glm::vec4 clip = views[std::size_t(face)].clip_from_world() * glm::vec4(lamp + 5.0F * v, 1.0F);
    // Inside the border, whose texels are for filters only.
    EXPECT_LE(std::abs(clip.x), clip.w * scale * 1.00001F);
    EXPECT_LE(std::abs(clip.y), clip.w * scale * 1.00001F);
    const glm::vec3 p = shared::cube_face_project(face, 5.0F * v);
    EXPECT_NEAR(clip.z / clip.w, 0.01F / p.z, 1e-6F);
    EXPECT_NEAR(clip.x / clip.w, scale * p.x / p.z, 1e-5F);
  }
}

TEST(Texcomat, TakesClipCornersToTextureCorners)
{
  EXPECT_EQ(texcomat * glm::vec4(-1, -1, 0.25F, 1), glm::vec4(0, 0, 0.25F, 1));
  EXPECT_EQ(texcomat * glm::vec4(1, 1, 1, 1), glm::vec4(1, 1, 1, 1));
  // Homogeneous: the same after division.
  const glm::vec4 q = texcomat * glm::vec4(3, -3, 1.5F, 3);
  EXPECT_EQ(glm::vec3(q) / q.w, glm::vec3(1, 0, 0.5F));
}

TEST(SpotView, HoldsItsCone)
{
  for (const float angle : {1e-3F, 0.2F, 0.8F, spot_map_angle_max}) {
    const draw::View view = shadow_spot_view(glm::mat4(1.0F), angle, 0.01F, 512);
    const glm::vec4 clip = view.clip_from_world() * glm::vec4(std::tan(angle), 0, -1, 1);
    EXPECT_LT(clip.x / clip.w, 1.0F) << "half the opening " << angle;
    EXPECT_GT(clip.x / clip.w, 0.9F);
  }
}

TEST_F(ShadowsTest, PointsAndWideSpotsHaveCubesSunsAndSpotsMaps)
{
  add_lamp(scene::LampKind::Point, "point");
  add_lamp(scene::LampKind::Spot, "wide").spot_outer_angle = 1.5F;
  add_lamp(scene::LampKind::Spot, "spot");
  add_lamp(scene::LampKind::Sun, "sun");
  add_lamp(scene::LampKind::Hemi, "hemi");
  sync({.cascades = {.count = 1}});
  update();
  EXPECT_EQ(scene_shadows.cube_count(), 2U);
  EXPECT_EQ(scene_shadows.map_count(), 2U);
  EXPECT_EQ(scene_shadows.cubes().desc().layers, 12);
  EXPECT_EQ(scene_shadows.maps().desc().layers, 2);
  EXPECT_EQ(lamps.lights[1].shadow_kind, SHADOW_CUBE);
  EXPECT_EQ(lamps.lights[1].shadow_index, 1);
  EXPECT_EQ(lamps.lights[4].shadow_kind, SHADOW_NONE);
}

/** Change of the depth for each metre along the axes of the world. */
glm::vec3 row_z(const shared::ShadowMapData &map)
{
  return {map.texco_from_world[0].z, map.texco_from_world[1].z, map.texco_from_world[2].z};
}

TEST_F(ShadowsTest, MapsHaveShortDepthsWhileTheirErrorIsATenthOfATexel)
{
  constexpr float short_rounding = short_depth_half_step + shared::DEPTH_ROUNDING;
  add_lamp(scene::LampKind::Spot, "spot");
  add_lamp(scene::LampKind::Sun, "sun");
  settings.can_have_short_maps = true;
  sync(settings);
  update();
  EXPECT_EQ(scene_shadows.maps().desc().format, gpu::Format::Depth16);
  // A sun's depth is 1 over the length of the map, so that this is the length times the error.
  EXPECT_NEAR(shadows.block_data().maps[1].rounding * glm::length(row_z(shadows.block_data().maps[1])), short_rounding,
              1e-3F * short_rounding);
  // A caster just before the spot moves the near plane to it. The error at the box grows with the square of the
  // distance.
  casters.push_back(box_at({0, 0, -0.02F}, 0.01F));
  EXPECT_EQ(updated(), 2U) << "another format, so that all layers are drawn again";
  EXPECT_EQ(scene_shadows.maps().desc().format, gpu::Format::Depth32F);
  EXPECT_NEAR(shadows.block_data().maps[1].rounding * glm::length(row_z(shadows.block_data().maps[1])),
              shared::DEPTH_ROUNDING, 1e-3F * shared::DEPTH_ROUNDING);
  // The format does not change back and forth.
  casters.pop_back();
  updated();
  EXPECT_EQ(scene_shadows.maps().desc().format, gpu::Format::Depth32F);
  // New maps are short again.
  placed.clear();
  updated();
  add_lamp(scene::LampKind::Sun, "sun");
  updated();
  EXPECT_EQ(scene_shadows.maps().desc().format, gpu::Format::Depth16);
}

// hazards.md: the second lamp's layers overlapped the first's.
TEST_F(ShadowsTest, TheSecondCubeBeginsAtLayerSix)
{
  casters = {box_at({0, 0, 0}, 1.0F)};
  add_lamp(scene::LampKind::Point, "a");
  add_lamp(scene::LampKind::Point, "b");
  sync({.layer_pass = LayerPass::Single});
  view = draw::View(glm::translate(glm::mat4(1.0F), {0, 0, -5}), view.clip_from_view());
  const std::string text = update();
  for (int layer = 0; layer < 12; layer++) {
    const std::string expected =
        fmt::format("begin shadow of {}, face {} -> shadow_cubes {} ", layer < 6 ? "a" : "b", layer % 6, layer);
    EXPECT_NE(text.find(expected), std::string::npos) << expected << "\n" << text;
  }
  for (int face = 0; face < 6; face++) {
    EXPECT_EQ(shared::cube_face_layer(shadows.block_data().cubes[0].layers, face), face);
    EXPECT_EQ(shared::cube_face_layer(shadows.block_data().cubes[1].layers, face), 6 + face);
  }
}

TEST_F(ShadowsTest, CubesOfFittedPicturesHaveLayersForTheFacesThatAreLookedUp)
{
  settings = {.is_fitted_to_depth = true, .layer_pass = LayerPass::Single};
  casters = {box_at({0, 0, 0}, 3.0F)};
  add_lamp(scene::LampKind::Point, "a");
  add_lamp(scene::LampKind::Point, "b");
  const auto layer_of = [&](std::size_t cube, int face) {
    const shared::ShadowCubeData &data = shadows.block_data().cubes[cube];
    EXPECT_EQ(data.faces_and_filter, 1 << face);
    return shared::cube_face_layer(data.layers, face);
  };
  const auto expect_drawn = [](const std::string &text, const std::string &face, int layer) {
    const std::string expected = fmt::format("begin shadow of {} -> shadow_cubes {} ", face, layer);
    EXPECT_NE(text.find(expected), std::string::npos) << expected << "\n" << text;
  };
  // A narrow view from inside along -Z shows nothing behind or beside it.
  view = draw::View(glm::mat4(1.0F), draw::perspective(0.1F, 0.1F, 0.5F, 100.0F));
  sync(settings);
  EXPECT_FALSE(scene_shadows.cubes());
  std::string text = update();
  EXPECT_EQ(scene_shadows.cubes().desc().layers, 2);
  expect_drawn(text, "a, face 5", 0);
  expect_drawn(text, "b, face 5", 1);
  EXPECT_EQ(layer_of(0, 5), 0);
  EXPECT_EQ(layer_of(1, 5), 1);
  // Another view needs another face. From then on, all faces have a layer.
  view = draw::View(glm::rotate(glm::mat4(1.0F), 3.14159265F, {0, 1, 0}), view.clip_from_view());
  text = update();
  EXPECT_EQ(scene_shadows.cubes().desc().layers, 12);
  expect_drawn(text, "a, face 4", 4);
  expect_drawn(text, "b, face 4", 10);
  EXPECT_EQ(layer_of(0, 4), 4);
  EXPECT_EQ(layer_of(1, 4), 10);
  EXPECT_EQ(updated(), 0U) << "a sync without a change";
  add_lamp(scene::LampKind::Point, "c");
  EXPECT_EQ(updated(), 1U) << "one more lamp moves no texels of the others";
  EXPECT_EQ(scene_shadows.cubes().desc().layers, 18);
  // The array does not keep more layers than the remaining lamps may have.
  remove_lamp(0);
  remove_lamp(0);
  sync(settings);
  update();
  EXPECT_EQ(scene_shadows.cubes().desc().layers, 1);
  EXPECT_EQ(layer_of(0, 4), 0);
}

TEST_F(ShadowsTest, LayersOfAFittedCubeAreDrawnInOnePass)
{
  settings = {.is_fitted_to_depth = true, .layer_pass = LayerPass::Geometry};
  casters = {box_at({0, 0, 0}, 3.0F)};
  add_lamp(scene::LampKind::Point, "point");
  // From inside, half to the right: the faces at +X and -Z.
  view = draw::View(glm::rotate(glm::mat4(1.0F), 0.25F * 3.14159265F, {0, 1, 0}),
                    draw::perspective(0.1F, 0.1F, 0.5F, 100.0F));
  sync(settings);
  const std::string text = update();
  EXPECT_EQ(scene_shadows.cubes().desc().layers, 2) << text;
  EXPECT_NE(text.find("begin shadow of point, all layers -> shadow_cubes 0-1 "), std::string::npos) << text;
  EXPECT_EQ(text.find("begin shadow of point, face"), std::string::npos) << "one clear for both" << text;
  EXPECT_EQ(shadows.block_data().cubes[0].faces_and_filter, 1 << 0 | 1 << 5);
  EXPECT_EQ(shared::cube_face_layer(shadows.block_data().cubes[0].layers, 0), 0);
  EXPECT_EQ(shared::cube_face_layer(shadows.block_data().cubes[0].layers, 5), 1);
}

// hazards.md: a distance cube cleared to 0 is an occluder at the lamp.
TEST_F(ShadowsTest, AreClearedToTheFarPlane)
{
  // Reversed depth: far is 0.
  EXPECT_EQ(gpu::PassActions().clear_depth, 0.0F);
  add_lamp(scene::LampKind::Point, "a");
  sync();
  EXPECT_NE(update().find("depth clear/store"), std::string::npos);
}

TEST_F(ShadowsTest, AreDrawnOnceWhileNothingChanges)
{
  add_lamp(scene::LampKind::Point, "point");
  add_lamp(scene::LampKind::Sun, "sun");
  EXPECT_EQ(updated(), 2U);
  EXPECT_EQ(update(), "");
  EXPECT_EQ(updated(), 0U) << "a sync without a change";
}

TEST_F(ShadowsTest, FacesWithoutACasterAreSkipped)
{
  add_lamp(scene::LampKind::Point, "point");
  sync();
  update();
  // The caster is a box at -Z that ends within the 90° of its face.
  EXPECT_EQ(shadows.counters().faces_drawn, 1U);
  EXPECT_EQ(shadows.counters().faces_skipped, 5U);
  EXPECT_EQ(shadows.counters().caster_draws, 1U);
  EXPECT_EQ(shadows.block_data().cubes[0].faces_and_filter, 1 << 5);
}

TEST_F(ShadowsTest, FacesThatNothingVisibleLooksUpAreSkippedUntilItDoes)
{
  casters = {box_at({0, 0, 0}, 3.0F)};
  add_lamp(scene::LampKind::Point, "point");
  sync();
  // A narrow view from inside along -Z shows nothing behind or beside it.
  view = draw::View(glm::mat4(1.0F), draw::perspective(0.1F, 0.1F, 0.5F, 100.0F));
  update();
  EXPECT_EQ(shadows.block_data().cubes[0].faces_and_filter, 1 << 5);
  const std::uint64_t before = shadows.counters().faces_drawn;
  view = draw::View(glm::rotate(glm::mat4(1.0F), 3.14159265F, {0, 1, 0}), view.clip_from_view());
  update();
  EXPECT_EQ(shadows.counters().faces_drawn, before + 1) << "the face that came into view, and no other again";
  EXPECT_EQ(shadows.block_data().cubes[0].faces_and_filter, 1 << 5 | 1 << 4);
}

TEST_F(ShadowsTest, FacesThatOnlyPenumbrasLookUpAreDrawn)
{
  // All that is visible is in the face at -Z, and a part of the first box is in the face at -Y.
  casters = {box_at({0, -1.3F, -1.4F}, 0.25F), box_at({0, -2, -2.5F}, 0.1F)};
  view = draw::View(glm::lookAt(glm::vec3(0, 0, -2.5F), {0, -2, -2.5F}, {0, 0, -1}),
                    draw::perspective(0.01F, 0.01F, 0.5F, 100.0F));
  for (const float radius : {0.0F, 0.03F, 0.5F}) {
    placed.clear();
    add_lamp(scene::LampKind::Point, "point").radius = radius;
    sync();
    update();
    EXPECT_EQ((shadows.block_data().cubes[0].faces_and_filter & 1 << 3) != 0, radius == 0.5F) << radius;
  }
}

TEST_F(ShadowsTest, AMovedCasterUpdatesTheLampsInWhoseRangeItWasOrIs)
{
  view = draw::View(glm::translate(glm::mat4(1.0F), {0, 0, -60}), draw::perspective(1.0F, 1.0F, 0.1F, 1000.0F));
  for (int i = 0; i < 4; i++) {
    add_lamp(scene::LampKind::Point, "point" + std::to_string(i), {20.0F * float(i), 0, 0}).range = 6.0F;
  }
  casters.clear();
  for (int i = 0; i < 4; i++) {
    casters.push_back(box_at({20.0F * float(i), 0, -3}, 1.0F));
  }
  EXPECT_EQ(updated(), 4U);
  casters[1] = box_at({20, 0, -4}, 1.0F);
  EXPECT_EQ(updated(), 1U) << "it stays with its lamp";
  casters[1] = box_at({40, 0, 4}, 1.0F);
  EXPECT_EQ(updated(), 1U) << "it goes to another lamp: that one is drawn; the one it left has no caster any more";
  EXPECT_EQ(shadows.block_data().cubes[1].faces_and_filter, 0) << "and no shadow";
  casters.push_back(box_at({60, 3, 0}, 0.5F));
  EXPECT_EQ(updated(), 1U) << "one more";
  casters.pop_back();
  EXPECT_NE(shadows.block_data().cubes[3].faces_and_filter & 1 << 2, 0);
  EXPECT_EQ(updated(), 0U) << "one less: the face that it leaves is empty, and the others stay";
  EXPECT_EQ(shadows.block_data().cubes[3].faces_and_filter, 1 << 5);
  casters.push_back(box_at({200, 0, 0}, 1.0F));
  EXPECT_EQ(updated(), 0U) << "out of everyone's range";
}

TEST_F(ShadowsTest, AChangedLampIsUpdatedAlone)
{
  add_lamp(scene::LampKind::Point, "a");
  add_lamp(scene::LampKind::Spot, "b");
  add_lamp(scene::LampKind::Sun, "c");
  EXPECT_EQ(updated(), 3U);
  placed[1].world_from_lamp[3] = {0.5F, 0, 0, 1};
  EXPECT_EQ(updated(), 1U);
  placed[2].world_from_lamp = glm::mat4(glm::rotate(glm::mat4(1.0F), 0.1F, {1, 0, 0}));
  EXPECT_EQ(updated(), 1U);
  settings.cube_size_px = 512;
  EXPECT_EQ(updated(), 1U);
}

TEST_F(ShadowsTest, OfASunAreDrawnAgainWhenTheViewSeesMore)
{
  add_lamp(scene::LampKind::Sun, "sun");
  casters.push_back(box_at({40, 0, -3}, 1.0F));
  sync();
  update();
  ASSERT_EQ(shadows.counters().lamps_updated, 1U);
  view = draw::View(glm::rotate(glm::mat4(1.0F), 1.0F, glm::vec3(0, 1, 0)), view.clip_from_view());
  update();
  EXPECT_EQ(shadows.counters().lamps_updated, 2U);
}

TEST_F(ShadowsTest, DisabledShadowsCreateNothing)
{
  add_lamp(scene::LampKind::Point, "point");
  sync({.kind = scene::ShadowKind::None});
  EXPECT_EQ(scene_shadows.features(), Feature::None);
  EXPECT_FALSE(scene_shadows.cubes());
  EXPECT_EQ(update(), "");
  EXPECT_EQ(device->counters().textures_made, 0U);
}

TEST_F(ShadowsTest, SizesAreLoweredEvenlyToFitTheMemory)
{
  for (int i = 0; i < 5; i++) {
    add_lamp(scene::LampKind::Point, "point" + std::to_string(i));
  }
  ShadowSettings small;
  small.cube_size_px = 640;
  small.memory_bytes_max = std::size_t(5) * 6 * 64 * 64 * 4;
  sync(small);
  EXPECT_EQ(scene_shadows.cube_count(), 5U);
  EXPECT_EQ(scene_shadows.cubes().desc().width, 64);
  ASSERT_EQ(scene_shadows.limits().size(), 1U);
  EXPECT_NE(scene_shadows.limits()[0].find("the shadows of 5 lamps"), std::string::npos) << scene_shadows.limits()[0];
  EXPECT_NE(scene_shadows.limits()[0].find("lowered to 10 %"), std::string::npos) << scene_shadows.limits()[0];
}

// hazards.md: with more lamps than slots, shadows were lost silently.
TEST_F(ShadowsTest, LampsWithoutLayersAreNamed)
{
  for (int i = 0; i < 5; i++) {
    add_lamp(scene::LampKind::Point, "point" + std::to_string(i));
  }
  ShadowSettings small;
  small.cube_size_px = 64;
  small.memory_bytes_max = 3 * 6 * 16 * 16 * 4;
  sync(small);
  EXPECT_EQ(scene_shadows.cube_count(), 3U);
  ASSERT_EQ(scene_shadows.limits().size(), 2U);
  EXPECT_NE(scene_shadows.limits()[1].find("2 lamps lost their shadow"), std::string::npos)
      << scene_shadows.limits()[1];
  EXPECT_NE(scene_shadows.limits()[1].find("'point4', 'point3'"), std::string::npos) << scene_shadows.limits()[1];
  EXPECT_EQ(lamps.lights[3].shadow_kind, SHADOW_NONE);
  EXPECT_EQ(lamps.lights[3].shadow_index, -1);
  EXPECT_EQ(lamps.lights[2].shadow_kind, SHADOW_CUBE) << "the first are unchanged";
}

TEST_F(ShadowsTest, AreLimitedByTheDevicesLayers)
{
  const std::unique_ptr<gpu::Device> small = gpu::create_null_device({.array_layers_max = 13});
  for (int i = 0; i < 3; i++) {
    add_lamp(scene::LampKind::Point, "point" + std::to_string(i));
  }
  SceneShadows few;
  const std::vector<ShadowLamp> identified = identified_lamps();
  few.sync(small->limits(), identified, bounds_ws(), lamps.lights, {.cube_size_px = 16});
  EXPECT_EQ(few.cube_count(), 2U);
  EXPECT_NE(few.limits().at(0).find("'point2'"), std::string::npos);
}

TEST_F(ShadowsTest, FortyThreeCubesInARoomKeepTheirShadows)
{
  for (int i = 0; i < 43; i++) {
    add_lamp(scene::LampKind::Point, "point" + std::to_string(i));
  }
  sync({.memory_bytes_max = std::size_t(43) * 6 * 1024 * 1024 * 4});
  EXPECT_EQ(scene_shadows.cube_count(), 43U);
  EXPECT_TRUE(scene_shadows.limits().empty());
}

TEST_F(ShadowsTest, WithoutVertexLayersTheGeometryShaderChoosesOrEachLayerHasAPass)
{
  SceneShadows plain;
  const auto sync_plain = [&](const gpu::Limits &limits, const ShadowSettings &asked) {
    const std::vector<ShadowLamp> identified = identified_lamps();
    plain.sync(limits, identified, bounds_ws(), lamps.lights, asked);
  };
  gpu::Limits limits;
  limits.has_vertex_layer = false;
  EXPECT_THROW(sync_plain(limits, {.layer_pass = LayerPass::Layered}), gpu::Error);
  sync_plain(limits, {});
  EXPECT_EQ(plain.layer_pass(), LayerPass::Geometry) << "the next best";
  limits.has_geometry_shader = false;
  EXPECT_THROW(sync_plain(limits, {.layer_pass = LayerPass::Geometry}), gpu::Error);
  sync_plain(limits, {});
  EXPECT_EQ(plain.layer_pass(), LayerPass::Single);
}

}  // namespace
}  // namespace gnomon::eevee
