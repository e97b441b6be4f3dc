// SPDX-License-Identifier: MIT
#include "scene_image.hh"

#include <gtest/gtest.h>

namespace gnomon::scene {
namespace {

/** An image of equal red, green and blue. */
Image grey_image(std::uint32_t width, const std::vector<std::uint8_t> &values)
{
  Image image{"grey", width, std::uint32_t(values.size()) / width, {}};
  for (const std::uint8_t value : values) {
    image.texels.insert(image.texels.end(), {value, value, value, value});
  }
  return image;
}

TEST(ReducedImage, HasTheMeanOfTheAreaOfEachTexel)
{
  const Image image = grey_image(4, {0, 100, 50, 50, 200, 100, 50, 250, 0, 0, 8, 8, 0, 0, 8, 8});
  const Image half = reduced(image, 2, false);
  EXPECT_EQ(half.name, "grey");
  ASSERT_EQ(half.width, 2U);
  ASSERT_EQ(half.height, 2U);
  EXPECT_EQ(half.texels, grey_image(2, {100, 100, 0, 8}).texels);
  // 3 texels to 2: the middle one counts for a third of both.
  EXPECT_EQ(reduced(grey_image(3, {30, 90, 150}), 2, false).texels, grey_image(2, {50, 130}).texels);
}

TEST(ReducedImage, IsTheMeanOfLightForColours)
{
  // Half the light is encoded as 188 by sRGB. Alpha is linear.
  const Image half = reduced(grey_image(2, {0, 255}), 1, true);
  EXPECT_EQ(half.texels, (std::vector<std::uint8_t>{188, 188, 188, 128}));
  for (int value = 0; value < 256; value++) {
    const Image image = grey_image(2, {std::uint8_t(value), std::uint8_t(value)});
    EXPECT_EQ(reduced(image, 1, true).texels, grey_image(1, {std::uint8_t(value)}).texels) << value;
  }
}

TEST(ReducedImage, KeepsTheRatioOfItsEdgesAndIsNeverEmpty)
{
  const auto size_of = [](std::uint32_t width, std::uint32_t height, std::uint32_t size_max) {
    const Image image =
        reduced(grey_image(width, std::vector<std::uint8_t>(std::size_t(width) * height, 7)), size_max, true);
    EXPECT_EQ(image.texels,
              grey_image(image.width, std::vector<std::uint8_t>(std::size_t(image.width) * image.height, 7)).texels);
    return std::pair(image.width, image.height);
  };
  EXPECT_EQ(size_of(100, 50, 64), std::pair(64U, 32U));
  EXPECT_EQ(size_of(50, 100, 64), std::pair(32U, 64U));
  EXPECT_EQ(size_of(4096, 1, 16), std::pair(16U, 1U));
  EXPECT_EQ(size_of(3, 2, 3), std::pair(3U, 2U));
  EXPECT_EQ(size_of(7, 5, 1), std::pair(1U, 1U));
}

}  // namespace
}  // namespace gnomon::scene
