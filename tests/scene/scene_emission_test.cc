// SPDX-License-Identifier: MIT
#include "scene_emission.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <cmath>

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
  material.emissive = glm::vec3(3e38F);
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

}  // namespace
}  // namespace gnomon::scene
