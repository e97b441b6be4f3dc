// SPDX-License-Identifier: MIT
#include "gltf/gltf_check.hh"
#include "image_file.hh"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>

namespace gnomon::test {
namespace {

using scene::Image;
using scene::Scene;
using Bytes = std::vector<std::uint8_t>;

std::string data_uri(const Bytes &bytes)
{
  return "data:image/png;base64," + base64(bytes);
}

/** Two by two texels with different colours and alphas. */
const Bytes four_texels{255, 0, 0, 255, 0, 200, 10, 128, 20, 30, 240, 64, 90, 80, 70, 0};

Bytes four_texel_png()
{
  return image_file("png", 2, 2, 4, four_texels);
}

const std::vector<float> triangle_uvs{0, 0, 1, 0, 0.25F, 0.75F};

/** A triangle whose material uses texture 0 (image 0) at TEXCOORD_0. */
GltfBuilder textured_triangle(const json &image)
{
  GltfBuilder builder;
  const int mesh = builder.mesh({{"attributes",
                                  {{"POSITION", builder.positions(triangle_positions)},
                                   {"TEXCOORD_0", builder.accessor(triangle_uvs, Float32, "VEC2")}}},
                                 {"material", 0}});
  builder.node({{"mesh", mesh}});
  builder.append("materials", {{"name", "paint"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  builder.append("textures", {{"source", 0}});
  builder.append("images", image);
  return builder;
}

GltfBuilder textured_triangle()
{
  return textured_triangle({{"name", "leaf"}, {"uri", data_uri(four_texel_png())}});
}

json &slot(GltfBuilder &builder)
{
  return builder.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
}

Image only_image(const Bytes &file)
{
  const Scene scene = import(textured_triangle({{"name", "leaf"}, {"uri", data_uri(file)}}));
  EXPECT_EQ(scene.images().size(), 1U) << all_warnings(scene);
  return scene.images().empty() ? Image() : nth(scene.images(), 0);
}

/** The reason in the warning about a texture that cannot be drawn. */
std::string reason(const json &image)
{
  const Scene scene = import(textured_triangle(image));
  expect_valid(scene);
  // Only the stand-in: a checkerboard.
  EXPECT_EQ(nth(scene.materials(), 0).base_color_texture.texture, scene.textures().first());
  EXPECT_TRUE(scene.images().size() == 1 && scene.textures().size() == 1);
  EXPECT_EQ(nth(scene.images(), 0).texels, (Bytes{255, 0, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 0, 255, 255}));
  EXPECT_EQ(scene.objects().size(), 1U);
  EXPECT_WARNING(scene, "material 'paint': its baseColorTexture is drawn as a checkerboard: ");
  return all_warnings(scene);
}

// ---- Images ----

TEST(GltfImage, TexelsAreTheFilesFromTheTopNotMultipliedByAlpha)
{
  const Image image = only_image(four_texel_png());
  EXPECT_EQ(image.name, "leaf");
  EXPECT_EQ(image.width, 2U);
  EXPECT_EQ(image.height, 2U);
  EXPECT_EQ(image.texels, four_texels);
}

/** Alphas of 255, 128, 64 and 0, times a glossiness of 0.5. */
TEST(GltfImage, GlossinessIsConvertedToRoughness)
{
  GltfBuilder builder = textured_triangle();
  json &material = builder.document["materials"][0];
  material = {{"name", "paint"}};
  material["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {{"glossinessFactor", 0.5},
                                                                   {"specularGlossinessTexture", {{"index", 0}}}};
  const Scene scene = import(builder);
  const scene::Material &converted = nth(scene.materials(), 0);
  EXPECT_EQ(converted.roughness, 1.0F);
  const auto texels_of = [&](const scene::TextureSlot &of) {
    return scene.images()[scene.textures()[of.texture].image].texels;
  };
  EXPECT_EQ(texels_of(converted.specular_color_texture), four_texels);
  EXPECT_EQ(texels_of(converted.metallic_roughness_texture),
            (Bytes{0, 128, 0, 255, 0, 191, 0, 255, 0, 223, 0, 255, 0, 255, 0, 255}));
  EXPECT_EQ(scene.images().size(), 2U);
  // A file that is not there, and one whose header is whole and whose texels are not.
  Bytes cut = four_texel_png();
  cut.resize(cut.size() - 20);
  for (const std::string &uri : {std::string("missing.png"), data_uri(cut)}) {
    builder.document["images"][0]["uri"] = uri;
    const Scene damaged = import(builder);
    EXPECT_WARNING(damaged, "material 'paint': its metallicRoughnessTexture is drawn as no metal");
    EXPECT_WARNING(damaged, "material 'paint': its specularColorTexture is drawn as the factor alone");
    EXPECT_EQ(nth(damaged.materials(), 0).roughness, 0.5F) << "the factor's";
  }
}

TEST(GltfImage, MayBeInABufferView)
{
  GltfBuilder builder = textured_triangle(json::object());
  const int view = builder.view(four_texel_png());
  builder.document["images"][0] = {{"bufferView", view}, {"mimeType", "image/png"}};
  for (const std::string &content : {builder.gltf(), builder.glb()}) {
    const Scene scene = import_text(content);
    ASSERT_EQ(scene.images().size(), 1U) << all_warnings(scene);
    EXPECT_EQ(nth(scene.images(), 0).texels, four_texels);
  }
}

TEST(GltfImage, MayBeAnExternalFile)
{
  const TemporaryFolder folder;
  const Bytes png = four_texel_png();
  (void)folder.write("a leaf.png", std::string(png.begin(), png.end()));
  const Scene scene =
      gltf::import_gltf(folder.write("scene.gltf", textured_triangle({{"uri", "a%20leaf.png"}}).gltf()));
  ASSERT_EQ(scene.images().size(), 1U) << all_warnings(scene);
  EXPECT_EQ(nth(scene.images(), 0).texels, four_texels);
}

TEST(GltfImage, ChannelsAndDepthsAreSpreadToEightBitColourAndAlpha)
{
  EXPECT_EQ(only_image(image_file("png", 2, 1, 1, Bytes{7, 250})).texels, (Bytes{7, 7, 7, 255, 250, 250, 250, 255}));
  EXPECT_EQ(only_image(image_file("png", 2, 1, 2, Bytes{7, 9, 250, 0})).texels, (Bytes{7, 7, 7, 9, 250, 250, 250, 0}));
  EXPECT_EQ(only_image(image_file("png", 2, 1, 3, Bytes{1, 2, 3, 4, 5, 6})).texels,
            (Bytes{1, 2, 3, 255, 4, 5, 6, 255}));
  // One step of 8 bits equals 257 steps of 16 bits.
  const std::vector<std::uint16_t> deep{0, 257, 65535, 32896};
  EXPECT_EQ(only_image(image_file("png", 1, 1, 4, deep)).texels, (Bytes{0, 1, 255, 128}));
}

TEST(GltfImage, JpegIsReadWithinItsCompression)
{
  const Image colour = only_image(image_file("jpg", 8, 8, 3, [] {
    Bytes texels;
    for (int i = 0; i < 64; i++) {
      texels.insert(texels.end(), {200, 100, 50});
    }
    return texels;
  }()));
  ASSERT_EQ(colour.texels.size(), 256U);
  EXPECT_NEAR(colour.texels[0], 200, 2);
  EXPECT_NEAR(colour.texels[1], 100, 2);
  EXPECT_NEAR(colour.texels[2], 50, 2);
  EXPECT_EQ(colour.texels[3], 255);
  const Image grey = only_image(image_file("jpg", 8, 8, 1, Bytes(64, 77)));
  EXPECT_NEAR(grey.texels[2], 77, 2);
}

TEST(GltfImage, OneThatIsUsedTwiceIsDecodedOnce)
{
  GltfBuilder builder = textured_triangle();
  // A second texture of the same image, and a second image with the same content.
  builder.append("textures", {{"source", 0}});
  builder.append("images", builder.document["images"][0]);
  builder.append("textures", {{"source", 1}});
  for (int texture = 1; texture < 3; texture++) {
    json primitive = builder.document["meshes"][0]["primitives"][0];
    primitive["material"] =
        builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
    builder.document["meshes"][0]["primitives"].push_back(primitive);
  }
  const Scene scene = import(builder);
  EXPECT_EQ(scene.images().size(), 1U);
  EXPECT_EQ(scene.textures().size(), 3U);
}

TEST(GltfImage, UnreadableImagesAreNamedAndLeaveTheFactor)
{
  EXPECT_HAS(reason({{"name", "leaf"}, {"uri", data_uri({1, 2, 3})}}), "image 'leaf': is neither PNG nor JPEG");
  EXPECT_HAS(reason({{"uri", "data:image/png;base64,"}}), "image 0: is empty");
  EXPECT_HAS(reason({{"uri", "data:image/png,abc"}}), "image 0: its data URI is not base64");
  EXPECT_HAS(reason({{"uri", "absent.png"}}), "image 0 'absent.png': there is no such file");
  EXPECT_HAS(reason({{"uri", "/etc/passwd"}}), "is not a file beside the scene");
  EXPECT_HAS(reason(json::object()), "image 0: bufferView: is missing");
  EXPECT_HAS(reason({{"bufferView", 99}}), "image 0: bufferView: index 99 is out of range");
  GltfBuilder builder = textured_triangle();
  slot(builder)["index"] = 5;
  EXPECT_WARNING(import(builder), "texture: index 5 is out of range: the file has 1");
}

TEST(GltfImage, CutOffAtAnyByteLeavesTheFactor)
{
  std::mt19937 random(3);
  Bytes noise(3 * 24 * 24);
  std::generate(noise.begin(), noise.end(), [&] { return static_cast<std::uint8_t>(random()); });
  for (const char *extension : {"png", "jpg"}) {
    const Bytes file = image_file(extension, 24, 24, 3, noise);
    for (std::size_t size = 1; size < file.size() - 16; size += 97) {
      (void)reason({{"uri", data_uri(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)))}});
      ASSERT_FALSE(HasFailure()) << extension << ' ' << size;
    }
  }
}

TEST(GltfImage, DamagedBytesImportOrAreNamed)
{
  std::mt19937 random(5);
  Bytes noise(4 * 16 * 16);
  std::generate(noise.begin(), noise.end(), [&] { return static_cast<std::uint8_t>(random()); });
  for (const char *extension : {"png", "jpg"}) {
    const Bytes original = image_file(extension, 16, 16, extension[0] == 'p' ? 4 : 3, noise);
    for (int i = 0; i < 200; i++) {
      Bytes file = original;
      for (int k = 0; k < 4; k++) {
        file[random() % (i % 2 == 0 ? 64 : file.size())] = static_cast<std::uint8_t>(random());
      }
      // import() calls expect_valid.
      (void)import(textured_triangle({{"uri", data_uri(file)}}));
      ASSERT_FALSE(HasFailure()) << extension << ' ' << i;
    }
  }
}

/** A PNG of a few bytes whose header states \a edge texels of width and height. */
Bytes claimed_png(std::uint32_t edge)
{
  const auto crc = [](const Bytes &bytes) {
    std::uint32_t value = ~0U;
    for (const std::uint8_t byte : bytes) {
      value ^= byte;
      for (int i = 0; i < 8; i++) {
        value = value >> 1U ^ (value % 2 == 0 ? 0U : 0xEDB88320U);
      }
    }
    return ~value;
  };
  Bytes header{'I', 'H', 'D', 'R'};
  const auto add_u32 = [](Bytes &bytes, std::uint32_t value) {
    for (const unsigned shift : {24U, 16U, 8U, 0U}) {
      bytes.push_back(static_cast<std::uint8_t>(value >> shift));
    }
  };
  add_u32(header, edge);
  add_u32(header, edge);
  header.insert(header.end(), {8, 6, 0, 0, 0});
  Bytes file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n', 0, 0, 0, 13};
  file.insert(file.end(), header.begin(), header.end());
  add_u32(file, crc(header));
  file.insert(file.end(), {0, 0, 0, 16, 'I', 'D', 'A', 'T'});
  file.resize(file.size() + 64);
  return file;
}

TEST(GltfImage, InvalidSizesAreRefusedBeforeAllocation)
{
  EXPECT_HAS(reason({{"uri", data_uri(claimed_png(8000))}}), "is cut off: 8000x8000 texels cannot be in ");
  EXPECT_HAS(reason({{"uri", data_uri(claimed_png(16000))}}), "is too large, 16000x16000 texels");
  EXPECT_HAS(reason({{"uri", data_uri(claimed_png(40000))}}),
             "is too large, 40000x40000 texels: an edge may have 16384");
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
  const Scene two = import(builder);
  EXPECT_EQ(nth(two.meshes(), 0).uvs.at(2), glm::vec2(0.25F, 0.75F));
  EXPECT_EQ(nth(two.meshes(), 0).second_uvs.at(2), glm::vec2(7));
  EXPECT_EQ(nth(two.materials(), 0).emissive_texture.uv_set, 1);
  EXPECT_EQ(two.images().size(), 1U) << "shared";
  material["occlusionTexture"] = {{"index", 0}, {"texCoord", 5}};
  EXPECT_WARNING(import(builder), "its occlusionTexture is drawn as no occlusion: texCoord: 5 is a third set");
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
