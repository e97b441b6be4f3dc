// SPDX-License-Identifier: MIT
// The inputs of materials compared with closed forms and with the reference, on the driver.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "reference_light.hh"
#include "scene_tangents.hh"

#include "eevee_bsdf_shared.h"

#include <gtest/gtest.h>

#include <numbers>
#include <utility>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;
using Bytes = std::vector<std::uint8_t>;

using std::numbers::pi;

/** A white Lambertian square that fills the view, and a sun that lights it with radiance 1. */
class MaterialGpuTest : public test::SharedDeviceTest {
 protected:
  MaterialGpuTest()
  {
    material = test::add_material(scene, glm::vec3(1.0F));
    mesh = test::add_square_mesh(scene, material);
    test::add_object(scene, mesh, glm::scale(glm::dmat4(1.0), glm::dvec3(4.0)));
    scene.edit(mesh, [](scene::Mesh &value) {
      value.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
      value.second_uvs = {{0.75F, 0.5F}, {0.75F, 0.5F}, {0.75F, 0.5F}, {0.75F, 0.5F}};
    });
  }
  void add_sun(const glm::vec3 &forward = {0, 0, -1})
  {
    test::add_lamp(scene, scene::LampKind::Sun, {}, forward, float(pi));
  }
  template <typename Change>
  void edit(Change &&change)
  {
    scene.edit(material, change);
  }
  /** A texture of texels in one row, not filtered. */
  scene::Handle<scene::Texture> texture(const Bytes &texels)
  {
    return test::add_texture(scene, std::uint32_t(texels.size() / 4), texels);
  }
  Picture render()
  {
    Renderer renderer(*device, scene, {16, 16});
    Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture;
  }
  glm::vec3 middle()
  {
    return glm::vec3(render().at(8, 8));
  }
  /** The middle pixel of the reference picture. */
  glm::vec3 reference_middle()
  {
    const reference::Tracer tracer(scene);
    const std::vector<glm::ivec2> pixels = {{8, 8}};
    return glm::vec3(reference::direct_light(tracer, camera, {16, 16}, pixels, {.sample_count = 4}).front());
  }

  scene::Scene scene;
  scene::Handle<scene::Material> material;
  scene::Handle<scene::Mesh> mesh;
  scene::PlacedCamera camera = test::camera_at({0.1, 0.1, 16}, {0.1, 0.1, 0}, 0.05F);
};

/** Tolerance of llvmpipe's filter and its sRGB table. */
constexpr float texel_tolerance = 3e-3F;

TEST_F(MaterialGpuTest, VertexColoursMultiplyTheBaseColour)
{
  add_sun();
  edit([](scene::Material &value) { value.base_color = {1.0F, 0.5F, 0.25F}; });
  scene.edit(mesh, [](scene::Mesh &value) { value.colors.assign(4, {0.5F, 0.25F, 1.0F, 1.0F}); });
  test::expect_near(middle(), {0.5F, 0.125F, 0.25F}, 1e-4F);
  test::expect_near(reference_middle(), {0.5F, 0.125F, 0.25F}, 1e-5F);
}

TEST_F(MaterialGpuTest, VertexAlphaCutsAMaskAndItsShadow)
{
  add_sun();
  edit([](scene::Material &value) { value.alpha_mode = scene::AlphaMode::Mask; });
  scene.edit(mesh, [](scene::Mesh &value) { value.colors.assign(4, glm::vec4(1.0F, 1.0F, 1.0F, 0.25F)); });
  const auto ground = test::add_material(scene, glm::vec3(0.5F));
  test::add_object(scene, test::add_square_mesh(scene, ground),
                   glm::translate(glm::scale(glm::dmat4(1.0), glm::dvec3(4.0)), glm::dvec3(0, 0, -0.5)));
  test::expect_near(middle(), glm::vec3(0.5F), 1e-4F);
  test::expect_near(reference_middle(), glm::vec3(0.5F), 1e-5F);
}

TEST_F(MaterialGpuTest, EachSlotHasItsOwnSetAndTransform)
{
  add_sun();
  const auto halves = texture({255, 0, 0, 255, 0, 255, 0, 255});
  edit([&](scene::Material &value) { value.base_color_texture = halves; });
  test::expect_near(middle(), {0, 1, 0}, texel_tolerance);
  edit([](scene::Material &value) { value.base_color_texture.offset.x = 0.5F; });
  test::expect_near(middle(), {1, 0, 0}, texel_tolerance);
  test::expect_near(reference_middle(), {1, 0, 0}, 1e-5F);
  edit([](scene::Material &value) { value.base_color_texture.uv_set = 1; });
  test::expect_near(middle(), {1, 0, 0}, texel_tolerance);
  edit([](scene::Material &value) { value.base_color_texture.offset.x = 0.0F; });
  test::expect_near(middle(), {0, 1, 0}, texel_tolerance);
  test::expect_near(reference_middle(), {0, 1, 0}, 1e-5F);
}

TEST_F(MaterialGpuTest, EmissiveTextureMultipliesTheFactorAlsoWithoutLight)
{
  edit([&](scene::Material &value) {
    value.emissive = {2.0F, 1.0F, 1.0F};
    value.emissive_texture = texture({255, 0, 255, 255});
  });
  test::expect_near(middle(), {2, 0, 1}, 2 * texel_tolerance);
  test::expect_near(reference_middle(), {2, 0, 1}, 1e-5F);
}

TEST_F(MaterialGpuTest, MetallicRoughnessTexturesAreLinearAndMultiplyTheFactors)
{
  add_sun({0.3F, 0, -1});
  const auto expected_of = [&](float metallic, float roughness) {
    edit([&](scene::Material &value) {
      value.base_color = {0.9F, 0.5F, 0.2F};
      value.metallic_roughness_texture = {};
      value.metallic = metallic;
      value.roughness = roughness;
    });
    return middle();
  };
  const glm::vec3 expected = expected_of(0.5F * 204.0F / 255.0F, 0.8F * 128.0F / 255.0F);
  edit([&](scene::Material &value) {
    value.metallic = 0.5F;
    value.roughness = 0.8F;
    value.metallic_roughness_texture = texture({7, 128, 204, 255});
  });
  test::expect_near(middle(), expected, texel_tolerance);
  test::expect_near(reference_middle(), expected, texel_tolerance);
}

TEST_F(MaterialGpuTest, SpecularTexturesMultiplyTheFactors)
{
  add_sun();
  edit([](scene::Material &value) {
    value.base_color = glm::vec3(0.0F);
    value.specular_color = {1.0F, 0.5F, 1.0F};
    value.roughness = 0.5F;
    value.specular = 0.5F;
  });
  const glm::vec3 half = middle();
  ASSERT_GT(half.r, 0.01F);
  edit([&](scene::Material &value) {
    value.specular = 1.0F;
    value.specular_color = glm::vec3(1.0F);
    value.specular_texture = texture({0, 0, 0, 128});
    value.specular_color_texture = texture({255, 188, 255, 255});
  });
  test::expect_near(middle(), half, 0.01F * half.r + 1e-4F);
  test::expect_near(reference_middle(), half, 0.01F * half.r + 1e-4F);
}

/** A normal tilted by 45 degrees towards +X, and a sun from +X at 45 degrees, which it faces. */
TEST_F(MaterialGpuTest, NormalTextureTurnsTheNormalInTheTangentFrame)
{
  add_sun({-1, 0, -1});
  test::expect_near(middle(), glm::vec3(std::sqrt(0.5F)), 1e-3F);
  const auto tilted = texture({218, 128, 218, 255});
  edit([&](scene::Material &value) { value.normal_texture = tilted; });
  scene.edit(mesh,
             [&](scene::Mesh &value) { scene::make_tangents(value, scene.materials()[material].normal_texture); });
  test::expect_near(middle(), glm::vec3(1.0F), 1e-3F);
  test::expect_near(reference_middle(), glm::vec3(1.0F), 1e-3F);
  // Tilted away from the sun: orthogonal to it.
  edit([](scene::Material &value) { value.normal_scale = -1.0F; });
  test::expect_near(middle(), glm::vec3(0.0F), 0.02F);
  test::expect_near(reference_middle(), glm::vec3(0.0F), 0.02F);
  // A mirrored object mirrors its image: the normal is still tilted along the image's u, which now points to -X.
  edit([](scene::Material &value) { value.normal_scale = 1.0F; });
  const auto node = scene.nodes().first();
  scene.set_transform(node, glm::scale(glm::dmat4(1.0), {-4.0, 4.0, 4.0}));
  test::expect_near(middle(), glm::vec3(0.0F), 0.02F);
  test::expect_near(reference_middle(), glm::vec3(0.0F), 0.02F);
}

TEST_F(MaterialGpuTest, GreenOfANormalTexturePointsUpTheImageAlsoMirrored)
{
  // From +Y at 45 degrees; up the image is +Y.
  add_sun({0, -1, -1});
  edit([&](scene::Material &value) { value.normal_texture = texture({128, 218, 218, 255}); });
  scene.edit(mesh,
             [&](scene::Mesh &value) { scene::make_tangents(value, scene.materials()[material].normal_texture); });
  test::expect_near(middle(), glm::vec3(1.0F), 1e-3F);
  scene.set_transform(scene.nodes().first(), glm::scale(glm::dmat4(1.0), {-4.0, 4.0, 4.0}));
  test::expect_near(middle(), glm::vec3(1.0F), 1e-3F);
  test::expect_near(reference_middle(), glm::vec3(1.0F), 1e-3F);
}

TEST_F(MaterialGpuTest, NormalTextureLetsNoLightThroughTheSurface)
{
  // From below the plane, at 10 degrees; the normal is turned towards it by 45.
  const float angle = 0.17F;
  add_sun({-std::cos(angle), 0, std::sin(angle)});
  scene.edit(scene.lamps().first(), [](scene::Lamp &lamp) { lamp.shadow.kind = scene::ShadowKind::None; });
  edit([&](scene::Material &value) { value.normal_texture = texture({218, 128, 218, 255}); });
  scene.edit(mesh,
             [&](scene::Mesh &value) { scene::make_tangents(value, scene.materials()[material].normal_texture); });
  EXPECT_EQ(middle(), glm::vec3(0.0F));
}

TEST_F(MaterialGpuTest, OcclusionAffectsAmbientLightOnly)
{
  test::add_lamp(scene, scene::LampKind::Hemi, {}, {0, 0, -1}, float(pi));
  const auto dark = texture({51, 255, 255, 255});
  edit([&](scene::Material &value) {
    value.occlusion_texture = dark;
    value.occlusion_strength = 0.5F;
  });
  // 1 + 0.5 (0.2 - 1).
  test::expect_near(middle(), glm::vec3(0.6F), texel_tolerance);
  test::expect_near(reference_middle(), glm::vec3(0.6F), 1e-5F);
  test::remove_lamps(scene, [](const scene::Lamp &) { return true; });
  add_sun();
  test::expect_near(middle(), glm::vec3(1.0F), 1e-3F);
  test::expect_near(reference_middle(), glm::vec3(1.0F), 1e-5F);
}

TEST_F(MaterialGpuTest, UnlitIsTheBaseColourWhateverTheLight)
{
  edit([](scene::Material &value) {
    value.is_unlit = true;
    value.base_color = {0.25F, 0.5F, 0.75F};
    value.emissive = glm::vec3(9.0F);
  });
  test::expect_near(middle(), {0.25F, 0.5F, 0.75F}, 1e-6F);
  add_sun();
  test::expect_near(middle(), {0.25F, 0.5F, 0.75F}, 1e-6F);
  test::expect_near(reference_middle(), {0.25F, 0.5F, 0.75F}, 1e-6F);
  edit([&](scene::Material &value) { value.base_color_texture = texture({255, 0, 255, 255}); });
  test::expect_near(middle(), {0.25F, 0.0F, 0.75F}, texel_tolerance);
  test::expect_near(reference_middle(), {0.25F, 0.0F, 0.75F}, 1e-6F);
}

TEST_F(MaterialGpuTest, AMeshWithoutUvsDoesNotEmitByATexture)
{
  edit([&](scene::Material &value) {
    value.emissive = glm::vec3(1.0F);
    value.emissive_texture = texture({255, 255, 255, 255});
  });
  scene.edit(mesh, [](scene::Mesh &value) { value.uvs.clear(); });
  EXPECT_EQ(middle(), glm::vec3(0.0F));
  EXPECT_EQ(reference_middle(), glm::vec3(0.0F));
}

/** The square seen at 60 degrees, under a sun that it almost mirrors. */
class LayersGpuTest : public MaterialGpuTest {
 protected:
  LayersGpuTest()
  {
    camera = test::camera_at(glm::dvec3(0.1, 0.1, 0) + 16.0 * glm::dvec3(to_view), {0.1, 0.1, 0}, 0.001F);
  }
  void add_mirrored_sun()
  {
    add_sun(-to_light);
  }
  /** The sun's light from a lobe, for a Fresnel term of 1. */
  [[nodiscard]] float ggx(float roughness) const
  {
    return float(pi) * to_light.z * shared::ggx_lobe(to_light.z, to_view.z, half_vector.z, roughness * roughness);
  }

  glm::vec3 to_view = {0.866025F, 0.0F, 0.5F};
  glm::vec3 to_light = glm::normalize(glm::vec3(-0.7F, 0.1F, 0.5F));
  glm::vec3 half_vector = glm::normalize(to_light + to_view);
};

TEST_F(LayersGpuTest, ACoatReflectsByItsRoughnessAndDimsTheBase)
{
  add_mirrored_sun();
  for (const float roughness : {0.4F, 0.7F}) {
    edit([&](scene::Material &value) {
      value.base_color = {0.5F, 0.25F, 0.125F};
      value.coat = 0.75F;
      value.coat_roughness = roughness;
    });
    const float share = 0.75F * (0.04F + 0.96F * std::pow(1.0F - to_view.z, 5.0F));
    const glm::vec3 base = to_light.z * glm::vec3(0.5F, 0.25F, 0.125F);
    const glm::vec3 expected = (1.0F - share) * base + share * ggx(roughness);
    test::expect_near(middle(), expected, 2e-3F * expected.r);
  }
}

TEST_F(LayersGpuTest, ACoatDimsEmission)
{
  add_sun({0, 0, 1});
  edit([](scene::Material &value) {
    value.emissive = glm::vec3(1.0F);
    value.coat = 1.0F;
    value.is_double_sided = false;
  });
  scene.edit(scene.lamps().first(), [](scene::Lamp &lamp) { lamp.shadow.kind = scene::ShadowKind::None; });
  test::expect_near(middle(), glm::vec3(1.0F - (0.04F + 0.96F / 32.0F)), 1e-3F);
}

TEST_F(LayersGpuTest, SheenIsThatOfFibresAndLeavesTheRestToTheBase)
{
  add_mirrored_sun();
  const glm::vec3 color(0.25F, 0.5F, 1.0F);
  for (const float roughness : {0.3F, 0.5F, 1.0F}) {
    edit([&](scene::Material &value) {
      value.base_color = glm::vec3(0.5F);
      value.sheen_color = color;
      value.sheen_roughness = roughness;
    });
    const float alpha = roughness * roughness;
    double albedo = 0.0;
    constexpr int count = 256;
    for (int i = 0; i < count; i++) {
      for (int j = 0; j < count; j++) {
        const float cos_l = (float(i) + 0.5F) / count;
        const float azimuth = 2.0F * float(pi) * (float(j) + 0.5F) / count;
        const float sin_l = std::sqrt(1.0F - cos_l * cos_l);
        const glm::vec3 direction(sin_l * std::cos(azimuth), sin_l * std::sin(azimuth), cos_l);
        const float cos_h = glm::normalize(direction + to_view).z;
        albedo += 2.0 * float(pi) / (count * count) * cos_l * shared::sheen_lobe(cos_l, to_view.z, cos_h, alpha);
      }
    }
    ASSERT_LT(albedo, 1.0);
    const float lobe = float(pi) * to_light.z * shared::sheen_lobe(to_light.z, to_view.z, half_vector.z, alpha);
    const glm::vec3 expected = color * lobe + (1.0F - float(albedo)) * 0.5F * to_light.z;
    // The albedo is interpolated in a table.
    test::expect_near(middle(), expected, 5e-3F * expected.b);
  }
}

TEST_F(LayersGpuTest, TexturesMultiplyTheFactorsOfLayers)
{
  add_mirrored_sun();
  const auto layered = [&](float coat, float coat_roughness, float sheen, float sheen_roughness) {
    edit([&](scene::Material &value) {
      value.base_color = glm::vec3(0.0F);
      value.coat = coat;
      value.coat_roughness = coat_roughness;
      value.sheen_color = {0.5F, sheen, 0.5F};
      value.sheen_roughness = sheen_roughness;
    });
    return middle();
  };
  const glm::vec3 expected = layered(0.8F * 153.0F / 255.0F, 0.9F * 102.0F / 255.0F, 0.25F, 0.8F * 204.0F / 255.0F);
  const auto data = texture({153, 102, 0, 204});
  // 188 is 0.503 in linear values.
  const auto color = texture({255, 188, 255, 255});
  edit([&](scene::Material &value) {
    value.coat_texture = value.coat_roughness_texture = value.sheen_roughness_texture = data;
    value.sheen_color_texture = color;
  });
  const glm::vec3 textured = layered(0.8F, 0.9F, 0.5F, 0.8F);
  test::expect_near(textured, expected, 0.01F * expected.r);
  // Each texture has an effect.
  for (scene::TextureSlot scene::Material::*slot :
       {&scene::Material::coat_texture, &scene::Material::coat_roughness_texture, &scene::Material::sheen_color_texture,
        &scene::Material::sheen_roughness_texture}) {
    scene::TextureSlot kept;
    edit([&](scene::Material &value) { kept = std::exchange(value.*slot, {}); });
    EXPECT_GT(glm::length(middle() - textured), 1e-4F);
    edit([&](scene::Material &value) { value.*slot = kept; });
  }
}

TEST_F(LayersGpuTest, ABlendedSurfaceHasTheSameLayers)
{
  add_mirrored_sun();
  edit([&](scene::Material &value) {
    value.base_color = {0.5F, 0.25F, 0.125F};
    value.coat = 1.0F;
    value.coat_roughness = 0.5F;
    value.coat_texture = texture({153, 255, 255, 255});
    value.sheen_color = glm::vec3(0.25F);
    value.sheen_roughness = 0.5F;
  });
  const glm::vec3 opaque = middle();
  edit([](scene::Material &value) {
    value.alpha_mode = scene::AlphaMode::Blend;
    value.alpha = 0.5F;
  });
  test::expect_near(middle(), 0.5F * opaque, 1e-5F);
}

TEST_F(LayersGpuTest, WithoutTheirFactorsLayersChangeNoBit)
{
  add_mirrored_sun();
  test::add_lamp(scene, scene::LampKind::Point, {1, 1, 1}, {0, 0, -1}, 5.0F);
  edit([](scene::Material &value) { value.specular_color = glm::vec3(1.0F); });
  const Picture plain = render();
  edit([&](scene::Material &value) {
    value.coat_roughness = 0.5F;
    value.coat_texture = texture({255, 255, 255, 255});
    value.sheen_roughness = 0.5F;
  });
  const Picture picture = render();
  edit([&](scene::Material &value) { value.coat = 1.0F; });
  const Picture coated = render();
  bool is_coat_seen = false;
  for (int y = 0; y < 16; y++) {
    for (int x = 0; x < 16; x++) {
      EXPECT_EQ(picture.at(x, y), plain.at(x, y));
      is_coat_seen |= coated.at(x, y) != plain.at(x, y);
    }
  }
  EXPECT_TRUE(is_coat_seen);
}

TEST_F(LayersGpuTest, ACoatIsAsSmoothAsTheMesh)
{
  add_mirrored_sun();
  edit([&](scene::Material &value) {
    value.base_color = glm::vec3(0.0F);
    value.coat = 1.0F;
    value.coat_roughness = 0.3F;
  });
  const glm::vec3 smooth = middle();
  ASSERT_GT(smooth.r, 0.05F);
  // The base is turned away from the sun.
  edit([&](scene::Material &value) { value.normal_texture = texture({255, 128, 140, 255}); });
  scene.edit(mesh,
             [&](scene::Mesh &value) { scene::make_tangents(value, scene.materials()[material].normal_texture); });
  test::expect_near(middle(), smooth, 1e-5F);
}

/** Whatever the base's normal texture, and its factor, are. */
TEST_F(LayersGpuTest, ACoatsNormalTextureTurnsItAsNormalsOfTheMeshWould)
{
  add_mirrored_sun();
  edit([&](scene::Material &value) {
    value.base_color = glm::vec3(0.0F);
    value.coat = 1.0F;
    value.coat_roughness = 0.3F;
  });
  const glm::vec3 smooth = middle();
  const std::vector<glm::vec3> straight = scene.meshes()[mesh].normals;
  for (const float scale : {1.0F, -1.0F}) {
    const glm::vec3 texel = glm::vec3(153, 102, 230) / 255.0F * 2.0F - 1.0F;
    const glm::vec3 tilted = glm::normalize(glm::vec3(scale * texel.x, scale * texel.y, texel.z));
    edit([](scene::Material &value) { value.coat_normal_texture = value.normal_texture = {}; });
    scene.edit(mesh, [&](scene::Mesh &value) { value.normals.assign(straight.size(), tilted); });
    const glm::vec3 expected = middle();
    EXPECT_GT(glm::length(expected - smooth), 0.1F * smooth.r);
    scene.edit(mesh, [&](scene::Mesh &value) { value.normals = straight; });
    for (const float base_scale : {0.0F, 1.0F, -1.0F}) {
      edit([&](scene::Material &value) {
        value.coat_normal_texture = texture({153, 102, 230, 255});
        value.coat_normal_scale = scale;
        value.normal_texture = base_scale == 0.0F ? scene::TextureSlot() : texture({200, 128, 140, 255});
        value.normal_scale = base_scale;
      });
      scene.edit(mesh, [&](scene::Mesh &value) {
        scene::make_tangents(value, scene.materials()[material].coat_normal_texture);
      });
      test::expect_near(middle(), expected, 1e-4F * smooth.r);
    }
  }
}

/** Each lobe alone, from one frame and from samples of the lamp. */
TEST_F(LayersGpuTest, OneFrameOfAnAreaLampIsNearTheMeanOfItsSamples)
{
  const auto ratio = [&](const glm::vec3 &direction, const auto &change) {
    test::remove_lamps(scene);
    const auto lamp = test::add_lamp(scene, scene::LampKind::Area, 2.0F * direction, -direction, 10.0F);
    scene.edit(lamp, [](scene::Lamp &value) { value.shadow.kind = scene::ShadowKind::None; });
    edit([&](scene::Material &value) {
      value.base_color = glm::vec3(0.0F);
      value.coat = 0.0F;
      value.sheen_color = glm::vec3(0.0F);
      change(value);
    });
    const auto pixel = [&](int sample_count) {
      Renderer renderer(*device, scene, {4, 4}, {.sample_count = sample_count});
      return renderer.picture(camera).middle().r;
    };
    const float mean = pixel(256);
    EXPECT_GT(mean, 1e-3F);
    return pixel(1) / mean;
  };
  for (const float roughness : {0.3F, 0.6F}) {
    EXPECT_NEAR(ratio(to_light,
                      [&](scene::Material &value) {
                        value.coat = 1.0F;
                        value.coat_roughness = roughness;
                      }),
                1.0F, 0.06F);
    EXPECT_NEAR(ratio({0.8F, 0.3F, 0.5F},
                      [&](scene::Material &value) {
                        value.sheen_color = glm::vec3(1.0F);
                        value.sheen_roughness = roughness;
                      }),
                1.0F, 0.1F);
  }
}

}  // namespace
}  // namespace gnomon::eevee
