// SPDX-License-Identifier: MIT
#include "render_materials.hh"

#include "measure_scene.hh"

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
  const shared::MaterialData data = material_data(material);
  EXPECT_EQ(data.diffuse, material.base_color);
  EXPECT_EQ(data.specular_f0, glm::vec3(0.0F));
  EXPECT_EQ(data.specular_f90, 0.0F);
}

TEST(MaterialData, DielectricReflectsFourPercent)
{
  scene::Material material;
  material.metallic = 0.0F;
  const shared::MaterialData data = material_data(material);
  EXPECT_EQ(data.specular_f0, glm::vec3(0.04F));
  EXPECT_EQ(data.specular_f90, 1.0F);
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

TEST(MaterialData, TintIsTheMaterialOfTheProduct)
{
  const glm::vec3 tint(0.5F, 0.25F, 0.03125F);
  for (const float metallic : {0.0F, 0.5F, 1.0F}) {
    for (const float specular : {0.0F, 1.0F}) {
      scene::Material material;
      material.base_color = {0.75F, 0.5F, 1.0F};
      material.metallic = metallic;
      material.specular = specular;
      const shared::MaterialData tinted = shared::tinted(material_data(material), tint);
      material.base_color *= tint;
      const shared::MaterialData expected = material_data(material);
      for (int c = 0; c < 3; c++) {
        EXPECT_FLOAT_EQ(tinted.diffuse[c], expected.diffuse[c]);
        EXPECT_NEAR(tinted.specular_f0[c], expected.specular_f0[c], 1e-7F);
      }
      EXPECT_NEAR(tinted.specular_f90, expected.specular_f90, 5e-6F);
      EXPECT_GE(std::min({tinted.specular_f0.x, tinted.specular_f0.y, tinted.specular_f0.z}), 0.0F);
    }
  }
}

/** A scene with one square, whose material tests edit. */
struct SquareScene {
  scene::Scene scene;
  scene::Handle<scene::Material> material = measure::add_material(scene, glm::vec3(0.5F));
  scene::Handle<scene::Texture> texture = measure::add_texture(scene, 1, {255, 255, 255, 255});
  scene::Handle<scene::Mesh> mesh = measure::add_square_mesh(scene, material);

  template <typename Change>
  void edit(Change &&change)
  {
    scene.edit(material, change);
  }
  template <typename Change>
  void edit_mesh(Change &&change)
  {
    scene.edit(mesh, change);
  }
  [[nodiscard]] bool is_masked() const
  {
    return render_scene::is_masked(scene, scene.meshes()[mesh]);
  }
  [[nodiscard]] bool is_drawable() const
  {
    return render_scene::is_drawable(scene.materials()[material]);
  }
  [[nodiscard]] MaterialClass material_class() const
  {
    return render_scene::material_class(scene, scene.meshes()[mesh]);
  }
  [[nodiscard]] float mask_cutoff() const
  {
    return material_data(scene.materials()[material]).mask_cutoff;
  }
};

void add_uvs(scene::Mesh &mesh)
{
  mesh.uvs.assign(mesh.positions.size(), glm::vec2(0.0F));
}

TEST(MaterialData, OfAMaskTheTextureDecidesOnlyWhereItCan)
{
  SquareScene square;
  square.edit([](scene::Material &material) {
    material.alpha_mode = scene::AlphaMode::Mask;
    material.alpha = 0.8F;
  });
  square.edit_mesh(add_uvs);
  // Without a texture all of it is above the cutoff, or none.
  EXPECT_TRUE(square.is_drawable() && !square.is_masked());
  square.edit([](scene::Material &material) { material.alpha_cutoff = 0.9F; });
  EXPECT_FALSE(square.is_drawable() || square.is_masked());
  square.edit([&](scene::Material &material) { material.base_color_texture = square.texture; });
  EXPECT_FALSE(square.is_drawable() || square.is_masked());
  square.edit([](scene::Material &material) { material.alpha_cutoff = 0.4F; });
  EXPECT_TRUE(square.is_drawable() && square.is_masked());
  EXPECT_EQ(square.mask_cutoff(), 0.5F) << "of the texture's alpha, which is multiplied by 0.8";
  square.edit([](scene::Material &material) { material.alpha_cutoff = 0.0F; });
  EXPECT_TRUE(square.is_drawable() && !square.is_masked());
  EXPECT_EQ(square.mask_cutoff(), 0.0F);
  square.edit([](scene::Material &material) {
    material.alpha_cutoff = 0.4F;
    material.alpha_mode = scene::AlphaMode::Opaque;
  });
  EXPECT_TRUE(square.is_drawable() && !square.is_masked());
  EXPECT_EQ(square.mask_cutoff(), 0.0F);
}

TEST(MaterialData, VertexColoursDecideOfAMaskToo)
{
  SquareScene square;
  square.edit([](scene::Material &material) { material.alpha_mode = scene::AlphaMode::Mask; });
  EXPECT_FALSE(square.is_masked());
  square.edit_mesh([](scene::Mesh &mesh) { mesh.colors.assign(4, glm::vec4(0.25F)); });
  EXPECT_TRUE(square.is_masked());
}

TEST(MaterialData, AMaskWhoseTextureOrImageWasRemovedCutsNothingOut)
{
  for (const bool is_image_removed : {false, true}) {
    SquareScene square;
    square.edit([&](scene::Material &material) {
      material.alpha_mode = scene::AlphaMode::Mask;
      material.base_color_texture = square.texture;
    });
    square.edit_mesh(add_uvs);
    ASSERT_TRUE(square.is_masked());
    if (is_image_removed) {
      square.scene.remove(square.scene.images().first());
    }
    else {
      square.scene.remove(square.texture);
    }
    EXPECT_FALSE(square.is_masked());
    EXPECT_TRUE(square.is_drawable());
  }
}

TEST(MaterialClassTest, EachInputHasTheLeastClassThatReadsIt)
{
  SquareScene square;
  EXPECT_EQ(square.material_class(), MaterialClass::Plain);
  square.edit([&](scene::Material &material) { material.base_color_texture = square.texture; });
  EXPECT_EQ(square.material_class(), MaterialClass::Plain) << "the mesh has no uvs";
  square.edit_mesh(add_uvs);
  EXPECT_EQ(square.material_class(), MaterialClass::BaseColor);
  square.edit([](scene::Material &material) { material.base_color_texture.scale.x = 2.0F; });
  EXPECT_EQ(square.material_class(), MaterialClass::Full);
  square.edit([](scene::Material &material) {
    material.base_color_texture.scale.x = 1.0F;
    material.base_color_texture.uv_set = 1;
  });
  EXPECT_EQ(square.material_class(), MaterialClass::Plain) << "the mesh has no second uvs";
  square.edit_mesh([](scene::Mesh &mesh) { mesh.second_uvs = mesh.uvs; });
  EXPECT_EQ(square.material_class(), MaterialClass::Full);
  square.edit([&](scene::Material &material) {
    material.base_color_texture = {};
    material.normal_texture = square.texture;
  });
  EXPECT_EQ(square.material_class(), MaterialClass::Plain) << "the mesh has no tangents";
  square.edit_mesh([](scene::Mesh &mesh) { mesh.tangents.assign(4, {1, 0, 0, 1}); });
  EXPECT_EQ(square.material_class(), MaterialClass::Full);
  square.edit([](scene::Material &material) { material.normal_texture = {}; });
  EXPECT_EQ(square.material_class(), MaterialClass::Plain);
  square.edit_mesh([](scene::Mesh &mesh) { mesh.colors.assign(4, glm::vec4(1.0F)); });
  EXPECT_EQ(square.material_class(), MaterialClass::Full);
  square.edit([&](scene::Material &material) {
    material.coat_roughness = 0.5F;
    material.coat_texture = square.texture;
    material.sheen_roughness = 0.5F;
  });
  EXPECT_EQ(square.material_class(), MaterialClass::Full) << "it has neither a coat nor sheen";
  square.edit([](scene::Material &material) { material.coat = 0.5F; });
  EXPECT_EQ(square.material_class(), MaterialClass::Layered);
  square.edit([](scene::Material &material) {
    material.coat = 0.0F;
    material.anisotropy = 0.5F;
  });
  EXPECT_EQ(square.material_class(), MaterialClass::Layered);
  square.edit_mesh([](scene::Mesh &mesh) { mesh.tangents.clear(); });
  EXPECT_EQ(square.material_class(), MaterialClass::Full) << "it has no tangents";
  square.edit([](scene::Material &material) { material.transmission = 0.5F; });
  EXPECT_EQ(square.material_class(), MaterialClass::Transmissive);
  square.edit([](scene::Material &material) { material.is_unlit = true; });
  EXPECT_EQ(square.material_class(), MaterialClass::Full);
}

TEST(LayerData, HasTheFactorsAndTheUvsOfItsTextures)
{
  scene::Material material;
  material.coat = 0.25F;
  material.coat_roughness = 0.5F;
  material.sheen_color = {0.1F, 0.2F, 0.3F};
  material.sheen_roughness = 0.75F;
  material.coat_texture.offset = {1.0F, 2.0F};
  material.sheen_roughness_texture.uv_set = 1;
  const shared::LayerData data = layer_data(material);
  EXPECT_EQ(data.coat, 0.25F);
  EXPECT_EQ(data.coat_roughness, 0.5F);
  EXPECT_EQ(data.sheen_color, material.sheen_color);
  EXPECT_EQ(data.sheen_roughness, 0.75F);
  EXPECT_EQ(data.uv_rows[0], glm::vec4(1, 0, 1, 0));
  EXPECT_EQ(data.uv_rows[1], glm::vec4(0, 1, 2, 0));
  EXPECT_EQ(data.uv_rows[6].w, 1.0F);
}

TEST(LayerData, HasTheDirectionOfTheAnisotropy)
{
  scene::Material material;
  material.anisotropy = 0.25F;
  material.anisotropy_rotation = 0.5F;
  material.anisotropy_texture.uv_set = 1;
  const shared::LayerData data = layer_data(material);
  EXPECT_FLOAT_EQ(data.anisotropy.x, std::cos(0.5F));
  EXPECT_FLOAT_EQ(data.anisotropy.y, std::sin(0.5F));
  EXPECT_EQ(data.anisotropy.z, 0.25F);
  EXPECT_EQ(data.uv_rows[8].w, 1.0F);
}

TEST(LayerData, HasTheVolume)
{
  scene::Material material;
  material.transmission = 0.5F;
  material.thickness = 2.0F;
  material.ior = 1.25F;
  material.attenuation_distance = 4.0F;
  material.attenuation_color = {1.0F, 0.25F, 0.0F};
  material.thickness_texture.offset = {3.0F, 2.0F};
  const shared::LayerData data = layer_data(material);
  EXPECT_EQ(data.transmission, 0.5F);
  EXPECT_EQ(data.thickness, 2.0F);
  EXPECT_EQ(data.ior, 1.25F);
  EXPECT_EQ(data.uv_rows[14].z, 3.0F);
  const glm::vec3 left = shared::beer_lambert(data.absorption, 2.0F);
  EXPECT_EQ(left.x, 1.0F);
  EXPECT_FLOAT_EQ(left.y, 0.5F);
  EXPECT_LT(left.z, 1e-30F) << "black after any length";
  material.attenuation_distance = 0.0F;
  EXPECT_EQ(layer_data(material).absorption, glm::vec3(0.0F));
}

TEST(MaterialData, WithoutItsEmissiveTextureAMaterialDoesNotEmit)
{
  SquareScene square;
  square.edit([](scene::Material &material) { material.emissive = glm::vec3(1.0F); });
  const auto full = [&] { return full_material_data(square.scene, square.scene.materials()[square.material]); };
  EXPECT_EQ(material_data(square.scene.materials()[square.material]).emissive, glm::vec3(1.0F));
  EXPECT_EQ(full().emissive, glm::vec3(1.0F));
  square.edit([&](scene::Material &material) { material.emissive_texture = square.texture; });
  // The class Plain is for meshes without uvs: they do not have the texture.
  EXPECT_EQ(material_data(square.scene.materials()[square.material]).emissive, glm::vec3(0.0F));
  EXPECT_EQ(full().emissive, glm::vec3(1.0F));
  square.scene.remove(square.texture);
  EXPECT_EQ(full().emissive, glm::vec3(0.0F));
}

// A rough surface elsewhere gives the copy of the picture its mip levels, whatever its height.
TEST(TransmissionLevel, IsZeroForSmoothSurfacesAndAFractionOfTheHeightForRoughOnes)
{
  for (const float height_px : {16.0F, 1024.0F, 2160.0F, 16384.0F}) {
    EXPECT_EQ(shared::transmission_level(0.0F, 1.5F, height_px), 0.0F);
    EXPECT_EQ(shared::transmission_level(0.7F, 1.0F, height_px), 0.0F);
    EXPECT_NEAR(shared::transmission_level(1.0F, 1.5F, height_px), std::log2(height_px), 1e-4F);
  }
  EXPECT_NEAR(shared::transmission_level(0.5F, 1.5F, 1024.0F), 5.0F, 1e-4F);
}

}  // namespace
}  // namespace gnomon::render_scene
