// SPDX-License-Identifier: MIT
#include "scene_image.hh"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

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
  const Image half = reduced(image, 2, ImageUse::Data);
  EXPECT_EQ(half.name, "grey");
  ASSERT_EQ(half.width, 2U);
  ASSERT_EQ(half.height, 2U);
  EXPECT_EQ(half.texels, grey_image(2, {100, 100, 0, 8}).texels);
  // 3 texels to 2: the middle one counts for a third of both.
  EXPECT_EQ(reduced(grey_image(3, {30, 90, 150}), 2, ImageUse::Data).texels, grey_image(2, {50, 130}).texels);
}

TEST(ReducedImage, IsTheMeanOfLightForColours)
{
  // Half the light is encoded as 188 by sRGB. Alpha is linear.
  const Image half = reduced(grey_image(2, {0, 255}), 1, ImageUse::Color);
  EXPECT_EQ(half.texels, (std::vector<std::uint8_t>{188, 188, 188, 128}));
  for (int value = 0; value < 256; value++) {
    const Image image = grey_image(2, {std::uint8_t(value), std::uint8_t(value)});
    EXPECT_EQ(reduced(image, 1, ImageUse::Color).texels, grey_image(1, {std::uint8_t(value)}).texels) << value;
  }
}

TEST(ReducedImage, KeepsTheRatioOfItsEdgesAndIsNeverEmpty)
{
  const auto size_of = [](std::uint32_t width, std::uint32_t height, std::uint32_t size_max) {
    const Image image = reduced(grey_image(width, std::vector<std::uint8_t>(std::size_t(width) * height, 7)), size_max,
                                ImageUse::Color);
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

TEST(CoverageLevels, WeighColoursByAlphaAndKeepTheMeanOfAlpha)
{
  // One transparent, black texel in four.
  const std::vector<std::uint8_t> leaf{40, 160, 30, 255};
  Image image{"leaf", 4, 2, {}};
  for (int i = 0; i < 8; i++) {
    const std::vector<std::uint8_t> texel = i % 4 == 3 ? std::vector<std::uint8_t>(4, 0) : leaf;
    image.texels.insert(image.texels.end(), texel.begin(), texel.end());
  }
  const std::vector<std::uint8_t> levels = coverage_levels(image);
  // 4x2, 2x1 and 1x1 texels.
  ASSERT_EQ(levels.size(), 4U * (8 + 2 + 1));
  for (std::size_t i = 0; i < levels.size(); i += 4) {
    EXPECT_EQ(std::vector(levels.begin() + std::ptrdiff_t(i), levels.begin() + std::ptrdiff_t(i) + 3),
              std::vector(leaf.begin(), leaf.begin() + 3))
        << "texel " << i / 4;
  }
  for (std::size_t i = 0; i < 8; i++) {
    EXPECT_EQ(levels[4 * i + 3], image.texels[4 * i + 3]);
  }
  EXPECT_EQ(levels[4 * 8 + 3], 255);
  EXPECT_EQ(levels[4 * 9 + 3], 128);
  EXPECT_EQ(levels[4 * 10 + 3], 191);
}

TEST(CoverageLevels, OfAMaskAreSharesOfTheTexelsAtLeastAtItsCutoff)
{
  // Alpha of 0, 76, 77 and 255: of a cutoff of 0.3, which is 76.5, the last two are left.
  Image image{"mask", 2, 2, {9, 9, 9, 0, 200, 0, 0, 76, 0, 200, 0, 77, 0, 200, 0, 255}};
  std::vector<std::uint8_t> levels = coverage_levels(image, {0.3F});
  ASSERT_EQ(levels.size(), 20U);
  EXPECT_TRUE(std::equal(levels.begin() + 4, levels.begin() + 16, image.texels.begin() + 4)) << "the image";
  EXPECT_EQ(std::vector(levels.begin() + 16, levels.end()), (std::vector<std::uint8_t>{0, 200, 0, 128}));
  EXPECT_EQ(coverage_levels(image, {0.1F})[19], 191);
  EXPECT_EQ(coverage_levels({"none", 1, 2, {1, 1, 1, 99, 1, 1, 1, 99}}, {0.5F})[11], 0);
}

TEST(CoverageLevels, AreNotOfMasksThatHideNothing)
{
  const auto base_color = std::ranges::find(texture_inputs, &Material::base_color_texture, &TextureInput::slot);
  Material material;
  material.alpha_mode = AlphaMode::Mask;
  EXPECT_EQ(use_of(material, *base_color), ImageUse::Mask);
  material.alpha_cutoff = 0.0F;
  EXPECT_EQ(use_of(material, *base_color), ImageUse::Color) << "also texels with alpha 0 are seen";
  material.alpha_mode = AlphaMode::Blend;
  EXPECT_EQ(use_of(material, *base_color), ImageUse::Coverage);
}

TEST(CoverageLevels, AreMeansOfLightAlsoForOddEdges)
{
  // Opaque: the mean of the light of 0 and 255 is 187.5 / 255 encoded.
  Image image{"odd", 3, 1, {0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255, 255}};
  const std::vector<std::uint8_t> levels = coverage_levels(image);
  ASSERT_EQ(levels.size(), 16U);
  // A third of the light: 1.055 (1/3)^(1/2.4) - 0.055 = 0.6125.
  EXPECT_EQ(levels[12], 156);
  EXPECT_EQ(reduced(image, 1, ImageUse::Coverage).texels[0], 156);
  // In a mean by alpha, the transparent texels do not count.
  image.texels[3] = image.texels[7] = 0;
  EXPECT_EQ(reduced(image, 1, ImageUse::Coverage).texels, (std::vector<std::uint8_t>{255, 255, 255, 85}));
  EXPECT_EQ(reduced(image, 1, ImageUse::Color).texels[0], 156);
}

/** A mask of \a width squared: `covers` says which texels are leaf, and the others are red without alpha. */
template <typename Covers>
Image leaf_mask(std::uint32_t width, const Covers &covers)
{
  Image image{"leaf", width, width, {}};
  for (std::uint32_t i = 0; i < width * width; i++) {
    const std::array<std::uint8_t, 4> texel = covers(i % width, i / width)
                                                  ? std::array<std::uint8_t, 4>{50, 160, 40, 255}
                                                  : std::array<std::uint8_t, 4>{255, 0, 0, 0};
    image.texels.insert(image.texels.end(), texel.begin(), texel.end());
  }
  return image;
}

double covered_part(const Image &image, float cutoff)
{
  std::size_t count = 0;
  for (std::size_t i = 3; i < image.texels.size(); i += 4) {
    count += float(image.texels[i]) / 255.0F >= cutoff ? 1 : 0;
  }
  return 4.0 * double(count) / double(image.texels.size());
}

/** The part of \a image that a linear filter between its texels, which repeat, shows. */
double filtered_part(const Image &image, float cutoff)
{
  constexpr std::uint32_t steps = 8;
  const auto alpha = [&](std::uint32_t x, std::uint32_t y) {
    return float(image.texels[4 * (y % image.height * image.width + x % image.width) + 3]) / 255.0F;
  };
  std::size_t count = 0;
  for (std::uint32_t j = 0; j < steps * image.height; j++) {
    for (std::uint32_t i = 0; i < steps * image.width; i++) {
      const std::uint32_t x = i / steps;
      const std::uint32_t y = j / steps;
      const float u = (float(i % steps) + 0.5F) / float(steps);
      const float v = (float(j % steps) + 0.5F) / float(steps);
      const float value =
          std::lerp(std::lerp(alpha(x, y), alpha(x + 1, y), u), std::lerp(alpha(x, y + 1), alpha(x + 1, y + 1), u), v);
      count += value >= cutoff ? 1 : 0;
    }
  }
  return double(count) / double(steps * steps * image.width * image.height);
}

TEST(ReducedMask, CoversAsMuchAsTheImage)
{
  for (const float cutoff : {0.1F, 0.5F, 0.9F}) {
    for (const std::uint32_t size : {16U, 24U, 64U}) {
      for (std::uint32_t covered = 0; covered <= 8; covered++) {
        const Image image = leaf_mask(128, [&](std::uint32_t x, std::uint32_t) { return x % 8 < covered; });
        const Image small = reduced(image, size, ImageUse::Mask, {cutoff});
        EXPECT_NEAR(covered_part(small, cutoff), covered / 8.0, 1.0 / size) << cutoff << ' ' << size << ' ' << covered;
        // Edges lie between texels that are covered in part.
        EXPECT_NEAR(filtered_part(small, cutoff), covered / 8.0, 0.03) << cutoff << ' ' << size << ' ' << covered;
        for (std::size_t i = 0; i < small.texels.size(); i += 4) {
          if (float(small.texels[i + 3]) / 255.0F >= cutoff && covered > 0) {
            EXPECT_EQ(small.texels[i], 50) << "red is not seen";
          }
        }
      }
    }
  }
}

TEST(ReducedMask, ShowsNoColorThatIsCutOut)
{
  // Red has little alpha. Errors of texels go to neighbours of which no part is covered.
  Image image = leaf_mask(64, [](std::uint32_t x, std::uint32_t y) { return x % 8 < 2 && y % 8 < 2; });
  for (std::size_t i = 3; i < image.texels.size(); i += 4) {
    image.texels[i] = image.texels[i - 3] == 255 ? 150 : 255;
  }
  const Image small = reduced(image, 16, ImageUse::Mask, {0.8F});
  EXPECT_NEAR(covered_part(small, 0.8F), 1.0 / 16.0, 0.01);
  for (std::size_t i = 0; i < small.texels.size(); i += 4) {
    EXPECT_TRUE(small.texels[i] == 50 || float(small.texels[i + 3]) < 0.8F * 255.0F) << i;
  }
}

TEST(CoverageLevels, OfALinearMaskAreWhatTheFilterShows)
{
  for (const float cutoff : {0.1F, 0.25F, 0.5F, 0.8F}) {
    // The edge of a stripe lies where the filter passes the cutoff. A dot is (1 - x) (1 - y) in each of four squares,
    // and covers the integral of 1 - cutoff / (1 - x) from x = 0 to 1 - cutoff.
    const double stripe = (4.0 + 2.0 * (0.5 - cutoff)) / 8.0;
    const double dot = 4.0 * (1.0 - cutoff + cutoff * std::log(cutoff)) / 16.0;
    const Image stripes = leaf_mask(16, [](std::uint32_t x, std::uint32_t) { return x % 8 < 4; });
    const Image dots = leaf_mask(16, [](std::uint32_t x, std::uint32_t y) { return x % 4 == 0 && y % 4 == 0; });
    // A texel of the image and one of the level are rounded.
    EXPECT_NEAR(coverage_levels(stripes, {cutoff, true}).back() / 255.0, stripe, 1.0 / 255.0) << cutoff;
    // Four columns stand for the curve in a quarter of a texel.
    EXPECT_NEAR(coverage_levels(dots, {cutoff, true}).back() / 255.0, dot, 1.0 / 255.0) << cutoff;
    EXPECT_EQ(coverage_levels(dots, {cutoff}).back(), 16);
    // The colour is that of the dots; red is mixed into their edges by the filter alone.
    const std::vector<std::uint8_t> levels = coverage_levels(dots, {cutoff, true});
    EXPECT_EQ(levels[levels.size() - 4], 50);
  }
}

TEST(ReducedMask, OfALinearFilterCoversWhatTheFilterShowed)
{
  std::mt19937 random(1);
  for (const float cutoff : {0.1F, 0.25F, 0.5F, 0.8F}) {
    const Image image = leaf_mask(64, [&](std::uint32_t, std::uint32_t) { return random() % 2 == 0; });
    const Image small = reduced(image, 32, ImageUse::Mask, {cutoff, true});
    EXPECT_NEAR(filtered_part(small, cutoff), filtered_part(image, cutoff), 0.02) << cutoff;
  }
}

TEST(ReducedMask, DotsAndHolesKeepTheirAreaInAFilter)
{
  for (const std::uint32_t size : {32U, 64U}) {
    for (const bool is_hole : {false, true}) {
      const Image image =
          leaf_mask(128, [&](std::uint32_t x, std::uint32_t y) { return (x % 8 < 4 && y % 8 < 4) != is_hole; });
      EXPECT_NEAR(filtered_part(reduced(image, size, ImageUse::Mask, {0.5F}), 0.5F), is_hole ? 0.75 : 0.25, 0.02)
          << size;
    }
  }
}

TEST(ReducedMask, OfALargeShapeHasItsEdge)
{
  const auto is_inside = [](double x, double y) { return (x - 61) * (x - 61) + (y - 67) * (y - 67) < 50.0 * 50.0; };
  const Image small =
      reduced(leaf_mask(128, [&](std::uint32_t x, std::uint32_t y) { return is_inside(x + 0.5, y + 0.5); }), 32,
              ImageUse::Mask, {0.5F});
  for (std::uint32_t i = 0; i < 32 * 32; i++) {
    const double x = 4.0 * (i % 32) + 2.0;
    const double y = 4.0 * (i / 32) + 2.0;
    const double distance = std::hypot(x - 61, y - 67) - 50.0;
    // Half of a texel of 4 along a diagonal.
    if (std::abs(distance) > 2.9) {
      EXPECT_EQ(small.texels[4 * i + 3] >= 128, distance < 0.0) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace gnomon::scene
