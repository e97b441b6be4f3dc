// SPDX-License-Identifier: MIT
// Layers of pictures: parts of the light sum to the whole, and surfaces are where they are.
#include "eevee_picture_layers.hh"
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include "scene_studio.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace gnomon::eevee {
namespace {

using Radiances = std::vector<glm::vec4>;
using Kind = LightComponent::Kind;

constexpr glm::ivec2 layers_size_px(28, 20);

double rms(const Radiances &pixels)
{
  double sum = 0.0;
  for (const glm::vec4 &pixel : pixels) {
    sum += double(glm::dot(glm::vec3(pixel), glm::vec3(pixel)));
  }
  return std::sqrt(sum / (3.0 * double(pixels.size())));
}

Radiances sum_of(const Radiances &a, const Radiances &b, float factor = 1.0F)
{
  Radiances sum = a;
  std::ranges::transform(a, b, sum.begin(), [&](const glm::vec4 &x, const glm::vec4 &y) { return x + factor * y; });
  return sum;
}

class PictureLayersGpuTest : public test::SharedDeviceTest {
 protected:
  PictureLayersGpuTest()
  {
    ground = test::add_material(scene, {0.8F, 0.5F, 0.2F});
    test::edit_material(scene, 0, [](scene::Material &material) {
      material.specular_color = glm::vec3(1.0F);
      material.roughness = 0.3F;
    });
    test::add_object(scene, test::add_square_mesh(scene, ground), glm::scale(glm::dmat4(1), glm::dvec3(2)));
    metal = test::add_material(scene, {0.9F, 0.9F, 0.4F});
    scene.edit(metal, [&](scene::Material &material) {
      material.metallic = 1.0F;
      material.roughness = 0.5F;
      material.emissive = {0.1F, 0.0F, 0.2F};
      material.base_color_texture.texture = test::add_texture(scene, 2, std::vector<std::uint8_t>(16, 128));
    });
    test::add_object(scene, test::add_box_mesh(scene, metal),
                     glm::scale(glm::translate(glm::dmat4(1), {0.3, 0, 0.5}), glm::dvec3(0.5)));
    test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0.7F, -0.3F, -1}, 1.0F);
    scene::Lamp area;
    area.name = "area";
    area.kind = scene::LampKind::Area;
    area.intensity = 20.0F;
    test::add_lamp(scene, area, glm::translate(glm::dmat4(1), {-1, 0, 3}));
  }
  /** Things that only light needs: what is blended, clear, unlit, and a world with suns. */
  void add_more_light()
  {
    const auto glass = test::add_material(scene, glm::vec3(0.4F));
    scene.edit(glass, [](scene::Material &material) {
      material.emissive = {0.0F, 0.4F, 0.0F};
      material.alpha_mode = scene::AlphaMode::Blend;
      material.alpha = 0.4F;
      material.sheen_color = glm::vec3(0.7F);
    });
    test::add_object(scene, test::add_square_mesh(scene, glass),
                     glm::scale(glm::translate(glm::dmat4(1), {-0.5, -0.5, 1.2}), glm::dvec3(0.7)));
    const auto clear = test::add_material(scene, {0.7F, 0.9F, 0.8F});
    scene.edit(clear, [](scene::Material &material) {
      material.specular_color = glm::vec3(1.0F);
      material.transmission = 0.9F;
      material.thickness = 0.4F;
      material.roughness = 0.2F;
    });
    test::add_object(scene, test::add_box_mesh(scene, clear),
                     glm::scale(glm::translate(glm::dmat4(1), {0.9, -0.9, 0.5}), glm::dvec3(0.4)));
    const auto unlit = test::add_material(scene, {0.2F, 0.3F, 0.9F});
    scene.edit(unlit, [](scene::Material &material) { material.is_unlit = true; });
    test::add_object(scene, test::add_box_mesh(scene, unlit),
                     glm::scale(glm::translate(glm::dmat4(1), {-1.2, 0.8, 0.2}), glm::dvec3(0.2)));
    scene.edit(metal, [](scene::Material &material) { material.coat = 1.0F; });
    scene.set_world(scene::studio_world(camera.world_from_camera));
  }

  scene::Scene scene;
  scene::Handle<scene::Material> ground;
  scene::Handle<scene::Material> metal;
  scene::PlacedCamera camera = test::camera_at({0, -5, 4}, {0, 0, 0}, 0.6F);
};

TEST_F(PictureLayersGpuTest, PartsOfTheLightSumToThePicture)
{
  add_more_light();
  // 0: a picture without a known number of samples, of which 3 are drawn.
  for (const int sample_count : {1, 4, 0}) {
    const int drawn = sample_count == 0 ? 3 : sample_count;
    Settings settings{.shadow = {.cube_size_px = 64, .map_size_px = 128}, .sample_count = sample_count, .seed = 5};
    settings.background.kind = Background::Kind::World;
    SceneRenderer renderer(*device, scene, layers_size_px, settings);
    renderer.sync();
    renderer.draw(camera, {.progress = [&](int samples) { return samples < drawn; }});
    const Radiances whole = renderer.read_picture();
    Radiances sum(whole.size(), glm::vec4(0.0F));
    for (const LightComponent &component : {LightComponent{Kind::Lamp, 0}, LightComponent{Kind::Lamp, 1},
                                            LightComponent{Kind::Emission}, LightComponent{Kind::World}}) {
      const Radiances layer = render_light_layer(renderer, camera, drawn, component);
      EXPECT_GT(rms(layer), 0.01 * rms(whole)) << int(component.kind) << ' ' << component.lamp;
      EXPECT_LT(rms(layer), 0.995 * rms(whole)) << int(component.kind) << ' ' << component.lamp;
      sum = sum_of(sum, layer);
    }
    EXPECT_LE(rms(sum_of(sum, whole, -1.0F)), 1e-5 * rms(whole)) << sample_count << " samples";
    renderer.draw(camera, {.progress = [&](int samples) { return samples < drawn; }});
    EXPECT_EQ(renderer.read_picture(), whole) << "the layers leave the renderer as it was";
  }
}

TEST_F(PictureLayersGpuTest, ALampsLightIsThePictureOfTheSceneWithThatLampAlone)
{
  const Settings settings{.shadow = {.map_size_px = 128}, .sample_count = 4};
  SceneRenderer renderer(*device, scene, layers_size_px, settings);
  renderer.sync();
  renderer.draw(camera);
  const Radiances layer = render_light_layer(renderer, camera, 4, {Kind::Lamp, 0});
  test::remove_lamps(scene, [](const scene::Lamp &lamp) { return lamp.name == "area"; });
  scene.edit(metal, [](scene::Material &material) { material.emissive = glm::vec3(0.0F); });
  SceneRenderer alone(*device, scene, layers_size_px, settings);
  alone.sync();
  alone.draw(camera);
  EXPECT_LE(rms(sum_of(layer, alone.read_picture(), -1.0F)), 1e-6);
}

TEST_F(PictureLayersGpuTest, SurfacesAreWhereTheyAreAndCoverWhatThePictureCovers)
{
  const Settings settings{.shadow = {.cube_size_px = 64, .map_size_px = 128}, .sample_count = 8};
  SceneRenderer renderer(*device, scene, layers_size_px, settings);
  renderer.sync();
  renderer.draw(camera);
  const Radiances picture = renderer.read_picture();
  const SurfaceLayers layers = render_surface_layers(
      renderer, camera, 8, {.has_centers = true, .has_means = true, .has_objects = true, .visible_lamps = {0}});
  const draw::View view = renderer.view_of(camera);
  const glm::vec3 eye(0, -5, 4);
  const glm::vec3 axis = glm::normalize(-eye);
  int boxes = 0;
  int shadows = 0;
  for (int i = 0; i < layers_size_px.x * layers_size_px.y; i++) {
    const auto pixel = std::size_t(i);
    float coverage = 0.0F;
    glm::vec4 expected(0.0F);
    for (const auto &[object, share] : layers.objects[pixel]) {
      coverage += share;
      // The texture's texels are 128 of 255 in sRGB.
      expected += share * (object == 1 ? glm::vec4(0.8F, 0.5F, 0.2F, 0.3F)
                                       : glm::vec4(glm::vec3(0.9F, 0.9F, 0.4F) * 0.21586F, 0.5F));
    }
    const glm::ivec2 place(i % layers_size_px.x, i / layers_size_px.x);
    const bool is_rim =
        place.x == 0 || place.y == 0 || place.x == layers_size_px.x - 1 || place.y == layers_size_px.y - 1;
    if (!is_rim) {
      EXPECT_NEAR(coverage, picture[pixel].a, 1e-5F) << i;
    }
    for (int c = 0; c < 4; c++) {
      EXPECT_NEAR(layers.albedo_roughness[pixel][c], expected[c], 5e-3F * expected[c] + 1e-6F)
          << i << ": the driver decodes sRGB by a table";
    }
    EXPECT_GE(layers.visibilities[0][pixel], 0.0F);
    EXPECT_LE(layers.visibilities[0][pixel], coverage + 1e-5F);

    const glm::vec4 &normal = layers.normal[pixel];
    const glm::vec3 position(layers.position_depth[pixel]);
    if (normal.w == 0.0F) {
      EXPECT_EQ(layers.position_depth[pixel], glm::vec4(0.0F, 0.0F, 0.0F, no_depth));
      continue;
    }
    EXPECT_NEAR(layers.position_depth[pixel].w, glm::dot(axis, position - eye), 1e-5F);
    const glm::vec4 clip = view.clip_from_world() * glm::vec4(position, 1.0F);
    const glm::vec2 seen_px = (0.5F * glm::vec2(clip) / clip.w + 0.5F) * glm::vec2(layers_size_px);
    EXPECT_NEAR(seen_px.x, float(place.x) + 0.5F, 1e-3F);
    EXPECT_NEAR(seen_px.y, float(place.y) + 0.5F, 1e-3F);
    if (normal.w == 1.0F) {
      EXPECT_NEAR(position.z, 0.0F, 1e-5F);
      EXPECT_EQ(glm::vec3(normal), glm::vec3(0, 0, 1));
      shadows += layers.visibilities[0][pixel] < 0.01F;
    }
    else {
      boxes++;
      const glm::vec3 from_center = glm::abs(position - glm::vec3(0.3F, 0.0F, 0.5F)) * 2.0F;
      EXPECT_NEAR(std::max({from_center.x, from_center.y, from_center.z}), 1.0F, 1e-4F);
    }
  }
  EXPECT_GT(boxes, 20);
  EXPECT_GT(shadows, 2);
}

/** On a surface with uniform light, a pixel's light is its light without shadows times the visibility. */
TEST_F(PictureLayersGpuTest, VisibilityIsTheShareOfTheLightThatArrives)
{
  scene.edit(ground, [](scene::Material &material) { material.specular = 0.0F; });
  // A sun that covers a disk, so that each sample sees another point of it.
  scene.edit(test::handle_at(scene.lamps(), 0), [](scene::Lamp &lamp) { lamp.angle = 0.1F; });
  for (const bool is_fitted : {false, true}) {
    Settings settings{.shadow = {.map_size_px = 128, .is_fitted_to_depth = is_fitted}, .sample_count = 4};
    SceneRenderer renderer(*device, scene, layers_size_px, settings);
    renderer.sync();
    renderer.draw(camera);
    const Radiances lit = render_light_layer(renderer, camera, 4, {Kind::Lamp, 0});
    const SurfaceLayers layers =
        render_surface_layers(renderer, camera, 4, {.has_objects = true, .visible_lamps = {0}});
    settings.shadow.kind = scene::ShadowKind::None;
    renderer.set_settings(settings);
    renderer.sync();
    const Radiances unshadowed = render_light_layer(renderer, camera, 4, {Kind::Lamp, 0});
    int partial = 0;
    for (std::size_t i = 0; i < lit.size(); i++) {
      const auto &objects = layers.objects[i];
      const glm::ivec2 place(int(i) % layers_size_px.x, int(i) / layers_size_px.x);
      const bool is_rim =
          place.x == 0 || place.y == 0 || place.x == layers_size_px.x - 1 || place.y == layers_size_px.y - 1;
      if (is_rim || objects.size() != 1 || objects[0].first != 1) {
        continue;
      }
      const float visible = layers.visibilities[0][i] / objects[0].second;
      // The cosines of the sun's points differ by up to 7 %. The largest difference is 0.003.
      EXPECT_NEAR(lit[i].r / unshadowed[i].r, visible, 5e-3F) << place.x << ", " << place.y;
      partial += visible > 0.05F && visible < 0.95F;
    }
    EXPECT_GE(partial, 8);
  }
}

TEST_F(PictureLayersGpuTest, SurfacesThatReceiveNoShadowSeeTheWholeLamp)
{
  for (const scene::Object &object : scene.objects()) {
    scene.edit(object.node, [](scene::Node &node) { node.receives_shadow = false; });
  }
  SceneRenderer renderer(*device, scene, layers_size_px, {.shadow = {.map_size_px = 128}});
  renderer.sync();
  renderer.draw(camera);
  const SurfaceLayers layers = render_surface_layers(renderer, camera, 1, {.has_objects = true, .visible_lamps = {0}});
  for (std::size_t i = 0; i < layers.objects.size(); i++) {
    float coverage = 0.0F;
    for (const auto &[object, share] : layers.objects[i]) {
      coverage += share;
    }
    ASSERT_NEAR(layers.visibilities[0][i], coverage, 1e-5F) << i;
  }
}

TEST_F(PictureLayersGpuTest, TexturesAreInTheAlbedoAlsoWithoutLight)
{
  test::remove_lamps(scene);
  SceneRenderer renderer(*device, scene, layers_size_px);
  renderer.sync();
  renderer.draw(camera);
  const SurfaceLayers layers = render_surface_layers(renderer, camera, 1, {.has_means = true, .has_objects = true});
  int boxes = 0;
  for (std::size_t i = 0; i < layers.objects.size(); i++) {
    if (layers.objects[i].size() == 1 && layers.objects[i][0].first == 2) {
      boxes++;
      EXPECT_NEAR(layers.albedo_roughness[i].r, 0.9F * 0.21586F * layers.objects[i][0].second, 2e-3F);
    }
  }
  EXPECT_GT(boxes, 5);
}

}  // namespace
}  // namespace gnomon::eevee
