// SPDX-License-Identifier: MIT
// Layers that an edit keeps have the same texels as those of a fresh scene, on the driver.
#include "eevee_test_scene.hh"
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"
#include "shadows/shadows.hh"

#include <gtest/gtest.h>

namespace gnomon::eevee {
namespace {

using ShadowEditsGpuTest = test::SharedDeviceTest;

TEST_F(ShadowEditsGpuTest, LayersKeepTheirTexelsWhereTheirArrayGrowsAndShrinks)
{
  for (const scene::ShadowKind kind : {scene::ShadowKind::Hard, scene::ShadowKind::Esm}) {
    scene::Scene scene;
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1.0), glm::dvec3(10)));
    const auto box = test::add_box_mesh(scene, material);
    for (const float x : {-3.0F, 0.0F, 3.0F}) {
      test::add_object(scene, box, glm::translate(glm::dmat4(1.0), glm::dvec3(x, 0, 1.5)));
    }
    test::add_lamp(scene, scene::LampKind::Point, {-2, -2, 4}, {0, 0, -1}, 20.0F);
    const auto narrow = [](scene::Lamp &lamp) { lamp.spot_outer_angle = 0.6F; };
    scene.edit(test::add_lamp(scene, scene::LampKind::Spot, {2, -2, 5}, {0, 0, -1}, 30.0F), narrow);
    Settings settings;
    settings.shadow.kind = kind;
    settings.shadow.cube_size_px = settings.shadow.map_size_px = 64;
    settings.shadow.esm.size_px = 32;
    const scene::PlacedCamera camera = test::camera_at({0, -12, 9}, {0, 0, 0}, 0.9F);
    test::Renderer renderer(*device, scene, {64, 48}, settings);
    renderer.draw(camera);
    const auto expect_as_fresh = [&](const char *edit, std::uint64_t updated) {
      const std::uint64_t before = renderer.inspect().shadows().counters().lamps_updated;
      renderer.sync();
      const test::Picture edited = renderer.picture(camera);
      EXPECT_EQ(renderer.inspect().shadows().counters().lamps_updated, before + updated) << edit;
      test::Renderer fresh(*device, scene, {64, 48}, settings);
      EXPECT_EQ(edited.pixels, fresh.picture(camera).pixels) << edit << ", bit for bit";
    };
    scene.edit(test::add_lamp(scene, scene::LampKind::Point, {3, 2, 4}, {0, 0, -1}, 10.0F), [](scene::Lamp &lamp) {
      lamp.shadow.size = 128;
      lamp.shadow.esm_size = 64;
    });
    scene.edit(test::add_lamp(scene, scene::LampKind::Spot, {-2, 2, 5}, {0, 0, -1}, 30.0F), narrow);
    expect_as_fresh("two lamps more, one with larger layers", 2);
    for (int i = 0; i < 2; i++) {
      scene.remove(scene.placed_lamps().back().node);
    }
    expect_as_fresh("two lamps less", 0);
    scene.edit(scene.lamps().first(), [](scene::Lamp &lamp) { lamp.intensity *= 2.0F; });
    expect_as_fresh("a brighter lamp", 0);
  }
}

TEST_F(ShadowEditsGpuTest, NearPlaneDependsOnTheCastersAlone)
{
  for (const int sample_count : {1, 4}) {
    scene::Scene scene;
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1.0), glm::dvec3(10)));
    const auto box = test::add_object(scene, test::add_box_mesh(scene, material), glm::dmat4(1.0));
    scene.edit(test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 40.0F),
               [](scene::Lamp &lamp) { lamp.radius = 0.5F; });
    Settings settings = offline_settings(sample_count);
    settings.shadow.cube_size_px = 128;
    const scene::PlacedCamera camera = test::camera_at({0, -12, 9}, {0, 0, 0}, 0.9F);
    test::Renderer renderer(*device, scene, {64, 48}, settings);
    for (const double height : {0.0, 1.0, 1.5, 2.2, 1.0, -0.5}) {
      scene.set_transform(box, glm::translate(glm::dmat4(1.0), glm::dvec3(0.5, 0, height)));
      renderer.sync();
      const test::Picture edited = renderer.picture(camera);
      test::Renderer fresh(*device, scene, {64, 48}, settings);
      EXPECT_EQ(edited.pixels, fresh.picture(camera).pixels)
          << height << ", " << sample_count << " samples, bit for bit";
    }
  }
}

}  // namespace
}  // namespace gnomon::eevee
