// SPDX-License-Identifier: MIT
#include "gltf/gltf_textured_triangle.hh"

#include <webp/encode.h>

#include <algorithm>
#include <array>
#include <random>

namespace gnomon::test {
namespace {

using scene::Image;
using scene::Scene;

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

/** A WebP file with red, green, blue and alpha: lossless, so that all texels stay, or of the highest quality. */
Bytes webp_file(int width, int height, const Bytes &texels, bool is_lossless)
{
  WebPConfig config;
  WebPPicture picture;
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  EXPECT_TRUE(WebPConfigInit(&config) && WebPPictureInit(&picture));
  config.lossless = is_lossless ? 1 : 0;
  config.quality = 100.0F;
  // The colours of transparent texels stay.
  config.exact = 1;
  picture.use_argb = 1;
  picture.width = width;
  picture.height = height;
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  EXPECT_TRUE(WebPPictureImportRGBA(&picture, texels.data(), 4 * width) && WebPEncode(&config, &picture));
  Bytes file(writer.mem, writer.mem + writer.size);
  WebPPictureFree(&picture);
  WebPMemoryWriterClear(&writer);
  return file;
}

/** The file's length without its first 8 bytes, as its header has it. */
Bytes with_stated_size(Bytes webp)
{
  for (std::size_t i = 0; i < 4; i++) {
    webp[4 + i] = static_cast<std::uint8_t>((webp.size() - 8) >> (8 * i));
  }
  return webp;
}

/** The same as image_file, and for WebP, whose three channels become four. */
Bytes noise_file(const std::string &extension, int edge, std::mt19937 &random)
{
  const int channel_count = extension == "jpg" ? 3 : 4;
  Bytes noise(std::size_t(channel_count) * std::size_t(edge) * std::size_t(edge));
  std::generate(noise.begin(), noise.end(), [&] { return static_cast<std::uint8_t>(random()); });
  return extension.starts_with("webp") ? webp_file(edge, edge, noise, extension == "webp lossless")
                                       : image_file(extension, edge, edge, channel_count, noise);
}

constexpr std::array noise_files{"png", "jpg", "webp", "webp lossless"};

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

TEST(GltfImage, LargerOnesThanTheLimitAreReduced)
{
  const auto scene_with = [](std::uint32_t size_max) {
    return import_text(textured_triangle().gltf(), "scene.gltf", {.texture_size_max = size_max});
  };
  EXPECT_EQ((*scene_with(2).images().begin()).value.texels, four_texels);
  const Scene scene = scene_with(1);
  const Image &image = (*scene.images().begin()).value;
  EXPECT_EQ(image.width, 1U);
  EXPECT_EQ(image.height, 1U);
  // The red of base colours is encoded: the mean of the light of 255, 0, 20 and 90 is 143.6. Alpha is the mean of
  // values.
  EXPECT_EQ(image.texels[0], 144);
  EXPECT_EQ(image.texels[3], 112);
}

TEST(GltfImage, AReducedMaskCoversAsMuchWithTheAlphaOfItsVertices)
{
  // 4 of 16 texels have alpha 1, 8 have 0.6 and 4 have 0.
  Bytes texels;
  for (int i = 0; i < 16; i++) {
    const int place = (i % 4 + i / 4) % 4;
    texels.insert(texels.end(), {0, 200, 0, std::uint8_t(place == 0 ? 255 : place == 1 ? 0 : 153)});
  }
  GltfBuilder builder = textured_triangle({{"uri", data_uri(image_file("png", 4, 4, 4, texels))}});
  builder.append("samplers", {{"magFilter", 9728}});
  builder.document["textures"][0]["sampler"] = 0;
  builder.document["materials"][0]["alphaMode"] = "MASK";
  const auto covered = [&](float least) {
    const Scene scene = import_text(builder.gltf(), "scene.gltf", {.texture_size_max = 2});
    const Image &image = nth(scene.images(), 0);
    int count = 0;
    for (std::size_t i = 3; i < image.texels.size(); i += 4) {
      count += float(image.texels[i]) / 255.0F >= least ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(covered(0.5F), 3);
  json &attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["COLOR_0"] =
      builder.accessor(std::vector<float>{1, 1, 1, 0.5F, 1, 1, 1, 0.75F, 1, 1, 1, 1}, Float32, "VEC4");
  EXPECT_EQ(covered(0.5F / 0.75F), 1);
  // The mean counts where vertices differ, and the factor, too.
  builder.document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.8};
  EXPECT_EQ(covered(0.5F / (0.75F * 0.8F)), 1);
  // No texel reaches the cutoff, so that the image keeps no share.
  builder.document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.6};
  EXPECT_EQ(covered(0.0F), 4);
}

TEST(GltfImage, LimitsCountAfterTheReduction)
{
  // Wider than any texture.
  const Bytes wide = image_file("png", 16400, 1, 3, Bytes(std::size_t(3) * 16400, 100));
  EXPECT_HAS(reason({{"uri", data_uri(wide)}}), "is too large, 16400x1 texels: an edge may have 16384 unless");
  const Scene scene =
      import_text(textured_triangle({{"uri", data_uri(wide)}}).gltf(), "scene.gltf", {.texture_size_max = 1024});
  EXPECT_EQ(nth(scene.images(), 0).width, 1024U);
  EXPECT_EQ(nth(scene.images(), 0).texels[0], 100);
}

TEST(SlowGltfImage, SeventeenOf4096FitWithAndWithoutReduction)
{
  GltfBuilder builder = textured_triangle();
  json primitive = builder.document["meshes"][0]["primitives"][0];
  for (int i = 0; i < 17; i++) {
    // White but for the first texel, so that no two are the same bytes.
    const Bytes png = image_file("png", 4096, 4096, 1, [&] {
      Bytes texels(std::size_t(4096) * 4096, 255);
      texels[0] = std::uint8_t(i);
      return texels;
    }());
    builder.append("images", {{"uri", data_uri(png)}});
    builder.append("textures", {{"source", i + 1}});
    primitive["material"] =
        builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i + 1}}}}}});
    builder.document["meshes"][0]["primitives"].push_back(primitive);
  }
  const auto warnings = [&](std::uint32_t size_max) {
    return all_warnings(import_text(builder.gltf(), "scene.gltf", {.texture_size_max = size_max}));
  };
  EXPECT_EQ(warnings(0).find("too large"), std::string::npos);
  EXPECT_EQ(warnings(1024).find("too large"), std::string::npos);
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
  EXPECT_HAS(reason({{"name", "leaf"}, {"uri", data_uri({1, 2, 3})}}), "image 'leaf': is none of PNG, JPEG and WebP");
  EXPECT_HAS(reason({{"uri", data_uri({0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'})}}),
             "image 0: is KTX2, which is not read: only PNG, JPEG and WebP are");
  EXPECT_HAS(reason({{"uri", "data:image/png;base64,"}}), "image 0: is empty");
  EXPECT_HAS(reason({{"uri", "data:image/png,abc"}}), "image 0: is none of PNG, JPEG and WebP");
  EXPECT_HAS(reason({{"uri", "absent.png"}}), "image 0 'absent.png': there is no such file");
  EXPECT_HAS(reason({{"uri", "/etc/passwd"}}), "is not a file beside the scene");
  EXPECT_HAS(reason(json::object()), "image 0: bufferView: is missing");
  EXPECT_HAS(reason({{"bufferView", 99}}), "image 0: bufferView: index 99 is out of range");
  GltfBuilder builder = textured_triangle();
  builder.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 5;
  EXPECT_WARNING(import(builder), "texture: index 5 is out of range: the file has 1");
}

TEST(GltfImage, CutOffAtAnyByteLeavesTheFactor)
{
  std::mt19937 random(3);
  for (const char *extension : noise_files) {
    const Bytes file = noise_file(extension, 24, random);
    for (std::size_t size = 1; size < file.size() - 16; size += 97) {
      (void)reason({{"uri", data_uri(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)))}});
      ASSERT_FALSE(HasFailure()) << extension << ' ' << size;
    }
  }
}

/** Also where all texels come before the damage: the checksum of their chunk follows them. */
TEST(GltfImage, APngWithAWrongBitAmongTexelsOrWithoutItsEndLeavesTheFactor)
{
  std::mt19937 random(7);
  const Bytes original = noise_file("png", 24, random);
  const std::string_view text(reinterpret_cast<const char *>(original.data()), original.size());
  const std::size_t texels = text.find("IDAT") + 4;
  const std::size_t end = text.rfind("IEND") - 4;
  ASSERT_LT(texels + 1000, end);
  for (std::size_t i = texels; i < end; i += 61) {
    Bytes file = original;
    file[i] ^= std::uint8_t(1U << (i % 8));
    (void)reason({{"uri", data_uri(file)}});
    ASSERT_FALSE(HasFailure()) << "bit of byte " << i;
  }
  // libspng reads a file without its last four bytes, the checksum of IEND.
  for (std::size_t cut = 5; cut <= 16; cut++) {
    (void)reason({{"uri", data_uri(Bytes(original.begin(), original.end() - std::ptrdiff_t(cut)))}});
    ASSERT_FALSE(HasFailure()) << "without the last " << cut << " bytes";
  }
}

TEST(GltfImage, DamagedBytesImportOrAreNamed)
{
  std::mt19937 random(5);
  for (const char *extension : noise_files) {
    const Bytes original = noise_file(extension, 16, random);
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
  EXPECT_HAS(reason({{"uri", data_uri(claimed_png(16000))}}), "is cut off: 16000x16000 texels cannot be in ");
  EXPECT_HAS(reason({{"uri", data_uri(claimed_png(40000))}}), "is cut off: 40000x40000 texels cannot be in ");
}

// ---- WebP ----

TEST(GltfWebp, LosslessTexelsAreTheFiles)
{
  EXPECT_EQ(only_image(webp_file(2, 2, four_texels, true)).texels, four_texels);
  // Without a limit of texels for each byte: a code of one symbol takes no bits.
  const Bytes flat = webp_file(1024, 1024, Bytes(std::size_t(4) * 1024 * 1024, 200), true);
  EXPECT_LT(flat.size(), 1024U * 1024U / 8U / 1032U);
  EXPECT_EQ(only_image(flat).texels, Bytes(std::size_t(4) * 1024 * 1024, 200));
}

TEST(GltfWebp, LossyOnesAreReadWithinTheirCompression)
{
  Bytes texels;
  for (int i = 0; i < 64; i++) {
    texels.insert(texels.end(), {200, 100, 50, 120});
  }
  const Image image = only_image(webp_file(8, 8, texels, false));
  ASSERT_EQ(image.texels.size(), texels.size());
  for (std::size_t i = 0; i < texels.size(); i++) {
    // Luma and chroma are rounded to 8 bits of a smaller range: errors of up to 2. Alpha is lossless.
    EXPECT_NEAR(image.texels[i], texels[i], i % 4 == 3 ? 0 : 2) << i;
  }
}

/** The texture of textured_triangle with a WebP image beside its fallback. */
GltfBuilder with_webp(const json &webp)
{
  GltfBuilder builder =
      textured_triangle({{"name", "fallback"}, {"uri", data_uri(image_file("png", 1, 1, 3, Bytes{1, 2, 3}))}});
  builder.append("images", webp);
  builder.document["textures"][0]["extensions"]["EXT_texture_webp"] = {{"source", 1}};
  builder.document["extensionsUsed"] = {"EXT_texture_webp"};
  return builder;
}

TEST(GltfWebp, TheExtensionsImageIsPreferredToTheFallback)
{
  GltfBuilder builder = with_webp({{"uri", data_uri(webp_file(2, 2, four_texels, true))}});
  const Scene scene = import(builder);
  ASSERT_EQ(scene.images().size(), 1U);
  EXPECT_EQ(nth(scene.images(), 0).texels, four_texels);
  EXPECT_EQ(all_warnings(scene).find("texture"), std::string::npos) << all_warnings(scene);
  builder.document["textures"][0].erase("source");
  builder.document["extensionsRequired"] = {"EXT_texture_webp"};
  const Scene required = import(builder);
  ASSERT_EQ(required.images().size(), 1U);
  EXPECT_EQ(nth(required.images(), 0).texels, four_texels);
  EXPECT_EQ(all_warnings(required).find("extensionsRequired"), std::string::npos) << all_warnings(required);
}

TEST(GltfWebp, TheFallbackReplacesAMissingFileWithAWarning)
{
  GltfBuilder builder = with_webp({{"name", "leaf"}, {"uri", "missing.webp"}});
  const Scene scene = import(builder);
  ASSERT_EQ(scene.images().size(), 1U);
  EXPECT_EQ(nth(scene.images(), 0).texels, (Bytes{1, 2, 3, 255}));
  EXPECT_WARNING(scene, "texture 0: its fallback is drawn: image 'leaf' 'missing.webp': there is no such file");
  builder.document["textures"][0].erase("source");
  EXPECT_WARNING(import(builder), "checkerboard: image 'leaf' 'missing.webp': there is no such file");
  builder.document["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 7;
  EXPECT_WARNING(import(builder), "texture 0: source of EXT_texture_webp: index 7 is out of range: the file has 2");
}

TEST(GltfWebp, DamagedOnesLeaveTheFactor)
{
  std::mt19937 random(7);
  const Bytes file = noise_file("webp", 24, random);
  const auto first = [&](std::size_t count) {
    return Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(count));
  };
  EXPECT_HAS(reason({{"name", "leaf"}, {"uri", data_uri(first(file.size() - 1))}}), "image 'leaf': is cut off");
  EXPECT_HAS(reason({{"uri", data_uri(first(12))}}), "image 0: is cut off");
  // The container is whole, but not the texels in it.
  EXPECT_HAS(reason({{"uri", data_uri(with_stated_size(first(file.size() / 2)))}}), "image 0: cannot be decoded: ");
  EXPECT_HAS(reason({{"uri", data_uri(with_stated_size(first(12)))}}), "image 0: cannot be decoded: ");
  // The container of an animation with a canvas of 2x2.
  const Bytes animation{'R', 'I', 'F', 'F', 22, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8',
                        'X', 10,  0,   0,   0,  2, 0, 0, 0,   1,   0,   0,   1,   0,   0};
  EXPECT_HAS(reason({{"uri", data_uri(animation)}}), "image 0: is an animation");
}

/** A lossless file of a few bytes whose header states \a edge texels of width and height. */
Bytes claimed_webp(std::uint32_t edge)
{
  Bytes file{'R', 'I', 'F', 'F', 0, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8', 'L', 64, 0, 0, 0, 0x2F};
  const std::uint32_t size = (edge - 1) | (edge - 1) << 14U;
  for (const unsigned shift : {0U, 8U, 16U, 24U}) {
    file.push_back(static_cast<std::uint8_t>(size >> shift));
  }
  file.resize(20 + 64);
  return with_stated_size(file);
}

TEST(GltfWebp, SizesAreLimitedBeforeAllocation)
{
  // The headers of three images state more than all may have, and the texels of the first two are damaged.
  GltfBuilder builder = textured_triangle({{"uri", data_uri(claimed_webp(16000))}});
  for (int i = 1; i < 3; i++) {
    builder.append("images", {{"uri", data_uri(claimed_webp(std::uint32_t(16000 + i)))}});
    builder.append("textures", {{"source", i}});
  }
  json &material = builder.document["materials"][0];
  material["emissiveTexture"] = {{"index", 1}};
  material["occlusionTexture"] = {{"index", 2}};
  EXPECT_WARNING(import(builder),
                 "is too large, 16001x16001 texels: 24806908 are left of those that all images may have");
}

TEST(GltfWebp, SixteenImagesOf4096TexelsFitTheBudgetAndItIsAnOption)
{
  GltfBuilder builder = textured_triangle({{"uri", data_uri(claimed_webp(4096))}});
  for (int i = 1; i < 16; i++) {
    Bytes file = claimed_webp(4096);
    file.back() = std::uint8_t(i);
    builder.append("images", {{"uri", data_uri(file)}});
    builder.append("textures", {{"source", i}});
    builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    json primitive = builder.document["meshes"][0]["primitives"][0];
    primitive["material"] = i;
    builder.document["meshes"][0]["primitives"].push_back(primitive);
  }
  const auto count_of = [&](const gltf::ImportOptions &options) {
    const scene::Scene scene = import_text(builder.gltf(), "scene.gltf", options);
    // Other warnings are those of images that are damaged, which no limit is the reason for.
    EXPECT_EQ(
        std::ranges::count_if(scene.warnings, [](auto &text) { return text.find("--image-memory") != text.npos; }),
        std::ptrdiff_t(scene.limits.size()));
    return std::ranges::count_if(scene.warnings, [](const std::string &warning) {
      return warning.find("are left of those that all images may have, by --image-memory") != warning.npos;
    });
  };
  EXPECT_EQ(count_of({}), 0);
  EXPECT_EQ(count_of({.image_bytes_max = std::size_t(15) * 4 * 4096 * 4096}), 1);
}

}  // namespace
}  // namespace gnomon::test
