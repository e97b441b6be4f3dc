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
#include <numbers>
#include <random>
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
           {"shift of 0 and nan", [](auto &camera) { camera.shift_y = nan; }},
           {"aperture of radius -1", [](auto &camera) { camera.aperture_radius = -1.0F; }},
           {"aperture of radius inf", [](auto &camera) { camera.aperture_radius = infinite; }},
           {"with a focus at -1", [](auto &camera) { camera.focus_distance = -1.0F; }},
           {"with a focus at 1e-12",
            [](auto &camera) {
              camera.aperture_radius = 1e20F;
              camera.focus_distance = 1e-12F;
            }},
           {"ratio 0", [](auto &camera) { camera.aperture_ratio = 0.0F; }},
           {"2 blades", [](auto &camera) { camera.aperture_blades = 2; }},
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

TEST(CameraView, ShiftMovesTheFrameByItsSizes)
{
  for (const scene::CameraKind kind : {scene::CameraKind::Perspective, scene::CameraKind::Orthographic}) {
    for (const glm::ivec2 size : {glm::ivec2(200, 100), glm::ivec2(100, 400)}) {
      scene::PlacedCamera camera;
      camera.kind = kind;
      camera.aspect = 2.0F;
      camera.half_width = 2.0F;
      const draw::View middle = view_of(camera, size);
      camera.shift_x = 0.25F;
      camera.shift_y = -0.5F;
      const draw::View shifted = view_of(camera, size);
      // The frame's right edge is 1.25 - 0.5 = 0.75 widths from the middle, its lower edge a height.
      const float half_height = kind == scene::CameraKind::Perspective ? std::tan(0.5F * camera.vertical_angle) : 1.0F;
      const glm::vec3 edge = ndc(middle, {2.0F * half_height, -half_height, -1.0F});
      const glm::vec3 shifted_edge = ndc(shifted, {3.0F * half_height, -2.0F * half_height, -1.0F});
      EXPECT_NEAR(shifted_edge.x, edge.x, 1e-5F);
      EXPECT_NEAR(shifted_edge.y, edge.y, 1e-5F);
      EXPECT_NEAR(shifted_edge.z, edge.z, 1e-6F);
    }
  }
}

/** Mean, and mean of the products, of points that cover an aperture evenly. */
struct Moments {
  glm::dvec2 mean{0.0};
  glm::dvec2 squares{0.0};
  double product = 0.0;
  double radius_max = 0.0;
};

Moments lens_moments(const draw::Lens &lens)
{
  Moments moments;
  // A whole number of columns in each triangle of a polygon.
  const int columns = 512 * std::max(lens.blades, 1);
  constexpr int rows = 128;
  const double share = 1.0 / (double(columns) * rows);
  for (int i = 0; i < columns * rows; i++) {
    const glm::vec2 place = (glm::vec2(i % columns, i / columns) + 0.5F) / glm::vec2(columns, rows);
    const glm::dvec2 point(lens_point(lens, place));
    moments.mean += share * point;
    moments.squares += share * point * point;
    moments.product += share * point.x * point.y;
    moments.radius_max = std::max(moments.radius_max, glm::length(point));
  }
  return moments;
}

TEST(LensPoint, CoversTheApertureEvenly)
{
  // The mean of x² over a disk of radius r is r²/4, and over a regular polygon of n corners on it
  // r² (2 + cos(2π/n)) / 12; both have the mean 0 of x, and of xy.
  for (const int blades : {0, 3, 4, 5, 6, 9}) {
    for (const float ratio : {1.0F, 2.0F, 0.5F}) {
      const Moments moments = lens_moments({.radius = 0.3F, .blades = blades, .rotation = 0.4F, .ratio = ratio});
      const double square =
          0.09 * (blades == 0 ? 0.25 : (2.0 + std::cos(2.0 * std::numbers::pi / double(blades))) / 12.0);
      EXPECT_NEAR(moments.mean.x, 0.0, 1e-4) << blades;
      EXPECT_NEAR(moments.mean.y, 0.0, 1e-4) << blades;
      EXPECT_NEAR(moments.squares.x * double(ratio * ratio), square, 2e-3 * square) << blades;
      EXPECT_NEAR(moments.squares.y, square, 2e-3 * square) << blades;
      EXPECT_NEAR(moments.product, 0.0, 1e-3 * square) << blades;
      EXPECT_LE(moments.radius_max, 0.3 * std::max(1.0, 1.0 / double(ratio)) * 1.000001);
    }
  }
  // A square whose edge is in the middle of +X at the rotation 0.
  const float half = 0.3F * std::sqrt(0.5F);
  for (const glm::vec2 place : {glm::vec2(0.1F, 0.2F), glm::vec2(0.4F, 0.9F), glm::vec2(0.95F, 0.5F)}) {
    const glm::vec2 point = glm::abs(lens_point({.radius = 0.3F, .blades = 4}, place));
    EXPECT_LE(std::max(point.x, point.y), half * 1.00001F);
  }
}

/** A camera with a lens of 5 cm that is focused at 4 m. */
scene::PlacedCamera camera_with_lens()
{
  scene::PlacedCamera camera;
  camera.aperture_radius = 0.05F;
  camera.focus_distance = 4.0F;
  camera.shift_x = 0.1F;
  camera.world_from_camera = glm::translate(glm::dmat4(1.0), glm::dvec3(1, 2, 3));
  return camera;
}

TEST(LensView, KeepsThePlaneInFocusAndBlursByTheCircleOfConfusion)
{
  const draw::View view = view_of(camera_with_lens(), {200, 100});
  const float scale = view.clip_from_view()[1][1];
  glm::vec2 low(1.0F);
  glm::vec2 high(-1.0F);
  for (int index = 0; index < 64; index++) {
    const draw::View moved = view_through_lens(view, index, 64, 7);
    EXPECT_EQ(moved.lens(), draw::Lens());
    const glm::vec3 sharp = glm::vec3(1.5F, 2.25F, 3.0F - 4.0F);
    EXPECT_NEAR(ndc(moved, sharp).x, ndc(view, sharp).x, 1e-6F);
    EXPECT_NEAR(ndc(moved, sharp).y, ndc(view, sharp).y, 1e-6F);
    EXPECT_NEAR(ndc(moved, sharp).z, ndc(view, sharp).z, 1e-7F);
    const glm::vec3 blurred = glm::vec3(1.5F, 2.25F, 3.0F - 8.0F);
    const glm::vec2 shift = glm::vec2(ndc(moved, blurred) - ndc(view, blurred));
    low = glm::min(low, shift);
    high = glm::max(high, shift);
    // The circle of confusion of a point at the distance d has the radius r |1/d - 1/focus|.
    EXPECT_LE(std::abs(shift.y), 1.0001F * scale * 0.05F * (0.25F - 0.125F));
  }
  EXPECT_GT(high.y - low.y, 1.8F * scale * 0.05F * (0.25F - 0.125F));
  EXPECT_EQ(view_through_lens(view, 0, 1, 7).clip_from_world(), view.clip_from_world()) << "one sample: a pinhole";
}

TEST(LensView, IsWithinTheViewAroundTheLens)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  for (const float far : {0.0F, 50.0F}) {
    for (const float focus : {0.2F, 4.0F, 0.0F}) {
      scene::PlacedCamera camera = camera_with_lens();
      camera.far = far;
      camera.focus_distance = focus;
      camera.aperture_ratio = 0.5F;
      const draw::View view = view_of(camera, {200, 100});
      const draw::View around = view_around_lens(view);
      for (int index = 0; index < 100; index++) {
        const draw::View moved = view_through_lens(view, index, 100, 1);
        const glm::vec3 clip(unit(random), unit(random), 0.5F * (unit(random) + 1.0F) + 1e-4F);
        const glm::vec4 point = glm::inverse(glm::dmat4(moved.clip_from_world())) * glm::dvec4(clip, 1.0);
        EXPECT_TRUE(around.touches({glm::vec3(point) / point.w, 1e-4F})) << far << " " << focus << " " << index;
      }
    }
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
