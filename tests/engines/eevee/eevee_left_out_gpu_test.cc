// SPDX-License-Identifier: MIT
// Parts that are left out change no pixel, on the driver.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>

#include <algorithm>

namespace gnomon::eevee {
namespace {

using test::Renderer;

class LeftOutGpuTest : public test::SharedDeviceTest {
 protected:
  LeftOutGpuTest()
  {
    const auto plain = test::add_material(scene, glm::vec3(0.5F));
    test::add_object(scene, test::add_square_mesh(scene, plain), glm::mat4(1.0F));
    test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0, 0, -1}, 1.0F);
  }
  scene::Scene scene;
  /** Shows the square in the middle of the background. */
  scene::PlacedCamera camera = test::camera_at({0, 0, 8}, {0, 0, 0});
  scene::PlacedCamera away = test::camera_at({0, 0, 8}, {0, 0, 20});
};

TEST_F(LeftOutGpuTest, EmptyPictureEqualsTheBackgroundOfAnother)
{
  const draw::TargetTexture display(*device, "display", gpu::Format::RGBA8, {32, 32});
  Renderer renderer(*device, scene, {32, 32}, {.sample_count = 2});
  const auto bytes = [&](const scene::PlacedCamera &from) {
    const test::Picture picture = renderer.picture(from, display.target());
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return std::pair(picture, device->read(display.texture()));
  };
  // Independent of the pictures before.
  const auto [seen, seen_display] = bytes(camera);
  const auto [nothing, nothing_display] = bytes(away);
  EXPECT_GT(seen.middle().r, 0.1F);
  for (const glm::vec4 &pixel : nothing.pixels) {
    ASSERT_EQ(pixel, seen.at(0, 0));
  }
  for (std::size_t i = 0; i < nothing_display.size(); i++) {
    ASSERT_EQ(nothing_display[i], seen_display[i % 4]);
  }
}

TEST_F(LeftOutGpuTest, SunWithoutVisibleShadowsHasNoLayerAndTheSameLight)
{
  Renderer shadowed(*device, scene, {32, 32}, {.shadow = {.map_size_px = 64}});
  Renderer plain(*device, scene, {32, 32}, {.shadow = {.kind = scene::ShadowKind::None}});
  const test::Picture a = shadowed.picture(camera);
  const std::vector<std::string> live = device->live_resources();
  EXPECT_EQ(std::ranges::count(live, "texture 'shadow_maps'"), 0);
  const test::Picture b = plain.picture(camera);
  EXPECT_GT(b.middle().r, 0.1F);
  // Two programs round a radiance below 1 differently.
  for (std::size_t i = 0; i < a.pixels.size(); i++) {
    ASSERT_NEAR(a.pixels[i].r, b.pixels[i].r, 1e-6F);
  }
}

}  // namespace
}  // namespace gnomon::eevee
