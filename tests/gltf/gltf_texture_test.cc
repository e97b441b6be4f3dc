// SPDX-License-Identifier: MIT
#include "gltf/gltf_textured_triangle.hh"

#include <limits>
#include <numbers>

namespace gnomon::test {
namespace {

using scene::Scene;

json &slot(GltfBuilder &builder)
{
  return builder.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
}

// ---- Samplers ----

TEST(GltfTexture, SamplersAreConverted)
{
  GltfBuilder builder = textured_triangle();
  const scene::Texture without = nth(import(builder).textures(), 0);
  EXPECT_EQ(without.wrap_u, scene::TextureWrap::Repeat);
  EXPECT_EQ(without.magnified, scene::TextureFilter::Linear);
  EXPECT_EQ(without.mip, scene::MipFilter::Linear);
  builder.document["textures"][0]["sampler"] = 0;
  builder.document["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9985}}};
  const scene::Texture texture = nth(import(builder).textures(), 0);
  EXPECT_EQ(texture.wrap_u, scene::TextureWrap::ClampToEdge);
  EXPECT_EQ(texture.wrap_v, scene::TextureWrap::MirroredRepeat);
  EXPECT_EQ(texture.magnified, scene::TextureFilter::Nearest);
  EXPECT_EQ(texture.minified, scene::TextureFilter::Linear);
  EXPECT_EQ(texture.mip, scene::MipFilter::Nearest);
  builder.document["samplers"] = {{{"minFilter", 9728}}};
  EXPECT_EQ(nth(import(builder).textures(), 0).mip, scene::MipFilter::None);
  builder.document["samplers"] = {{{"wrapS", 1}, {"minFilter", 2}}};
  EXPECT_WARNING(import(builder), "texture 0: wrapS 1 is unknown");
  EXPECT_WARNING(import(builder), "texture 0: minFilter 2 is unknown");
}

// ---- Coordinates ----

std::vector<glm::vec2> uvs_of(const GltfBuilder &builder)
{
  return nth(import(builder).meshes(), 0).uvs;
}

/** Texture coordinates of the base colour texture. */
std::vector<glm::dvec2> transformed_uvs_of(const GltfBuilder &builder)
{
  const Scene scene = import(builder);
  const scene::Mesh &mesh = nth(scene.meshes(), 0);
  std::vector<glm::dvec2> uvs;
  for (const glm::vec2 &uv : mesh.uvs) {
    uvs.push_back(scene.material_of(mesh).base_color_texture.uv_from_mesh() * glm::dvec3(uv, 1.0));
  }
  return uvs;
}

TEST(GltfUv, AreThoseOfTheVertices)
{
  const std::vector<glm::vec2> uvs = uvs_of(textured_triangle());
  ASSERT_EQ(uvs.size(), 3U);
  EXPECT_EQ(uvs[1], glm::vec2(1, 0));
  EXPECT_EQ(uvs[2], glm::vec2(0.25F, 0.75F));
}

TEST(GltfUv, AreLeftOutWithoutATexture)
{
  GltfBuilder builder = textured_triangle();
  builder.document["materials"][0].erase("pbrMetallicRoughness");
  EXPECT_TRUE(uvs_of(builder).empty());
}

TEST(GltfUv, IntegersAreNormalised)
{
  GltfBuilder builder = textured_triangle();
  json &attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = builder.accessor(Bytes{0, 255, 51, 0, 255, 255}, Uint8, "VEC2", {{"normalized", true}});
  EXPECT_EQ(uvs_of(builder).at(1), glm::vec2(0.2F, 0));
  attributes["TEXCOORD_0"] = builder.accessor(std::vector<std::uint16_t>{0, 65535, 13107, 0, 65535, 65535}, Uint16,
                                              "VEC2", {{"normalized", true}});
  EXPECT_EQ(uvs_of(builder).at(1), glm::vec2(0.2F, 0));
}

TEST(GltfUv, TheSlotChoosesTheSetAndItsTransformGoesFirst)
{
  GltfBuilder builder = textured_triangle();
  json &attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_2"] = builder.accessor(std::vector<float>{5, 5, 6, 6, 7, 7}, Float32, "VEC2");
  slot(builder)["texCoord"] = 2;
  EXPECT_EQ(uvs_of(builder).at(2), glm::vec2(7));
  slot(builder)["extensions"]["KHR_texture_transform"] = {{"texCoord", 0}};
  EXPECT_EQ(uvs_of(builder).at(2), glm::vec2(0.25F, 0.75F));
}

TEST(GltfUv, TwoSetsAreKeptAndAThirdIsNamed)
{
  GltfBuilder builder = textured_triangle();
  json &attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_3"] = builder.accessor(std::vector<float>{5, 5, 6, 6, 7, 7}, Float32, "VEC2");
  json &material = builder.document["materials"][0];
  material["emissiveTexture"] = {{"index", 0}, {"texCoord", 3}};
  material["emissiveFactor"] = {1, 1, 1};
  const Scene two = import(builder);
  EXPECT_EQ(nth(two.meshes(), 0).uvs.at(2), glm::vec2(0.25F, 0.75F));
  EXPECT_EQ(nth(two.meshes(), 0).second_uvs.at(2), glm::vec2(7));
  EXPECT_EQ(nth(two.materials(), 0).emissive_texture.uv_set, 1);
  EXPECT_EQ(two.images().size(), 1U) << "shared";
  material["occlusionTexture"] = {{"index", 0}, {"texCoord", 5}};
  EXPECT_WARNING(import(builder), "its occlusionTexture is drawn as no occlusion: texCoord: 5 is a third set");
}

TEST(GltfUv, SetsAreKeptByImportanceAndNotByNumber)
{
  GltfBuilder builder = textured_triangle();
  json &attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
  for (const char *name : {"TEXCOORD_1", "TEXCOORD_2", "TEXCOORD_7"}) {
    attributes[name] = builder.accessor(std::vector<float>{5, 5, 6, 6, 7, 7}, Float32, "VEC2");
  }
  json &material = builder.document["materials"][0];
  slot(builder)["texCoord"] = 7;
  material["normalTexture"] = {{"index", 0}, {"texCoord", 0}};
  material["occlusionTexture"] = {{"index", 0}, {"texCoord", 1}};
  const Scene lit = import(builder);
  EXPECT_NO_WARNING(lit, "baseColorTexture");
  EXPECT_NO_WARNING(lit, "normalTexture");
  EXPECT_WARNING(lit, "its occlusionTexture is drawn as no occlusion: texCoord: 1 is a third set");
  EXPECT_EQ(lit.limits.size(), 1U);
  // A texture without an effect gives way.
  material["extensions"]["KHR_materials_unlit"] = json::object();
  EXPECT_NO_WARNING(import(builder), "baseColorTexture");
  material["extensions"].erase("KHR_materials_unlit");
  material["normalTexture"]["scale"] = 0;
  EXPECT_WARNING(import(builder), "its normalTexture is drawn as a flat surface: texCoord: 0 is a third set");
}

TEST(GltfTangent, AreReadOrComputed)
{
  GltfBuilder builder = textured_triangle();
  builder.document["materials"][0]["normalTexture"] = {{"index", 0}};
  json &attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
  const std::size_t made = nth(import(builder).meshes(), 0).tangents.size();
  EXPECT_EQ(made, 3U);
  attributes["NORMAL"] = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  const std::vector<float> tangents{0, 1, 0, -1, 0, 2, 0, 1, 0.6F, 0.8F, 0, 1};
  attributes["TANGENT"] = builder.accessor(tangents, Float32, "VEC4", {{"count", 3}});
  const Scene scene = import(builder);
  EXPECT_EQ(nth(scene.meshes(), 0).tangents, (std::vector<glm::vec4>{{0, 1, 0, -1}, {0, 1, 0, 1}, {0.6F, 0.8F, 0, 1}}));
  attributes["TANGENT"] = builder.accessor(std::vector<float>(12, 0.0F), Float32, "VEC4", {{"count", 3}});
  EXPECT_WARNING(import(builder), "mesh 'mesh': tangents made instead: TANGENT: one is zero or not finite");
}

TEST(GltfTangent, AnisotropyAloneHasThemWithoutTheUvs)
{
  GltfBuilder builder = textured_triangle();
  builder.document["materials"][0] = {{"name", "brushed"}};
  builder.document["materials"][0]["extensions"]["KHR_materials_anisotropy"] = {{"anisotropyStrength", 0.5}};
  json &attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  const auto mesh_of = [&] { return nth(import(builder).meshes(), 0); };
  // u grows along +X.
  const scene::Mesh made = mesh_of();
  ASSERT_EQ(made.tangents.size(), 3U);
  EXPECT_NEAR(made.tangents[0].x, 1.0F, 1e-6F);
  EXPECT_TRUE(made.uvs.empty()) << "no texture reads them";
  attributes.erase("TEXCOORD_0");
  EXPECT_TRUE(mesh_of().tangents.empty());
  EXPECT_WARNING(import(builder), "mesh 'mesh': anisotropy is not drawn: there is neither TANGENT nor TEXCOORD_0");
  attributes["TANGENT"] = builder.accessor(std::vector<float>{0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1}, Float32, "VEC4");
  EXPECT_EQ(mesh_of().tangents, std::vector<glm::vec4>(3, {0, 1, 0, 1}));
}

TEST(GltfUv, TransformScalesTurnsThenMoves)
{
  GltfBuilder builder = textured_triangle();
  slot(builder)["extensions"]["KHR_texture_transform"] = {
      {"offset", {10, 20}}, {"rotation", std::numbers::pi / 2}, {"scale", {2, 4}}};
  const glm::dvec2 uv = transformed_uvs_of(builder).at(2);
  // (0.25, 0.75) scaled is (0.5, 3). A visual rotation by 90 degrees counter-clockwise, with v down, maps u to -v.
  EXPECT_NEAR(uv.x, 10 + 3, 1e-5);
  EXPECT_NEAR(uv.y, 20 - 0.5, 1e-5);
}

TEST(GltfUv, StayWithTheirVerticesWhenOthersAreLeftOut)
{
  // No triangle uses vertex 0, and the second triangle has no area.
  const std::vector<float> positions{9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0};
  const std::vector<float> uvs{9, 9, 0.1F, 0, 0.2F, 0, 0.3F, 0, 0.4F, 0};
  const std::vector<float> normals{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  for (const bool has_normals : {true, false}) {
    GltfBuilder builder = textured_triangle();
    json &primitive = builder.document["meshes"][0]["primitives"][0];
    primitive["attributes"] = {{"POSITION", builder.positions(positions)},
                               {"TEXCOORD_0", builder.accessor(uvs, Float32, "VEC2")}};
    if (has_normals) {
      primitive["attributes"]["NORMAL"] = builder.positions(normals);
    }
    primitive["indices"] = builder.accessor(std::vector<std::uint16_t>{1, 2, 3, 1, 2, 4}, Uint16, "SCALAR");
    const Scene scene = import(builder);
    const scene::Mesh &mesh = nth(scene.meshes(), 0);
    ASSERT_EQ(mesh.indices.size(), 3U);
    for (const std::uint32_t index : mesh.indices) {
      const float expected = mesh.positions[index].x == 1 ? 0.2F : mesh.positions[index].y == 1 ? 0.3F : 0.1F;
      EXPECT_EQ(mesh.uvs[index], glm::vec2(expected, 0));
    }
  }
}

TEST(GltfUv, BadOnesAreZeroAndCounted)
{
  GltfBuilder builder = textured_triangle();
  json &attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
  const float nan = std::numeric_limits<float>::quiet_NaN();
  attributes["TEXCOORD_0"] = builder.accessor(std::vector<float>{nan, 0, 1e30F, 0, 0.5F, 0.5F}, Float32, "VEC2");
  const Scene scene = import(builder);
  EXPECT_EQ(nth(scene.meshes(), 0).uvs, (std::vector<glm::vec2>{{0, 0}, {0, 0}, {0.5F, 0.5F}}));
  EXPECT_WARNING(scene, "texture coordinate replaced by 0: it was not finite or beyond 1e6 (2 times)");
  attributes["TEXCOORD_0"] = builder.accessor(std::vector<float>{0, 0}, Float32, "VEC2");
  EXPECT_WARNING(import(builder), "mesh 'mesh': its texture is drawn as the colour of one corner: TEXCOORD_0: count");
  attributes.erase("TEXCOORD_0");
  EXPECT_WARNING(import(builder), "one corner: TEXCOORD_0: is missing");
}

}  // namespace
}  // namespace gnomon::test
