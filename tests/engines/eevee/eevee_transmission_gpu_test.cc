// SPDX-License-Identifier: MIT
// Light that passes surfaces, compared with closed forms, on the driver.
#include "eevee_bodies_shared.h"
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include "render_world.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;

constexpr glm::ivec2 square_size_px(24, 24);

/** An unlit square behind a plate that transmits light, both across the view. */
class TransmissionGpuTest : public test::SharedDeviceTest {
 protected:
  TransmissionGpuTest()
  {
    const auto unlit = test::add_material(scene, glm::vec3(1.0F));
    scene.edit(unlit, [](scene::Material &value) { value.is_unlit = true; });
    ground = test::add_square_mesh(scene, unlit);
    test::add_object(scene, ground, glm::scale(glm::dmat4(1), glm::dvec3(half_size)));
    glass = test::add_material(scene, glm::vec3(1.0F));
    edit([](scene::Material &value) {
      value.roughness = 0.0F;
      value.transmission = 1.0F;
      value.ior = 1.0F;
    });
  }
  /** Radiance of the ground at its corners, in the order of add_square_mesh. It is linear if opposite sums are equal.
   */
  void set_ground(const std::array<glm::vec3, 4> &corners)
  {
    scene.edit(ground, [&](scene::Mesh &mesh) {
      mesh.colors.clear();
      for (const glm::vec3 &corner : corners) {
        mesh.colors.emplace_back(corner, 1.0F);
      }
    });
  }
  void add_plate(const glm::dmat4 &world_from_plate)
  {
    test::add_object(scene, test::add_square_mesh(scene, glass), world_from_plate);
  }
  static glm::dmat4 at_height(double z, const glm::dvec3 &scale = glm::dvec3(2))
  {
    return glm::scale(glm::translate(glm::dmat4(1), glm::dvec3(0, 0, z)), scale);
  }
  template <typename Change>
  void edit(Change &&change)
  {
    scene.edit(glass, change);
  }
  Picture render(const Settings &settings = {})
  {
    Renderer renderer(*device, scene, square_size_px, settings);
    Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture;
  }

  static constexpr double half_size = 4.0;
  scene::Scene scene;
  scene::Handle<scene::Mesh> ground;
  scene::Handle<scene::Material> glass;
  scene::PlacedCamera camera = test::camera_at({0, 0, 5}, {0, 0, 0}, 0.6F);
};

const std::array<glm::vec3, 4> gradient = {{{0, 0, 0.5F}, {1, 0, 0.5F}, {1, 1, 0.5F}, {0, 1, 0.5F}}};

double largest_difference(const Picture &a, const Picture &b)
{
  double largest = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); i++) {
    largest = std::max(largest, double(glm::distance(a.pixels[i], b.pixels[i])));
  }
  return largest;
}

TEST_F(TransmissionGpuTest, AThinWallThatReflectsAndAbsorbsNothingIsNotSeen)
{
  // A checkerboard with edges at all places in pixels.
  const auto checks = test::add_texture(
      scene, 3, {255, 0, 0, 255, 9, 99, 255, 255, 0, 255, 0, 255, 7, 7, 7, 255, 200, 0, 90, 255, 255, 255, 255, 255});
  scene.edit(scene.meshes()[ground].material,
             [&](scene::Material &value) { value.base_color_texture.texture = checks; });
  scene.edit(ground, [](scene::Mesh &mesh) { mesh.uvs = {{0, 4}, {4, 4}, {4, 0}, {0, 0}}; });
  for (const int sample_count : {1, 3}) {
    test::remove_objects(scene);
    test::add_object(scene, ground, glm::scale(glm::dmat4(1), glm::dvec3(half_size)));
    const Picture bare = render({.sample_count = sample_count});
    add_plate(at_height(1.0));
    EXPECT_LE(largest_difference(render({.sample_count = sample_count}), bare), 1e-6);
    // With a lamp, and with an index that a thin wall does not refract by.
    edit([](scene::Material &value) { value.ior = 1.5F; });
    test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0.3F, 0, -1}, 3.0F);
  }
}

TEST_F(TransmissionGpuTest, AbsorptionIsBeerLambertsOverTheWayInTheScaledObject)
{
  const glm::vec3 radiance(1.0F, 0.5F, 0.25F);
  set_ground({{radiance, radiance, radiance, radiance}});
  // Along the plate's normal, its third axis is the scale of the way. The ground is farther than that.
  add_plate(at_height(3.5, {2, 2, 3}));
  for (const float roughness : {0.0F, 0.5F}) {
    for (const float thickness : {0.0F, 0.2F, 1.0F}) {
      edit([&](scene::Material &value) {
        value.roughness = roughness;
        value.thickness = thickness;
        value.ior = 1.5F;
        value.attenuation_distance = 0.5F;
        value.attenuation_color = {0.25F, 0.5F, 1.0F};
        value.base_color = {1.0F, 0.5F, 0.75F};
      });
      const float way_m = 3.0F * thickness;
      const glm::vec3 left(std::pow(0.25F, 2.0F * way_m), std::pow(0.5F, 2.0F * way_m), 1.0F);
      const glm::vec3 expected = radiance * glm::vec3(1.0F, 0.5F, 0.75F) * left;
      // At the middle pixel, the way is 1.0006 times that along the axis.
      test::expect_near(glm::vec3(render().middle()), expected, 2e-3F * expected.b);
    }
  }
  // A way ends at an opaque surface.
  edit([](scene::Material &value) { value.thickness = 1e6F; });
  const glm::vec3 left(std::pow(0.25F, 7.0F), std::pow(0.5F, 7.0F), 1.0F);
  test::expect_near(glm::vec3(render().middle()), radiance * glm::vec3(1.0F, 0.5F, 0.75F) * left, 2e-3F);
}

TEST_F(TransmissionGpuTest, AThickPlateShowsWhatIsBehindTheEndOfTheRefractedRay)
{
  set_ground(gradient);
  constexpr double thickness = 0.625;
  constexpr double ior = 1.375;
  add_plate(at_height(1.0, glm::dvec3(1.0)));
  edit([&](scene::Material &value) {
    value.thickness = thickness;
    value.ior = ior;
  });
  camera = test::camera_at({0.5F, -2.0F, 5}, {0, 0, 1}, 0.3F);
  const Picture picture = render();
  const glm::dmat4 world_from_camera = camera.world_from_camera;
  const glm::dvec3 eye(world_from_camera[3]);
  const auto ray_through = [&](const glm::dvec2 &pixel) {
    const glm::dvec2 ndc = (2.0 * pixel + 1.0) / double(square_size_px.x) - 1.0;
    const double reach = std::tan(0.5 * 0.3);
    return glm::normalize(glm::dvec3(world_from_camera * glm::dvec4(reach * ndc, -1.0, 0.0)));
  };
  const auto ground_at = [&](const glm::dvec2 &pixel) {
    const glm::dvec3 ray = ray_through(pixel);
    return eye + ray * (-eye.z / ray.z);
  };
  for (const glm::dvec2 pixel : {glm::dvec2(4, 4), glm::dvec2(12, 12), glm::dvec2(19, 6)}) {
    const glm::dvec3 ray = ray_through(pixel);
    const glm::dvec3 hit = eye + ray * ((1.0 - eye.z) / ray.z);
    // Snell's law for the normal (0, 0, 1).
    glm::dvec3 inside(ray.x / ior, ray.y / ior, 0.0);
    inside.z = -std::sqrt(1.0 - inside.x * inside.x - inside.y * inside.y);
    const glm::dvec3 exit = hit + thickness * inside;
    const glm::dvec3 behind = eye + (exit - eye) * (-eye.z / (exit.z - eye.z));
    const glm::vec3 expected(glm::dvec3(0.5 + 0.5 * behind.x / half_size, 0.5 + 0.5 * behind.y / half_size, 0.5));
    const glm::dvec3 straight = ground_at(pixel);
    // The lookup is linear between pixels, which a projection is not. The ground's corners are moved to the device's
    // grid, and its colours with them.
    const double change_of_pixel = glm::distance(ground_at(pixel + glm::dvec2(1, 0)), straight) +
                                   glm::distance(ground_at(pixel + glm::dvec2(0, 1)), straight);
    const double moved = test::vertex_shift_max_px(*device) * change_of_pixel * 0.5 / half_size;
    test::expect_near(glm::vec3(picture.at(int(pixel.x), int(pixel.y))), expected, float(6e-5 + moved));
    EXPECT_GT(glm::distance(behind, straight), 0.08) << "the test tells refraction from a thin wall";
  }
}

TEST_F(TransmissionGpuTest, ARoughWallShowsTheMeanOfWhatIsBehind)
{
  set_ground(gradient);
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = camera.half_height = 1.0F;
  camera.far = 20.0F;
  add_plate(at_height(1.0));
  const auto pixel_with = [&](float roughness) {
    edit([&](scene::Material &value) {
      value.roughness = roughness;
      value.ior = 1.5F;
    });
    return glm::vec3(render().at(1, 22));
  };
  // The picture is symmetrical about its middle, where the ground has its mean.
  const glm::vec3 smooth = pixel_with(0.0F);
  const glm::vec3 half = pixel_with(0.8F);
  test::expect_near(pixel_with(1.0F), glm::vec3(0.5F), 1e-4F);
  EXPECT_GT(half.x, smooth.x + 0.01F);
  EXPECT_LT(half.x, 0.5F);
}

TEST_F(TransmissionGpuTest, ASurfaceFunctionsRoughnessBlursAsTheMaterialsDoes)
{
  const auto checks = test::add_texture(scene, 2, {255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255, 255});
  scene.edit(scene.meshes()[ground].material,
             [&](scene::Material &value) { value.base_color_texture.texture = checks; });
  scene.edit(ground, [](scene::Mesh &mesh) { mesh.uvs = {{0, 4}, {4, 4}, {4, 0}, {0, 0}}; });
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = camera.half_height = 1.0F;
  camera.far = 20.0F;
  // Edges of the plate cross quads of pixels, so that some invocations are outside of its triangles.
  add_plate(glm::rotate(at_height(1.0, glm::dvec3(0.83)), 0.3, glm::dvec3(0, 0, 1)));
  const auto picture_with = [&](float roughness, const std::string &body) {
    const auto function = scene.add(scene::SurfaceFunction{
        .name = "test",
        .text = "void surface(SurfaceInputs inputs, inout StandardSurface result)\n{\n" + body + "\n}\n",
        .path = "test.glsl"});
    edit([&](scene::Material &value) {
      value.roughness = roughness;
      value.ior = 1.5F;
      value.surface_function = body.empty() ? scene::Handle<scene::SurfaceFunction>() : function;
    });
    return render();
  };
  const Picture rough = picture_with(0.7F, "");
  EXPECT_GT(largest_difference(rough, picture_with(0.0F, "")), 0.05);
  // Rounding of the function's programs, which are compiled apart.
  EXPECT_LE(largest_difference(rough, picture_with(0.0F, "result.roughness = 0.7;")), 1e-5);
  // Read from the material's storage block, which has zeros in invocations outside of triangles.
  EXPECT_LE(largest_difference(rough, picture_with(0.7F, "result.base_color *= 1.0;")), 1e-5);
}

/** The direction behind a sphere of radius 1 around the origin, by Snell's law; with the ray's own for an index of 1.
 */
glm::dvec3 behind_sphere(const glm::dvec3 &eye, const glm::dvec3 &ray, double ior)
{
  const double along = -glm::dot(eye, ray);
  const double half_chord = std::sqrt(1.0 - glm::dot(eye, eye) + along * along);
  const glm::dvec3 entry = eye + (along - half_chord) * ray;
  const glm::dvec3 inside = glm::refract(ray, entry, 1.0 / ior);
  const glm::dvec3 exit = entry - 2.0 * glm::dot(entry, inside) * inside;
  return glm::refract(inside, -exit, ior);
}

TEST_F(TransmissionGpuTest, ASphereRefractsAtBothOfItsSurfaces)
{
  // The radiance of the world is its direction.
  scene::WorldPicture picture{256, 128, {}};
  for (int y = 0; y < picture.height; y++) {
    for (int x = 0; x < picture.width; x++) {
      const glm::dvec3 v = render_scene::direction_of((x + 0.5) / picture.width, 1.0 - (y + 0.5) / picture.height);
      picture.texels.emplace_back(0.5 + 0.5 * v);
    }
  }
  scene.set_world(scene::World{.picture = std::make_shared<const scene::WorldPicture>(std::move(picture))});
  test::remove_objects(scene);
  const auto sphere = test::add_sphere_mesh(scene, glass);
  const std::size_t texel_count = scene.meshes()[sphere].indices.size() / 3 * (BODY_TRIANGLE_TEXELS + BODY_NODE_TEXELS);
  if (std::size_t(device->limits().buffer_texels_max) < texel_count) {
    GTEST_SKIP() << "the triangles do not fit into a texel buffer of " << device->limits().buffer_texels_max;
  }
  test::add_object(scene, sphere, glm::dmat4(1));
  Settings settings;
  settings.background.kind = Background::Kind::World;
  camera = test::camera_at({1, -2, 5}, {0, 0, 0}, 0.42F);
  const glm::dmat4 world_from_camera = camera.world_from_camera;
  const glm::dvec3 eye(world_from_camera[3]);
  for (const float ior : {1.1F, 1.5F, 2.4F}) {
    edit([&](scene::Material &value) {
      value.ior = ior;
      value.thickness = 1.0F;
    });
    const Picture rendered = render(settings);
    for (const glm::ivec2 pixel : {glm::ivec2(12, 12), glm::ivec2(8, 14), glm::ivec2(16, 6), glm::ivec2(4, 12)}) {
      SCOPED_TRACE(::testing::Message() << "ior " << ior << ", pixel " << pixel.x << " " << pixel.y);
      const glm::dvec2 ndc = (2.0 * glm::dvec2(pixel) + 1.0) / double(square_size_px.x) - 1.0;
      const glm::dvec3 ray =
          glm::normalize(glm::dvec3(world_from_camera * glm::dvec4(std::tan(0.21) * ndc, -1.0, 0.0)));
      const glm::dvec3 expected = behind_sphere(eye, ray, double(ior));
      // Chords of the sphere's facets are up to 6e-4 below it.
      test::expect_near(glm::vec3(rendered.at(pixel.x, pixel.y)), glm::vec3(0.5 + 0.5 * expected), 3e-3F);
    }
  }
}

TEST_F(TransmissionGpuTest, ABodyIsSeenThroughAnotherAndWhatIsBehindTheGroundIsNot)
{
  set_ground({{glm::vec3(0.5F), glm::vec3(0.5F), glm::vec3(0.5F), glm::vec3(0.5F)}});
  const glm::vec3 tint(0.8F, 0.6F, 0.4F);
  const auto pane = test::add_material(scene, tint);
  scene.edit(pane, [](scene::Material &value) {
    value.transmission = 1.0F;
    value.roughness = 0.0F;
    value.ior = 1.0F;
  });
  const auto pane_mesh = test::add_square_mesh(scene, pane);
  add_plate(at_height(2.0));
  test::add_object(scene, pane_mesh, at_height(1.0));
  test::add_object(scene, pane_mesh, at_height(-1.0));
  for (const int sample_count : {1, 4}) {
    test::expect_near(glm::vec3(render({.sample_count = sample_count}).middle()), 0.5F * tint, 1e-5F);
  }
  // A box has two surfaces, and absorbs over the way between them, which is 1 m.
  test::remove_objects(scene);
  test::add_object(scene, ground, glm::scale(glm::dmat4(1), glm::dvec3(half_size)));
  add_plate(at_height(2.0));
  test::add_object(scene, test::add_box_mesh(scene, pane), at_height(1.0, {2, 2, 0.5}));
  scene.edit(pane, [](scene::Material &value) {
    value.ior = 1.5F;
    value.thickness = 0.1F;
    value.attenuation_distance = 1.0F;
    value.attenuation_color = {0.5F, 0.25F, 1.0F};
  });
  test::expect_near(glm::vec3(render().middle()), 0.5F * tint * tint * glm::vec3(0.5F, 0.25F, 1.0F), 1e-3F);
}

/** A sphere of glass before another one and a ground of several colours. */
class TwoBodiesGpuTest : public TransmissionGpuTest {
 protected:
  TwoBodiesGpuTest()
  {
    set_ground({{glm::vec3(0.9F, 0, 0), glm::vec3(0, 0.9F, 0), glm::vec3(0, 0, 0.9F), glm::vec3(0.9F)}});
    edit([](scene::Material &value) {
      value.ior = 1.5F;
      value.thickness = 1.0F;
    });
    // Two of them fit into the least texel buffer that Vulkan allows.
    mesh = test::add_sphere_mesh(scene, glass, 48);
    body = test::add_object(scene, mesh, at_height(2.0, glm::dvec3(0.7)));
    behind = test::add_object(scene, mesh, at_height(0.5, glm::dvec3(0.4)));
  }
  scene::Handle<scene::Mesh> mesh;
  scene::Handle<scene::Node> body;
  scene::Handle<scene::Node> behind;
};

TEST_F(TwoBodiesGpuTest, ParallelRaysMeetTheGroundWithAnyClipEnd)
{
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = camera.half_height = 1.5F;
  camera.far = 20.0F;
  const Picture near = render({.sample_count = 4});
  camera.far = 1000.0F;
  // Rounding of the depths.
  EXPECT_LT(largest_difference(render({.sample_count = 4}), near), 1e-3);
}

TEST_F(TwoBodiesGpuTest, EditedBodiesAreTracedAsTheyAre)
{
  Renderer renderer(*device, scene, square_size_px, {});
  Picture last = renderer.picture(camera);
  const auto check = [&](const std::string &edit_name) {
    renderer.sync();
    const Picture live = renderer.picture(camera);
    EXPECT_EQ(live.pixels, render().pixels) << edit_name;
    EXPECT_GT(largest_difference(live, last), 0.01) << edit_name;
    last = live;
  };
  scene.edit(behind, [&](scene::Node &node) { node.parent_from_node = at_height(0.5, glm::dvec3(0.6, 0.3, 0.3)); });
  check("the farther one is scaled");
  scene.edit(mesh, [](scene::Mesh &value) {
    for (glm::vec3 &position : value.positions) {
      position.z *= 0.5F;
    }
  });
  check("vertices");
  edit([](scene::Material &value) { value.ior = 1.2F; });
  check("index");
  scene.edit(behind, [](scene::Node &node) { node.is_visible = false; });
  check("hidden");
  scene.remove(body);
  check("removed");
}

TEST_F(TwoBodiesGpuTest, WhatAViewLeavesOutIsNotTraced)
{
  SceneRenderer renderer(*device, scene, square_size_px, {.sample_count = 1});
  const auto drawn = [&](std::vector<scene::Handle<scene::Node>> hidden, std::vector<glm::dvec4> planes) {
    renderer.set_hidden(std::move(hidden));
    renderer.set_clip_planes(std::move(planes));
    renderer.sync();
    renderer.draw(camera);
    return Picture{square_size_px, renderer.read_picture()};
  };
  // It cuts off the farther body and the ground.
  const std::vector<glm::dvec4> above{{0, 0, 1, -1.2}};
  const Picture whole = drawn({}, {});
  const Picture hidden = drawn({behind}, {});
  const Picture cut = drawn({}, above);
  EXPECT_EQ(drawn({}, {}).pixels, whole.pixels);
  scene.edit(behind, [](scene::Node &node) { node.is_visible = false; });
  EXPECT_EQ(drawn({}, {}).pixels, hidden.pixels);
  EXPECT_EQ(drawn({}, above).pixels, cut.pixels);
  EXPECT_GT(largest_difference(whole, hidden), 0.01);
}

TEST_F(TransmissionGpuTest, ATextureOfTheNearestSurfaceHoldsForItsBody)
{
  set_ground({{glm::vec3(0.5F), glm::vec3(0.5F), glm::vec3(0.5F), glm::vec3(0.5F)}});
  edit([](scene::Material &value) { value.thickness = 1.0F; });
  test::add_object(scene, test::add_box_mesh(scene, glass), at_height(1.0, {2, 2, 0.5}));
  const glm::vec3 clear(render().middle());
  test::expect_near(clear, glm::vec3(0.5F), 1e-4F);
  // Metallic and rough by its factors, as a file without them is, and neither by its texture.
  edit([&](scene::Material &value) {
    value.metallic = value.roughness = 1.0F;
    value.metallic_roughness_texture.texture = test::add_texture(scene, 1, {0, 0, 0, 255});
  });
  test::expect_near(glm::vec3(render().middle()), clear, 1e-4F);
}

TEST_F(TransmissionGpuTest, LightIsReflectedTotallyBeyondTheCriticalAngle)
{
  set_ground({{glm::vec3(0.5F), glm::vec3(0.5F), glm::vec3(0.5F), glm::vec3(0.5F)}});
  // Through the top of a tall box, its sides are met at more than 48° from their normals: arcsin(1 / 1.5) is 42°.
  test::add_object(scene, test::add_box_mesh(scene, glass), at_height(1.5, {0.5, 0.5, 1.5}));
  camera = test::camera_at({1.5F, 0, 6}, {-0.4F, 0, 3}, 0.02F);
  const auto middle_with = [&](float ior) {
    edit([&](scene::Material &value) {
      value.ior = ior;
      value.thickness = 1.0F;
    });
    return glm::vec3(render().middle());
  };
  test::expect_near(middle_with(1.5F), glm::vec3(0.0F), 0.0F);
  test::expect_near(middle_with(1.0F), glm::vec3(0.5F), 1e-5F);
}

TEST_F(TransmissionGpuTest, TransmissionTakesLightFromTheDiffusePartAndReflectionFromBoth)
{
  set_ground({{glm::vec3(0.5F), glm::vec3(0.5F), glm::vec3(0.5F), glm::vec3(0.5F)}});
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0, 0, -1}, std::numbers::pi_v<float>);
  add_plate(at_height(1.0));
  const auto texture = test::add_texture(scene, 1, {102, 0, 0, 0});
  edit([&](scene::Material &value) {
    value.base_color = glm::vec3(0.8F);
    value.transmission = 0.5F;
    value.transmission_texture.texture = texture;
  });
  scene.edit(test::handle_at(scene.meshes(), 1), [](scene::Mesh &mesh) { mesh.uvs.assign(4, glm::vec2(0.5F)); });
  // 0.2 passes; 0.8 is scattered, and the radiance of a white surface is 1.
  test::expect_near(glm::vec3(render().middle()), glm::vec3(0.8F * (0.2F * 0.5F + 0.8F)), 1e-4F);
  // A surface that reflects 4 % transmits 96 %. Its highlight is not in the direction of the camera.
  test::remove_lamps(scene);
  edit([](scene::Material &value) {
    value.specular_color = glm::vec3(1.0F);
    value.transmission_texture = {};
    value.transmission = 1.0F;
  });
  test::expect_near(glm::vec3(render().middle()), glm::vec3(0.8F * 0.96F * 0.5F), 2e-3F);
}

TEST_F(TransmissionGpuTest, WithoutItsFactorTransmissionChangesNoBit)
{
  test::add_lamp(scene, scene::LampKind::Point, {1, 1, 4}, {0, 0, -1}, 20.0F);
  add_plate(at_height(1.0));
  edit([](scene::Material &value) { value.transmission = 0.0F; });
  const Picture plain = render();
  edit([&](scene::Material &value) {
    value.transmission_texture.texture = test::add_texture(scene, 1, {255, 255, 255, 255});
    value.thickness_texture = value.transmission_texture;
    value.thickness = 1.0F;
    value.ior = 2.0F;
    value.attenuation_color = {0.5F, 0.1F, 0.2F};
    value.attenuation_distance = 0.1F;
  });
  EXPECT_EQ(render().pixels, plain.pixels);
  edit([](scene::Material &value) { value.transmission = 0.01F; });
  EXPECT_NE(render().pixels, plain.pixels);
}

TEST_F(TransmissionGpuTest, BlendedSurfacesAreSeenBehindAndInFront)
{
  set_ground({{glm::vec3(0.5F), glm::vec3(0.5F), glm::vec3(0.5F), glm::vec3(0.5F)}});
  const auto add_pane = [&](double z, const glm::vec3 &emissive) {
    const auto material = test::add_material(scene, glm::vec3(0.0F));
    scene.edit(material, [&](scene::Material &value) {
      value.emissive = emissive;
      value.alpha_mode = scene::AlphaMode::Blend;
      value.alpha = 0.5F;
    });
    test::add_object(scene, test::add_square_mesh(scene, material), at_height(z));
  };
  add_pane(2.0, {0, 0, 1});
  add_plate(at_height(1.0));
  add_pane(0.5, {1, 0, 0});
  const glm::vec3 tint(0.8F, 0.6F, 0.4F);
  edit([&](scene::Material &value) { value.base_color = tint; });
  const glm::vec3 behind = tint * (0.5F * glm::vec3(1, 0, 0) + 0.5F * glm::vec3(0.5F));
  test::expect_near(glm::vec3(render().middle()), 0.5F * glm::vec3(0, 0, 1) + 0.5F * behind, 1e-5F);
  // The plate may itself be blended over what is behind it.
  edit([](scene::Material &value) {
    value.alpha_mode = scene::AlphaMode::Blend;
    value.alpha = 0.25F;
  });
  const glm::vec3 partly = (0.25F * tint + 0.75F) * (0.5F * glm::vec3(1, 0, 0) + 0.5F * glm::vec3(0.5F));
  test::expect_near(glm::vec3(render().middle()), 0.5F * glm::vec3(0, 0, 1) + 0.5F * partly, 1e-5F);
}

TEST_F(TransmissionGpuTest, BeforeATransparentBackgroundAlphaIsWhatDoesNotPass)
{
  test::remove_objects(scene);
  add_plate(at_height(1.0));
  edit([](scene::Material &value) {
    value.base_color = {0.9F, 0.6F, 0.3F};
    value.transmission = 0.5F;
  });
  const glm::vec4 pixel = render().middle();
  test::expect_near(glm::vec3(pixel), glm::vec3(0.0F), 0.0F);
  EXPECT_NEAR(pixel.w, 1.0F - 0.5F * 0.6F, 1e-5F);
  Settings settings;
  settings.background = {.kind = Background::Kind::Color, .color = {1.0F, 2.0F, 3.0F}};
  test::expect_near(glm::vec3(render(settings).middle()), 0.5F * glm::vec3(0.9F, 1.2F, 0.9F), 1e-5F);
  EXPECT_NEAR(render(settings).middle().w, 1.0F, 1e-5F);
}

TEST_F(TransmissionGpuTest, ShadowsAreAsDarkAsThePartThatDoesNotPass)
{
  // The plate is beside the view, where its shadow falls.
  const auto white = test::add_material(scene, glm::vec3(1.0F));
  scene.edit(ground, [&](scene::Mesh &mesh) { mesh.material = white; });
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {-1, 0, -1},
                 std::numbers::sqrt2_v<float> * std::numbers::pi_v<float>);
  add_plate(glm::scale(glm::translate(glm::dmat4(1), glm::dvec3(3, 0, 3)), glm::dvec3(1)));
  camera = test::camera_at({0, 0, 5}, {0, 0, 0}, 0.1F);
  const auto shadow_with = [&](const auto &change) {
    edit(change);
    return render({.shadow = {.map_size_px = 64}, .sample_count = 64}).middle().x;
  };
  // The standard deviation of 64 stratified thresholds is below 1/64; the pixel filter averages several texels.
  EXPECT_NEAR(shadow_with([](scene::Material &value) {
                value.base_color = {1.0F, 0.5F, 0.0F};
              }),
              0.2126F + 0.5F * 0.7152F, 0.02F);
  EXPECT_NEAR(shadow_with([](scene::Material &value) { value.transmission = 0.5F; }), 0.5F * (0.2126F + 0.5F * 0.7152F),
              0.02F);
  EXPECT_NEAR(shadow_with([&](scene::Material &value) {
                value.transmission_texture.texture = test::add_texture(scene, 1, {255, 255, 255, 255});
              }),
              0.5F * (0.2126F + 0.5F * 0.7152F), 0.02F)
      << "the mesh has no uvs";
  scene.edit(test::handle_at(scene.meshes(), 1), [](scene::Mesh &mesh) { mesh.uvs.assign(4, glm::vec2(0.5F)); });
  EXPECT_EQ(shadow_with([](scene::Material & /*value*/) {}), 0.0F) << "a texture's part is not known to shadows";
  EXPECT_EQ(shadow_with([](scene::Material &value) {
              value.transmission_texture = {};
              value.thickness = 0.1F;
            }),
            0.0F)
      << "a body focuses light elsewhere";
  EXPECT_GT(shadow_with([](scene::Material &value) { value.thickness = 0.0F; }), 0.2F);
}

TEST_F(TransmissionGpuTest, HostileValuesStayFinite)
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  set_ground(gradient);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0.3F, 0, -1}, 1.0F);
  add_plate(at_height(1.0));
  test::add_object(scene, test::add_box_mesh(scene, glass), at_height(0.5, {0.5, 0.5, 0.0}));
  Renderer renderer(*device, scene, square_size_px);
  constexpr float largest = std::numeric_limits<float>::max();
  for (const float extreme : {0.0F, -1.0F, std::numeric_limits<float>::denorm_min(), 1e-30F, float(scene::number_max),
                              largest, infinity, nan}) {
    SCOPED_TRACE(extreme);
    const auto expect_finite = [&](const auto &change) {
      // Also false for NaN.
      if (!(extreme >= 0.0F && extreme <= largest)) {
        EXPECT_THROW(edit(change), scene::InvalidEdit);
        return;
      }
      const scene::Material kept = scene.materials()[glass];
      try {
        edit(change);
      }
      catch (const scene::InvalidEdit &) {
        // Outside of the limits of the property.
        EXPECT_EQ(scene.materials()[glass].ior, kept.ior);
        return;
      }
      renderer.sync();
      EXPECT_EQ(renderer.picture(camera).non_finite_count(), 0U);
      edit([&](scene::Material &value) { value = kept; });
    };
    expect_finite([&](scene::Material &value) {
      value.ior = extreme;
      value.thickness = 1.0F;
      value.roughness = 1.0F;
    });
    expect_finite([&](scene::Material &value) {
      value.thickness = 1.0F;
      value.attenuation_distance = extreme;
      value.attenuation_color = {0.0F, 0.5F, 1.0F};
    });
    expect_finite([&](scene::Material &value) {
      value.thickness = extreme;
      value.attenuation_distance = 1.0F;
      value.attenuation_color = {extreme, 0.0F, 1.0F};
    });
  }
}

}  // namespace
}  // namespace gnomon::eevee
