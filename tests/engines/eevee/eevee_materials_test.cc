// SPDX-License-Identifier: MIT
#include "eevee_materials.hh"

#include "eevee_bsdf_shared.h"

#include <gtest/gtest.h>

namespace gnomon::eevee {
namespace {

TEST(MaterialData, BlackSpecularIsLambertian)
{
  scene::Material material;
  material.metallic = 0.0F;
  material.specular_color = glm::vec3(0.0F);
  material.base_color = {0.2F, 0.4F, 0.6F};
  const shared::MaterialData data = material_data(material);
  EXPECT_EQ(data.diffuse, material.base_color);
  EXPECT_EQ(data.specular_f0, glm::vec3(0.0F));
  EXPECT_EQ(data.specular_f90, 0.0F);
  EXPECT_EQ(material_features({data}), Feature::None);
}

TEST(MaterialData, DielectricReflectsFourPercent)
{
  scene::Material material;
  material.metallic = 0.0F;
  const shared::MaterialData data = material_data(material);
  EXPECT_EQ(data.specular_f0, glm::vec3(0.04F));
  EXPECT_EQ(data.specular_f90, 1.0F);
  EXPECT_EQ(material_features({data}), Feature::Specular);
}

TEST(MaterialData, MetalReflectsItsColourAndScattersNothing)
{
  scene::Material material;
  material.base_color = {0.9F, 0.6F, 0.3F};
  const shared::MaterialData data = material_data(material);
  EXPECT_EQ(data.diffuse, glm::vec3(0.0F));
  EXPECT_EQ(data.specular_f0, material.base_color);
}

TEST(MaterialData, RoughnessIsSquaredAndNeverZero)
{
  scene::Material material;
  material.roughness = 0.5F;
  EXPECT_FLOAT_EQ(material_data(material).alpha, 0.25F);
  material.roughness = 0.0F;
  EXPECT_EQ(material_data(material).alpha, shared::ALPHA_MIN);
}

}  // namespace
}  // namespace gnomon::eevee
