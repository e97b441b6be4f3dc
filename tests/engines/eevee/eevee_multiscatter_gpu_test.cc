// SPDX-License-Identifier: MIT
// Pictures with multiple scattering on the driver: white furnaces, reciprocity, and the reference.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "reference_light.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace gnomon::eevee {
namespace {

constexpr double pi = std::numbers::pi;

/** A square in the plane z = 0 that fills the view. */
class MultiscatterGpuTest : public test::GpuDeviceTest {
 protected:
  MultiscatterGpuTest()
  {
    material = test::add_material(scene, glm::vec3(1.0F));
    test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1.0), glm::dvec3(8.0)));
    set_material(glm::vec3(1.0F), 1.0F, 0.5F);
  }
  void set_material(const glm::vec3 &color, float metallic, float roughness)
  {
    scene.edit(material, [&](scene::Material &value) {
      value.base_color = color;
      value.specular_color = glm::vec3(1.0F);
      value.metallic = metallic;
      value.roughness = roughness;
    });
  }
  /** Parallel rays from \a direction, a unit vector, to the middle of the square. */
  static scene::PlacedCamera camera_from(const glm::dvec3 &direction)
  {
    scene::PlacedCamera camera = test::camera_at(glm::vec3(4.0 * direction) + 0.1F, glm::vec3(0.1F, 0.1F, 0.1F));
    camera.kind = scene::CameraKind::Orthographic;
    camera.half_width = camera.half_height = 1e-3F;
    camera.near = 0.1F;
    camera.far = 8.0F;
    return camera;
  }
  static glm::dvec3 direction_of(double angle, double azimuth)
  {
    return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)};
  }
  glm::vec3 seen_from(const glm::dvec3 &direction, int sample_count = 1)
  {
    test::Renderer renderer(*device, scene, {3, 3},
                            {.shadow = {.map_size_px = 64}, .sample_count = sample_count, .has_multiscatter = true});
    const test::Picture picture = renderer.picture(camera_from(direction));
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return glm::vec3(picture.middle());
  }
  glm::vec3 traced_from(const glm::dvec3 &direction, int sample_count = 1)
  {
    const reference::Tracer tracer(scene);
    const std::vector<glm::ivec2> pixels = {{1, 1}};
    return glm::vec3(reference::direct_light(tracer, camera_from(direction), {3, 3}, pixels,
                                             {.sample_count = sample_count, .has_multiscatter = true})
                         .front());
  }

  scene::Scene scene;
  scene::Handle<scene::Material> material;
};

TEST_F(MultiscatterGpuTest, WhiteFurnaceInOneFrame)
{
  scene.set_world(scene::World{});
  for (const float metallic : {0.0F, 1.0F}) {
    for (const float roughness : {0.03F, 0.1F, 0.25F, 0.5F, 0.75F, 1.0F}) {
      set_material(glm::vec3(1.0F), metallic, roughness);
      for (const double angle : {0.0, 0.8, 1.3, 1.5}) {
        // The albedos of the light and of the surface are the same number.
        EXPECT_NEAR(seen_from(direction_of(angle, 0.3)).r, 1.0F, 1e-3F) << metallic << ' ' << roughness << ' ' << angle;
      }
    }
  }
}

TEST_F(MultiscatterGpuTest, WhiteFurnaceOfSampledDirections)
{
  scene.set_world(scene::World{});
  for (const float metallic : {0.0F, 1.0F}) {
    for (const float roughness : {0.03F, 0.25F, 0.5F, 0.75F, 1.0F}) {
      set_material(glm::vec3(1.0F), metallic, roughness);
      for (const double angle : {0.0, 0.8, 1.3}) {
        const float light = seen_from(direction_of(angle, 0.3), 64).r;
        std::printf("sampled %g %g %g: %g\n", double(metallic), double(roughness), angle, double(light));
      }
    }
  }
}

TEST_F(MultiscatterGpuTest, WhiteFurnaceOfASunThatFillsTheSky)
{
  scene::Lamp sun;
  sun.kind = scene::LampKind::Sun;
  // A radiance of 1 over the hemisphere.
  sun.intensity = float(pi);
  sun.angle = float(pi);
  sun.shadow.kind = scene::ShadowKind::None;
  test::add_lamp(scene, sun, glm::dmat4(1.0));
  for (const float metallic : {0.0F, 1.0F}) {
    for (const float roughness : {0.03F, 0.25F, 0.5F, 0.75F, 1.0F}) {
      set_material(glm::vec3(1.0F), metallic, roughness);
      for (const double angle : {0.0, 0.8, 1.3}) {
        const float light = seen_from(direction_of(angle, 0.3)).r;
        const float many = seen_from(direction_of(angle, 0.3), 1024).r;
        std::printf("sun %g %g %g: %g %g\n", double(metallic), double(roughness), angle, double(light), double(many));
      }
    }
  }
}

TEST_F(MultiscatterGpuTest, IsThatOfTheReferenceAndReciprocal)
{
  scene::Lamp sun;
  sun.kind = scene::LampKind::Sun;
  sun.shadow.kind = scene::ShadowKind::None;
  test::add_lamp(scene, sun, glm::dmat4(1.0));
  const scene::Handle<scene::Node> lamp_node = scene.placed_lamps().front().node;
  const glm::dvec3 a = direction_of(0.4, 0.0);
  const glm::dvec3 b = direction_of(1.2, 2.0);
  for (const float metallic : {0.0F, 1.0F}) {
    for (const float roughness : {0.1F, 0.5F, 1.0F}) {
      set_material({1.0F, 0.7F, 0.2F}, metallic, roughness);
      glm::vec3 brdf[2];
      for (int i = 0; i < 2; i++) {
        const glm::dvec3 to_light = i == 0 ? a : b;
        const glm::dvec3 view = i == 0 ? b : a;
        scene.set_transform(lamp_node, glm::inverse(glm::lookAt(glm::dvec3(0.0), -to_light, glm::dvec3(0, 1, 0.1))));
        const glm::vec3 drawn = seen_from(view);
        const glm::vec3 traced = traced_from(view);
        brdf[i] = drawn / float(to_light.z);
        for (int channel = 0; channel < 3; channel++) {
          // The engine's table has 32 rows, that of the reference 48.
          EXPECT_NEAR(drawn[channel] / traced[channel], 1.0F, 3e-3F) << metallic << ' ' << roughness << ' ' << i;
        }
      }
      for (int channel = 0; channel < 3; channel++) {
        // Driver: the filter of the table has eight bits of its weights on some devices.
        EXPECT_NEAR(brdf[0][channel] / brdf[1][channel], 1.0F, 1e-4F) << metallic << ' ' << roughness;
      }
    }
  }
}

TEST_F(MultiscatterGpuTest, RoughCoatsLoseNoLight)
{
  scene.set_world(scene::World{});
  set_material(glm::vec3(1.0F), 0.0F, 0.6F);
  for (const float roughness : {0.1F, 0.6F, 1.0F}) {
    scene.edit(material, [&](scene::Material &value) {
      value.coat = 1.0F;
      value.coat_roughness = roughness;
    });
    for (const double angle : {0.0, 1.0, 1.4}) {
      EXPECT_NEAR(seen_from(direction_of(angle, 0.3)).r, 1.0F, 1e-3F) << roughness << ' ' << angle;
    }
  }
}

}  // namespace
}  // namespace gnomon::eevee
