// SPDX-License-Identifier: MIT
#include "eevee_camera.hh"

#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"
#include "gpu/gpu_testing.hh"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <tuple>

namespace gnomon::eevee {
namespace {

glm::vec3 ndc(const draw::View &view, const glm::vec3 &position_ws)
{
  const glm::vec4 clip = view.clip_from_world() * glm::vec4(position_ws, 1.0F);
  return glm::vec3(clip) / clip.w;
}

TEST(CameraView, PutsTheFrameEdgeAtTheImageEdge)
{
  scene::PlacedCamera camera;
  camera.vertical_angle = 1.0F;
  camera.near = 0.5F;
  camera.far = 100.0F;
  const draw::View view = view_of(camera, {200, 100});
  const float half_height = std::tan(0.5F);
  EXPECT_NEAR(ndc(view, {0, half_height * 3.0F, -3.0F}).y, 1.0F, 1e-6F);
  EXPECT_NEAR(ndc(view, {half_height * 2.0F * 3.0F, 0, -3.0F}).x, 1.0F, 1e-6F);
  EXPECT_NEAR(ndc(view, {0, 0, -0.5F}).z, 1.0F, 1e-6F);
  EXPECT_NEAR(ndc(view, {0, 0, -100.0F}).z, 0.0F, 1e-6F);
}

TEST(CameraView, WithoutFarPlaneReachesInfinity)
{
  scene::PlacedCamera camera;
  const draw::View view = view_of(camera, {64, 64});
  const float depth = ndc(view, {0, 0, -1e9F}).z;
  EXPECT_GT(depth, 0.0F);
  EXPECT_NEAR(depth, camera.near / 1e9F, 1e-12F);
}

TEST(CameraView, KeepsTheWholeFrameWhateverTheImage)
{
  scene::PlacedCamera camera;
  camera.vertical_angle = 0.8F;
  camera.aspect = 1.5F;
  const float half_height = std::tan(0.4F);
  for (const glm::ivec2 size : {glm::ivec2(150, 100), glm::ivec2(400, 100), glm::ivec2(100, 400), glm::ivec2(1, 9)}) {
    const glm::vec3 corner = ndc(view_of(camera, size), {1.5F * half_height, half_height, -1.0F});
    EXPECT_LE(corner.x, 1.0F + 1e-6F);
    EXPECT_LE(corner.y, 1.0F + 1e-6F);
    EXPECT_NEAR(std::max(corner.x, corner.y), 1.0F, 1e-6F) << size.x << "x" << size.y;
  }
}

TEST(CameraView, OrthographicKeepsSizeAtEveryDistance)
{
  scene::PlacedCamera camera;
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = 4.0F;
  camera.half_height = 2.0F;
  camera.near = 0.0F;
  camera.far = 50.0F;
  const draw::View view = view_of(camera, {200, 100});
  EXPECT_FALSE(view.is_perspective());
  for (const float z : {-1.0F, -10.0F, -49.0F}) {
    EXPECT_NEAR(ndc(view, {4, 2, z}).x, 1.0F, 1e-6F);
    EXPECT_NEAR(ndc(view, {4, 2, z}).y, 1.0F, 1e-6F);
    EXPECT_NEAR(ndc(view, {0, 0, z}).z, 1.0F + z / 50.0F, 1e-6F);
  }
}

TEST(CameraView, StaysFiniteForExtremeCameras)
{
  for (const float angle : {1e-6F, 3.1415925F}) {
    for (const float near : {1e-6F, 1e9F}) {
      for (const scene::CameraKind kind : {scene::CameraKind::Perspective, scene::CameraKind::Orthographic}) {
        for (const float far : {0.0F, std::nextafter(near, 1e30F)}) {
          scene::PlacedCamera camera;
          camera.kind = kind;
          camera.vertical_angle = angle;
          camera.near = near;
          camera.far = far;
          const draw::View view = view_of(camera, {16384, 1});
          for (int i = 0; i < 16; i++) {
            EXPECT_TRUE(std::isfinite(view.clip_from_world()[i / 4][i % 4])) << angle << " " << near << " " << far;
          }
        }
      }
    }
  }
}

TEST(CameraView, NamesALensThatCannotBeDrawn)
{
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinite = std::numeric_limits<float>::infinity();
  using Change = std::function<void(scene::PlacedCamera &)>;
  for (const auto &[part, change] : std::initializer_list<std::pair<const char *, Change>>{
           {"vertical angle 0", [](auto &camera) { camera.vertical_angle = 0.0F; }},
           {"vertical angle 9", [](auto &camera) { camera.vertical_angle = 9.0F; }},
           {"vertical angle nan", [](auto &camera) { camera.vertical_angle = nan; }},
           {"too small", [](auto &camera) { camera.vertical_angle = 1e-45F; }},
           {"near plane 0", [](auto &camera) { camera.near = 0.0F; }},
           {"near plane inf", [](auto &camera) { camera.near = infinite; }},
           {"far plane nan", [](auto &camera) { camera.far = nan; }},
           {"aspect ratio -1", [](auto &camera) { camera.aspect = -1.0F; }},
           {"position is not finite", [](auto &camera) { camera.world_from_camera[3].y = nan; }},
           {"half size 0x1", [](auto &camera) {
              camera.kind = scene::CameraKind::Orthographic;
              camera.half_width = 0.0F;
            }}}) {
    scene::PlacedCamera camera;
    camera.name = "eye";
    change(camera);
    test::expect_contains(test::error_of([&] { std::ignore = view_of(camera, {64, 64}); }), "camera 'eye': its ");
    test::expect_contains(test::error_of([&] { std::ignore = view_of(camera, {64, 64}); }), part);
  }
}

TEST(CameraView, ACameraThatCannotBeDrawnLeavesTheRendererAsItWas)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F))), glm::dmat4(1));
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 3}, {0, 0, -1}, 10.0F);
  SceneRenderer renderer(*device, scene, {16, 16}, {.sample_count = 1});
  EXPECT_EQ(renderer.budget_report().samples_drawn, 0) << "nothing was drawn yet";
  const scene::PlacedCamera camera = test::camera_at({0, -2, 3}, {0, 0, 0});
  for (const double position : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    scene::PlacedCamera lost = camera;
    lost.world_from_camera[3].x = position;
    test::expect_contains(test::error_of([&] { renderer.draw_within(0.033, lost); }), "position is not finite");
    EXPECT_NO_THROW(while (!renderer.draw_within(0.033, camera)){});
    test::expect_contains(test::error_of([&] { renderer.draw_sample(lost); }), "position is not finite");
    EXPECT_TRUE(renderer.draw_sample(camera));
  }
}

TEST(SampleOffset, ShiftsThePictureByFractionsOfAPixel)
{
  scene::PlacedCamera camera;
  const glm::ivec2 size{320, 200};
  const draw::View view = view_of(camera, size);
  const draw::View moved = with_sample_offset(view, {0.25F, -0.5F}, size);
  for (const float z : {-0.2F, -3.0F, -1e4F}) {
    const glm::vec3 point{0.1F * z, 0.2F * z, z};
    const glm::vec2 shift_px = 0.5F * glm::vec2(size) * glm::vec2(ndc(moved, point) - ndc(view, point));
    // The sample moves right, so its picture moves left.
    EXPECT_NEAR(shift_px.x, -0.25F, 1e-3F);
    EXPECT_NEAR(shift_px.y, 0.5F, 1e-3F);
  }
}

}  // namespace
}  // namespace gnomon::eevee
