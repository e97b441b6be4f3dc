// SPDX-License-Identifier: MIT
// Adaptive sampling on the null backend: the order of the samples, when it applies, and what it rejects.
#include "internal/eevee_adaptive.hh"
#include "eevee_pixel_filter.hh"
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"
#include "scene_studio.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace gnomon::eevee {
namespace {

TEST(AdaptiveOrder, EachSampleIsDrawnOnceAndTheFirstOnesAreSpread)
{
  for (int count = 1; count <= 300; count++) {
    EXPECT_EQ(sample_step({.sample_count = count}), 1) << "without a threshold";
    EXPECT_EQ(std::gcd(sample_step({.sample_count = count, .noise_threshold = 0.01F}), count), 1) << count;
  }
  for (const int count : {16, 32, 64, 256, 4096}) {
    const int step = sample_step({.sample_count = count, .noise_threshold = 0.01F});
    for (int i = 0; i < 4; i++) {
      const glm::vec2 offset = film_offset_px(i * step % count, count, 0);
      for (int other = 0; other < i; other++) {
        const glm::vec2 difference = offset - film_offset_px(other * step % count, count, 0);
        // The four points of a regular grid are 0.5 apart.
        EXPECT_GT(glm::length(difference - glm::round(difference)), 0.32F) << count;
      }
    }
  }
  EXPECT_EQ(sample_step({.sample_count = 0, .noise_threshold = 0.01F}), 1) << "all prefixes of the sequence are spread";
}

class AdaptiveTest : public testing::Test {
 protected:
  AdaptiveTest()
  {
    object = test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F))),
                              glm::mat4(1.0F));
    lamp = test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0, 0, -1}, 1.0F);
  }

  /** Runs of \a pass in a picture. */
  std::uint64_t runs(const Settings &settings, const std::string &pass, const gpu::Rectangle &region = {})
  {
    SceneRenderer renderer(*device, scene, {16, 12}, settings);
    renderer.sync();
    if (!region.is_whole()) {
      renderer.viewport().set_region(region);
    }
    const gpu::PassCounts before = device->pass_counts();
    renderer.draw(camera);
    const auto count = [&](const gpu::PassCounts &counts) {
      const auto found = counts.find(pass);
      return found == counts.end() ? 0 : found->second;
    };
    return count(device->pass_counts()) - count(before);
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  scene::Handle<scene::Node> object;
  scene::Handle<scene::Lamp> lamp;
  scene::PlacedCamera camera = test::camera_at({0, 0, 4}, {0, 0, 0});
  Settings adaptive{.sample_count = 16, .noise_threshold = 0.01F};
};

TEST_F(AdaptiveTest, TheFirstSamplesAreOfAllPixels)
{
  for (const auto &[count, first] : {std::pair(2, 1), {4, 2}, {8, 4}, {16, 4}, {100, 4}}) {
    EXPECT_EQ(adaptive_first_samples(count), first);
    adaptive.sample_count = count;
    EXPECT_EQ(runs(adaptive, "film"), std::uint64_t(first)) << count;
    EXPECT_EQ(runs(adaptive, "adaptive_film"), std::uint64_t(count - first)) << count;
    EXPECT_EQ(runs(adaptive, "adaptive_test"), 1U) << count;
    EXPECT_EQ(runs(adaptive, "adaptive_depth"), std::uint64_t(count - first)) << count;
    EXPECT_EQ(runs(adaptive, "adaptive_background"), std::uint64_t(count - first)) << count;
  }
}

TEST_F(AdaptiveTest, NothingIsMadeWithoutAThresholdOrFurtherSamples)
{
  for (const Settings &settings :
       {Settings{.sample_count = 16}, Settings{.sample_count = 1, .noise_threshold = 0.1F}}) {
    EXPECT_EQ(runs(settings, "adaptive_test"), 0U);
    EXPECT_EQ(runs(settings, "film"), std::uint64_t(settings.sample_count));
  }
  const auto made = [&](const Settings &settings) {
    SceneRenderer renderer(*device, scene, {16, 12}, settings);
    renderer.sync();
    renderer.draw(camera);
    const auto is_of_it = [](const gpu::LiveResource &live) {
      return live.name.find("converged") != std::string::npos || live.name.find("adaptive") != std::string::npos;
    };
    return std::ranges::count_if(device->live(), is_of_it);
  };
  // Two textures, three framebuffers and four programs.
  EXPECT_EQ(made(adaptive), 9);
  EXPECT_EQ(made({.sample_count = 16}), 0);
  EXPECT_EQ(made({.sample_count = 1, .noise_threshold = 0.1F}), 0);
  scene.edit(lamp, [](scene::Lamp &value) { value.angle = 0.1F; });
  EXPECT_EQ(made(adaptive), 0) << "a lamp with an extent";
}

TEST_F(AdaptiveTest, SamplesThatSeeOtherLightAreOfAllPixels)
{
  EXPECT_EQ(runs(adaptive, "adaptive_test"), 1U);
  EXPECT_EQ(runs(adaptive, "adaptive_test", {{0, 0}, {8, 12}}), 0U) << "a region";
  Settings part = adaptive;
  part.light.kind = LightComponent::Kind::Emission;
  EXPECT_EQ(runs(part, "adaptive_test"), 0U) << "a part of the light";
  const scene::Scene plain = scene;
  scene.set_world(scene::studio_world(camera.world_from_camera));
  EXPECT_EQ(runs(adaptive, "adaptive_test"), 0U) << "a world";
  scene = plain;
  scene.edit(lamp, [](scene::Lamp &value) { value.angle = 0.1F; });
  EXPECT_EQ(runs(adaptive, "adaptive_test"), 0U) << "a lamp with an extent";
  scene = plain;
  test::edit_material(scene, 0, [](scene::Material &material) { material.transmission = 1.0F; });
  EXPECT_EQ(runs(adaptive, "adaptive_test"), 0U) << "glass";
  scene = plain;
  test::edit_material(scene, 0, [](scene::Material &material) {
    material.alpha_mode = scene::AlphaMode::Blend;
    material.alpha = 0.5F;
  });
  EXPECT_EQ(runs(adaptive, "adaptive_test"), 0U) << "a blended caster";
}

TEST_F(AdaptiveTest, DepthsThatAreReadBackAreOfAllPixels)
{
  adaptive.sample_count = 2;
  adaptive.shadow.is_fitted_to_depth = true;
  SceneRenderer renderer(*device, scene, {16, 12}, adaptive);
  renderer.sync();
  // Both samples are prepared before the host has the depths of the first.
  std::array<gpu::Packet, 2> packets;
  for (gpu::Packet &packet : packets) {
    renderer.prepare(packet, camera);
  }
  for (gpu::Packet &packet : packets) {
    device->submit(packet);
  }
  EXPECT_EQ(device->pass_counts().count("adaptive_film"), 0U);
  EXPECT_EQ(device->pass_counts().at("film"), 2U);
}

TEST_F(AdaptiveTest, SettingsWithoutAMeaningAreRejected)
{
  const auto fails = [&](const Settings &settings) {
    try {
      SceneRenderer(*device, scene, {16, 12}, settings).sync();
    }
    catch (const gpu::Error &error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  for (const float threshold : {-0.1F, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    EXPECT_NE(fails({.noise_threshold = threshold}).find("noise_threshold"), std::string::npos) << threshold;
  }
  EXPECT_EQ(fails({.sample_count = 4, .sample_first = 1, .sample_end = 2, .noise_threshold = 0.1F}),
            "eevee: noise_threshold 0.1 needs all samples of the picture, not 1 to 2");
}

}  // namespace
}  // namespace gnomon::eevee
