// SPDX-License-Identifier: MIT
#include "measure_flip.hh"

#include <gtest/gtest.h>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace gnomon::measure {
namespace {

using Picture = std::vector<glm::vec4>;

constexpr glm::ivec2 size_px{32, 16};

/**
 * Without edges, slopes in float are up to 3e-8 instead of 0, and the error of features is their square root: 1.5e-4 in
 * the exponent of a value v with |v ln v| below 0.37. Measured: 5.4e-5.
 */
constexpr double tolerance = 1e-4;

Picture uniform(glm::vec3 rgb, glm::ivec2 size = size_px)
{
  return Picture(std::size_t(size.x) * std::size_t(size.y), glm::vec4(rgb, 1.0F));
}

Picture grey(float value)
{
  return uniform(glm::vec3(value));
}

Picture noise(unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-0.5F, 1.5F);
  Picture picture = uniform({});
  for (glm::vec4 &pixel : picture) {
    pixel = {value(random), value(random), value(random), value(random)};
  }
  return picture;
}

/** FLIP of two greys, for which filters and features have no effect, and a and b are 0. */
double flip_of_greys(double a, double b)
{
  const auto lightness = [](double y) {
    return y > 216.0 / 24389.0 ? 116.0 * std::cbrt(y) - 16.0 : y * 24389.0 / 27.0;
  };
  // HyAB of green and blue to the power of 0.7; the number is that of FLIP's authors.
  constexpr double largest = 41.2761;
  const double distance = std::pow(std::abs(lightness(a) - lightness(b)), 0.7);
  const double turn = 0.4 * largest;
  return distance < turn ? 0.95 * distance / turn : 0.95 + 0.05 * (distance - turn) / (largest - turn);
}

struct RowFlip {
  double flip = 0.0;
  /** FLIP without features. */
  double colour = 0.0;
};

/** FLIP of two pictures with equal rows of greys, computed by one-dimensional sums as in the paper. */
RowFlip flip_of_rows(const std::vector<double> &a, const std::vector<double> &b)
{
  constexpr double pi = std::numbers::pi;
  constexpr double per_degree = 67.0206;
  constexpr double sigma = 0.5 * 0.082 * per_degree;
  const auto contrast = [](double d) { return std::exp(-pi * pi * d * d / (per_degree * per_degree) / 0.0047); };
  const auto gaussian = [](double d) { return std::exp(-d * d / (2.0 * sigma * sigma)); };
  const auto slope = [&gaussian](double d) { return -d * gaussian(d); };
  const auto bend = [&gaussian](double d) { return (d * d / (sigma * sigma) - 1.0) * gaussian(d); };
  const auto filtered = [](const std::vector<double> &row, int x, int radius, const auto &kernel) {
    // Positive and negative weights each have a sum of 1.
    double above = 0.0;
    double below = 0.0;
    double above_weights = 0.0;
    double below_weights = 0.0;
    for (int d = -radius; d <= radius; d++) {
      const double value = row[std::size_t(std::clamp(x + d, 0, int(row.size()) - 1))];
      const double weight = kernel(double(d));
      (weight > 0.0 ? above : below) += weight * value;
      (weight > 0.0 ? above_weights : below_weights) += weight;
    }
    return above / above_weights - (below_weights < 0.0 ? below / below_weights : 0.0);
  };
  RowFlip mean;
  for (int x = 0; x < int(a.size()); x++) {
    const double colour = flip_of_greys(filtered(a, x, 10, contrast), filtered(b, x, 10, contrast));
    const auto off = [&](const auto &kernel) {
      return std::abs(std::abs(filtered(a, x, 9, kernel)) - std::abs(filtered(b, x, 9, kernel)));
    };
    const double feature = std::sqrt(std::max(off(slope), off(bend)) / std::numbers::sqrt2);
    mean.colour += colour / double(a.size());
    mean.flip += std::pow(colour, 1.0 - feature) / double(a.size());
  }
  return mean;
}

/** Each row is \a row. */
Picture rows_of(const std::vector<double> &row, int height)
{
  Picture picture;
  for (int y = 0; y < height; y++) {
    for (const double value : row) {
      picture.emplace_back(glm::vec3(float(value)), 1.0F);
    }
  }
  return picture;
}

/** Each column is \a column. */
Picture columns_of(const std::vector<double> &column, int width)
{
  Picture picture;
  for (const double value : column) {
    picture.insert(picture.end(), std::size_t(width), glm::vec4(glm::vec3(float(value)), 1.0F));
  }
  return picture;
}

TEST(Flip, OfEqualPicturesIsNone)
{
  EXPECT_EQ(mean_flip(size_px, noise(1), noise(1)), 0.0);
}

TEST(Flip, IsInRangeAndSymmetric)
{
  const double one = mean_flip(size_px, noise(1), noise(2));
  EXPECT_GT(one, 0.0);
  EXPECT_LE(one, 1.0);
  EXPECT_EQ(one, mean_flip(size_px, noise(2), noise(1)));
}

TEST(Flip, OfPicturesThatAreTurnedIsTheSame)
{
  const auto half_turn = [](const Picture &picture) { return Picture(picture.rbegin(), picture.rend()); };
  const auto transposed = [](const Picture &picture) {
    Picture result;
    const std::size_t width = std::size_t(size_px.x);
    for (std::size_t x = 0; x < width; x++) {
      for (std::size_t i = x; i < picture.size(); i += width) {
        result.push_back(picture[i]);
      }
    }
    return result;
  };
  const double upright = mean_flip(size_px, noise(1), noise(2));
  // The tolerance covers the other order of the sums.
  EXPECT_NEAR(mean_flip(size_px, half_turn(noise(1)), half_turn(noise(2))), upright, 1e-6);
  EXPECT_NEAR(mean_flip({size_px.y, size_px.x}, transposed(noise(1)), transposed(noise(2))), upright, 1e-6);
}

TEST(Flip, OfUniformGreysIsOfTheirLightness)
{
  // Both sides of CIELAB's knee, and of the turn in the redistribution.
  for (const auto &[a, b] : {std::pair{0.0F, 0.005F}, {0.004F, 0.02F}, {0.2F, 0.3F}, {0.1F, 0.9F}, {0.0F, 1.0F}}) {
    EXPECT_NEAR(mean_flip(size_px, grey(a), grey(b)), flip_of_greys(double(a), double(b)), tolerance) << a << ", " << b;
  }
}

TEST(Flip, GreenAndBlueGiveTheLargestErrorOne)
{
  constexpr glm::ivec2 small{4, 4};
  // Rounding in float.
  EXPECT_NEAR(mean_flip(small, uniform({0, 1, 0}, small), uniform({0, 0, 1}, small)), 1.0, 1e-6);
  for (int a = 0; a < 8; a++) {
    for (int b = 0; b < 8; b++) {
      const auto corner = [](int bits) { return glm::vec3(bits & 1, bits >> 1 & 1, bits >> 2 & 1); };
      const double flip = mean_flip(small, uniform(corner(a), small), uniform(corner(b), small));
      EXPECT_LE(flip, 1.0);
      EXPECT_TRUE((flip == 0.0) == (a == b));
      // All other pairs are nearer; green and magenta are the next.
      EXPECT_TRUE(flip < 0.9999 || (std::min(a, b) == 2 && std::max(a, b) == 4)) << a << ", " << b << ": " << flip;
    }
  }
}

TEST(Flip, DetectsABlackSquareOnGrey)
{
  constexpr glm::ivec2 large{128, 64};
  const Picture plain = uniform(glm::vec3(0.2F), large);
  Picture square = plain;
  for (std::size_t y = 24; y < 40; y++) {
    for (std::size_t x = 56; x < 72; x++) {
      square[y * 128 + x] = glm::vec4(0.0F);
    }
  }
  // The square covers 1/32 of the picture. Inside, the error is at least that of the greys, except at the filtered rim;
  // outside, no pixel farther than nine pixels differs.
  const double within = flip_of_greys(0.0, 0.2) * 14.0 * 14.0 / (128.0 * 64.0);
  const double around = 34.0 * 34.0 / (128.0 * 64.0);
  const double flip = mean_flip(large, square, plain);
  EXPECT_GT(flip, within);
  EXPECT_LT(flip, around);
}

TEST(Flip, ThousandthOfLightIsAlmostInvisible)
{
  EXPECT_LT(mean_flip(size_px, grey(0.2F), grey(0.201F)), 0.02);
}

TEST(Flip, RowsGiveTheOneDimensionalSumAndLinesCountMoreThanGradients)
{
  const std::vector<double> plain(64, 0.3);
  std::vector<double> line = plain;
  line[31] += 0.4;
  std::vector<double> step = plain;
  std::fill(step.begin() + 40, step.end(), 0.1);
  // A picture with the same colour difference, but without features.
  std::vector<double> swell = plain;
  for (std::size_t x = 0; x < swell.size(); x++) {
    swell[x] += 0.0033 * std::exp(-0.5 * std::pow((double(x) - 31.0) / 16.0, 2.0));
  }
  std::vector<double> features;
  for (const std::vector<double> &row : {line, swell, step}) {
    const RowFlip expected = flip_of_rows(row, plain);
    const double across = mean_flip({64, 4}, rows_of(row, 4), rows_of(plain, 4));
    EXPECT_NEAR(across, expected.flip, tolerance);
    EXPECT_NEAR(mean_flip({4, 64}, columns_of(row, 4), columns_of(plain, 4)), expected.flip, tolerance);
    features.push_back(across - expected.colour);
  }
  EXPECT_NEAR(flip_of_rows(line, plain).colour, flip_of_rows(swell, plain).colour, 1e-3);
  EXPECT_GT(features[0], 3.0 * features[1]);
}

/** FLIP of grey against vertical stripes with amplitude \a direction. */
double flip_of_stripes(glm::vec3 direction, double period_px)
{
  // Wide, so that the edges have a small effect.
  constexpr glm::ivec2 wide{240, 2};
  const Picture plain = uniform(glm::vec3(0.4F), wide);
  Picture picture = plain;
  for (std::size_t i = 0; i < picture.size(); i++) {
    const double x = double(i % std::size_t(wide.x));
    picture[i] += glm::vec4(float(std::cos(2.0 * std::numbers::pi * x / period_px)) * direction, 0.0F);
  }
  return mean_flip(wide, picture, plain);
}

TEST(Flip, FineStripesOfRedAndGreenCountMoreThanOfBlueAndYellow)
{
  // The directions of X and Z in sRGB (Lindbloom), which do not change luminance, with 10 % of white's value.
  const glm::vec3 red_green = 0.1F * 0.95047F * glm::vec3(3.24045F, -0.96927F, 0.05564F);
  const glm::vec3 blue_yellow = 0.1F * 1.08883F * glm::vec3(-0.49853F, 0.04156F, 1.05723F);
  // A Gaussian of 1.1 pixels keeps half of the amplitude of a wave of six pixels. Gaussians of 3 and 2.4 pixels keep
  // 1/60 of it, and three quarters of a wave of 24 pixels.
  EXPECT_GT(flip_of_stripes(red_green, 6.0), 0.2);
  EXPECT_LT(flip_of_stripes(blue_yellow, 6.0), 0.02);
  EXPECT_GT(flip_of_stripes(blue_yellow, 24.0), 0.1);
}

TEST(Flip, ValuesOutsideOfTheDisplayRangeHaveNoError)
{
  EXPECT_EQ(mean_flip(size_px, uniform({1.0F, 0.0F, 0.5F}), uniform({1e30F, -7.0F, 0.5F})), 0.0);
}

TEST(Flip, OfSmallPicturesIsThatOfTheirPixels)
{
  for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(1, 7), glm::ivec2(7, 1)}) {
    // A uniform picture is the same in any size.
    EXPECT_NEAR(mean_flip(size, uniform(glm::vec3(0.2F), size), uniform(glm::vec3(0.3F), size)),
                flip_of_greys(0.2, 0.3), tolerance);
  }
}

}  // namespace
}  // namespace gnomon::measure
