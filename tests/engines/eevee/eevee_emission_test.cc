// SPDX-License-Identifier: MIT
// What the light of emissive surfaces creates and runs, by the backend's names.
#include "eevee_test_scene.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>

namespace gnomon::eevee {
namespace {

/** The resources and passes of a picture of a square with that emission, under a sun. */
std::set<std::string> names_of(const glm::vec3 &emissive, const Settings &settings)
{
  scene::Scene scene;
  const auto material = test::add_material(scene, glm::vec3(1.0F));
  scene.edit(material, [&](scene::Material &value) { value.emissive = emissive; });
  test::add_object(scene, test::add_square_mesh(scene, material), glm::dmat4(1.0));
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0.2F, 0.1F, -1}, 1.0F);
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  test::Renderer renderer(*device, scene, {8, 8}, settings);
  renderer.draw(test::camera_at({0, -1, 3}, {0, 0, 0}));
  std::set<std::string> names;
  for (const gpu::LiveResource &live : device->live()) {
    names.insert(live.name + " " + live.detail);
  }
  for (const auto &[name, count] : device->pass_counts()) {
    names.insert(name);
  }
  return names;
}

TEST(Emission, WithoutPointsIsThatOfASceneWithoutEmission)
{
  const glm::vec3 black(0.0F);
  const glm::vec3 bright(2.0F);
  EXPECT_EQ(names_of(bright, {.sample_count = 1}), names_of(black, {.sample_count = 1}));
  EXPECT_EQ(names_of(bright, {.sample_count = 4, .emissive_point_count = 0}), names_of(black, {.sample_count = 4}));
  const std::set<std::string> all = names_of(bright, {.sample_count = 4});
  EXPECT_NE(all, names_of(black, {.sample_count = 4}));
  EXPECT_TRUE(std::ranges::any_of(all, [](const std::string &name) { return name.starts_with("shadow_cubes"); }));
}

TEST(Emission, ChecksTheNumberOfPoints)
{
  EXPECT_THROW(names_of(glm::vec3(1.0F), {.sample_count = 4, .emissive_point_count = -1}), gpu::Error);
  EXPECT_THROW(names_of(glm::vec3(1.0F), {.sample_count = 4, .emissive_point_count = emissive_point_max + 1}),
               gpu::Error);
}

}  // namespace
}  // namespace gnomon::eevee
