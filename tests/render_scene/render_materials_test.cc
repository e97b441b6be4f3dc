// SPDX-License-Identifier: MIT
#include "render_materials.hh"

#include "internal/measure_scene.hh"

#include "eevee_bsdf_shared.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gnomon::render_scene {
namespace {

TEST(MaterialData, BlackSpecularIsLambertian)
{
  scene::Material material;
  material.metallic = 0.0F;
  material.specular_color = glm::vec3(0.0F);
  material.base_color = {0.2F, 0.4F, 0.6F};
  const shared::MaterialData data = material_data(material, false);
  EXPECT_EQ(data.diffuse, material.base_color);
  EXPECT_EQ(data.specular_f0, glm::vec3(0.0F));
  EXPECT_EQ(data.specular_f90, 0.0F);
}

TEST(MaterialData, DielectricReflectsFourPercent)
{
  scene::Material material;
  material.metallic = 0.0F;
  const shared::MaterialData data = material_data(material, false);
  EXPECT_EQ(data.specular_f0, glm::vec3(0.04F));
  EXPECT_EQ(data.specular_f90, 1.0F);
}

TEST(MaterialData, MetalReflectsItsColourAndScattersNothing)
{
  scene::Material material;
  material.base_color = {0.9F, 0.6F, 0.3F};
  const shared::MaterialData data = material_data(material, false);
  EXPECT_EQ(data.diffuse, glm::vec3(0.0F));
  EXPECT_EQ(data.specular_f0, material.base_color);
}

TEST(MaterialData, RoughnessIsSquaredAndNeverZero)
{
  scene::Material material;
  material.roughness = 0.5F;
  EXPECT_FLOAT_EQ(material_data(material, false).alpha, 0.25F);
  material.roughness = 0.0F;
  EXPECT_EQ(material_data(material, false).alpha, shared::ALPHA_MIN);
}

TEST(MaterialData, TintIsTheMaterialOfTheProduct)
{
  const glm::vec3 tint(0.5F, 0.25F, 0.03125F);
  for (const float metallic : {0.0F, 0.5F, 1.0F}) {
    for (const float specular : {0.0F, 1.0F}) {
      scene::Material material;
      material.base_color = {0.75F, 0.5F, 1.0F};
      material.metallic = metallic;
      material.specular = specular;
      const shared::MaterialData tinted = shared::tinted(material_data(material, false), tint);
      material.base_color *= tint;
      const shared::MaterialData expected = material_data(material, false);
      for (int c = 0; c < 3; c++) {
        EXPECT_FLOAT_EQ(tinted.diffuse[c], expected.diffuse[c]);
        EXPECT_NEAR(tinted.specular_f0[c], expected.specular_f0[c], 1e-7F);
      }
      EXPECT_NEAR(tinted.specular_f90, expected.specular_f90, 5e-6F);
      EXPECT_GE(std::min({tinted.specular_f0.x, tinted.specular_f0.y, tinted.specular_f0.z}), 0.0F);
    }
  }
}

TEST(MaterialData, OfAMaskTheTextureDecidesOnlyWhereItCan)
{
  scene::Scene scene;
  scene::Material material;
  const auto mask_cutoff = [&] { return material_data(material, is_masked(scene, material)).mask_cutoff; };
  material.alpha_mode = scene::AlphaMode::Mask;
  material.alpha = 0.8F;
  // Without a texture all of it is above the cutoff, or none.
  EXPECT_TRUE(is_drawable(material) && !is_masked(scene, material));
  material.alpha_cutoff = 0.9F;
  EXPECT_FALSE(is_drawable(material) || is_masked(scene, material));
  material.base_color_texture = measure::add_texture(scene, 1, {255, 255, 255, 255});
  EXPECT_FALSE(is_drawable(material) || is_masked(scene, material));
  material.alpha_cutoff = 0.4F;
  EXPECT_TRUE(is_drawable(material) && is_masked(scene, material));
  EXPECT_EQ(mask_cutoff(), 0.5F) << "of the texture's alpha, which is multiplied by 0.8";
  material.alpha_cutoff = 0.0F;
  EXPECT_TRUE(is_drawable(material) && !is_masked(scene, material));
  EXPECT_EQ(mask_cutoff(), 0.0F);
  material.alpha_cutoff = 0.4F;
  material.alpha_mode = scene::AlphaMode::Opaque;
  EXPECT_TRUE(is_drawable(material) && !is_masked(scene, material));
  EXPECT_EQ(mask_cutoff(), 0.0F);
}

TEST(MaterialData, AMaskWhoseTextureOrImageWasRemovedCutsNothingOut)
{
  for (const bool is_image_removed : {false, true}) {
    scene::Scene scene;
    scene::Material material;
    material.alpha_mode = scene::AlphaMode::Mask;
    material.base_color_texture = measure::add_texture(scene, 1, {255, 255, 255, 255});
    ASSERT_TRUE(is_masked(scene, material));
    if (is_image_removed) {
      scene.remove(scene.images().first());
    }
    else {
      scene.remove(material.base_color_texture);
    }
    EXPECT_FALSE(is_masked(scene, material));
    EXPECT_TRUE(is_drawable(material));
  }
}

}  // namespace
}  // namespace gnomon::render_scene
