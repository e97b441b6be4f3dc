// SPDX-License-Identifier: MIT
// Contents of shadow layers, and the conditions for drawing them, on the driver.
#include "eevee_test_scene.hh"
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"
#include "shadows/shadow_spot.hh"
#include "shadows/shadows.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;

class ShadowLayersGpuTest : public test::SharedDeviceTest {
 protected:
  /** The ways to draw layers that the device has. */
  [[nodiscard]] std::vector<LayerPass> layer_passes() const
  {
    std::vector<LayerPass> ways{LayerPass::Single, LayerPass::Geometry, LayerPass::Layered};
    std::erase_if(ways, [this](LayerPass way) { return !test::has_layer_pass(device->limits(), way); });
    return ways;
  }
  void add(scene::Handle<scene::Mesh> mesh, const glm::vec3 &center, const glm::vec3 &scale = glm::vec3(1.0F))
  {
    test::add_object(scene, mesh, glm::scale(glm::translate(glm::mat4(1.0F), center), scale));
  }
  scene::Handle<scene::Material> add_one_sided()
  {
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    scene.edit(material, [](scene::Material &value) { value.is_double_sided = false; });
    return material;
  }
  /** A leaf whose left half is cut out. */
  scene::Handle<scene::Mesh> add_leaf()
  {
    const auto texture = test::add_texture(scene, 2, {255, 255, 255, 0, 255, 255, 255, 255});
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    scene.edit(material, [&](scene::Material &value) {
      value.base_color_texture = texture;
      value.alpha_mode = scene::AlphaMode::Mask;
    });
    return test::add_square_mesh(scene, material);
  }
  /** Boxes and leaves above a ground, mirrored ones among them, and each kind of lamp. */
  void make_garden()
  {
    const auto leaf = add_leaf();
    add(square, {0, 0, 0}, glm::vec3(60));
    for (int i = 0; i < 30; i++) {
      const float x = -8.0F + 0.6F * float(i);
      const float mirror = i % 2 == 0 ? 1.0F : -1.0F;
      add(box, {x, 0.7F * float(i % 5) + 40.0F * float(i % 3 == 0), 1.0F + 0.2F * float(i % 4)},
          glm::vec3(0.2F * mirror, 0.2F, 0.3F));
      add(leaf, {x, -1.5F, 1.5F}, glm::vec3(0.25F, 0.25F * mirror, 1));
    }
    test::add_lamp(scene, scene::LampKind::Point, {0, 0.5F, 2}, {0, 0, -1}, 20.0F);
    test::add_lamp(scene, scene::LampKind::Point, {4, -3, 3}, {0, 0, -1}, 20.0F);
    scene.edit(test::add_lamp(scene, scene::LampKind::Spot, {-3, 1, 5}, {0.2F, 0, -1}, 50.0F),
               [](scene::Lamp &lamp) { lamp.spot_outer_angle = 0.8F; });
    test::add_lamp(scene, scene::LampKind::Sun, {}, {0.5F, 0.3F, -1}, 2.0F);
  }

  scene::Scene scene;
  /** Two-sided squares and a one-sided box, each with a material of its own. */
  scene::Handle<scene::Mesh> square = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F)));
  scene::Handle<scene::Mesh> box = test::add_box_mesh(scene, add_one_sided());
  scene::PlacedCamera camera = test::camera_at({0, -14, 6}, {0, 0, 0}, 0.9F);
};

/** Layers that were drawn, of cubes and then of maps. */
std::vector<std::vector<float>> drawn_layers(gpu::Device &device, const Shadows &shadows)
{
  std::vector<std::vector<float>> layers;
  for (std::size_t cube = 0; cube < shadows.scene().cube_count(); cube++) {
    const shared::ShadowCubeData &data = shadows.block_data().cubes[cube];
    for (int face = 0; face < 6; face++) {
      if ((data.faces_and_filter >> face & 1) != 0) {
        layers.push_back(
            gpu::read_as<float>(device, shadows.scene().cubes(), shared::cube_face_layer(data.layers, face)));
      }
    }
  }
  for (int layer = 0; shadows.scene().maps() && layer < shadows.scene().maps().desc().layers; layer++) {
    layers.push_back(gpu::read_as<float>(device, shadows.scene().maps(), layer));
  }
  return layers;
}

float largest_difference(const std::vector<float> &a, const std::vector<float> &b)
{
  float largest = 0.0F;
  for (std::size_t i = 0; i < a.size(); i++) {
    largest = std::max(largest, std::abs(a[i] - b.at(i)));
  }
  return largest;
}

TEST_F(ShadowLayersGpuTest, ThreeCubePassesGiveTheSameTexels)
{
  if (layer_passes().size() < 3) {
    GTEST_SKIP() << "the device lacks geometry shaders, or layers in vertex shaders";
  }
  make_garden();
  std::vector<std::vector<std::vector<float>>> layers;
  std::vector<ShadowCounters> counters;
  std::vector<Picture> pictures;
  for (const LayerPass way : layer_passes()) {
    Renderer renderer(
        *device, scene, {48, 32},
        {.shadow = {.cube_size_px = 96, .map_size_px = 128, .cascades = {.count = 4}, .layer_pass = way}});
    pictures.push_back(renderer.picture(camera));
    const Shadows &shadows = renderer.inspect().shadows();
    ASSERT_EQ(shadows.scene().layer_pass(), way);
    layers.push_back(drawn_layers(*device, shadows));
    counters.push_back(shadows.counters());
  }
  // A few faces of two cubes, a spot and the cascades.
  ASSERT_GE(layers[0].size(), 10U);
  EXPECT_EQ(layers[2], layers[0]) << "bit for bit";
  // Mesa clips the output of a geometry shader to a wider frustum, so triangles that cross a layer's edge are
  // interpolated between other points.
  ASSERT_EQ(layers[1].size(), layers[0].size());
  for (std::size_t i = 0; i < layers[0].size(); i++) {
    EXPECT_LE(largest_difference(layers[1][i], layers[0][i]), 2.0F * shared::DEPTH_ROUNDING) << "layer " << i;
  }
  for (std::size_t way = 1; way < 3; way++) {
    EXPECT_EQ(pictures[way].pixels, pictures[0].pixels);
    EXPECT_EQ(counters[way].caster_draws, counters[0].caster_draws);
    EXPECT_EQ(counters[way].faces_drawn, counters[0].faces_drawn);
  }
}

/** Rounded by the driver. \see short_depth_half_step */
TEST_F(ShadowLayersGpuTest, ShortMapsHoldTheSameDepthsInHalfOfTheMemory)
{
  make_garden();
  std::vector<std::vector<glm::vec4>> texels;
  std::vector<std::size_t> bytes;
  std::vector<float> rounding;
  for (const bool can_have_short_maps : {false, true}) {
    Renderer renderer(*device, scene, {48, 32},
                      {.shadow = {.map_size_px = 128, .can_have_short_maps = can_have_short_maps}});
    renderer.picture(camera);
    const Shadows &shadows = renderer.inspect().shadows();
    const gpu::Texture &maps = shadows.scene().maps();
    bytes.push_back(maps.desc().size_bytes());
    rounding.push_back(shadows.block_data().maps[0].rounding);
    for (int layer = 0; layer < maps.desc().layers; layer++) {
      texels.push_back(test::decoded_texels(*device, maps, layer));
    }
  }
  EXPECT_EQ(2 * bytes[1], bytes[0]);
  EXPECT_NEAR(rounding[1] / rounding[0], (short_depth_half_step + shared::DEPTH_ROUNDING) / shared::DEPTH_ROUNDING,
              1e-3);
  const std::size_t layer_count = texels.size() / 2;
  ASSERT_GE(layer_count, 2U) << "a spot and a sun";
  float largest = 0.0F;
  for (std::size_t layer = 0; layer < layer_count; layer++) {
    for (std::size_t i = 0; i < texels[layer].size(); i++) {
      largest = std::max(largest, std::abs(texels[layer_count + layer].at(i).x - texels[layer][i].x));
    }
  }
  EXPECT_LE(largest, short_depth_half_step + shared::DEPTH_ROUNDING);
  EXPECT_GT(largest, 0.0F) << "the depths are not floats";
}

/** A caster high above the ground that the camera sees, and fitted maps without it. */
TEST_F(ShadowLayersGpuTest, CastersInFrontOfFittedDepthsDarkenWhatIsBehindThem)
{
  add(box, {0, -1, 0}, {8, 1, 8});
  // Low boxes, so that the ground is not all that maps show.
  add(box, {-3, 0.1F, -3}, glm::vec3(0.1F));
  add(box, {3, 0.1F, 3}, glm::vec3(0.1F));
  const auto high = test::add_object(scene, box, glm::translate(glm::mat4(1.0F), {0, 2000, 0}));
  const auto sun = test::add_lamp(scene, scene::LampKind::Sun, {0, 5, 0}, {0, -1, 0}, 3.0F);
  // A sun is at no distance, so that this has no effect.
  scene.edit(sun, [](scene::Lamp &lamp) { lamp.shadow.clip_start = 1.0F; });
  camera = test::camera_at({0, 8, 6}, {0, 0, 0}, 0.7F);
  constexpr glm::ivec2 size_px(32, 32);
  const auto picture = [&](bool can_have_short_maps) {
    Renderer renderer(
        *device, scene, size_px,
        {.shadow = {.map_size_px = 512, .is_fitted_to_depth = true, .can_have_short_maps = can_have_short_maps},
         .sample_count = 1});
    Picture result = renderer.picture(camera);
    const shared::ShadowMapData &map = renderer.inspect().shadows().block_data().maps[0];
    const glm::vec4 caster = map.texco_from_world * glm::vec4(0, 2000, 0, 1);
    EXPECT_GT(caster.z, 1.0F) << "in front of the depths";
    const gpu::Format format = renderer.inspect().shadows().scene().maps().desc().format;
    EXPECT_EQ(format, can_have_short_maps ? gpu::Format::Depth16 : gpu::Format::Depth32F);
    return result;
  };
  const std::size_t middle = std::size_t(size_px.y / 2 * size_px.x + size_px.x / 2);
  for (const bool can_have_short_maps : {false, true}) {
    EXPECT_LT(picture(can_have_short_maps).pixels.at(middle).x, 1e-3F) << "in shadow";
  }
  scene.remove(high);
  Renderer without(*device, scene, size_px, {.sample_count = 1});
  EXPECT_GT(without.picture(camera).pixels.at(middle).x, 0.1F) << "lit";
}

// hazards.md: every caster drawn six times into every updated lamp, no cull.
TEST_F(ShadowLayersGpuTest, ACasterIsDrawnOnceForEachFaceThatItTouches)
{
  for (int i = 0; i < 6; i++) {
    glm::vec3 center(0.0F);
    center[i / 2] = i % 2 == 0 ? 4.0F : -4.0F;
    add(box, center, glm::vec3(0.5F));
  }
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 0}, {0, 0, -1}, 20.0F);
  camera = test::camera_at({0, 0, 30}, {0, 0, 0}, 1.0F);
  std::vector<std::vector<float>> six;
  for (const LayerPass way : layer_passes()) {
    Renderer renderer(*device, scene, {16, 16}, {.shadow = {.cube_size_px = 64, .layer_pass = way}});
    renderer.draw(camera);
    const auto layers = drawn_layers(*device, renderer.inspect().shadows());
    six = six.empty() ? layers : six;
    EXPECT_EQ(layers, six) << "bit for bit";
    const ShadowCounters counters = renderer.inspect().report().shadow_counters;
    EXPECT_EQ(counters.faces_drawn, 6U);
    EXPECT_EQ(counters.caster_draws, 6U) << "and not 36";
    for (const std::vector<float> &layer : layers) {
      EXPECT_GT(std::ranges::max(layer), 0.0F);
    }
  }
}

/** Distance of the caster in the middle of a lamp's only map, metres; infinite if there is none. */
float middle_distance(gpu::Device &device, const Shadows &shadows)
{
  const shared::ShadowMapData &map = shadows.block_data().maps[0];
  const std::vector<float> texels = gpu::read_as<float>(device, shadows.scene().maps(), map.layer);
  const std::size_t size = std::size_t(map.size_px);
  // The z row of texco_from_world contains near: depth = near / distance.
  const float near = glm::length(glm::vec3(0, 0, map.texco_from_world[3][2]));
  return near / texels[size / 2 * size + size / 2];
}

TEST_F(ShadowLayersGpuTest, CastingSidesFollowTheSettingAlsoForMirroredObjects)
{
  struct Case {
    CasterFaces faces;
    float one_sided;
    float two_sided;
  };
  // The lamp is at 4, the box reaches from 1 to 2: its upper side is 2 away, its lower one 3.
  for (const Case &one :
       {Case{CasterFaces::All, 2, 2}, Case{CasterFaces::Front, 2, 2}, Case{CasterFaces::Back, 3, 2}}) {
    for (const glm::vec3 &scale :
         {glm::vec3(0.5F), glm::vec3(-0.5F, 0.5F, 0.5F), glm::vec3(-0.5F), glm::vec3(0.5F, 0.5F, -0.5F)}) {
      for (const bool is_two_sided : {false, true}) {
        test::edit_material(scene, 1, [&](scene::Material &material) { material.is_double_sided = is_two_sided; });
        test::remove_objects(scene);
        test::remove_lamps(scene);
        add(box, {0, 0, 1.5F}, scale);
        scene.edit(test::add_lamp(scene, scene::LampKind::Spot, {0, 0, 4}, {0, 0, -1}, 1.0F),
                   [](scene::Lamp &lamp) { lamp.spot_outer_angle = 0.5F; });
        Renderer renderer(*device, scene, {8, 8}, {.shadow = {.map_size_px = 64, .caster_faces = one.faces}});
        renderer.draw(camera);
        EXPECT_NEAR(middle_distance(*device, renderer.inspect().shadows()),
                    is_two_sided ? one.two_sided : one.one_sided, 1e-4F)
            << "faces " << int(one.faces) << ", scale " << scale.x << " " << scale.y << " " << scale.z
            << (is_two_sided ? ", two-sided" : "");
      }
    }
  }
}

// hazards.md: a lookup outside of the map reads its edge, or another lamp's; a lamp's layer overlaps the next one's.
TEST_F(ShadowLayersGpuTest, EachOfThreeSpotsHasItsOwnMapAndIsLitOutsideOfIt)
{
  add(square, {0, 0, 0}, glm::vec3(20));
  const std::array<float, 3> caster_half = {0.03F, 0.05F, 0.04F};
  for (int i = 0; i < 3; i++) {
    const float x = 3.0F * float(i - 1);
    const auto lamp = test::add_lamp(scene, scene::LampKind::Spot, {x, 0, 4}, {0, 0, -1}, 50.0F);
    scene.edit(lamp, [&](scene::Lamp &value) { value.spot_outer_angle = 1.0F; });
    scene.edit(lamp, [&](scene::Lamp &value) {
      value.color = {i == 0 ? 1.0F : 0.0F, i == 1 ? 1.0F : 0.0F, i == 2 ? 1.0F : 0.0F};
    });
    // Near its lamp, so that it does not hide the ground from the other lamps.
    add(square, {x, 0, 3.8F}, glm::vec3(caster_half[std::size_t(i)]));
  }
  const scene::PlacedCamera above = test::camera_at({0, 0, 30}, {0, 0, 0}, 0.4F);
  const glm::ivec2 size_px(128, 128);
  Renderer renderer(*device, scene, size_px, {.shadow = {.map_size_px = 512}});
  Renderer unshadowed(*device, scene, size_px, {.shadow = {.kind = scene::ShadowKind::None}});
  const Picture picture = renderer.picture(above);
  const Picture lit = unshadowed.picture(above);
  EXPECT_EQ(renderer.inspect().shadows().scene().map_count(), 3U);
  // Half a picture is 30 · tan(0.2) = 6.08 m; a caster's shadow is 20 times as large as it.
  const float px_m = 2.0F * 30.0F * std::tan(0.2F) / 128.0F;
  int dark = 0;
  for (int y = 0; y < 128; y++) {
    for (int x = 0; x < 128; x++) {
      const glm::vec2 p = (glm::vec2(x, y) + 0.5F - 64.0F) * px_m;
      for (int i = 0; i < 3; i++) {
        const float from_middle = std::max(std::abs(p.x - 3.0F * float(i - 1)), std::abs(p.y));
        const float edge_m = 20.0F * caster_half[std::size_t(i)];
        // Two pixels for the film's filter, and the casters themselves are seen from above.
        if (std::abs(from_middle - edge_m) < 2.0F * px_m || std::abs(p.y) < 2.0F * px_m || lit.at(x, y)[i] <= 0.0F) {
          continue;
        }
        const float visibility = picture.at(x, y)[i] / lit.at(x, y)[i];
        const bool is_dark = from_middle < edge_m;
        dark += is_dark ? 1 : 0;
        ASSERT_NEAR(visibility, is_dark ? 0.0F : 1.0F, 1e-3F) << "spot " << i << " at " << p.x << " " << p.y;
      }
    }
  }
  EXPECT_GT(dark, 30);
}

/** Fraction of the unshadowed light in the middle of the picture. */
class ClipGpuTest : public ShadowLayersGpuTest {
 protected:
  float middle_visibility(const ShadowSettings &shadow = {})
  {
    Renderer lit(*device, scene, {32, 32}, {.shadow = {.kind = scene::ShadowKind::None}});
    Renderer shadowed(*device, scene, {32, 32}, {.shadow = shadow});
    return shadowed.picture(below).middle().r / lit.picture(below).middle().r;
  }
  /** Looks at the origin from beside the caster above it. */
  scene::PlacedCamera below = test::camera_at({0, -1, 0.5F}, {0, 0, 0}, 0.1F);
};

TEST_F(ClipGpuTest, CastersBeforeTheNearPlaneCastUnlessClipped)
{
  for (const scene::LampKind kind : {scene::LampKind::Point, scene::LampKind::Spot}) {
    test::remove_objects(scene);
    test::remove_lamps(scene);
    add(square, {0, 0, 0}, glm::vec3(20));
    // A small square right under the lamp in a mesh that reaches 3 km around it: the near plane is a ten thousandth
    // away.
    scene::Mesh mesh = scene.meshes()[box];
    const glm::vec3 far(1700, 1700, -1700);
    mesh.positions = {{-0.05F, -0.05F, 3.9F},
                      {0.05F, -0.05F, 3.9F},
                      {0.05F, 0.05F, 3.9F},
                      {-0.05F, 0.05F, 3.9F},
                      far,
                      far,
                      -far,
                      -far};
    mesh.normals.assign(8, {0, 0, 1});
    mesh.uvs.clear();
    mesh.indices = {0, 1, 2, 0, 2, 3, 4, 5, 4, 6, 7, 6};
    scene.replace(box, mesh);
    test::edit_material(scene, 1, [&](scene::Material &material) { material.is_double_sided = true; });
    add(box, {0, 0, 0});
    const auto lamp = test::add_lamp(scene, kind, {0, 0, 4}, {0, 0, -1}, 20.0F);
    scene.edit(lamp, [&](scene::Lamp &value) { value.spot_outer_angle = 0.6F; });
    for (const LayerPass way : layer_passes()) {
      scene.edit(lamp, [](scene::Lamp &value) { value.shadow.clip_start.reset(); });
      Renderer renderer(*device, scene, {8, 8}, {.shadow = {.layer_pass = way}});
      renderer.draw(below);
      const shared::ShadowBlock &block = renderer.inspect().shadows().block_data();
      const float near = kind == scene::LampKind::Point ? block.cubes[0].near : block.maps[0].texco_from_world[3][2];
      ASSERT_GT(std::abs(near), 0.2F) << "the caster, at 0.1, is before the near plane";
      EXPECT_EQ(middle_visibility({.layer_pass = way}), 0.0F) << "lamp kind " << int(kind);
      scene.edit(lamp, [&](scene::Lamp &value) { value.shadow.clip_start = 0.2F; });
      EXPECT_EQ(middle_visibility({.layer_pass = way}), 1.0F) << "lamp kind " << int(kind);
      // Casters beyond the clip distance remain.
      scene.edit(lamp, [&](scene::Lamp &value) { value.shadow.clip_start = 0.05F; });
      EXPECT_EQ(middle_visibility({.layer_pass = way}), 0.0F) << "lamp kind " << int(kind);
    }
  }
}

TEST_F(ClipGpuTest, ReceiversBeyondTheClipEndAreLit)
{
  for (const scene::LampKind kind : {scene::LampKind::Point, scene::LampKind::Spot}) {
    test::remove_objects(scene);
    test::remove_lamps(scene);
    add(square, {0, 0, 0}, glm::vec3(20));
    add(square, {0, 0, 2}, glm::vec3(0.5F));
    const auto lamp = test::add_lamp(scene, kind, {0, 0, 4}, {0, 0, -1}, 20.0F);
    scene.edit(lamp, [&](scene::Lamp &value) { value.spot_outer_angle = 0.6F; });
    EXPECT_EQ(middle_visibility(), 0.0F);
    // The ground is 4 away, the caster 2.
    scene.edit(lamp, [&](scene::Lamp &value) { value.shadow.clip_end = 4.5F; });
    EXPECT_EQ(middle_visibility(), 0.0F);
    scene.edit(lamp, [&](scene::Lamp &value) { value.shadow.clip_end = 3.0F; });
    EXPECT_EQ(middle_visibility(), 1.0F);
  }
}

/** Pictures of a changing scene compared with pictures of a fresh scene in the same state. */
class ShadowCacheGpuTest : public ShadowLayersGpuTest {
 protected:
  Picture fresh_picture(const scene::PlacedCamera &from)
  {
    Renderer renderer(*device, scene, {48, 32}, settings);
    return renderer.picture(from);
  }
  static std::uint64_t lamps_updated(Renderer &renderer)
  {
    return renderer.inspect().report().shadow_counters.lamps_updated;
  }
  Settings settings{.shadow = {.cube_size_px = 128, .map_size_px = 256}};
};

TEST_F(ShadowCacheGpuTest, AStillSceneIsDrawnOnce)
{
  make_garden();
  Renderer renderer(*device, scene, {48, 32}, settings);
  const Picture first = renderer.picture(camera);
  EXPECT_EQ(lamps_updated(renderer), 4U);
  EXPECT_EQ(renderer.picture(camera).pixels, first.pixels);
  renderer.sync();
  EXPECT_EQ(renderer.picture(camera).pixels, first.pixels);
  EXPECT_EQ(lamps_updated(renderer), 4U) << "0 more";
}

TEST_F(ShadowCacheGpuTest, AMovedCasterGivesThePictureOfAFreshStart)
{
  add(square, {0, 0, 0}, glm::vec3(20));
  add(box, {-6, 0, 1}, glm::vec3(0.3F));
  add(box, {6, 0, 1}, glm::vec3(0.3F));
  // Each reaches its own half, and the ground.
  scene.edit(test::add_lamp(scene, scene::LampKind::Point, {-6, 1, 3}, {0, 0, -1}, 20.0F),
             [](scene::Lamp &lamp) { lamp.range = 4.0F; });
  scene.edit(test::add_lamp(scene, scene::LampKind::Point, {6, 1, 3}, {0, 0, -1}, 20.0F),
             [](scene::Lamp &lamp) { lamp.range = 4.0F; });
  Renderer renderer(*device, scene, {48, 32}, settings);
  renderer.draw(camera);
  ASSERT_EQ(lamps_updated(renderer), 2U);
  const auto move_box = [&](const glm::dvec3 &center) {
    const scene::Object object = scene.objects()[1];
    glm::dmat4 world_from_object = object.world_from_object;
    world_from_object[3] = glm::dvec4(center, 1.0);
    scene.set_transform(object.node, world_from_object);
  };
  move_box({-6, 0.5, 1});
  renderer.sync();
  EXPECT_EQ(renderer.picture(camera).pixels, fresh_picture(camera).pixels);
  EXPECT_EQ(lamps_updated(renderer), 3U) << "the lamp in whose range it is";
  move_box({6, 0.5, 1.5});
  renderer.sync();
  EXPECT_EQ(renderer.picture(camera).pixels, fresh_picture(camera).pixels);
  EXPECT_EQ(lamps_updated(renderer), 5U) << "the one that it left, where the ground still casts, and the other";
  move_box({0, 60, 1});
  renderer.sync();
  EXPECT_EQ(renderer.picture(camera).pixels, fresh_picture(camera).pixels);
  EXPECT_EQ(lamps_updated(renderer), 6U) << "the one that it left, and no other: no lamp reaches so far";
}

TEST_F(ShadowCacheGpuTest, FacesSkippedAppearWhenTheCameraTurns)
{
  make_garden();
  test::remove_lamps(scene, [](const scene::Lamp &lamp) { return lamp.name > "lamp1"; });
  // Low between the boxes: ahead, and behind.
  const scene::PlacedCamera ahead = test::camera_at({0, 0.2F, 1}, {0, 9, 1}, 0.5F);
  const scene::PlacedCamera behind = test::camera_at({0, 0.2F, 1}, {0, -9, 0.5F}, 0.5F);
  Renderer renderer(*device, scene, {48, 32}, settings);
  const Picture first = renderer.picture(ahead);
  const ShadowCounters before = renderer.inspect().report().shadow_counters;
  EXPECT_GT(before.faces_skipped, 0U);
  const Picture turned = renderer.picture(behind);
  const ShadowCounters after = renderer.inspect().report().shadow_counters;
  EXPECT_GT(after.faces_drawn, before.faces_drawn);
  EXPECT_LE(after.faces_drawn, 12U) << "none twice";
  EXPECT_EQ(turned.pixels, fresh_picture(behind).pixels);
  EXPECT_EQ(renderer.picture(ahead).pixels, first.pixels) << "what was drawn before is still there";
}

/** A sun's cascades, newly drawn for a camera. */
struct Cascades {
  std::vector<shared::ShadowMapData> maps;
  std::vector<std::vector<float>> texels;

  Cascades(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera,
           const ShadowSettings &settings)
  {
    Renderer renderer(device, scene, {48, 32}, {.shadow = settings});
    renderer.draw(camera);
    const Shadows &shadows = renderer.inspect().shadows();
    for (int i = 0; i < shadows.block_data().maps[0].cascade_count; i++) {
      maps.push_back(shadows.block_data().maps[i]);
      texels.push_back(gpu::read_as<float>(device, shadows.scene().maps(), maps.back().layer));
    }
  }

  /** The result of the finest cascade that contains a point. */
  struct Lookup {
    /** -1 if no cascade contains it, or if it is too near the edge of its texel. */
    int cascade = -1;
    bool is_lit = true;
  };
  [[nodiscard]] Lookup at(const glm::vec3 &point) const
  {
    for (std::size_t i = 0; i < maps.size(); i++) {
      const int size = maps[i].size_px;
      const glm::dvec4 texco = glm::dmat4(maps[i].texco_from_world) * glm::dvec4(point, 1.0);
      const glm::dvec2 texel = glm::dvec2(texco) * double(size);
      // Inside the region that does not fade into the next cascade.
      if (std::min({texco.x, texco.y, 1.0 - texco.x, 1.0 - texco.y}) < 0.06) {
        continue;
      }
      const glm::dvec2 fraction = texel - glm::floor(texel);
      if (std::min({fraction.x, fraction.y, 1.0 - fraction.x, 1.0 - fraction.y}) < 1e-2) {
        return {};
      }
      const std::size_t index = std::size_t(texel.y) * std::size_t(size) + std::size_t(texel.x);
      return {int(i), double(texels[i][index]) < texco.z + 1e-4};
    }
    return {};
  }
};

TEST_F(ShadowLayersGpuTest, ACameraMovedByFractionsOfATexelChangesNoStaticShadow)
{
  add(square, {0, 0, 0}, glm::vec3(200));
  for (int i = 0; i < 200; i++) {
    add(box, {-60.0F + 13.1F * float(i % 10), -10.0F + 12.3F * float(i / 10), 3.2F},
        glm::vec3(1.4F, 1.3F, 0.2F + 0.3F * float(i % 7)));
  }
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0.5F, 0.3F, -1}, 1.0F);
  const ShadowSettings settings{.map_size_px = 128, .cascades = {.count = 4}};
  const scene::PlacedCamera still = test::camera_at({0, -14, 6}, {0, 0, 1}, 0.9F);
  const Cascades before(*device, scene, still, settings);
  ASSERT_EQ(before.maps.size(), 4U);
  const float texel = before.maps[0].texel_size;
  for (const float share : {0.13F, 0.37F, 0.61F, 0.99F}) {
    scene::PlacedCamera moved = still;
    moved.world_from_camera[3] += glm::dvec4(share * texel, 0.7F * share * texel, 0.2F * share * texel, 0);
    const Cascades after(*device, scene, moved, settings);
    ASSERT_EQ(after.maps.size(), 4U);
    int compared = 0;
    int dark = 0;
    int changed = 0;
    for (int i = 0; i < 40000; i++) {
      const glm::vec3 point(-20.0F + 0.2F * float(i % 200), -10.0F + 0.6F * float(i / 200), 0);
      const Cascades::Lookup old_lookup = before.at(point);
      const Cascades::Lookup new_lookup = after.at(point);
      if (old_lookup.cascade >= 0 && old_lookup.cascade == new_lookup.cascade) {
        compared++;
        dark += old_lookup.is_lit ? 0 : 1;
        changed += old_lookup.is_lit == new_lookup.is_lit ? 0 : 1;
      }
    }
    EXPECT_GT(compared, 20000);
    EXPECT_GT(dark, 500);
    // Rasterisers round vertices to 1/256 of a texel, so an edge this near to a texel's centre may be on either side.
    EXPECT_LE(changed, compared / 10000) << "of " << compared << " points, the camera moved by " << share << " texels";
  }
}

}  // namespace
}  // namespace gnomon::eevee
