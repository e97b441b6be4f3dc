// SPDX-License-Identifier: MIT
#include "scene_emission.hh"
#include "scene_animation.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace gnomon::scene {
namespace {

/** A square from -1 to 1 with the whole image, scaled by 3 along x: 12 m². */
class EmissiveSurfacesTest : public testing::Test {
 protected:
  EmissiveSurfacesTest()
  {
    mesh.name = "square";
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    material.emissive = {2.0F, 1.0F, 0.5F};
  }
  TextureSlot image(std::uint32_t width, std::vector<std::uint8_t> texels)
  {
    const auto height = std::uint32_t(texels.size() / 4 / width);
    return {scene.add(Texture{.image = scene.add(Image{"image", width, height, std::move(texels)})})};
  }
  EmissiveSurfaces surfaces()
  {
    mesh.material = scene.add(material);
    Node node;
    node.meshes = {scene.add(mesh)};
    node.parent_from_node = glm::scale(glm::dmat4(1.0), glm::dvec3(3, 1, 1));
    scene.add(node);
    return {scene, scene.objects()};
  }
  /** Calls \a visit with 4096 points at even places. */
  template <typename Visit>
  static void for_each_point(const EmissiveSurfaces &surfaces, Visit &&visit)
  {
    for (int i = 0; i < 4096; i++) {
      visit(surfaces.at((glm::dvec3(i % 16, i / 16 % 16, i / 256) + 0.5) / 16.0));
    }
  }

  Scene scene;
  Material material;
  Mesh mesh;
};

TEST_F(EmissiveSurfacesTest, PlainTrianglesHaveTheirAreaAndRadiance)
{
  const EmissiveSurfaces found = surfaces();
  EXPECT_EQ(found.patch_count(), 2U);
  glm::dvec3 mean(0.0);
  for_each_point(found, [&](const EmissivePoint &point) {
    EXPECT_EQ(point.radiance, glm::dvec3(2.0, 1.0, 0.5));
    EXPECT_NEAR(point.area, 12.0, 1e-9);
    EXPECT_EQ(std::abs(point.normal.z), 1.0);
    EXPECT_LE(std::abs(point.position.x), 3.0);
    mean += point.position / 4096.0;
  });
  // Even over the square; the root of the even places is too small at its ends.
  EXPECT_NEAR(mean.x, 0.0, 0.01);
  EXPECT_NEAR(mean.y, 0.0, 0.01);
}

TEST_F(EmissiveSurfacesTest, PointsFollowThePowerOfTheTexture)
{
  // A bright red quarter, a darker green one, and two black ones.
  material.emissive = glm::vec3(1.0F);
  material.emissive_texture = image(2, {255, 0, 0, 255, 0, 128, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255});
  const EmissiveSurfaces found = surfaces();
  const double green = std::pow((128.0 / 255.0 + 0.055) / 1.055, 2.4);
  glm::dvec3 power(0.0);
  int green_count = 0;
  for_each_point(found, [&](const EmissivePoint &point) {
    power += point.area * point.radiance / 4096.0;
    // The upper half of the image is that of y > 0.
    EXPECT_GT(point.position.y, -1.0 / 24.0);
    green_count += point.radiance.g > 0.0 ? 1 : 0;
  });
  // Means over patches at the edges of the quarters, and 16 strata of the place in the table.
  EXPECT_NEAR(power.r, 3.0, 0.25);
  EXPECT_NEAR(power.g, 3.0 * green, 0.25);
  EXPECT_NEAR(power.r + power.g, 3.0 * (1.0 + green), 1e-3);
  EXPECT_NEAR(green_count / 4096.0, green / (1.0 + green), 0.08);
}

TEST_F(EmissiveSurfacesTest, TransparentPartsEmitAsMuchLess)
{
  material.base_color_texture = image(2, {255, 255, 255, 255, 255, 255, 255, 0});
  const auto red = [&] {
    double sum = 0.0;
    for_each_point(surfaces(), [&](const EmissivePoint &point) { sum += point.area * point.radiance.r / 4096.0; });
    return sum;
  };
  EXPECT_NEAR(red(), 24.0, 1e-6);
  scene = Scene();
  material.base_color_texture = image(2, {255, 255, 255, 255, 255, 255, 255, 0});
  material.alpha_mode = AlphaMode::Mask;
  EXPECT_NEAR(red(), 12.0, 0.3);
  scene = Scene();
  material.base_color_texture = {};
  material.alpha_mode = AlphaMode::Blend;
  material.alpha = 0.25F;
  EXPECT_NEAR(red(), 6.0, 1e-6);
}

TEST_F(EmissiveSurfacesTest, WhatEmitsNoLightHasNoPatches)
{
  EXPECT_FALSE(has_emission(scene));
  material.emissive = glm::vec3(0.0F);
  EXPECT_TRUE(surfaces().empty());
  EXPECT_FALSE(has_emission(scene));
  material.emissive = glm::vec3(1.0F);
  material.is_unlit = true;
  EXPECT_TRUE(surfaces().empty());
  material.is_unlit = false;
  mesh.uvs.clear();
  material.emissive_texture = image(1, {255, 255, 255, 255});
  EXPECT_TRUE(surfaces().empty()) << "the texture has no place on the mesh";
  EXPECT_TRUE(has_emission(scene));
}

TEST_F(EmissiveSurfacesTest, PatchesAreBoundedAndFinite)
{
  material.emissive = glm::vec3(float(light_max));
  material.emissive_texture = image(1, {255, 255, 255, 255});
  for (glm::vec2 &uv : mesh.uvs) {
    uv *= 1e6F;
  }
  for (int i = 0; i < 20; i++) {
    mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
  }
  const EmissiveSurfaces found = surfaces();
  EXPECT_GT(found.patch_count(), 1000U);
  EXPECT_LE(found.patch_count(), EmissiveSurfaces::patch_count_max);
  for_each_point(found, [](const EmissivePoint &point) {
    EXPECT_TRUE(std::isfinite(point.area) && point.area > 0.0);
    EXPECT_TRUE(std::isfinite(float(point.radiance.r)));
  });
}

TEST_F(EmissiveSurfacesTest, TheStateChangesWithWhatEmits)
{
  EXPECT_EQ(emission_state(scene), EmissionState());
  material.emissive_texture = image(1, {255, 255, 255, 255});
  surfaces();
  const auto emitter = scene.nodes().first();
  const auto emissive = scene.materials().first();
  const auto emissive_mesh = scene.meshes().first();
  const auto black = scene.add(Material());
  mesh.material = black;
  const auto other_mesh = scene.add(mesh);
  Node node;
  node.meshes = {other_mesh};
  const auto other = scene.add(node);
  const auto parent = scene.add(Node());
  node.is_visible = false;
  const auto twin = scene.add(node);

  EmissionState state = emission_state(scene);
  EXPECT_EQ(state.object_count, 1U);
  const auto is_changed = [&] {
    const EmissionState before = std::exchange(state, emission_state(scene));
    return before != state;
  };
  scene.set_transform(other, glm::translate(glm::dmat4(1.0), {1, 2, 3}));
  scene.edit(other_mesh, [](Mesh &value) { value.positions[0].x -= 1.0F; });
  scene.edit(black, [](Material &value) { value.base_color = glm::vec3(0.5F); });
  scene.edit(other, [](Node &value) { value.is_visible = false; });
  scene.edit(other, [](Node &value) { value.is_visible = true; });
  EXPECT_FALSE(is_changed());

  scene.set_transform(emitter, glm::translate(glm::dmat4(1.0), {1, 2, 3}));
  EXPECT_TRUE(is_changed());
  scene.set_parent(emitter, parent);
  is_changed();
  scene.set_transform(parent, glm::translate(glm::dmat4(1.0), {1, 2, 3}));
  EXPECT_TRUE(is_changed());
  scene.edit(emissive_mesh, [](Mesh &value) { value.positions[0].x -= 1.0F; });
  EXPECT_TRUE(is_changed());
  scene.edit(emissive, [](Material &value) { value.emissive *= 2.0F; });
  EXPECT_TRUE(is_changed());
  scene.edit(emissive, [](Material &value) { value.alpha_mode = AlphaMode::Mask; });
  EXPECT_TRUE(is_changed());
  scene.edit(emissive, [](Material &value) { value.emissive_texture.offset.x = 0.5F; });
  EXPECT_TRUE(is_changed());
  scene.edit(scene.textures().first(), [](Texture &value) { value.wrap_u = TextureWrap::ClampToEdge; });
  EXPECT_TRUE(is_changed());
  scene.edit(scene.images().first(), [](Image &value) { value.texels[0] = 0; });
  EXPECT_TRUE(is_changed());
  // One object leaves and another joins.
  scene.edit(emissive_mesh, [&](Mesh &value) { value.material = black; });
  scene.edit(other_mesh, [&](Mesh &value) { value.material = emissive; });
  EXPECT_TRUE(is_changed());
  EXPECT_EQ(state.object_count, 1U);
  scene.edit(other, [](Node &value) { value.is_visible = false; });
  EXPECT_TRUE(is_changed());
  scene.edit(other, [](Node &value) { value.is_visible = true; });
  EXPECT_TRUE(is_changed());
  // One is hidden and an older one is shown.
  scene.edit(other, [](Node &value) { value.is_visible = false; });
  scene.edit(twin, [](Node &value) { value.is_visible = true; });
  EXPECT_TRUE(is_changed());
  EXPECT_EQ(state.object_count, 1U);
  scene.remove(emissive);
  EXPECT_TRUE(is_changed());
  EXPECT_EQ(state, EmissionState());
}

TEST_F(EmissiveSurfacesTest, DeformedMeshesEmitFromTheirPose)
{
  surfaces();
  const auto node = scene.nodes().first();
  const auto deformed = scene.meshes().first();
  const EmissionState rest = emission_state(scene);
  DeformedMesh shape;
  shape.mesh = deformed;
  shape.node = node;
  shape.positions = mesh.positions;
  shape.normals = mesh.normals;
  shape.targets = {{std::vector<glm::vec3>(4, {0, 0, 5}), {}, {}}};
  shape.weights = {1.0};
  scene.deformed_meshes.push_back(shape);
  deform_meshes(scene);
  EXPECT_NE(emission_state(scene), rest);
  EXPECT_NEAR(EmissiveSurfaces(scene, scene.objects()).at({0.5, 0.5, 0.5}).position.z, 5.0, 1e-6);
  // A pose of a mesh that a host deforms on the device is left out, and so is its light.
  scene.replace(deformed, Mesh{.name = "of the host",
                               .material = scene.meshes()[deformed].material,
                               .host_shape = HostShape{.bounds = {{-1, -1, -1}, {1, 1, 1}}}});
  scene.deformed_meshes.front().weights = {0.5};
  deform_meshes(scene);
  EXPECT_TRUE(scene.meshes()[deformed].positions.empty());
  EXPECT_TRUE(EmissiveSurfaces(scene, scene.objects()).empty());
}

}  // namespace
}  // namespace gnomon::scene
