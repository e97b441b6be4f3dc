// SPDX-License-Identifier: MIT
// Base colour textures and alpha masks compared with closed forms and invariants, on the driver.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;
using Bytes = std::vector<std::uint8_t>;

using std::numbers::pi;

class TextureGpuTest : public test::SharedDeviceTest {
 protected:
  /** A square of half size 1 with a texture. \return its mesh. */
  scene::Handle<scene::Mesh> add_textured(std::uint32_t width, const Bytes &texels,
                                          scene::AlphaMode mode = scene::AlphaMode::Mask)
  {
    const auto texture = test::add_texture(scene, width, texels);
    const auto material = test::add_material(scene, glm::vec3(1.0F));
    scene.edit(material, [&](scene::Material &value) {
      value.base_color_texture = texture;
      value.alpha_mode = mode;
    });
    return test::add_square_mesh(scene, material);
  }
  scene::Handle<scene::Mesh> add_plain(const glm::vec3 &albedo)
  {
    return test::add_square_mesh(scene, test::add_material(scene, albedo));
  }
  void add(scene::Handle<scene::Mesh> mesh, const glm::vec3 &center, const glm::vec3 &scale = glm::vec3(1.0F))
  {
    test::add_object(scene, mesh, glm::scale(glm::translate(glm::mat4(1.0F), center), scale));
  }
  Picture render(const Settings &settings = {})
  {
    Renderer renderer(*device, scene, {64, 64}, settings);
    Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture;
  }

  scene::Scene scene;
  /** Shows x and y from -1.6 to 1.6 on the plane z = 0: 20 pixels per metre. */
  scene::PlacedCamera camera = test::camera_at({0, 0, 16}, {0, 0, 0}, 2.0F * std::atan(0.1F));
};

const Settings no_shadow = {.shadow = {.kind = scene::ShadowKind::None}};

/** Pixel of \a x and \a y, metres on the plane z = 0. */
glm::vec4 at(const Picture &picture, float x, float y)
{
  return picture.at(int(32 + 20 * x), int(32 + 20 * y));
}

/** sRGB, IEC 61966-2-1. */
float decoded(int encoded)
{
  const float value = float(encoded) / 255.0F;
  return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

/** Red, green; blue, grey: rows from the top; alpha as given. */
Bytes four_colours(std::uint8_t alpha)
{
  return {200, 0, 0, alpha, 0, 150, 0, alpha, 0, 0, 100, alpha, 50, 50, 50, alpha};
}

TEST_F(TextureGpuTest, BaseColourIsTheFactorTimesTheDecodedTexelUpright)
{
  const auto mesh = add_textured(2, four_colours(0), scene::AlphaMode::Opaque);
  test::edit_material(scene, 0, [&](scene::Material &material) { material.base_color = {0.5F, 0.25F, 1.0F}; });
  add(mesh, {0, 0, 0});
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, float(pi));
  const Picture picture = render();
  // llvmpipe decodes through a table of eight bits and more.
  const float tolerance = 2e-3F;
  EXPECT_NEAR(at(picture, -0.5F, 0.5F).r, 0.5F * decoded(200), tolerance);
  EXPECT_EQ(at(picture, -0.5F, 0.5F).g, 0.0F);
  EXPECT_NEAR(at(picture, 0.5F, 0.5F).g, 0.25F * decoded(150), tolerance);
  EXPECT_NEAR(at(picture, -0.5F, -0.5F).b, decoded(100), tolerance);
  EXPECT_NEAR(at(picture, 0.5F, -0.5F).r, 0.5F * decoded(50), tolerance);
}

TEST_F(TextureGpuTest, ATextureOnAMetalColoursItsReflection)
{
  const auto mesh = add_textured(1, {255, 0, 0, 255}, scene::AlphaMode::Opaque);
  test::edit_material(scene, 0, [](scene::Material &material) {
    material.metallic = 1.0F;
    material.roughness = 0.7F;
  });
  add(mesh, {0, 0, 0});
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, float(pi));
  const glm::vec4 pixel = at(render(), 0, 0);
  EXPECT_GT(pixel.r, 0.1F);
  // Schlick's term at an angle of half a degree is far below.
  EXPECT_LT(pixel.g, 1e-4F);
}

TEST_F(TextureGpuTest, MaskCutsTheSurfaceAndItsShadow)
{
  for (const scene::LampKind kind : {scene::LampKind::Sun, scene::LampKind::Point}) {
    scene = {};
    // The left half is cut out.
    const auto leaf = add_textured(2, {255, 255, 255, 127, 255, 255, 255, 128});
    test::edit_material(scene, 0, [&](scene::Material &material) { material.base_color = {1, 0, 0}; });
    add(leaf, {0, 0, 1}, glm::vec3(0.5F));
    add(add_plain({0, 1, 0}), {0, 0, 0}, glm::vec3(3));
    // The shadow falls beside the leaf.
    test::add_lamp(scene, kind, {4, 0, 5}, {-1, 0, -1}, kind == scene::LampKind::Sun ? 1.0F : 30.0F);
    const Picture picture = render();
    EXPECT_GT(at(picture, 0.25F, 0.3F).r, 0.0F) << "the leaf";
    EXPECT_EQ(at(picture, 0.25F, 0.3F).g, 0.0F);
    EXPECT_EQ(at(picture, -0.25F, 0.3F).r, 0.0F) << "through the leaf";
    // The middle of either half of the leaf as the lamp projects it to the ground.
    const auto shadow_x = [kind](float x) { return kind == scene::LampKind::Sun ? x - 1 : 4 + (x - 4) * 5 / 4; };
    EXPECT_EQ(at(picture, shadow_x(0.25F), 0.2F).g, 0.0F) << "its shadow";
    EXPECT_GT(at(picture, shadow_x(-0.25F), 0.2F).g, 0.0F) << "the hole in its shadow";
    EXPECT_GT(at(picture, shadow_x(-0.8F), 0.2F).g, 0.0F) << "beside its shadow";
  }
}

class DistantMaskGpuTest : public TextureGpuTest {
 protected:
  /** 6.4 texels in a pixel. Three texels in four are left, with little alpha; the others are red. */
  void add_leaf(scene::MipFilter mip, const glm::vec3 &center = {0, 0, 0})
  {
    Bytes texels;
    for (int i = 0; i < 256 * 256; i++) {
      const Bytes texel = (i + i / 256) % 4 == 3 ? Bytes{255, 0, 0, 70} : Bytes{0, 200, 0, 90};
      texels.insert(texels.end(), texel.begin(), texel.end());
    }
    add(add_textured(256, texels), center);
    scene.edit(scene.textures().first(), [&](scene::Texture &texture) {
      texture.magnified = texture.minified = scene::TextureFilter::Nearest;
      texture.mip = mip;
    });
    test::edit_material(scene, 0, [](scene::Material &material) {
      material.alpha_cutoff = 0.3F;
      material.is_unlit = true;
    });
  }
  /** The mean within the edges of the leaf. */
  glm::vec4 mean(int sample_count)
  {
    const Picture picture = render({.sample_count = sample_count});
    glm::vec4 sum(0.0F);
    for (int y = 16; y < 48; y++) {
      for (int x = 16; x < 48; x++) {
        sum += picture.at(x, y) / (32.0F * 32.0F);
      }
    }
    return sum;
  }
};

TEST_F(DistantMaskGpuTest, CoversItsShareAtAnyNumberOfSamples)
{
  add_leaf(scene::MipFilter::Linear);
  for (const bool is_full : {false, true}) {
    if (is_full) {
      test::edit_material(scene, 0, [&](scene::Material &material) {
        material.is_unlit = false;
        material.emissive = {0, 1, 0};
        material.emissive_texture = material.base_color_texture;
      });
    }
    for (const int sample_count : {1, 4, 16}) {
      const glm::vec4 color = mean(sample_count);
      // Independent samples of 1024 pixels would have standard deviations of 0.0135, 0.0068 and 0.0034.
      EXPECT_NEAR(color.a, 0.75F, 0.01F) << sample_count << is_full;
      if (!is_full) {
        EXPECT_NEAR(color.g / color.a, decoded(200), 2e-3F) << sample_count;
        EXPECT_LT(color.r, 1e-3F * color.a) << sample_count;
      }
    }
  }
}

TEST_F(DistantMaskGpuTest, CoversWhatTheAlphaOfVerticesLeaves)
{
  // A tenth of a texel from the place at which the middle of each fifth pixel is at an edge of texels. There, the share
  // of one sample is 0.752 or 0.717: the last digit of the coordinate decides.
  add_leaf(scene::MipFilter::Linear, {0.1F / 128.0F, -0.1F / 128.0F, 0});
  // The red texels are below the cutoff only with that alpha.
  test::edit_material(scene, 0, [](scene::Material &material) { material.alpha_cutoff = 0.24F; });
  scene.edit(scene.meshes().first(),
             [](scene::Mesh &mesh) { mesh.colors.assign(mesh.positions.size(), glm::vec4(1.0F, 1.0F, 1.0F, 0.8F)); });
  for (const int sample_count : {1, 4, 16}) {
    EXPECT_NEAR(mean(sample_count).a, 0.75F, 0.02F) << sample_count;
  }
}

TEST_F(DistantMaskGpuTest, CoversItsShareWherePixelsAreAsLargeAsItsPattern)
{
  // Columns repeat after 4, 2, 1 and half a pixel. The leaf is 40 pixels wide.
  for (const std::uint32_t texels_per_pixel : {2U, 4U, 8U, 16U}) {
    for (const std::uint32_t covered : {1U, 3U, 6U}) {
      scene = {};
      const std::uint32_t width = 40 * texels_per_pixel;
      Bytes texels;
      for (std::uint32_t i = 0; i < width * width; i++) {
        const Bytes texel = i % width % 8 < covered ? Bytes{0, 200, 0, 255} : Bytes{255, 0, 0, 0};
        texels.insert(texels.end(), texel.begin(), texel.end());
      }
      add(add_textured(width, texels), {0, 0, 0});
      scene.edit(scene.textures().first(), [&](scene::Texture &texture) { texture.mip = scene::MipFilter::Linear; });
      test::edit_material(scene, 0, [](scene::Material &material) { material.is_unlit = true; });
      for (const int sample_count : {1, 16}) {
        EXPECT_NEAR(mean(sample_count).a, float(covered) / 8.0F, 0.01F)
            << sample_count << ' ' << texels_per_pixel << ' ' << covered;
      }
    }
  }
}

TEST_F(DistantMaskGpuTest, CoversItsShareBesideAnotherPattern)
{
  // Four texels in a pixel. Columns are aligned with the pixels, in the left half only.
  const std::uint32_t width = 160;
  Bytes texels;
  for (std::uint32_t i = 0; i < width * width; i++) {
    const std::uint32_t x = i % width;
    const Bytes texel = x < width / 2 && x % 8 < 2 ? Bytes{0, 200, 0, 255} : Bytes{255, 0, 0, 0};
    texels.insert(texels.end(), texel.begin(), texel.end());
  }
  add(add_textured(width, texels), {0, 0, 0});
  scene.edit(scene.textures().first(), [&](scene::Texture &texture) { texture.mip = scene::MipFilter::Linear; });
  test::edit_material(scene, 0, [](scene::Material &material) { material.is_unlit = true; });
  for (const int sample_count : {1, 4, 16}) {
    const Picture picture = render({.sample_count = sample_count});
    float left = 0.0F;
    float right = 0.0F;
    for (int y = 16; y < 48; y++) {
      for (int x = 0; x < 16; x++) {
        left += picture.at(16 + x, y).a / (16.0F * 32.0F);
        right += picture.at(32 + x, y).a / (16.0F * 32.0F);
      }
    }
    // Independent pixels would have a standard deviation of 0.016. The pixel's middle is at the edge of a column: 0.5
    // without an offset.
    EXPECT_NEAR(left, 0.25F, 0.03F) << sample_count;
    EXPECT_NEAR(right, 0.0F, 0.01F) << sample_count;
  }
}

TEST_F(DistantMaskGpuTest, TheEdgeOfAShapeIsSharp)
{
  // 1.2 to 1.8 texels in a pixel.
  for (const std::uint32_t width : {48U, 60U, 72U}) {
    scene = {};
    Bytes texels;
    for (std::uint32_t i = 0; i < width * width; i++) {
      const Bytes texel = i % width < width / 3 ? Bytes{0, 200, 0, 255} : Bytes{255, 0, 0, 0};
      texels.insert(texels.end(), texel.begin(), texel.end());
    }
    add(add_textured(width, texels), {0, 0, 0});
    scene.edit(scene.textures().first(), [&](scene::Texture &texture) { texture.mip = scene::MipFilter::Linear; });
    test::edit_material(scene, 0, [](scene::Material &material) { material.is_unlit = true; });
    const Picture picture = render({.sample_count = 1});
    for (int x = 16; x < 48; x++) {
      for (int y = 17; y < 48; y++) {
        EXPECT_EQ(picture.at(x, y).a, picture.at(x, 16).a) << width << ' ' << x << ' ' << y;
      }
    }
  }
}

TEST_F(DistantMaskGpuTest, WithoutMipLevelsIsThatOfItsTexels)
{
  add_leaf(scene::MipFilter::None);
  test::edit_material(scene, 0, [](scene::Material &material) { material.alpha_cutoff = 0.25F; });
  EXPECT_NEAR(mean(1).a, 1.0F, 1e-6F) << "alpha of each texel is at least 0.27";
}

TEST_F(TextureGpuTest, CutOutSurfacesChangeNoPixel)
{
  const auto ground = add_plain({0.5F, 0.25F, 0.75F});
  const auto ghost = add_textured(1, {255, 255, 255, 0});
  test::add_lamp(scene, scene::LampKind::Sun, {}, {1, 0.5F, -1}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Point, {1, 0, 4}, {0, 0, -1}, 10.0F);
  add(ground, {0, 0, 0}, glm::vec3(2));
  // So that the shadow maps are fitted to the same box.
  const auto post = add_plain({1, 1, 1});
  add(post, {1, 0, 2}, glm::vec3(0.1F));
  add(post, {-1, 0, 2}, glm::vec3(0.1F));
  const Picture without = render();
  add(ghost, {0.2F, 0.1F, 0.5F}, glm::vec3(0.5F));
  // At the depth of the ground.
  add(ghost, {0, 0, 0}, glm::vec3(2));
  EXPECT_EQ(render().pixels, without.pixels);
}

TEST_F(TextureGpuTest, DepthAndLitPassesCutAlike)
{
  std::mt19937 random(11);
  Bytes noise(4 * 64 * 64);
  std::generate(noise.begin(), noise.end(), [&] { return std::uint8_t(random()); });
  const auto leaf = add_textured(64, noise);
  test::edit_material(scene, 0, [&](scene::Material &material) { material.emissive = {1, 0, 0}; });
  scene.edit(scene.textures().first(),
             [](scene::Texture &texture) { texture.magnified = texture.minified = scene::TextureFilter::Linear; });
  const auto ground = add_plain({1, 1, 1});
  test::edit_material(scene, 1, [&](scene::Material &material) { material.emissive = {0, 1, 0}; });
  add(ground, {0, 0, -1}, glm::vec3(5));
  // Tilted, mirrored and small ones, so that texels are larger and smaller than pixels.
  for (int i = 0; i < 12; i++) {
    const glm::mat4 turn = glm::rotate(glm::mat4(1.0F), 0.4F * float(i), glm::vec3(1, 0.3F, 0.2F));
    const glm::vec3 scale(i % 2 == 0 ? 0.5F : -0.5F, 0.05F * float(i + 1), 1.0F);
    const glm::vec3 center(-1.2F + 0.8F * float(i % 4), -1.0F + 0.8F * float(i / 4), 0.0F);
    test::add_object(scene, leaf, glm::scale(glm::translate(glm::mat4(1.0F), center) * turn, scale));
  }
  const Picture picture = render();
  int leaf_count = 0;
  for (const glm::vec4 &pixel : picture.pixels) {
    // If they differed, nothing would be drawn.
    ASSERT_NEAR(pixel.r + pixel.g, 1.0F, 1e-5F);
    leaf_count += pixel.r > 0.5F ? 1 : 0;
  }
  EXPECT_GT(leaf_count, 200);
}

TEST_F(TextureGpuTest, MirroredTwoSidedAndTurnedLeavesKeepTheirShape)
{
  // Only the texel at the upper left is left.
  const auto leaf = add_textured(2, {255, 255, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  test::add_lamp(scene, scene::LampKind::Hemi, {}, {0, 0, -1}, 1.0F);
  const auto corners = [&](const glm::mat4 &world_from_object) {
    test::remove_objects(scene);
    test::add_object(scene, leaf, world_from_object);
    const Picture picture = render(no_shadow);
    std::string seen;
    for (const float y : {0.5F, -0.5F}) {
      for (const float x : {-0.5F, 0.5F}) {
        seen += at(picture, x, y).r > 0.0F ? 'x' : '.';
      }
    }
    return seen;
  };
  const auto scaled = [](float x, float y, float z) { return glm::scale(glm::mat4(1.0F), glm::vec3(x, y, z)); };
  const glm::mat4 half_turn = glm::rotate(glm::mat4(1.0F), float(pi), glm::vec3(0, 1, 0));
  for (const bool is_double_sided : {true, false}) {
    test::edit_material(scene, 0, [&](scene::Material &material) { material.is_double_sided = is_double_sided; });
    EXPECT_EQ(corners(scaled(1, 1, 1)), "x...");
    EXPECT_EQ(corners(scaled(-1, 1, 1)), ".x..");
    EXPECT_EQ(corners(scaled(1, -1, 1)), "..x.");
    EXPECT_EQ(corners(scaled(-1, -1, 1)), "...x");
    // From behind, the picture is mirrored, or empty for one-sided materials.
    EXPECT_EQ(corners(half_turn), is_double_sided ? ".x.." : "....");
    EXPECT_EQ(corners(scaled(1, 1, -1)), is_double_sided ? "x..." : "....");
  }
}

TEST_F(TextureGpuTest, TransformedCoordinatesWrapAsTheSamplerSays)
{
  const auto mesh = add_textured(2, four_colours(255), scene::AlphaMode::Opaque);
  // Twice as many: the right half of the square is the next image.
  scene.edit(mesh, [](scene::Mesh &value) {
    for (glm::vec2 &uv : value.uvs) {
      uv.x *= 2;
    }
  });
  add(mesh, {0, 0, 0});
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, float(pi));
  const auto is_red = [&](scene::TextureWrap wrap, float x) {
    scene.edit(scene.textures().first(), [&](scene::Texture &texture) { texture.wrap_u = wrap; });
    return at(render(), x, 0.5F).r > 0.1F;
  };
  EXPECT_TRUE(is_red(scene::TextureWrap::Repeat, 0.25F));
  EXPECT_FALSE(is_red(scene::TextureWrap::MirroredRepeat, 0.25F));
  EXPECT_TRUE(is_red(scene::TextureWrap::MirroredRepeat, 0.75F));
  EXPECT_FALSE(is_red(scene::TextureWrap::ClampToEdge, 0.75F));
}

}  // namespace
}  // namespace gnomon::eevee
