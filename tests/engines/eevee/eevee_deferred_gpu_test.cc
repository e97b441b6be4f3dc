// SPDX-License-Identifier: MIT
// Deferred lighting. A white texture on each plain material changes nothing but the path: these objects are lit
// forward.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "scene_studio.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;

enum class Path { Deferred, Forward };

class DeferredGpuTest : public test::SharedDeviceTest {
 protected:
  /** A plain material of \a color, and a white texture that takes it off deferred lighting. */
  scene::Handle<scene::Material> add_plain(const glm::vec3 &color, Path path, float specular = 0.0F)
  {
    scene::Material material;
    material.base_color = color;
    material.metallic = 0.0F;
    material.roughness = 0.3F;
    material.specular_color = glm::vec3(specular);
    material.is_double_sided = false;
    if (path == Path::Forward) {
      material.base_color_texture = test::add_texture(scene, 1, {255, 255, 255, 255});
    }
    return scene.add(std::move(material));
  }

  /** Plain boxes on a plain ground, among them mirrored, two-sided and single ones. */
  void add_plain_objects(Path path, float specular)
  {
    const auto ground = add_plain({0.6F, 0.6F, 0.5F}, path);
    scene.edit(ground, [](scene::Material &material) { material.is_double_sided = true; });
    test::add_object(scene, test::add_square_mesh(scene, ground), glm::scale(glm::dmat4(1.0), glm::dvec3(6)));
    const auto box = test::add_box_mesh(scene, add_plain({0.7F, 0.3F, 0.2F}, path, specular));
    const auto sheet = test::add_square_mesh(scene, ground);
    const auto one_sided = test::add_square_mesh(scene, add_plain({0.2F, 0.3F, 0.8F}, path, specular));
    for (int i = 0; i < 12; i++) {
      glm::dmat4 matrix = glm::translate(glm::dmat4(1.0), glm::dvec3(i % 4 - 1.5, 1.2 * (i / 4) - 1.0, 0.25));
      matrix = glm::rotate(matrix, 0.5 * i, glm::dvec3(1, 0.3, 0.5));
      const double mirror = i % 3 == 1 ? -1.0 : 1.0;
      test::add_object(scene,
                       i % 4 == 3   ? sheet
                       : i % 4 == 2 ? one_sided
                                    : box,
                       glm::scale(matrix, glm::dvec3(0.3 * mirror, 0.35, 0.25)));
    }
  }

  /** A masked, a textured and a blended square between the boxes, and a box that receives no shadow. */
  void add_other_objects()
  {
    const auto add = [&](const glm::dvec3 &center, scene::AlphaMode mode, std::uint8_t alpha) {
      scene::Material material;
      material.is_double_sided = true;
      material.metallic = 0.0F;
      material.alpha_mode = mode;
      material.base_color_texture =
          test::add_texture(scene, 2, {250, 200, 60, 255, 80, 200, 60, alpha, 80, 90, 200, alpha, 200, 90, 200, 255});
      const glm::dmat4 matrix = glm::rotate(glm::translate(glm::dmat4(1.0), center), 1.1, glm::dvec3(1, 0.2, 0));
      test::add_object(scene, test::add_square_mesh(scene, scene.add(std::move(material))),
                       glm::scale(matrix, glm::dvec3(0.6)));
    };
    add({-0.8, -1.4, 0.4}, scene::AlphaMode::Mask, 0);
    add({0.3, 0.4, 0.6}, scene::AlphaMode::Opaque, 255);
    add({1.1, -1.2, 0.5}, scene::AlphaMode::Blend, 60);
    const auto box = test::add_box_mesh(scene, test::add_material(scene, {0.3F, 0.6F, 0.3F}));
    const auto node = test::add_object(
        scene, box, glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(-1.6, 0.2, 0.5)), glm::dvec3(0.35)));
    scene.edit(node, [](scene::Node &value) { value.receives_shadow = false; });
  }

  void add_lamps()
  {
    test::add_lamp(scene, scene::LampKind::Point, {1.5F, -1, 3}, {0, 0, -1}, 40.0F);
    test::add_lamp(scene, scene::LampKind::Sun, {}, {0.3F, 0.5F, -1}, 1.5F);
    test::add_lamp(scene, scene::LampKind::Spot, {-2, -2, 3}, {0.6F, 0.6F, -1}, 60.0F);
  }

  Picture render(const Settings &settings, bool is_deferred, glm::ivec2 size = {77, 53})
  {
    Renderer renderer(*device, scene, size, settings);
    Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    EXPECT_EQ(runs("deferred_lit") > deferred_runs, is_deferred);
    deferred_runs = runs("deferred_lit");
    return picture;
  }

  scene::Scene scene;
  scene::PlacedCamera camera = test::camera_at({0.4F, -5, 3.5F}, {0, 0, 0.2F}, 0.7F);
  std::uint64_t deferred_runs = 0;
};

const Settings with_small_shadows = {.shadow = {.cube_size_px = 256, .map_size_px = 256}};

/**
 * Directions of the G-buffer have 15 bits a coordinate, an error of up to 1.3e-4. Measured: at most 13 pixels differ by
 * more than 1e-4, and none by more than 3e-4.
 */
constexpr float tolerance = 3e-4F;
/**
 * Beyond the end of a caster, light rises within a fortieth of a texel (CONTACT_RISE), where it differs more. Measured:
 * with OpenGL one pixel, by 7.9e-4 to 9.4e-4; with lavapipe two, by 3.1e-4 to 5.9e-4; with SwiftShader one, by 3.6e-4
 * to 9.8e-4.
 */
constexpr int contact_pixels_max = 2;
constexpr float contact_tolerance = 2e-3F;

void expect_equal(const Picture &deferred, const Picture &forward)
{
  ASSERT_EQ(deferred.pixels.size(), forward.pixels.size());
  int different = 0;
  float largest = 0.0F;
  float brightest = 0.0F;
  for (std::size_t i = 0; i < deferred.pixels.size(); i++) {
    const glm::vec4 delta = glm::abs(deferred.pixels[i] - forward.pixels[i]);
    const float difference = std::max({delta.r, delta.g, delta.b, delta.a});
    different += difference > tolerance ? 1 : 0;
    largest = std::max(largest, difference);
    brightest = std::max(brightest, forward.pixels[i].r);
  }
  EXPECT_LE(different, contact_pixels_max);
  EXPECT_LE(largest, contact_tolerance);
  EXPECT_GT(brightest, 0.1F) << "a picture without light would test nothing";
}

TEST_F(DeferredGpuTest, ThePictureIsThatOfForwardLighting)
{
  for (const float specular : {0.0F, 1.0F}) {
    for (const bool is_perspective : {true, false}) {
      for (const int sample_count : {1, 4}) {
        std::vector<Picture> pictures;
        for (const Path path : {Path::Deferred, Path::Forward}) {
          scene = {};
          add_plain_objects(path, specular);
          add_lamps();
          if (!is_perspective) {
            camera.kind = scene::CameraKind::Orthographic;
            camera.far = 20.0F;
            camera.half_height = 2.0F;
            camera.half_width = 2.0F * 77.0F / 53.0F;
          }
          Settings settings = with_small_shadows;
          settings.sample_count = sample_count;
          pictures.push_back(render(settings, path == Path::Deferred));
        }
        SCOPED_TRACE(testing::Message() << specular << is_perspective << sample_count);
        expect_equal(pictures[0], pictures[1]);
      }
    }
    camera = test::camera_at({0.4F, -5, 3.5F}, {0, 0, 0.2F}, 0.7F);
  }
}

TEST_F(DeferredGpuTest, ObjectsOfOtherKindsLieInFrontAndBehind)
{
  for (const bool is_fitted : {false, true}) {
    std::vector<Picture> pictures;
    for (const Path path : {Path::Deferred, Path::Forward}) {
      scene = {};
      add_plain_objects(path, 1.0F);
      add_other_objects();
      add_lamps();
      Settings settings = with_small_shadows;
      settings.shadow.is_fitted_to_depth = is_fitted;
      settings.has_multiscatter = true;
      settings.background = {.kind = Background::Kind::Color, .color = {0.2F, 0.4F, 0.9F}};
      pictures.push_back(render(settings, path == Path::Deferred));
    }
    expect_equal(pictures[0], pictures[1]);
  }
}

TEST_F(DeferredGpuTest, GlassShowsThemAndTheWorldBehindThem)
{
  std::vector<Picture> pictures;
  for (const Path path : {Path::Deferred, Path::Forward}) {
    scene = {};
    add_plain_objects(path, 1.0F);
    add_lamps();
    scene::Material glass;
    glass.metallic = 0.0F;
    glass.roughness = 0.0F;
    glass.transmission = 1.0F;
    glass.is_double_sided = true;
    const glm::dmat4 upright =
        glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(0.2, -1.8, 0.8)), 1.5, glm::dvec3(1, 0, 0));
    test::add_object(scene, test::add_square_mesh(scene, scene.add(std::move(glass))), upright);
    scene.set_world(scene::studio_world(camera.world_from_camera));
    Settings settings = with_small_shadows;
    settings.background.kind = Background::Kind::World;
    pictures.push_back(render(settings, path == Path::Deferred));
  }
  expect_equal(pictures[0], pictures[1]);
  EXPECT_GT(runs("transmission"), 1U) << "once for each picture";
}

TEST_F(DeferredGpuTest, PartsOfASampleAreThoseOfTheWholePicture)
{
  add_plain_objects(Path::Deferred, 1.0F);
  add_other_objects();
  add_lamps();
  const Picture whole = render(with_small_shadows, true);
  SceneRenderer renderer(*device, scene, {77, 53}, with_small_shadows);
  renderer.sync();
  renderer.viewport().set_rows_max(9);
  int calls = 1;
  while (calls < 20 && !renderer.draw_sample(camera)) {
    calls++;
  }
  EXPECT_EQ(calls, 7) << "55 rows with the guard band";
  EXPECT_TRUE(renderer.read_picture() == whole.pixels);
}

TEST_F(DeferredGpuTest, PixelsWithoutASurfaceAreTransparent)
{
  test::add_object(scene, test::add_box_mesh(scene, add_plain({0.5F, 0.5F, 0.5F}, Path::Deferred)),
                   glm::scale(glm::dmat4(1.0), glm::dvec3(0.4)));
  add_lamps();
  const Picture picture = render(with_small_shadows, true, {33, 31});
  EXPECT_EQ(picture.at(0, 0), glm::vec4(0.0F));
  EXPECT_EQ(picture.at(32, 30), glm::vec4(0.0F));
  // The weights of the film add up to 1 with rounding.
  EXPECT_NEAR(picture.middle().a, 1.0F, 1e-6F);
}

TEST_F(DeferredGpuTest, ScenesOfFewPlainObjectsAreLitForward)
{
  add_plain_objects(Path::Forward, 0.0F);
  add_other_objects();
  test::add_object(scene, test::add_box_mesh(scene, add_plain({0.5F, 0.5F, 0.5F}, Path::Deferred)), glm::dmat4(1.0));
  add_lamps();
  render(with_small_shadows, false);
  for (const std::string &resource : device->live_resources()) {
    EXPECT_EQ(resource.find("gbuffer"), std::string::npos) << resource;
  }
}

}  // namespace
}  // namespace gnomon::eevee
