// SPDX-License-Identifier: MIT
#include "eevee_shadows.hh"

#include "eevee_view_volume.hh"

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
  const auto views = shadow_cube_views(lamp, 0.01F);
  for (const glm::vec3 &v : random_directions(500)) {
    const int face = shared::cube_face(v);
    const glm::vec4 clip = views[std::size_t(face)].clip_from_world() * glm::vec4(lamp + 5.0F * v, 1.0F);
    EXPECT_LE(std::abs(clip.x), clip.w * 1.00001F);
    EXPECT_LE(std::abs(clip.y), clip.w * 1.00001F);
    const glm::vec3 p = shared::cube_face_project(face, 5.0F * v);
    EXPECT_NEAR(clip.z / clip.w, 0.01F / p.z, 1e-6F);
    EXPECT_NEAR(clip.x / clip.w, p.x / p.z, 1e-5F);
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

TEST(LampNear, IsBeforeEveryCasterAndAboveZero)
{
  scene::Bounds box;
  box.extend({-1, -1, -1});
  box.extend({1, 1, 1});
  // Along a cube face's axis a point at distance d is at least d / √3 away.
  EXPECT_LE(lamp_near({0, 5, 0}, {box}), 4.0F / std::sqrt(3.0F));
  EXPECT_GT(lamp_near({0, 5, 0}, {box}), 1.0F);
  EXPECT_GT(lamp_near({0, 0, 0}, {box}), 0.0F);
  EXPECT_GT(lamp_near({0, 0, 0}, {}), 0.0F);
}

scene::Lamp sun_along(const glm::vec3 &forward)
{
  scene::Lamp lamp;
  lamp.kind = scene::LampKind::Sun;
  const glm::vec3 z = -glm::normalize(forward);
  const glm::vec3 x = glm::normalize(glm::cross(std::abs(z.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0), z));
  lamp.world_from_lamp =
      glm::mat4(glm::vec4(x, 0), glm::vec4(glm::cross(z, x), 0), glm::vec4(z, 0), glm::vec4(0, 0, 0, 1));
  return lamp;
}

scene::Bounds box_at(const glm::vec3 &center, float half)
{
  scene::Bounds box;
  box.extend(center - half);
  box.extend(center + half);
  return box;
}

TEST(SunFit, HoldsEveryCasterOfAVisibleReceiver)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
  for (int trial = 0; trial < 100; trial++) {
    const scene::Lamp lamp = sun_along(point() + glm::vec3(0, -1.5F, 0));
    std::vector<scene::Bounds> casters;
    scene::Bounds all;
    for (int i = 0; i < 12; i++) {
      casters.push_back(box_at(6.0F * point(), 0.5F));
      all.extend(casters.back());
    }
    const draw::View view(glm::lookAt(10.0F * point(), point(), glm::vec3(0, 1, 0)),
                          draw::perspective(0.3F, 0.2F, 0.1F, 50.0F));
    const auto receivers = visible_corners(view, all);
    const std::optional<SunFit> fit = fit_sun(lamp, receivers, casters, 512);
    // A ray from a visible receiver towards the sun that meets a caster: caster point and receiver both in the map.
    for (int i = 0; i < 4000; i++) {
      const glm::vec3 caster = casters[std::size_t(i) % 12].center() + 0.49F * point();
      const glm::vec3 receiver = caster - glm::vec3(lamp.world_from_lamp[2]) * (6.0F * std::abs(unit(random)));
      const bool is_seen = glm::all(glm::greaterThanEqual(receiver, all.min)) &&
                           glm::all(glm::lessThanEqual(receiver, all.max)) && view.touches({receiver, 0.0F});
      if (is_seen) {
        ASSERT_TRUE(fit) << "trial " << trial;
        for (const glm::vec3 &p : {caster, receiver}) {
          const glm::vec4 clip = fit->view.clip_from_world() * glm::vec4(p, 1.0F);
          ASSERT_LE(std::max(std::abs(clip.x), std::abs(clip.y)), 1.0F) << "trial " << trial;
          ASSERT_GE(clip.z, 0.0F);
          ASSERT_LE(clip.z, 1.0F);
        }
      }
    }
  }
}

TEST(SunFit, LeavesTheGroundOutOfTheCasters)
{
  scene::Bounds ground;
  ground.extend({-100, 0, -100});
  ground.extend({100, 0, 100});
  const std::vector<glm::dvec3> receivers = {{-100, 0, -100}, {100, 0, -100}, {-100, 0, 100}, {100, 3, 100}};
  const std::vector<scene::Bounds> casters = {ground, box_at({0, 1, 0}, 1.0F)};
  const scene::Lamp sun = sun_along({0.3F, -1, 0});
  const std::optional<SunFit> fit = fit_sun(sun, receivers, casters, 1024);
  ASSERT_TRUE(fit);
  EXPECT_LT(fit->max.x - fit->min.x, 6.0);
  EXPECT_LT(fit->max.y - fit->min.y, 6.0);
  EXPECT_FALSE(fit_sun(sun, receivers, {ground}, 1024)) << "the ground alone darkens nothing";
}

TEST(SunFit, KeepsGroundAboveWhatIsSeen)
{
  // A ceiling is flat too, and darkens what is below.
  scene::Bounds ceiling;
  ceiling.extend({-2, 4, -2});
  ceiling.extend({2, 4, 2});
  EXPECT_TRUE(fit_sun(sun_along({0, -1, 0}), {{-1, 0, -1}, {1, 0, 1}}, {ceiling}, 256));
}

// hazards.md: a degenerate frustum returned an uninitialised matrix.
TEST(SunFit, OfASinglePointIsFinite)
{
  const std::optional<SunFit> fit = fit_sun(sun_along({0, -1, 0}), {{1, 2, 3}}, {box_at({1, 2, 3}, 0.0F)}, 64);
  if (fit) {
    for (int i = 0; i < 16; i++) {
      EXPECT_TRUE(std::isfinite(fit->view.clip_from_world()[i / 4][i % 4]));
    }
  }
  EXPECT_FALSE(fit_sun(sun_along({0, -1, 0}), {}, {box_at({1, 2, 3}, 1.0F)}, 64));
}

// hazards.md: scale-free from 1e-4 to 1e5 m.
TEST(SunFit, IsTheSameAtEveryScale)
{
  for (const float scale : {1e-4F, 1.0F, 1e5F}) {
    const std::optional<SunFit> fit = fit_sun(
        sun_along({0.2F, -1, 0.1F}), {glm::dvec3(-2, 0, -2) * double(scale), glm::dvec3(2, 1, 2) * double(scale)},
        {box_at(glm::vec3(0, 0.5F * scale, 0), 0.5F * scale)}, 512);
    ASSERT_TRUE(fit);
    EXPECT_NEAR((fit->max.x - fit->min.x) / double(scale), 1.1, 0.5);
    const glm::vec4 clip = fit->view.clip_from_world() * glm::vec4(0, scale, 0, 1);
    EXPECT_LE(std::abs(clip.x), 1.0F);
    EXPECT_GT(clip.z, 0.5F);
  }
}

TEST(SpotView, HoldsItsCone)
{
  for (const float angle : {1e-3F, 0.2F, 0.8F, spot_map_angle_max}) {
    scene::Lamp lamp;
    lamp.kind = scene::LampKind::Spot;
    lamp.spot_outer_angle = angle;
    const draw::View view = shadow_spot_view(lamp, 0.01F, 512);
    const glm::vec4 clip = view.clip_from_world() * glm::vec4(std::tan(angle), 0, -1, 1);
    EXPECT_LT(clip.x / clip.w, 1.0F) << "half the opening " << angle;
    EXPECT_GT(clip.x / clip.w, 0.9F);
  }
}

/** Shadows of a few lamps on a null device. */
class ShadowsTest : public testing::Test {
 protected:
  void add_lamp(scene::LampKind kind, const std::string &name, float spot_angle = 0.5F)
  {
    scene::Lamp lamp;
    lamp.kind = kind;
    lamp.name = name;
    lamp.spot_outer_angle = spot_angle;
    scene.lamps.push_back(lamp);
  }
  void sync(const ShadowSettings &settings = {})
  {
    lamps = make_lamps(scene);
    shadows.sync(*device, scene, lamps, settings);
    shadows.add_caster(box_at({0, 0, -3}, 1.0F));
    shadows.finish(scene);
  }
  std::string update()
  {
    gpu::CommandList list;
    shadows.update(*device, view, draw::Pass("casters", gpu::State::WriteDepth), list);
    return list.serialize(*device);
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  Lamps lamps;
  Shadows shadows;
  const draw::View view{glm::mat4(1.0F), draw::perspective(1.0F, 1.0F, 0.1F, 100.0F)};
};

TEST_F(ShadowsTest, PointsAndWideSpotsHaveCubesSunsAndSpotsMaps)
{
  add_lamp(scene::LampKind::Point, "point");
  add_lamp(scene::LampKind::Spot, "wide", 1.5F);
  add_lamp(scene::LampKind::Spot, "spot");
  add_lamp(scene::LampKind::Sun, "sun");
  add_lamp(scene::LampKind::Hemi, "hemi");
  sync();
  EXPECT_EQ(shadows.cube_count(), 2U);
  EXPECT_EQ(shadows.map_count(), 2U);
  EXPECT_EQ(shadows.cubes().desc().layers, 12);
  EXPECT_EQ(shadows.maps().desc().layers, 2);
  EXPECT_EQ(lamps.light_block.lights[1].shadow_kind, SHADOW_CUBE);
  EXPECT_EQ(lamps.light_block.lights[1].shadow_index, 1);
  EXPECT_EQ(lamps.light_block.lights[4].shadow_kind, SHADOW_NONE);
}

// hazards.md: the second lamp's layers overlapped the first's.
TEST_F(ShadowsTest, TheSecondCubeBeginsAtLayerSix)
{
  add_lamp(scene::LampKind::Point, "a");
  add_lamp(scene::LampKind::Point, "b");
  sync();
  const std::string text = update();
  for (int layer = 0; layer < 12; layer++) {
    const std::string expected =
        fmt::format("begin shadow of {}, face {} -> shadow_cubes {} ", layer < 6 ? "a" : "b", layer % 6, layer);
    EXPECT_NE(text.find(expected), std::string::npos) << expected << "\n" << text;
  }
}

TEST_F(ShadowsTest, ClearToFar)
{
  // Reversed depth: far is 0; a cleared 1 would be an occluder at the lamp.
  EXPECT_EQ(gpu::PassActions().clear_depth, 0.0F);
  add_lamp(scene::LampKind::Point, "a");
  sync();
  EXPECT_NE(update().find("depth clear/store"), std::string::npos);
}

TEST_F(ShadowsTest, AreDrawnOnceWhileNothingChanges)
{
  add_lamp(scene::LampKind::Point, "point");
  add_lamp(scene::LampKind::Sun, "sun");
  sync();
  update();
  EXPECT_EQ(shadows.counters().lamps_updated, 2U);
  EXPECT_EQ(shadows.counters().faces_drawn, 7U);
  EXPECT_EQ(update(), "");
  EXPECT_EQ(shadows.counters().lamps_updated, 2U);
}

TEST_F(ShadowsTest, OfASunAreDrawnAgainWhenTheViewSeesMore)
{
  add_lamp(scene::LampKind::Sun, "sun");
  sync();
  shadows.add_caster(box_at({40, 0, -3}, 1.0F));
  update();
  ASSERT_EQ(shadows.counters().lamps_updated, 1U);
  const draw::View turned(glm::rotate(glm::mat4(1.0F), 1.0F, glm::vec3(0, 1, 0)), view.clip_from_view());
  gpu::CommandList list;
  shadows.update(*device, turned, draw::Pass("casters", gpu::State::WriteDepth), list);
  EXPECT_EQ(shadows.counters().lamps_updated, 2U);
}

TEST_F(ShadowsTest, OffMeansNothingIsMade)
{
  add_lamp(scene::LampKind::Point, "point");
  sync({.method = ShadowMethod::None});
  EXPECT_EQ(shadows.features(), Feature::None);
  EXPECT_FALSE(shadows.cubes());
  EXPECT_EQ(update(), "");
  EXPECT_EQ(device->counters().textures_made, 0U);
}

// hazards.md: more lamps than slots lost their shadow without a word.
TEST_F(ShadowsTest, ThoseThatLoseTheirsAreNamed)
{
  for (int i = 0; i < 5; i++) {
    add_lamp(scene::LampKind::Point, "point" + std::to_string(i));
  }
  ShadowSettings settings;
  settings.cube_size_px = 64;
  settings.memory_bytes_max = 3 * 6 * 64 * 64 * 4;
  sync(settings);
  EXPECT_EQ(shadows.cube_count(), 3U);
  ASSERT_EQ(shadows.limits().size(), 1U);
  EXPECT_NE(shadows.limits()[0].find("2 lamps lost their shadow"), std::string::npos) << shadows.limits()[0];
  EXPECT_NE(shadows.limits()[0].find("'point3', 'point4'"), std::string::npos) << shadows.limits()[0];
  EXPECT_EQ(lamps.light_block.lights[3].shadow_kind, SHADOW_NONE);
  EXPECT_EQ(lamps.light_block.lights[3].shadow_index, -1);
}

TEST_F(ShadowsTest, RespectTheDevicesLayers)
{
  device = gpu::create_null_device({.array_layers_max = 13});
  for (int i = 0; i < 3; i++) {
    add_lamp(scene::LampKind::Point, "point" + std::to_string(i));
  }
  sync({.cube_size_px = 16});
  EXPECT_EQ(shadows.cube_count(), 2U);
  EXPECT_NE(shadows.limits().at(0).find("'point2'"), std::string::npos);
  shadows = {};
}

}  // namespace
}  // namespace gnomon::eevee
