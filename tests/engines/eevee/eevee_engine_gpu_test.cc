// SPDX-License-Identifier: MIT
// Light and shadow compared with closed forms, on the driver.
#include "eevee_light_shared.h"
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "shader_check_reflection.hh"
#include "shader_files.hh"

#include <gtest/gtest.h>

#include <numbers>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;

using std::numbers::pi;

class EngineGpuTest : public test::SharedDeviceTest {
 protected:
  /** A square of half size \a half at \a center, facing \a normal. */
  scene::Handle<scene::Node> add_square(const glm::vec3 &center, const glm::vec3 &normal, float half,
                                        scene::Handle<scene::Mesh> mesh)
  {
    const glm::vec3 up = std::abs(glm::normalize(normal).y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::mat4 world_from_square =
        glm::inverse(glm::lookAt(center, center - normal, up)) * glm::scale(glm::mat4(1.0F), glm::vec3(half));
    return test::add_object(scene, mesh, world_from_square);
  }
  Picture render(const scene::PlacedCamera &camera, const Settings &settings = {}, glm::ivec2 size_px = {64, 64})
  {
    Renderer renderer(*device, scene, size_px, settings);
    const Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture;
  }

  scene::Scene scene;
  scene::Handle<scene::Mesh> square = test::add_square_mesh(scene, test::add_material(scene, {0.8F, 0.4F, 0.2F}));
  scene::PlacedCamera above = test::camera_at({0, 0, 5}, {0, 0, 0}, 0.2F);
};

TEST_F(EngineGpuTest, SunIsAlbedoOverPiTimesCosine)
{
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, std::sin(0.7F), -std::cos(0.7F)}, 3.0F);
  const glm::vec4 pixel = render(above).middle();
  const float expected = 3.0F * std::cos(0.7F) / float(pi);
  EXPECT_NEAR(pixel.r, 0.8F * expected, 1e-5F);
  EXPECT_NEAR(pixel.g, 0.4F * expected, 1e-5F);
  EXPECT_NEAR(pixel.b, 0.2F * expected, 1e-5F);
}

TEST_F(EngineGpuTest, PointFallsWithTheSquareOfTheDistance)
{
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  const auto lamp = test::add_lamp(scene, scene::LampKind::Point, {1, 0, 2}, {0, 0, -1}, 50.0F);
  // Centre of the pixel to the upper right of the middle.
  const float half_pixel = 5.0F * std::tan(0.1F) / 64.0F;
  const glm::vec3 to_lamp = glm::vec3(1, 0, 2) - glm::vec3(half_pixel, half_pixel, 0);
  const float d2 = glm::dot(to_lamp, to_lamp);
  const float cosine = 2.0F / std::sqrt(d2);
  EXPECT_NEAR(render(above).middle().r, 0.8F / float(pi) * 50.0F * cosine / d2, 2e-3F);
  scene.edit(lamp, [&](scene::Lamp &value) { value.radius = 0.5F; });
  EXPECT_NEAR(render(above).middle().r, 0.8F / float(pi) * 50.0F * cosine / (d2 + 0.25F), 2e-3F);
}

TEST_F(EngineGpuTest, SpotIsMaskedByItsCone)
{
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  const auto lamp = test::add_lamp(scene, scene::LampKind::Spot, {0, 0, 4}, {0, 0, -1}, 50.0F);
  scene.edit(lamp, [&](scene::Lamp &value) { value.spot_outer_angle = 0.3F; });
  scene.edit(lamp, [&](scene::Lamp &value) { value.spot_blend = 0.0F; });
  const scene::PlacedCamera wide = test::camera_at({0, 0, 5}, {0, 0, 0}, 1.0F);
  const Picture picture = render(wide, {}, {128, 128});
  const float plain = 0.8F / float(pi) * 50.0F / 16.0F;
  EXPECT_NEAR(picture.middle().r, plain, 2e-2F * plain);
  const float pixel_m = 2.0F * 5.0F * std::tan(0.5F) / 128.0F;
  const auto edge_px = int(4.0F * std::tan(0.3F) / pixel_m);
  EXPECT_GT(picture.at(64 + edge_px - 3, 64).r, 0.5F * plain);
  EXPECT_EQ(picture.at(64 + edge_px + 3, 64).r, 0.0F);
}

TEST_F(EngineGpuTest, HemiLightsByTheTiltedSky)
{
  for (const float tilt : {0.0F, 1.0F, 3.0F}) {
    test::remove_objects(scene);
    test::remove_lamps(scene);
    add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
    test::add_lamp(scene, scene::LampKind::Hemi, {}, {std::sin(tilt), 0, -std::cos(tilt)}, 2.0F);
    EXPECT_NEAR(render(above).middle().r, 0.8F / float(pi) * 2.0F * (0.5F + 0.5F * std::cos(tilt)), 1e-5F) << tilt;
  }
}

TEST_F(EngineGpuTest, LightsAddUp)
{
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  // One more than light_block holds.
  for (int i = 0; i <= LIGHT_MAX; i++) {
    test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 0.1F);
    if (i + 1 >= LIGHT_MAX) {
      EXPECT_NEAR(render(above, {.shadow = {.kind = scene::ShadowKind::None}}).middle().r,
                  0.8F / float(pi) * 0.1F * float(i + 1), 1e-3F);
    }
  }
}

TEST_F(EngineGpuTest, EmissionIsVisibleWithoutLamps)
{
  test::edit_material(scene, 0, [&](scene::Material &material) { material.emissive = {1, 2, 3}; });
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  const glm::vec4 pixel = render(above).middle();
  EXPECT_FLOAT_EQ(pixel.r, 1.0F);
  EXPECT_FLOAT_EQ(pixel.g, 2.0F);
  EXPECT_FLOAT_EQ(pixel.b, 3.0F);
}

TEST_F(EngineGpuTest, BothSidesOfATwoSidedSurfaceAreLitFromTheirSide)
{
  add_square({0, 0, 0}, {0, 0, -1}, 10.0F, square);
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 1.0F);
  EXPECT_NEAR(render(above).middle().r, 0.8F / float(pi), 1e-5F);
}

TEST_F(EngineGpuTest, BackOfAOneSidedSurfaceIsInvisible)
{
  test::edit_material(scene, 0, [&](scene::Material &material) { material.is_double_sided = false; });
  add_square({0, 0, 0}, {0, 0, -1}, 10.0F, square);
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 1.0F);
  EXPECT_EQ(render(above).middle().r, 0.0F);
}

TEST_F(EngineGpuTest, FrontOfTwoOneSidedSurfacesBackToBackIsVisible)
{
  test::edit_material(scene, 0, [&](scene::Material &material) { material.is_double_sided = false; });
  const auto green = test::add_square_mesh(scene, test::add_material(scene, {0, 1, 0}));
  test::edit_material(scene, 1, [&](scene::Material &material) { material.is_double_sided = false; });
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 1.0F);
  for (const bool is_front_first : {true, false}) {
    test::remove_objects(scene);
    for (const bool is_front : {is_front_first, !is_front_first}) {
      // A rotation by 180° around Y keeps the vertices in the plane and shows the back.
      const glm::mat4 turn = glm::rotate(glm::mat4(1.0F), is_front ? 0.0F : float(pi), glm::vec3(0, 1, 0));
      test::add_object(scene, is_front ? square : green, turn);
    }
    const glm::vec4 pixel = render(above, {.shadow = {.kind = scene::ShadowKind::None}}).middle();
    EXPECT_NEAR(pixel.r, 0.8F / float(pi), 1e-4F) << "the red front " << (is_front_first ? "first" : "last");
  }
}

// hazards.md: negative, sheared and singular object matrices.
TEST_F(EngineGpuTest, MirroredObjectsAreLitAsTheirImage)
{
  test::edit_material(scene, 0, [&](scene::Material &material) { material.is_double_sided = false; });
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0.5F, -1}, 1.0F);
  test::add_object(scene, square, glm::scale(glm::mat4(1.0F), glm::vec3(10, 10, 1)));
  const glm::vec4 plain = render(above).middle();
  test::remove_objects(scene);
  test::add_object(scene, square, glm::scale(glm::mat4(1.0F), glm::vec3(-10, 10, 1)));
  EXPECT_EQ(render(above).middle(), plain);
}

TEST_F(EngineGpuTest, SingularMatricesGiveFinitePictures)
{
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 1}, {0, 0, -1}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 1}, {0, 0, -1}, 1.0F);
  for (const glm::vec3 &scale : {glm::vec3(0, 1, 1), glm::vec3(0), glm::vec3(1, 1, 0)}) {
    test::add_object(scene, square, glm::scale(glm::mat4(1.0F), scale));
  }
  render(above);
}

TEST_F(EngineGpuTest, LampsInAndOnSurfacesGiveFinitePictures)
{
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  const float half_pixel = 5.0F * std::tan(0.1F) / 64.0F;
  test::add_lamp(scene, scene::LampKind::Point, {half_pixel, half_pixel, 0}, {0, 0, -1}, 1.0F);
  scene.edit(test::add_lamp(scene, scene::LampKind::Spot, {0, 0, 0}, {1, 0, 0}, 1.0F),
             [](scene::Lamp &lamp) { lamp.spot_outer_angle = 1.5707F; });
  scene.edit(test::add_lamp(scene, scene::LampKind::Spot, {0, 0, 0}, {1, 0, 0}, 1.0F),
             [](scene::Lamp &lamp) { lamp.spot_outer_angle = 1e-4F; });
  test::add_lamp(scene, scene::LampKind::Sun, {}, {1, 0, 0}, 1.0F);
  render(above);
}

TEST_F(EngineGpuTest, SmoothMetalIsFinite)
{
  test::edit_material(scene, 0, [](scene::Material &material) {
    material.metallic = 1.0F;
    material.roughness = 0.0F;
  });
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 1.0F);
  EXPECT_GT(render(above).middle().r, 1.0F) << "the mirror image of the sun";
}

/** Shadow of a square of half size 1 at height 2 from a lamp at height 4: half size 2 on the ground. */
class ShadowGpuTest : public EngineGpuTest {
 protected:
  /** Ground pixels, not next to the shadow's edge, where visibility differs from the truth. */
  int wrong_pixels(scene::LampKind kind, float edge_m)
  {
    test::remove_objects(scene);
    test::remove_lamps(scene);
    add_square({0, 0, 0}, {0, 0, 1}, 20.0F, square);
    add_square({0, 0, 2}, {0, 0, 1}, 1.0F, square);
    scene.edit(test::add_lamp(scene, kind, {0, 0, 4}, {0, 0, -1}, 20.0F),
               [](scene::Lamp &lamp) { lamp.spot_outer_angle = 1.0F; });
    // From below the square, so that it hides no part of the ground.
    scene::PlacedCamera camera = test::camera_at({0, 0, 1.9F}, {0, 0, 0}, 2.6F);
    const Picture lit = render(camera, {.shadow = {.kind = scene::ShadowKind::None}}, {256, 256});
    const Picture shadowed = render(camera, {}, {256, 256});
    int wrong = 0;
    for (int y = 0; y < 256; y++) {
      for (int x = 0; x < 256; x++) {
        const float half_m = 1.9F * std::tan(1.3F);
        const glm::vec2 p = ((glm::vec2(x, y) + 0.5F) / 128.0F - 1.0F) * half_m;
        const float from_middle = std::max(std::abs(p.x), std::abs(p.y));
        if (std::abs(from_middle - edge_m) < margin_m || lit.at(x, y).r <= 0.0F) {
          continue;
        }
        const float visibility = shadowed.at(x, y).r / lit.at(x, y).r;
        wrong += std::abs(visibility - (from_middle < edge_m ? 0.0F : 1.0F)) > 1e-3F;
      }
    }
    return wrong;
  }
  // Two pixels of 2·1.9·tan(1.3) / 256 = 5.3 cm, which the filter spreads the edge over, and a texel.
  static constexpr float margin_m = 0.12F;
};

TEST_F(ShadowGpuTest, PointMatchesTheClosedForm)
{
  EXPECT_EQ(wrong_pixels(scene::LampKind::Point, 2.0F), 0);
}

TEST_F(ShadowGpuTest, SpotMatchesTheClosedForm)
{
  EXPECT_EQ(wrong_pixels(scene::LampKind::Spot, 2.0F), 0);
}

TEST_F(ShadowGpuTest, SunMatchesTheClosedForm)
{
  EXPECT_EQ(wrong_pixels(scene::LampKind::Sun, 1.0F), 0);
}

// hazards.md: the second lamp's layers overlapped the first's.
TEST_F(ShadowGpuTest, EachOfTwoPointLampsHasItsOwnShadow)
{
  add_square({0, 0, 0}, {0, 0, 1}, 20.0F, square);
  add_square({0, 0, 2}, {0, 0, 1}, 0.5F, square);
  scene.edit(test::add_lamp(scene, scene::LampKind::Point, {-2, 0, 4}, {0, 0, -1}, 20.0F), [](scene::Lamp &lamp) {
    lamp.color = {1, 0, 0};
  });
  scene.edit(test::add_lamp(scene, scene::LampKind::Point, {2, 0, 4}, {0, 0, -1}, 20.0F), [](scene::Lamp &lamp) {
    lamp.color = {0, 1, 0};
  });
  const scene::PlacedCamera camera = test::camera_at({0, -8, 1.5F}, {0, 0, 0}, 0.8F);
  const Picture picture = render(camera, {}, {256, 256});
  // The left lamp's shadow falls to the right, around x = 2, and there is no red; the right one's around -2.
  const auto at = [&](const glm::vec3 &p) {
    const glm::vec4 clip = view_of(camera, {256, 256}).clip_from_world() * glm::vec4(p, 1.0F);
    const glm::vec2 px = (glm::vec2(clip) / clip.w * 0.5F + 0.5F) * 256.0F;
    return picture.at(int(px.x), int(px.y));
  };
  EXPECT_EQ(at({2, 0, 0}).r, 0.0F);
  EXPECT_GT(at({2, 0, 0}).g, 0.0F);
  EXPECT_EQ(at({-2, 0, 0}).g, 0.0F);
  EXPECT_GT(at({-2, 0, 0}).r, 0.0F);
}

TEST_F(ShadowGpuTest, APlaneDoesNotDarkenItselfAtAnyAngle)
{
  for (const scene::LampKind kind : {scene::LampKind::Sun, scene::LampKind::Point, scene::LampKind::Spot}) {
    for (const float degrees : {0.5F, 1.0F, 3.0F, 10.0F, 30.0F, 45.0F, 60.0F, 89.0F, 90.0F}) {
      test::remove_objects(scene);
      test::remove_lamps(scene);
      const float elevation = degrees * float(pi) / 180.0F;
      const glm::vec3 to_lamp(std::cos(elevation) * 0.6F, std::cos(elevation) * 0.8F, std::sin(elevation));
      add_square({0, 0, 0}, {0, 0, 1}, 4.0F, square);
      // Without a caster above, the sun would have no map. Its shadow falls outside of the picture.
      add_square({-3.9F, -3.9F, 3}, {1, 1, 0}, 0.1F, square);
      scene.edit(test::add_lamp(scene, kind, 6.0F * to_lamp, -to_lamp, 10.0F),
                 [](scene::Lamp &lamp) { lamp.spot_outer_angle = 0.6F; });
      const scene::PlacedCamera camera = test::camera_at({1, -2, 5}, {0, 0, 0}, 0.3F);
      const Picture lit = render(camera, {.shadow = {.kind = scene::ShadowKind::None}});
      const Picture shadowed = render(camera);
      int dark = 0;
      for (std::size_t i = 0; i < lit.pixels.size(); i++) {
        dark += shadowed.pixels[i].r < 0.999F * lit.pixels[i].r;
      }
      EXPECT_EQ(dark, 0) << "lamp kind " << int(kind) << " at " << degrees << "°";
    }
  }
}

TEST_F(ShadowGpuTest, ABareGroundIsLitWhateverTheLampsHeight)
{
  for (const float half : {1.0F, 5.0F, 50.0F}) {
    for (const scene::LampKind kind : {scene::LampKind::Sun, scene::LampKind::Point}) {
      for (const float height : {0.02F, 0.5F, 3.0F}) {
        test::remove_objects(scene);
        test::remove_lamps(scene);
        add_square({0, 0, 0}, {0, 0, 1}, half, square);
        test::add_lamp(scene, kind, {0, 0, height}, {0.3F, 0.1F, -1}, 1.0F);
        const scene::PlacedCamera camera = test::camera_at({0.5F * half, -half, half}, {0, 0, 0}, 0.9F);
        const Picture lit = render(camera, {.shadow = {.kind = scene::ShadowKind::None}});
        const Picture shadowed = render(camera, {.shadow = {.cube_size_px = 64}});
        int dark = 0;
        for (std::size_t i = 0; i < lit.pixels.size(); i++) {
          dark += shadowed.pixels[i].r < 0.999F * lit.pixels[i].r;
        }
        EXPECT_EQ(dark, 0) << "lamp kind " << int(kind) << " at " << height << " m over a ground of " << half;
      }
    }
  }
}

TEST_F(ShadowGpuTest, SmallThingsCastInWideScenes)
{
  for (const scene::LampKind kind : {scene::LampKind::Sun, scene::LampKind::Point}) {
    test::remove_objects(scene);
    test::remove_lamps(scene);
    add_square({0, 0, 0}, {0, 0, 1}, 20000.0F, square);
    add_square({0, 0, 1}, {0, 0, 1}, 0.5F, square);
    test::add_lamp(scene, kind, {0, 0, 2}, {0, 0, -1}, 1.0F);
    // Looks under the small square, at the middle of its shadow.
    const scene::PlacedCamera camera = test::camera_at({0, -2, 0.9F}, {0, 0, 0}, 0.05F);
    EXPECT_EQ(render(camera).middle().r, 0.0F) << "lamp kind " << int(kind);
    EXPECT_GT(render(camera, {.shadow = {.kind = scene::ShadowKind::None}}).middle().r, 0.0F);
  }
}

// hazards.md: a shadow map's edge bled outside; outside is lit.
TEST_F(ShadowGpuTest, OutsideOfTheSunsMapIsLit)
{
  add_square({0, 0, 0}, {0, 0, 1}, 20.0F, square);
  add_square({0, 0, 1}, {0, 0, 1}, 0.2F, square);
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0.3F, -1}, 1.0F);
  const scene::PlacedCamera camera = test::camera_at({0, -10, 8}, {0, 0, 0}, 0.9F);
  const Picture lit = render(camera, {.shadow = {.kind = scene::ShadowKind::None}});
  const Picture shadowed = render(camera);
  int dark = 0;
  for (std::size_t i = 0; i < lit.pixels.size(); i++) {
    dark += shadowed.pixels[i].r < 0.999F * lit.pixels[i].r;
  }
  EXPECT_GT(dark, 0);
  EXPECT_LT(dark, 20) << "of 4096 pixels, for a square of 0.4 m on a ground of 40 m";
}

TEST_F(ShadowGpuTest, ASurfaceThatCastsNoShadowReceivesThoseOfCastersOutsideTheView)
{
  const scene::Handle<scene::Node> ground = add_square({0, 0, 0}, {0, 0, 1}, 20.0F, square);
  add_square({0, 0, 10}, {0, 0, 1}, 1.0F, square);
  scene.edit(ground, [](scene::Node &node) { node.casts_shadow = false; });
  // It sees the shadow only.
  const scene::PlacedCamera camera = test::camera_at({0, 0, 2}, {0, 0, 0}, 0.2F);
  for (const scene::LampKind kind : {scene::LampKind::Sun, scene::LampKind::Spot, scene::LampKind::Point}) {
    test::remove_lamps(scene);
    scene.edit(test::add_lamp(scene, kind, {0, 0, 20}, {0, 0, -1}, 100.0F),
               [](scene::Lamp &lamp) { lamp.spot_outer_angle = 0.4F; });
    EXPECT_GT(render(camera, {.shadow = {.kind = scene::ShadowKind::None}}).middle().r, 0.0F);
    for (const scene::ShadowKind shadow : {scene::ShadowKind::Hard, scene::ShadowKind::Esm}) {
      EXPECT_LT(render(camera, {.shadow = {.kind = shadow}}).middle().r, 1e-4F) << int(kind) << ' ' << int(shadow);
    }
  }
}

/** Objects of one mesh share what is recorded for them, except where their winding or their shadows differ. */
TEST_F(ShadowGpuTest, ObjectsOfOneMeshAreThoseOfCopiesOfIt)
{
  test::edit_material(scene, 0, [](scene::Material &material) { material.is_double_sided = false; });
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0.5F, 0.3F, -1}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 50.0F);
  const auto box = test::add_box_mesh(scene, scene.materials().first());
  std::vector<scene::Handle<scene::Node>> nodes = {add_square({0, 0, -1}, {0, 0, 1}, 20.0F, square)};
  for (int i = 0; i < 16; i++) {
    const glm::vec3 place(1.5F * float(i % 4) - 2.0F, 1.5F * float(i / 4) - 2.0F, 0.1F * float(i));
    const glm::vec3 scale((i & 1) != 0 ? -0.5F : 0.5F, 0.5F, 0.4F);
    nodes.push_back(test::add_object(
        scene, box, glm::scale(glm::rotate(glm::translate(glm::mat4(1.0F), place), float(i), {0.6F, 0, 0.8F}), scale)));
    scene.edit(nodes.back(), [&](scene::Node &node) {
      node.receives_shadow = (i & 2) == 0;
      node.casts_shadow = (i & 4) == 0;
    });
  }
  const scene::PlacedCamera camera = test::camera_at({0, -8, 6}, {0, 0, 0}, 0.8F);
  for (const CasterFaces faces : {CasterFaces::Front, CasterFaces::Back}) {
    const Settings settings{.shadow = {.caster_faces = faces}};
    const Picture shared = render(camera, settings);
    scene::Scene others = scene;
    for (const scene::Handle<scene::Node> node : nodes) {
      others.edit(node, [&](scene::Node &value) { value.meshes = {others.add(others.meshes()[value.meshes[0]])}; });
    }
    Renderer renderer(*device, others, {64, 64}, settings);
    EXPECT_EQ(shared.pixels, renderer.picture(camera).pixels) << int(faces);
    EXPECT_NE(shared.pixels, render(camera, {.shadow = {.kind = scene::ShadowKind::None}}).pixels);
  }
}

TEST_F(ShadowGpuTest, SamplesConvergeToASmoothEdge)
{
  add_square({0, 0, 0}, {0, 0, 1}, 20.0F, square);
  add_square({0, 0, 2}, {0.2F, 0.1F, 1}, 1.0F, square);
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0.5F, 0.3F, -1}, 1.0F);
  const scene::PlacedCamera camera = test::camera_at({0, -6, 5}, {0, 0, 0}, 0.8F);
  const auto rmse = [](const Picture &a, const Picture &b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); i++) {
      const glm::vec3 d(a.pixels[i] - b.pixels[i]);
      sum += double(glm::dot(d, d)) / 3.0;
    }
    return std::sqrt(sum / double(a.pixels.size()));
  };
  const Picture truth = render(camera, {.sample_count = 256});
  const double error_1 = rmse(render(camera, {.sample_count = 1}), truth);
  const double error_16 = rmse(render(camera, {.sample_count = 16}), truth);
  EXPECT_LT(error_16, 0.25 * error_1);

  // Without a count, the picture so far is one of that many samples.
  Renderer renderer(*device, scene, truth.size_px, {.sample_count = 0});
  const auto drawn = [&](int count) {
    renderer.draw(camera, {}, {.progress = [=](int samples) { return samples < count; }});
    return renderer.picture();
  };
  EXPECT_LT(rmse(drawn(16), truth), 1.25 * error_16);
  EXPECT_EQ(rmse(drawn(1), render(camera, {.sample_count = 1})), 0.0) << "both samples are at the pixels' centres";
}

TEST_F(EngineGpuTest, RecordsTheSamePassesAsTheNullBackend)
{
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 2}, {0, 0, -1}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0, 0, -1}, 1.0F);
  const auto null_device = gpu::create_null_device(device->limits());
  const draw::TargetTexture gl_target(*device, "display", gpu::Format::RGBA8, {16, 16});
  const draw::TargetTexture null_target(*null_device, "display", gpu::Format::RGBA8, {16, 16});
  Renderer gl(*device, scene, {16, 16});
  Renderer null(*null_device, scene, {16, 16});
  gl.draw(above, gl_target.target());
  null.draw(above, null_target.target());
  const std::string passes = gl.inspect().serialize_passes();
  EXPECT_NE(passes.find("group eevee_deferred_lit"), std::string::npos) << passes;
  EXPECT_EQ(passes, null.inspect().serialize_passes());
}

TEST_F(EngineGpuTest, AnEditedShaderIsReloadedAndABadEditKeepsTheLastGoodOne)
{
  test::edit_material(scene, 0, [&](scene::Material &material) { material.emissive = {1, 1, 1}; });
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  Renderer renderer(*device, scene, {8, 8});
  ASSERT_FLOAT_EQ(renderer.picture(above).middle().r, 1.0F);

  const std::string path = "eevee/eevee_lit_frag.glsl";
  const std::string original(*shaders::file(path));
  std::string edited = original;
  const std::string line = "radiance = vec4(sum, alpha);";
  ASSERT_NE(edited.find(line), std::string::npos);
  const auto reload = [&](const std::string &replacement) {
    edited = original;
    edited.replace(edited.find(line), line.size(), replacement);
    const gpu::ShaderFiles files = [&](std::string_view file) {
      return file == path ? std::optional<std::string_view>(edited) : shaders::file(file);
    };
    const auto failures = renderer.engine.reload_shaders(renderer.viewport, files, shader_check::reflect);
    renderer.sync();
    return failures;
  };
  EXPECT_EQ(reload("radiance = vec4(sum * 2.0, 1.0);"), std::vector<std::string>());
  EXPECT_FLOAT_EQ(renderer.picture(above).middle().r, 2.0F);

  const std::vector<std::string> failures = reload("radiance = vec4(sum * 3.0, 1.0) oops;");
  ASSERT_EQ(failures.size(), 1U);
  const auto line_number =
      std::count(original.begin(), original.begin() + std::ptrdiff_t(original.find(line)), '\n') + 1;
  EXPECT_NE(failures[0].find(path + ":" + std::to_string(line_number)), std::string::npos) << failures[0];
  EXPECT_FLOAT_EQ(renderer.picture(above).middle().r, 2.0F);
}

TEST_F(EngineGpuTest, DisplayIsTheViewTransformOfTheRadiance)
{
  test::edit_material(scene, 0, [&](scene::Material &material) { material.emissive = {0.5F, 0.001F, 4.0F}; });
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  const draw::TargetTexture display(*device, "display", gpu::Format::RGBA8, {8, 8});
  Renderer renderer(*device, scene, {8, 8});
  for (const draw::ViewTransform transform : {draw::ViewTransform::Standard, draw::ViewTransform::Raw}) {
    draw::Target target = display.target();
    target.view_transform = transform;
    target.exposure = -1.0F;
    renderer.draw(above, target);
    const std::vector<std::byte> pixels = device->read(display.texture());
    const auto encoded = [&](double linear) {
      const double v = std::clamp(linear, 0.0, 1.0);
      const double srgb = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
      return 255.0 * (transform == draw::ViewTransform::Raw ? v : srgb);
    };
    // Rounding: half a step of 255, and a margin for the driver's pow.
    EXPECT_NEAR(double(pixels[0]), encoded(0.25), 0.6);
    EXPECT_NEAR(double(pixels[1]), encoded(0.0005), 0.6);
    EXPECT_EQ(int(pixels[2]), 255);
    EXPECT_EQ(int(pixels[3]), 255);
  }
}

TEST_F(EngineGpuTest, StepTimesAreMeasured)
{
  add_square({0, 0, 0}, {0, 0, 1}, 10.0F, square);
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 2}, {0, 0, -1}, 1.0F);
  Renderer renderer(*device, scene, {64, 64}, {.is_timed = true});
  renderer.draw(above);
  std::vector<std::string> names;
  for (const StepTime &step : renderer.inspect().take_step_times()) {
    names.push_back(step.step);
    EXPECT_GE(step.seconds, 0.0);
    EXPECT_LT(step.seconds, 60.0);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"gbuffer", "shadows", "deferred_lit", "film"}));
}

}  // namespace
}  // namespace gnomon::eevee
