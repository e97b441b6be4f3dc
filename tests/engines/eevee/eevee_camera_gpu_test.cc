// SPDX-License-Identifier: MIT
// Pictures of cameras, on the driver.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "reference_light.hh"

#include <gtest/gtest.h>

namespace gnomon::eevee {
namespace {

using CameraGpuTest = test::GpuDeviceTest;

constexpr glm::ivec2 size_px(64, 48);

/** Number of pixels of \a mirrored that differ from those of \a picture with left and right, or up and down exchanged.
 */
int different_count(const std::vector<glm::vec4> &picture, const std::vector<glm::vec4> &mirrored, bool is_x, bool is_y)
{
  // The filter of the film spreads a pixel that differs over its neighbours.
  constexpr float tolerance = 0.1F;
  int count = 0;
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      const int from_x = is_x ? size_px.x - 1 - x : x;
      const int from_y = is_y ? size_px.y - 1 - y : y;
      const glm::vec4 difference =
          picture[std::size_t(from_y * size_px.x + from_x)] - mirrored[std::size_t(y * size_px.x + x)];
      count += glm::length(difference) > tolerance ? 1 : 0;
    }
  }
  return count;
}

TEST_F(CameraGpuTest, NegativeHalfSizesMirrorThePicture)
{
  scene::Scene scene;
  const auto box = test::add_box_mesh(scene, test::add_material(scene, {0.8F, 0.3F, 0.2F}));
  const auto square = test::add_square_mesh(scene, test::add_material(scene, {0.2F, 0.7F, 0.3F}));
  const auto two_sided = test::add_material(scene, {0.3F, 0.3F, 0.9F});
  scene.edit(two_sided, [](scene::Material &material) { material.is_double_sided = true; });
  const auto sheet = test::add_square_mesh(scene, two_sided);
  const auto glass = test::add_material(scene, {0.9F, 0.9F, 0.1F});
  scene.edit(glass, [](scene::Material &material) {
    material.alpha_mode = scene::AlphaMode::Blend;
    material.alpha = 0.5F;
  });
  const auto place = [](const glm::dvec3 &at, double angle, const glm::dvec3 &scale) {
    return glm::scale(glm::rotate(glm::translate(glm::dmat4(1.0), at), angle, glm::dvec3(0.3, 1.0, 0.1)), scale);
  };
  test::add_object(scene, box, place({-1.1, 0.4, 0}, 0.5, glm::dvec3(0.4)));
  test::add_object(scene, box, place({0.9, -0.6, 0}, 0.9, {0.3, -0.5, 0.4}));
  test::add_object(scene, square, place({0, 0, -1.5}, 0.0, glm::dvec3(3)));
  // From behind.
  test::add_object(scene, sheet, place({0.8, 0.8, 0}, 2.8, glm::dvec3(0.4)));
  test::add_object(scene, square, place({-0.2, 0.9, 0}, 2.8, glm::dvec3(0.3)));
  test::add_object(scene, test::add_square_mesh(scene, glass), place({0.1, -0.3, 0.8}, 0.2, glm::dvec3(0.4)));
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0.3F, -0.5F, -1.0F}, 2.0F);
  test::add_lamp(scene, scene::LampKind::Point, {1, 1, 2}, {0, 0, -1}, 20.0F);
  scene::PlacedCamera camera = test::camera_at({0.1F, 0.2F, 8}, {0, 0, 0}, 0.5F);
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = 2.0F;
  camera.half_height = 1.5F;
  const reference::Tracer tracer(scene);
  test::Renderer renderer(*device, scene, size_px, {});
  // Shadow maps of mirrored views are cropped to other texels.
  test::Renderer unshadowed(*device, scene, size_px, {.shadow = {.kind = scene::ShadowKind::None}});
  const std::vector<glm::vec4> picture = unshadowed.picture(camera).pixels;
  EXPECT_GT(different_count(picture, picture, true, false), 1000) << "the scene is not its own mirror image";
  for (const glm::vec2 sign : {glm::vec2(-1, 1), glm::vec2(1, -1), glm::vec2(-1, -1)}) {
    scene::PlacedCamera mirror = camera;
    mirror.half_width *= sign.x;
    mirror.half_height *= sign.y;
    const std::vector<glm::vec4> mirrored = unshadowed.picture(mirror).pixels;
    const std::vector<glm::vec4> shadowed = renderer.picture(mirror).pixels;
    const std::vector<glm::vec4> reference = reference::direct_light(tracer, mirror, size_px, {}).pixels;
    // Edges through the middle of a pixel belong to another pixel.
    constexpr int edge_max = size_px.x * size_px.y / 100;
    EXPECT_LE(different_count(picture, mirrored, sign.x < 0, sign.y < 0), edge_max) << sign.x << ' ' << sign.y;
    // The reference takes other samples of edges.
    EXPECT_LE(different_count(reference, shadowed, false, false), 15 * edge_max) << sign.x << ' ' << sign.y;
  }
}

}  // namespace
}  // namespace gnomon::eevee
