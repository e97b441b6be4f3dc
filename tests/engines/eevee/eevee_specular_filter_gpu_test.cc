// SPDX-License-Identifier: MIT
// Highlights smaller than a pixel, in one frame and in the mean of many samples, on the driver.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "reference_light.hh"
#include "scene_tangents.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;

/** A smooth metal in the plane z = 0, 16 pixels wide, seen from above under a sun from nearly there. */
class SpecularFilterGpuTest : public test::SharedDeviceTest {
 protected:
  SpecularFilterGpuTest()
  {
    material = test::add_material(scene, glm::vec3(1.0F));
    scene.edit(material, [](scene::Material &value) {
      value.metallic = 1.0F;
      value.specular = 1.0F;
      value.roughness = 0.15F;
    });
    mesh = test::add_square_mesh(scene, material);
    test::add_object(scene, mesh, glm::dmat4(1.0));
  }
  /** Normals as those of a part of a sphere. */
  void curve()
  {
    scene.edit(mesh, [](scene::Mesh &value) {
      for (std::size_t i = 0; i < value.normals.size(); i++) {
        value.normals[i] = glm::normalize(glm::vec3(0.8F * glm::vec2(value.positions[i]), 1.0F));
      }
    });
  }
  /** Normals that differ from texel to texel. */
  void roughen()
  {
    constexpr std::uint32_t edge = 32;
    std::mt19937 random(1);
    std::vector<std::uint8_t> texels;
    for (std::uint32_t i = 0; i < edge * edge; i++) {
      const auto tilt = [&] { return std::uint8_t(128 + int(random() % 41) - 20); };
      texels.insert(texels.end(), {tilt(), tilt(), 255, 255});
    }
    scene::Texture texture{.image = scene.add(scene::Image{"rough", edge, edge, texels})};
    scene.edit(material, [&](scene::Material &value) { value.normal_texture = scene.add(texture); });
    scene.edit(mesh, [&](scene::Mesh &value) {
      value.normals.assign(value.positions.size(), {0, 0, 1});
      value.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
      scene::make_tangents(value, scene.materials()[material].normal_texture);
    });
  }
  void aim_sun(const glm::vec3 &to_light)
  {
    test::remove_lamps(scene);
    const auto lamp = test::add_lamp(scene, scene::LampKind::Sun, {}, -to_light, 1.0F);
    scene.edit(lamp, [](scene::Lamp &value) { value.shadow.kind = scene::ShadowKind::None; });
  }
  Picture render(int sample_count)
  {
    Renderer renderer(*device, scene, {16, 16}, {.sample_count = sample_count});
    Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture;
  }
  static double mean(const Picture &picture)
  {
    double sum = 0.0;
    for (int y = 0; y < 16; y++) {
      for (int x = 0; x < 16; x++) {
        sum += double(picture.at(x, y).r) / 256.0;
      }
    }
    return sum;
  }

  scene::Scene scene;
  scene::Handle<scene::Material> material;
  scene::Handle<scene::Mesh> mesh;
  scene::PlacedCamera camera = test::camera_at({0, 0, 20}, {0, 0, 0}, 0.1F);
};

/** The highlight is a fifth of a pixel wide and wanders through pixels with the sun. */
TEST_F(SpecularFilterGpuTest, AHighlightOfACurvedSurfaceKeepsItsLightInOneFrame)
{
  curve();
  for (int i = 0; i < 8; i++) {
    aim_sun(glm::normalize(glm::vec3(0.05F + 0.013F * float(i), 0.03F + 0.007F * float(i), 1.0F)));
    const double ratio = mean(render(1)) / mean(render(256));
    // Measured: 0.83 to 1.40.
    EXPECT_GT(ratio, 0.7) << i;
    EXPECT_LT(ratio, 1.5) << i;
  }
}

/** Two texels a pixel, so that a pixel's neighbour has another normal. */
TEST_F(SpecularFilterGpuTest, ANormalTextureSparklesLessThanItsLobes)
{
  roughen();
  aim_sun(glm::normalize(glm::vec3(0.05F, 0.03F, 1.0F)));
  const Picture one = render(1);
  const Picture many = render(256);
  double square = 0.0;
  for (int y = 0; y < 16; y++) {
    for (int x = 0; x < 16; x++) {
      square += std::pow(double(one.at(x, y).r - many.at(x, y).r), 2.0) / 256.0;
    }
  }
  // Measured: 1.50.
  EXPECT_LT(std::sqrt(square) / mean(many), 1.7);
}

/**
 * One tilted normal for all texels. Invocations outside of a triangle would have another normal if it depended on
 * storage blocks, which llvmpipe lets them read as zeros.
 */
TEST_F(SpecularFilterGpuTest, NoEdgeOfATriangleIsSeenInANormalTexture)
{
  const auto tilted = test::add_texture(scene, 1, {148, 128, 254, 255});
  scene.edit(material, [&](scene::Material &value) {
    value.normal_texture = tilted;
    value.normal_scale = 0.75F;
  });
  scene.edit(mesh, [&](scene::Mesh &value) {
    value.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    scene::make_tangents(value, scene.materials()[material].normal_texture);
  });
  // Parallel rays, nearly.
  camera = test::camera_at({0, 0, 2000}, {0, 0, 0}, 0.001F);
  aim_sun(glm::normalize(glm::vec3(0.24F, 0.0F, 1.0F)));
  const Picture picture = render(1);
  const float middle = picture.at(8, 4).r;
  ASSERT_GT(middle, 10.0F);
  for (int y = 2; y < 14; y++) {
    for (int x = 2; x < 14; x++) {
      // The directions differ by 0.0005 from the middle, where the lobe has a width of 0.02.
      EXPECT_NEAR(picture.at(x, y).r, middle, 0.02F * middle) << x << ' ' << y;
    }
  }
}

TEST_F(SpecularFilterGpuTest, ManySamplesConvergeToTheReference)
{
  aim_sun(glm::normalize(glm::vec3(0.09F, 0.05F, 1.0F)));
  const auto relative_error = [&](int sample_count) {
    std::vector<glm::ivec2> pixels;
    for (int i = 0; i < 256; i++) {
      pixels.emplace_back(i % 16, i / 16);
    }
    const reference::Tracer tracer(scene);
    const auto truth = reference::direct_light(tracer, camera, {16, 16}, pixels, {.sample_count = 1024});
    const Picture picture = render(sample_count);
    double error = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < pixels.size(); i++) {
      error += std::pow(double(picture.at(pixels[i].x, pixels[i].y).r) - double(truth[i].r), 2.0);
      square += std::pow(double(truth[i].r), 2.0);
    }
    return std::sqrt(error / square);
  };
  curve();
  // Measured: 0.0051, as without the filter. The rest is the noise of the reference.
  EXPECT_LT(relative_error(64), 0.008);
  roughen();
  // Measured: 0.027. The driver rounds the texels that it filters to 8 bits.
  EXPECT_LT(relative_error(256), 0.05);
}

}  // namespace
}  // namespace gnomon::eevee
