// SPDX-License-Identifier: MIT
#include "measure_image_error.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace gnomon::measure {
namespace {

constexpr glm::ivec2 image_size_px{32, 16};
constexpr std::size_t pixel_count = 32 * 16;

std::vector<glm::vec4> flat(float value)
{
  return std::vector<glm::vec4>(pixel_count, glm::vec4(value, value, value, 1.0F));
}

TEST(ImageError, EqualPicturesHaveNoError)
{
  const ImageError error = image_error(image_size_px, flat(0.5F), flat(0.5F));
  EXPECT_EQ(error.rmse, 0.0);
  EXPECT_EQ(error.relative_mse, 0.0);
  EXPECT_EQ(error.p99, 0.0);
  EXPECT_EQ(error.flip, 0.0);
  EXPECT_EQ(error.non_finite_count, 0U);
}

TEST(ImageError, OfAnEvenOffset)
{
  // Powers of two: exact in float.
  const ImageError error = image_error(image_size_px, flat(0.75F), flat(0.5F));
  EXPECT_DOUBLE_EQ(error.rmse, 0.25);
  // Rounding of a sum of 1536 terms.
  EXPECT_NEAR(error.relative_mse, 0.0625 / (0.25 + relative_mse_floor), 1e-14);
  EXPECT_DOUBLE_EQ(error.p99, 0.25);
}

TEST(ImageError, MeanIsOverPixelsAndChannels)
{
  std::vector<glm::vec4> picture = flat(0.0F);
  picture[7].g = 2.0F;
  // The fourth value is ignored.
  picture[8].a = 100.0F;
  const ImageError error = image_error(image_size_px, picture, flat(0.0F));
  EXPECT_DOUBLE_EQ(error.rmse, std::sqrt(4.0 / double(3 * pixel_count)));
}

TEST(ImageError, P99IsThe99thPercentile)
{
  // 512 pixels: the 507th smallest difference is not exceeded by 99 %.
  std::vector<glm::vec4> picture = flat(0.0F);
  for (std::size_t i = 0; i < 5; i++) {
    picture[i].b = 1.0F;
  }
  EXPECT_EQ(image_error(image_size_px, picture, flat(0.0F)).p99, 0.0);
  picture[5].b = 1.0F;
  EXPECT_EQ(image_error(image_size_px, picture, flat(0.0F)).p99, 1.0);
}

TEST(ImageError, NonFiniteIsCountedAndErrorsAreNan)
{
  std::vector<glm::vec4> picture = flat(0.0F);
  picture[3].r = std::numeric_limits<float>::quiet_NaN();
  picture[9].b = std::numeric_limits<float>::infinity();
  const ImageError error = image_error(image_size_px, picture, flat(0.0F));
  EXPECT_EQ(error.non_finite_count, 2U);
  EXPECT_TRUE(std::isnan(error.rmse));
  EXPECT_TRUE(std::isnan(error.flip));
}

TEST(ImageError, OtherSizesAreRefused)
{
  EXPECT_THROW(static_cast<void>(image_error({31, 16}, flat(0.0F), flat(0.0F))), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(image_error({0, 0}, {}, {})), std::invalid_argument);
}

TEST(ImageError, DisplayHasTheCurveOfSrgb)
{
  // IEC 61966-2-1: 0.2 is encoded as 0.4845; values above white are clipped.
  const std::vector<glm::vec4> pixel = {glm::vec4(0.2F, 2.0F, -1.0F, 0.0F)};
  EXPECT_EQ(display_bytes(pixel), (std::vector<std::uint8_t>{124, 255, 0, 255}));
}

}  // namespace
}  // namespace gnomon::measure
