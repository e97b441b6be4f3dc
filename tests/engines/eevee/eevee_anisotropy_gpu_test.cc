// SPDX-License-Identifier: MIT
// Anisotropic materials compared with closed forms and with the mean of many samples, on the driver.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "scene_tangents.hh"

#include "eevee_bsdf_shared.h"

#include <gtest/gtest.h>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;

/** A white metal in the plane z = 0, with u along +X and up along +Y, seen at 60 degrees. */
class AnisotropyGpuTest : public test::SharedDeviceTest {
 protected:
  AnisotropyGpuTest()
  {
    material = test::add_material(scene, glm::vec3(1.0F));
    mesh = test::add_square_mesh(scene, material);
    test::add_object(scene, mesh, glm::scale(glm::dmat4(1.0), glm::dvec3(4.0)));
    edit([](scene::Material &value) {
      value.metallic = 1.0F;
      value.specular = 1.0F;
      value.roughness = 0.3F;
      value.anisotropy = 0.7F;
    });
    scene.edit(mesh, [&](scene::Mesh &value) {
      value.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
      scene::make_tangents(value, {});
    });
    camera = test::camera_at(glm::dvec3(0.1, 0.1, 0) + 16.0 * glm::dvec3(to_view), {0.1, 0.1, 0}, 0.001F);
  }
  template <typename Change>
  void edit(Change &&change)
  {
    scene.edit(material, change);
  }
  void add_sun()
  {
    test::add_lamp(scene, scene::LampKind::Sun, {}, -to_light, shared::PI);
  }
  float middle(int sample_count = 1)
  {
    Renderer renderer(*device, scene, {4, 4}, {.sample_count = sample_count});
    const Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture.middle().r;
  }
  /** The sun's light from a lobe whose rougher axis is at \a rotation from +X, for a Fresnel term of 1. */
  [[nodiscard]] float expected(float anisotropy, float rotation) const
  {
    const glm::vec3 half_vector = glm::normalize(to_light + to_view);
    const auto in_axes = [&](const glm::vec3 &v) {
      const float c = std::cos(rotation);
      const float s = std::sin(rotation);
      return glm::vec3(c * v.x + s * v.y, c * v.y - s * v.x, v.z);
    };
    const float alpha = 0.3F * 0.3F;
    const glm::vec2 alphas(alpha + (1.0F - alpha) * anisotropy * anisotropy, alpha);
    return shared::PI * to_light.z *
           shared::anisotropic_ggx_lobe(in_axes(to_light), in_axes(to_view), in_axes(half_vector), alphas);
  }

  scene::Scene scene;
  scene::Handle<scene::Material> material;
  scene::Handle<scene::Mesh> mesh;
  scene::PlacedCamera camera;
  glm::vec3 to_view = {0.866025F, 0.0F, 0.5F};
  glm::vec3 to_light = glm::normalize(glm::vec3(-0.7F, 0.1F, 0.5F));
};

TEST_F(AnisotropyGpuTest, IsRougherInTheDirectionOfTheRotation)
{
  add_sun();
  for (const float anisotropy : {0.3F, 0.7F, 1.0F}) {
    for (const float rotation : {0.0F, 0.5F, 0.5F * shared::PI, 4.0F}) {
      edit([&](scene::Material &value) {
        value.anisotropy = anisotropy;
        value.anisotropy_rotation = rotation;
      });
      const float light = expected(anisotropy, rotation);
      // The middle of four pixels is beside the axis of the camera, whose rays are not quite parallel.
      // Measured: 2.7e-3.
      EXPECT_NEAR(middle(), light, 5e-3F * light) << anisotropy << ' ' << rotation;
    }
  }
}

/** A mirrored image turns the direction, not the light. */
TEST_F(AnisotropyGpuTest, TheRotationIsCounterClockwiseOnTheImageAlsoMirrored)
{
  add_sun();
  edit([](scene::Material &value) { value.anisotropy_rotation = 0.5F; });
  scene.edit(mesh, [&](scene::Mesh &value) {
    value.uvs = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
    scene::make_tangents(value, {});
  });
  const float light = expected(0.7F, -0.5F);
  EXPECT_NEAR(middle(), light, 5e-3F * light);
}

TEST_F(AnisotropyGpuTest, ATextureGivesTheDirectionAndScalesTheStrength)
{
  add_sun();
  // The direction (-0.6, 0.8), and a half of the strength.
  const auto turned = test::add_texture(scene, 1, {51, 230, 128, 255});
  edit([&](scene::Material &value) {
    value.anisotropy = 1.0F;
    value.anisotropy_rotation = 0.4F;
    value.anisotropy_texture = turned;
  });
  const float light = expected(128.0F / 255.0F, std::atan2(0.8F, -0.6F) + 0.4F);
  // Half a step of 8 bits turns the direction by 0.002.
  EXPECT_NEAR(middle(), light, 0.01F * light);
}

TEST_F(AnisotropyGpuTest, WithoutTangentsItIsRoundAlsoUnderACoat)
{
  add_sun();
  edit([](scene::Material &value) {
    value.anisotropy = 0.0F;
    value.coat = 0.5F;
  });
  const float round = middle();
  edit([](scene::Material &value) { value.anisotropy = 1.0F; });
  EXPECT_LT(middle(), 0.9F * round);
  scene.edit(mesh, [](scene::Mesh &value) { value.tangents.clear(); });
  EXPECT_NEAR(middle(), round, 1e-4F * round);
}

TEST_F(AnisotropyGpuTest, ReflectsNoMoreOfAWhiteWorldThanItReceives)
{
  scene.set_world(scene::World{});
  for (const float anisotropy : {0.5F, 1.0F}) {
    edit([&](scene::Material &value) { value.anisotropy = anisotropy; });
    const float one_frame = middle();
    EXPECT_LT(one_frame, 1.002F) << anisotropy;
    EXPECT_GT(one_frame, 0.5F) << anisotropy;
    const float sampled = middle(128);
    EXPECT_LT(sampled, 1.03F) << anisotropy;
    // One frame has the albedo of a round lobe. Measured: 0.20 more for the largest anisotropy, which loses most light.
    EXPECT_NEAR(one_frame, sampled, anisotropy < 1.0F ? 0.1F : 0.25F) << anisotropy;
  }
}

/** The lobe of one direction, made wider, stands for the mean over the lamp. */
TEST_F(AnisotropyGpuTest, OneFrameOfAnAreaLampIsNearTheMeanOfItsSamples)
{
  const auto lamp = test::add_lamp(scene, scene::LampKind::Area, 4.0F * to_light, -to_light, 10.0F);
  scene.edit(lamp, [](scene::Lamp &value) { value.shadow.kind = scene::ShadowKind::None; });
  for (const float anisotropy : {0.3F, 0.7F}) {
    for (const float rotation : {0.0F, 0.5F * shared::PI}) {
      edit([&](scene::Material &value) {
        value.anisotropy = anisotropy;
        value.anisotropy_rotation = rotation;
      });
      const float mean = middle(256);
      const float ratio = middle() / mean;
      // Measured: 0.78 to 0.98.
      EXPECT_GT(ratio, 0.7F) << anisotropy << ' ' << rotation;
      EXPECT_LT(ratio, 1.1F) << anisotropy << ' ' << rotation;
    }
  }
}

}  // namespace
}  // namespace gnomon::eevee
