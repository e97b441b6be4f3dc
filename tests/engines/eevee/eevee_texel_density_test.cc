// SPDX-License-Identifier: MIT
#include "eevee_texel_density.hh"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <array>

namespace gnomon::eevee {
namespace {

TEST(TexelDensityTest, ColoursGoFromRedOverGreenToBlueAndEndAtTheScalesEnds)
{
  const glm::vec3 red = texel_density_color(1.0F / texel_density_max);
  const glm::vec3 green = texel_density_color(1.0F);
  const glm::vec3 blue = texel_density_color(texel_density_max);
  EXPECT_GT(red.r, 2.0F * std::max(red.g, red.b));
  EXPECT_GT(green.g, 2.0F * std::max(green.r, green.b));
  EXPECT_GT(blue.b, 2.0F * std::max(blue.r, blue.g));
  for (const float beyond : {1e-30F, 0.1F}) {
    EXPECT_EQ(texel_density_color(beyond), red);
    EXPECT_EQ(texel_density_color(1.0F / beyond), blue);
  }
  // Without jumps, and without two densities of the same colour: 64 steps over the scale.
  glm::vec3 before = red;
  for (int i = 1; i <= 64; i++) {
    const glm::vec3 color = texel_density_color(std::exp2(float(i) / 16.0F - 2.0F));
    const float step = glm::distance(color, before);
    EXPECT_GT(step, 0.01F) << i;
    EXPECT_LT(step, 0.1F) << i;
    before = color;
  }
}

TEST(TexelDensityTest, APictureKeepsItsBrightnessAndItsAlphaAndIsGreyWithoutADensity)
{
  std::array<std::uint8_t, 16> rgba = {200, 40, 10, 255, 0, 0, 0, 128, 255, 255, 255, 7, 0, 0, 0, 0};
  show_texel_density(rgba, std::array{0.0F, 1.0F, 1.0F, 0.0F});
  const auto channel = [&](int pixel, int index) { return int(rgba[std::size_t(4 * pixel + index)]); };
  // 0.2126 * 200 + 0.7152 * 40 + 0.0722 * 10
  for (int i = 0; i < 3; i++) {
    EXPECT_EQ(channel(0, i), 72);
    EXPECT_EQ(channel(3, i), 0);
    EXPECT_EQ(channel(2, i), int(std::lround(255.0F * texel_density_color(1.0F)[i])));
  }
  EXPECT_GT(channel(1, 1), 50) << "the colour is seen in the dark";
  EXPECT_LT(channel(1, 1), channel(2, 1));
  EXPECT_EQ(channel(0, 3), 255);
  EXPECT_EQ(channel(1, 3), 128);
  EXPECT_EQ(channel(2, 3), 7);
  EXPECT_EQ(channel(3, 3), 0);
}

}  // namespace
}  // namespace gnomon::eevee
