// SPDX-License-Identifier: MIT
// Texel density over the picture, compared with the geometry of lamp, plane and camera.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>

#include <cmath>

namespace gnomon::eevee {
namespace {

using test::Renderer;

class TexelDensityGpuTest : public test::SharedDeviceTest {
 protected:
  static constexpr int edge_px = 48;
  static constexpr int map_px = 64;
  /** A face and a map have 3 texels beyond their angle on each side. */
  static constexpr double inner_px = map_px - 6.0;

  TexelDensityGpuTest()
  {
    settings.has_surfaces = true;
    settings.shadow.cube_size_px = settings.shadow.map_size_px = settings.shadow.esm.size_px = map_px;
  }
  /** A square that faces +Z. */
  void add_square(const glm::vec3 &center, float half)
  {
    test::add_object(scene, square, glm::scale(glm::translate(glm::mat4(1.0F), center), glm::vec3(half, half, 1.0F)));
  }
  std::vector<float> density(const scene::PlacedCamera &camera)
  {
    Renderer renderer(*device, scene, glm::ivec2(edge_px), settings);
    renderer.draw(camera);
    const draw::View view = view_of(camera, glm::ivec2(edge_px), renderer.render_scene.origin_ws());
    return renderer.inspect().texel_density(view, 0).value();
  }
  /** Where the ray through the centre of a pixel meets the plane z = 0, and its distance along the view axis. */
  struct Place {
    glm::dvec3 position;
    double depth = 0.0;
  };
  static Place place_of(const scene::PlacedCamera &camera, int x, int y)
  {
    const glm::dvec2 across = (glm::dvec2(x, y) + 0.5) / (0.5 * edge_px) - 1.0;
    const double tangent = std::tan(0.5 * double(camera.vertical_angle));
    const glm::dvec3 direction = glm::dmat3(camera.world_from_camera) * glm::dvec3(tangent * across, -1.0);
    const glm::dvec3 eye(camera.world_from_camera[3]);
    const double depth = -eye.z / direction.z;
    return {eye + depth * direction, depth};
  }
  /** Expects wanted(place) at each pixel but those of which \a is_near_edge is true. */
  template <typename Wanted, typename IsNearEdge>
  void expect_density(const scene::PlacedCamera &camera, const Wanted &wanted, const IsNearEdge &is_near_edge)
  {
    const std::vector<float> values = density(camera);
    ASSERT_EQ(values.size(), std::size_t(edge_px * edge_px));
    int compared = 0;
    for (int y = 0; y < edge_px; y++) {
      for (int x = 0; x < edge_px; x++) {
        const Place place = place_of(camera, x, y);
        if (!is_near_edge(place.position)) {
          const double value = wanted(place);
          // The position of the surface and the texel's edge are floats.
          EXPECT_NEAR(values[std::size_t(y * edge_px + x)], value, 1e-5 * value) << x << ", " << y;
          compared++;
        }
      }
    }
    EXPECT_GT(compared, edge_px * edge_px / 2);
  }
  /** Whether the line from the eye to \a position passes near the middle of the square of half size 0.1 at z = 3. */
  static bool is_behind_caster(const scene::PlacedCamera &camera, const glm::dvec3 &position)
  {
    const glm::dvec3 eye(camera.world_from_camera[3]);
    const glm::dvec3 at = glm::mix(position, eye, 3.0 / eye.z);
    return std::max(std::abs(at.x), std::abs(at.y)) < 0.11;
  }
  static double pixel_at(const scene::PlacedCamera &camera, double depth)
  {
    return 2.0 * depth * std::tan(0.5 * double(camera.vertical_angle)) / edge_px;
  }

  scene::Scene scene;
  Settings settings;
  scene::Handle<scene::Mesh> square = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.8F)));
};

TEST_F(TexelDensityGpuTest, OfASpotStraightAboveAPlaneItIsTheConesWidthInTexelsAndTheFramesInPixels)
{
  add_square({0, 0, 0}, 20.0F);
  add_square({0, 0, 3}, 0.1F);
  constexpr float angle = 0.5F;
  scene.edit(test::add_lamp(scene, scene::LampKind::Spot, {0, 0, 4}, {0, 0, -1}, 20.0F),
             [](scene::Lamp &lamp) { lamp.spot_outer_angle = angle; });
  const scene::PlacedCamera camera = test::camera_at({1, -6, 5}, {0, 0, 0});
  const double radius = 4.0 * std::tan(angle);
  const double texel = 2.0 * radius / inner_px;
  expect_density(
      camera,
      [&](const Place &place) {
        return glm::length(glm::dvec2(place.position)) < radius ? pixel_at(camera, place.depth) / texel : 0.0;
      },
      [&](const glm::dvec3 &position) {
        // The edge of the cone, and the caster in front of the plane.
        return std::abs(glm::length(glm::dvec2(position)) - radius) < 0.01 || is_behind_caster(camera, position);
      });
}

TEST_F(TexelDensityGpuTest, OfACubeItFollowsTheDistanceAlongTheFacesAxis)
{
  add_square({0, 0, 0}, 40.0F);
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 20.0F);
  const scene::PlacedCamera camera = test::camera_at({0, -3, 12}, {0, 0, 0}, 1.2F);
  expect_density(
      camera,
      [&](const Place &place) {
        const glm::dvec3 from_lamp = glm::abs(place.position - glm::dvec3(0, 0, 4));
        const double distance = std::max({from_lamp.x, from_lamp.y, from_lamp.z});
        return pixel_at(camera, place.depth) / (2.0 * distance / inner_px);
      },
      [](const glm::dvec3 & /*position*/) { return false; });
}

TEST_F(TexelDensityGpuTest, OfAnOctahedralLayerItFollowsTheSolidAngleOfItsTexels)
{
  add_square({0, 0, 0}, 40.0F);
  settings.shadow.kind = scene::ShadowKind::Esm;
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 20.0F);
  const scene::PlacedCamera camera = test::camera_at({0, -3, 12}, {0, 0, 0}, 1.2F);
  expect_density(
      camera,
      [&](const Place &place) {
        // The octahedron |x| + |y| + |z| = 1 has the projected area 1 / (|x| + |y| + |z|)³ in each direction, and is
        // mapped to 2x2.
        const glm::dvec3 from_lamp = place.position - glm::dvec3(0, 0, 4);
        const glm::dvec3 direction = glm::abs(glm::normalize(from_lamp));
        const double angle = 2.0 / map_px * std::pow(direction.x + direction.y + direction.z, 1.5);
        return pixel_at(camera, place.depth) / (angle * glm::length(from_lamp));
      },
      [](const glm::dvec3 & /*position*/) { return false; });
}

TEST_F(TexelDensityGpuTest, OfASunItIsThatOfTheTexelsThatACasterCovers)
{
  add_square({0, 0, 0}, 20.0F);
  add_square({0, 0, 2}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0, 0, -1}, 20.0F);
  settings.shadow.cascades.count = 1;
  scene::PlacedCamera camera = test::camera_at({0, 0, 5}, {0, 0, 0});
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = camera.half_height = 3.0F;
  Renderer renderer(*device, scene, glm::ivec2(edge_px), settings);
  renderer.draw(camera);
  const gpu::Texture &map = renderer.inspect().shadow_picture(0);
  const std::vector<glm::vec4> texels = gpu::read_as<glm::vec4>(*device, map);
  float nearest = 1e30F;
  for (const glm::vec4 &texel : texels) {
    nearest = texel.a > 0.0F ? std::min(nearest, texel.a) : nearest;
  }
  const auto covered =
      std::ranges::count_if(texels, [&](const glm::vec4 &texel) { return texel.a > 0.0F && texel.a < nearest + 1.0F; });
  const double texel = std::sqrt(4.0 / double(covered));
  const double pixel = 6.0 / edge_px;
  const draw::View view = view_of(camera, glm::ivec2(edge_px), renderer.render_scene.origin_ws());
  const std::vector<float> values = renderer.inspect().texel_density(view, 0).value();
  // The caster's edges may cut the texels around it, half of one on each side.
  const double tolerance = texel / 2.0;
  EXPECT_NEAR(values[edge_px / 2 * edge_px + edge_px / 2], pixel / texel, tolerance * pixel / texel);
  EXPECT_EQ(values[0], 0.0F) << "the map reaches the caster's shadow, not the corner";
}

TEST_F(TexelDensityGpuTest, ThereIsNoneWithoutAShadowOrLight)
{
  const auto add_plain = [&](bool is_unlit, float x, float z, bool receives) {
    const auto material = test::add_material(scene, glm::vec3(0.8F));
    scene.edit(material, [&](scene::Material &one) { one.is_unlit = is_unlit; });
    const auto node =
        test::add_object(scene, test::add_square_mesh(scene, material), glm::translate(glm::mat4(1.0F), {x, 0, z}));
    scene.edit(node, [&](scene::Node &one) { one.receives_shadow = receives; });
  };
  add_plain(false, -6.0F, 0.0F, true);
  add_plain(true, -3.0F, 0.0F, true);
  add_plain(false, 0.0F, 0.0F, false);
  add_plain(false, 3.0F, 5.0F, true);  // Above the lamp: its visible side faces away.
  add_plain(false, 6.0F, 0.0F, true);
  scene.edit(test::add_lamp(scene, scene::LampKind::Point, {-4, 0, 4}, {0, 0, -1}, 20.0F),
             [](scene::Lamp &lamp) { lamp.range = 10.0F; });
  scene.edit(test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 20.0F),
             [](scene::Lamp &lamp) { lamp.shadow.kind = scene::ShadowKind::None; });
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 0.0F);
  scene::PlacedCamera camera = test::camera_at({0, 0, 20}, {0, 0, 0});
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = camera.half_height = 8.0F;
  Renderer renderer(*device, scene, glm::ivec2(edge_px), settings);
  renderer.draw(camera);
  const draw::View view = view_of(camera, glm::ivec2(edge_px), renderer.render_scene.origin_ws());
  const std::vector<float> values = renderer.inspect().texel_density(view, 0).value();
  const auto at = [&](float x) {
    return values[std::size_t(edge_px / 2 * edge_px + int((x + 8.0F) / 16.0F * edge_px))];
  };
  EXPECT_GT(at(-6.0F), 0.0F);
  EXPECT_EQ(at(-3.0F), 0.0F) << "unlit";
  EXPECT_EQ(at(0.0F), 0.0F) << "receives no shadow";
  EXPECT_EQ(at(3.0F), 0.0F) << "faces away";
  EXPECT_EQ(at(5.9F), 0.0F) << "out of range";
  EXPECT_EQ(at(-7.5F), 0.0F) << "no surface";
  EXPECT_FALSE(renderer.inspect().texel_density(view, 1)) << "no shadow";
  EXPECT_FALSE(renderer.inspect().texel_density(view, 2)) << "no light";
}

TEST_F(TexelDensityGpuTest, APictureStaysBitForBitTheSame)
{
  add_square({0, 0, 0}, 20.0F);
  add_square({0, 0, 2}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 20.0F);
  settings.sample_count = 4;
  settings.has_surfaces = false;
  const scene::PlacedCamera camera = test::camera_at({3, -6, 5}, {0, 0, 0});
  const test::Picture plain = Renderer(*device, scene, glm::ivec2(edge_px), settings).picture(camera);
  settings.has_surfaces = true;
  SceneRenderer renderer(*device, scene, glm::ivec2(edge_px), settings);
  renderer.sync();
  bool is_complete = false;
  while (!is_complete) {
    is_complete = renderer.draw_sample(camera);
    EXPECT_TRUE(renderer.inspect().texel_density(renderer.view_of(camera), 0));
  }
  EXPECT_EQ(renderer.read_picture(), plain.pixels);
}

}  // namespace
}  // namespace gnomon::eevee
