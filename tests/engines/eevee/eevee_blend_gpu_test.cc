// SPDX-License-Identifier: MIT
// Blended surfaces compared with closed forms and with the reference, on the driver.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include "reference_light.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <numeric>
#include <random>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;

/** A surface that emits, and lets a part of the light through. */
struct Pane {
  glm::vec3 emissive{0.0F};
  float alpha = 0.5F;
};

class BlendGpuTest : public test::SharedDeviceTest {
 protected:
  scene::Handle<scene::Mesh> pane_mesh(const Pane &pane, bool is_double_sided = true)
  {
    const auto material = test::add_material(scene, glm::vec3(0.0F));
    scene.edit(material, [&](scene::Material &value) {
      value.emissive = pane.emissive;
      value.alpha_mode = scene::AlphaMode::Blend;
      value.alpha = pane.alpha;
      value.is_double_sided = is_double_sided;
    });
    return test::add_square_mesh(scene, material);
  }
  Picture render(const scene::PlacedCamera &camera, const Settings &settings = {}, glm::ivec2 size_px = {16, 16})
  {
    Renderer renderer(*device, scene, size_px, settings);
    const Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture;
  }
  static void expect_near(const glm::vec4 &pixel, const glm::vec4 &expected, float tolerance, const std::string &what)
  {
    for (int c = 0; c < 4; c++) {
      EXPECT_NEAR(pixel[c], expected[c], tolerance) << what << ", channel " << c;
    }
  }
  scene::Scene scene;
};

/** \a panes over \a behind, the last of them nearest: colours premultiplied. */
glm::vec4 composed(std::span<const Pane> panes, glm::vec4 behind = glm::vec4(0.0F))
{
  for (const Pane &pane : panes) {
    behind = pane.alpha * glm::vec4(pane.emissive, 1.0F) + (1.0F - pane.alpha) * behind;
  }
  return behind;
}

std::vector<Pane> some_panes(std::size_t count)
{
  std::vector<Pane> panes;
  for (std::size_t i = 0; i < count; i++) {
    const float x = float(i) / 8.0F;
    panes.push_back({{x, 1.0F - x, i % 2 == 0 ? 2.0F : 0.1F}, 0.15F + 0.7F * float(i * 5 % 8) / 8.0F});
  }
  return panes;
}

TEST_F(BlendGpuTest, AStackIsItsClosedFormInEveryOrderOfObjects)
{
  std::mt19937 random(3);
  for (const std::size_t count : {1U, 2U, 8U}) {
    const std::vector<Pane> panes = some_panes(count);
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t(0));
    for (int turn = 0; turn < (count == 1 ? 1 : 4); turn++) {
      scene = {};
      for (const std::size_t i : order) {
        test::add_object(scene, pane_mesh(panes[i]), glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 0.1 * double(i))));
      }
      // Over nothing, the alpha is what all of them cover.
      for (const int sample_count : {1, 3}) {
        expect_near(render(test::camera_at({0, 0, 9}, {0, 0, 0}, 0.1F), {.sample_count = sample_count}).middle(),
                    composed(panes), 2e-5F, std::to_string(count) + " panes");
      }
      turn == 0 ? std::ranges::reverse(order) : std::ranges::shuffle(order, random);
    }
  }
}

TEST_F(BlendGpuTest, AStackIsRightFromAllAround)
{
  std::vector<Pane> panes = some_panes(4);
  for (std::size_t i = 0; i < panes.size(); i++) {
    // The middles lie on a line across the panes, as the boxes of turned panes overlap.
    test::add_object(scene, pane_mesh(panes[i]),
                     glm::rotate(glm::dmat4(1), 0.4, glm::dvec3(1, 2, 0)) *
                         glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 0.05 * double(i) - 0.075)));
  }
  const glm::dvec3 normal(glm::rotate(glm::dmat4(1), 0.4, glm::dvec3(1, 2, 0))[2]);
  Renderer renderer(*device, scene, {64, 64});
  int from_behind = 0;
  for (int i = 0; i < 16; i++) {
    const double angle = 2.0 * std::numbers::pi * (i + 0.3) / 16.0;
    const glm::dvec3 eye(8.0 * std::sin(angle), 1.0, 8.0 * std::cos(angle));
    const double side = glm::dot(eye, normal) / glm::length(eye);
    if (std::abs(side) < 0.4) {
      continue;
    }
    std::vector<Pane> seen = panes;
    if (side < 0.0) {
      from_behind++;
      std::ranges::reverse(seen);
    }
    const glm::vec4 expected = composed(seen);
    expect_near(renderer.picture(test::camera_at(glm::vec3(eye), {0, 0, 0}, 0.05F)).middle(), expected, 2e-5F,
                std::to_string(i));
    // Turned in its place the camera sees the same panes in the same order.
    const Picture aside = renderer.picture(test::camera_at(glm::vec3(eye), {0, 2.6F, 0}, 1.0F));
    EXPECT_TRUE(std::ranges::any_of(aside.pixels, [&](const glm::vec4 &pixel) {
      return glm::distance(pixel, expected) < 2e-5F;
    })) << i;
  }
  EXPECT_GT(from_behind, 3);
}

TEST_F(BlendGpuTest, BacksAreBehindFronts)
{
  // A box whose side towards the camera has another colour than the one behind.
  scene.edit(scene.meshes()[pane_mesh({{1, 1, 1}, 0.5F})].material, [](scene::Material &material) {
    material.is_unlit = true;
    material.base_color = glm::vec3(1.0F);
  });
  const auto box = test::add_box_mesh(scene, scene.materials().first());
  scene.edit(box, [](scene::Mesh &mesh) {
    for (const glm::vec3 &normal : mesh.normals) {
      mesh.colors.emplace_back(normal.z > 0.5F ? 1.0F : 0.0F, normal.z < -0.5F ? 1.0F : 0.0F, 0.0F, 0.8F);
    }
  });
  test::add_object(scene, box, glm::dmat4(1));
  const scene::PlacedCamera camera = test::camera_at({0, 0, 9}, {0, 0, 0}, 0.1F);
  const Pane front{{1, 0, 0}, 0.4F};
  const Pane back{{0, 1, 0}, 0.4F};
  expect_near(render(camera).middle(), composed(std::vector{back, front}), 2e-5F, "both sides");
  const scene::PlacedCamera behind = test::camera_at({0, 0, -9}, {0, 0, 0}, 0.1F);
  expect_near(render(behind).middle(), composed(std::vector{front, back}), 2e-5F, "both sides, from behind");
  scene.edit(scene.materials().first(), [](scene::Material &material) { material.is_double_sided = false; });
  expect_near(render(camera).middle(), composed(std::vector{front}), 2e-5F, "one side");
}

TEST_F(BlendGpuTest, OpaqueSurfacesHideAndShowThrough)
{
  const auto wall = test::add_material(scene, glm::vec3(0.0F));
  scene.edit(wall, [](scene::Material &material) { material.emissive = {0.2F, 0.4F, 0.8F}; });
  test::add_object(scene, test::add_square_mesh(scene, wall), glm::dmat4(1));
  const Pane hidden{{9, 9, 9}, 0.5F};
  const Pane seen{{1, 0, 0}, 0.25F};
  test::add_object(scene, pane_mesh(seen), glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 1)));
  test::add_object(scene, pane_mesh(hidden), glm::translate(glm::dmat4(1), glm::dvec3(0, 0, -1)));
  for (const int sample_count : {1, 2}) {
    expect_near(render(test::camera_at({0, 0, 9}, {0, 0, 0}, 0.1F), {.sample_count = sample_count}).middle(),
                composed(std::vector{seen}, {0.2F, 0.4F, 0.8F, 1.0F}), 2e-5F, "the wall through the pane");
  }
  Settings settings;
  settings.background = {Background::Kind::Color, {0.5F, 0.6F, 0.7F}};
  scene.remove(scene.nodes().first());
  expect_near(render(test::camera_at({0, 0, 9}, {0, 0, 0}, 0.1F), settings).middle(),
              composed(std::vector{hidden, seen}, {0.5F, 0.6F, 0.7F, 1.0F}), 2e-5F, "over the background");
}

TEST_F(BlendGpuTest, TheTexturesAlphaIsTheOpacity)
{
  // Colours of sRGB 0 and 1 are those of linear light.
  const auto texture = test::add_texture(scene, 1, {255, 0, 0, 51, 0, 0, 255, 204});
  const auto mesh = pane_mesh({{0, 0, 0}, 0.5F});
  scene.edit(scene.materials().first(), [&](scene::Material &material) {
    material.is_unlit = true;
    material.base_color = glm::vec3(1.0F);
    material.base_color_texture.texture = texture;
  });
  const auto square = test::add_square_mesh(scene, scene.materials().first());
  scene.remove(mesh);
  test::add_object(scene, square, glm::dmat4(1));
  const scene::PlacedCamera camera = test::camera_at({0, 0, 3}, {0, 0, 0}, 0.6F);
  const Picture picture = render(camera);
  expect_near(picture.at(8, 14), {0.1F, 0, 0, 0.1F}, 1e-5F, "above");
  expect_near(picture.at(8, 1), {0, 0, 0.4F, 0.4F}, 1e-5F, "below");
}

class BlendShadowTest : public BlendGpuTest {
 protected:
  void SetUp() override
  {
    BlendGpuTest::SetUp();
    test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.8F))),
                     glm::scale(glm::dmat4(1), glm::dvec3(4)));
  }
  /** Mean and deviation of the pixels in the middle of the floor, which no pane covers. */
  struct Seen {
    double mean = 0.0;
    double deviation = 0.0;
  };
  /** Relative to \a bright. */
  static Seen seen(const Picture &picture, const Picture &bright)
  {
    Seen result;
    double squares = 0.0;
    for (std::size_t i = 0; i < picture.pixels.size(); i++) {
      const double part = double(picture.pixels[i].g / bright.pixels[i].g);
      result.mean += part / double(picture.pixels.size());
      squares += part * part / double(picture.pixels.size());
    }
    result.deviation = std::sqrt(std::max(squares - result.mean * result.mean, 0.0));
    return result;
  }
  const scene::PlacedCamera floor_camera = test::camera_at({0, -7, 4}, {0, 0, 0}, 0.06F);
  static Settings settings_of(int sample_count, scene::ShadowKind kind = scene::ShadowKind::Hard)
  {
    Settings settings;
    settings.sample_count = sample_count;
    settings.shadow.kind = kind;
    settings.shadow.cube_size_px = settings.shadow.map_size_px = 256;
    return settings;
  }
};

TEST_F(BlendShadowTest, PassesAsMuchLightAsTheOccludersLetThrough)
{
  const auto first = pane_mesh({{0, 0, 0}, 0.7F});
  const auto second = pane_mesh({{0, 0, 0}, 0.5F});
  for (const scene::LampKind kind : {scene::LampKind::Point, scene::LampKind::Spot, scene::LampKind::Sun}) {
    for (const int sample_count : {1, 64}) {
      test::remove_lamps(scene);
      const auto lamp = test::add_lamp(scene, kind, {0, 0, 3}, {0, 0, -1}, 5.0F);
      scene.edit(lamp, [](scene::Lamp &value) { value.spot_outer_angle = 0.5F; });
      Renderer renderer(*device, scene, {16, 16}, settings_of(sample_count));
      const Picture bright = renderer.picture(floor_camera);
      const auto expect = [&](double open, const char *what) {
        renderer.sync();
        const Seen part = seen(renderer.picture(floor_camera), bright);
        // One sample: thresholds of neighbouring texels are spread evenly. Many: those of a texel are.
        EXPECT_NEAR(part.mean, open, sample_count == 1 ? 0.07 : 0.005) << what << int(kind);
        // Less than that of independent samples.
        EXPECT_LT(part.deviation, 0.8 * std::sqrt(open * (1.0 - open) / sample_count)) << what << int(kind);
      };
      const auto upper = test::add_object(scene, first, glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 1.5)));
      expect(0.3, "one pane, lamp ");
      const auto lower = test::add_object(scene, second, glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 1.2)));
      expect(0.15, "two panes, lamp ");
      scene.remove(upper);
      scene.remove(lower);
    }
  }
}

TEST_F(BlendShadowTest, IsAsDarkOfALampWithASize)
{
  const auto lamp = test::add_lamp(scene, scene::LampKind::Point, {0, 0, 3}, {0, 0, -1}, 5.0F);
  scene.edit(lamp, [](scene::Lamp &value) { value.radius = 0.2F; });
  Renderer renderer(*device, scene, {16, 16}, settings_of(64));
  const Picture bright = renderer.picture(floor_camera);
  test::add_object(scene, pane_mesh({{0, 0, 0}, 0.5F}), glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 1.5)));
  renderer.sync();
  EXPECT_NEAR(seen(renderer.picture(floor_camera), bright).mean, 0.5, 0.02);
}

TEST_F(BlendShadowTest, IsTheSameEveryTime)
{
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 3}, {0, 0, -1}, 5.0F);
  test::add_object(scene, pane_mesh({{0, 0, 0}, 0.5F}), glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 1.5)));
  Renderer renderer(*device, scene, {16, 16}, settings_of(3));
  const Picture first = renderer.picture(floor_camera);
  renderer.picture(test::camera_at({1, -7, 4}, {0, 0, 0}, 0.06F));
  EXPECT_EQ(renderer.picture(floor_camera).pixels, first.pixels);
}

TEST_F(BlendShadowTest, AgreesWithTheReference)
{
  // Lit panes before and above a floor, one of them specular.
  test::add_lamp(scene, scene::LampKind::Point, {0.5F, -1, 3}, {0, 0, -1}, 20.0F);
  const auto pane = pane_mesh({{0.02F, 0, 0}, 0.6F});
  scene.edit(scene.meshes()[pane].material, [](scene::Material &material) {
    material.base_color = {0.2F, 0.7F, 0.9F};
    material.specular_color = glm::vec3(1.0F);
    material.roughness = 0.4F;
  });
  test::add_object(scene, pane, glm::rotate(glm::translate(glm::dmat4(1), {0.3, 0.2, 1.0}), 0.4, {1, 1, 0}));
  const auto other = pane_mesh({{0, 0, 0}, 0.35F});
  scene.edit(scene.meshes()[other].material, [](scene::Material &material) {
    material.base_color = {0.9F, 0.3F, 0.1F};
  });
  test::add_object(scene, other, glm::rotate(glm::translate(glm::dmat4(1), {-0.5, -0.8, 0.6}), -0.5, {0, 1, 0}));
  const scene::PlacedCamera camera = test::camera_at({0, -5, 3.5F}, {0, 0, 0.3F}, 0.7F);
  const Picture picture = render(camera, settings_of(64), {48, 32});
  const reference::Tracer tracer(scene);
  const reference::Picture truth = reference::direct_light(tracer, camera, {48, 32}, {.sample_count = 64});
  double squares = 0.0;
  double bias = 0.0;
  for (std::size_t i = 0; i < truth.pixels.size(); i++) {
    const glm::vec3 difference = glm::vec3(picture.pixels[i]) - glm::vec3(truth.pixels[i]);
    squares += double(glm::dot(difference, difference)) / 3.0;
    bias += double(difference.g);
  }
  const auto count = double(truth.pixels.size());
  EXPECT_LT(std::sqrt(squares / count), 0.02);
  EXPECT_LT(std::abs(bias / count), 0.002);
}

}  // namespace
}  // namespace gnomon::eevee
