// SPDX-License-Identifier: MIT
#include "eevee_pixel_filter.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace gnomon::eevee {
namespace {

TEST(FilmFilter, FallsFromOneToNothingAtItsSupport)
{
  EXPECT_NEAR(filter_weight(0.0), 1.0, 1e-12);
  EXPECT_EQ(filter_weight(0.5 * filter_support_px), 0.0);
  EXPECT_LT(filter_weight(0.4999 * filter_support_px), 1e-4);
  for (double x = 0.0; x < 1.49; x += 0.01) {
    EXPECT_GT(filter_weight(x), filter_weight(x + 0.01));
    EXPECT_EQ(filter_weight(x), filter_weight(-x));
  }
}

TEST(FilmOffset, OneSampleIsInTheMiddle)
{
  EXPECT_EQ(film_offset_px(0, 1, 7), glm::vec2(0.0F));
}

TEST(FilmOffset, SamplesFillThePixelEvenly)
{
  for (const std::uint32_t seed : {0U, 1U, 99U}) {
    constexpr int COUNT = 64;
    std::vector<int> columns(8);
    std::vector<int> rows(8);
    for (int i = 0; i < COUNT; i++) {
      const glm::vec2 offset = film_offset_px(i, COUNT, seed);
      ASSERT_GE(offset.x, -0.5F);
      ASSERT_LE(offset.x, 0.5F);
      ASSERT_GE(offset.y, -0.5F);
      ASSERT_LE(offset.y, 0.5F);
      columns[std::min(std::size_t((offset.x + 0.5F) * 8.0F), std::size_t(7))]++;
      rows[std::min(std::size_t((offset.y + 0.5F) * 8.0F), std::size_t(7))]++;
    }
    for (int i = 0; i < 8; i++) {
      EXPECT_NEAR(columns[std::size_t(i)], COUNT / 8, 1) << "seed " << seed;
      EXPECT_NEAR(rows[std::size_t(i)], COUNT / 8, 2) << "seed " << seed;
    }
  }
}

TEST(FilmOffset, SeedsMoveTheSamples)
{
  EXPECT_NE(film_offset_px(0, 16, 1), film_offset_px(0, 16, 2));
  EXPECT_NE(film_offset_px(0, 0, 1), film_offset_px(0, 0, 2));
}

TEST(FilmOffset, WithoutACountTheFirstSampleIsInTheMiddleAndEachBeginningFillsThePixelEvenly)
{
  EXPECT_EQ(film_offset_px(0, 0, 0), glm::vec2(0.0F));
  for (const std::size_t count : {2U, 4U, 16U, 64U, 1024U}) {
    std::vector<int> columns(count);
    std::vector<int> rows(count);
    for (std::size_t i = 0; i < count; i++) {
      // A lattice with one point in each column and in each row. Half a cell keeps its points off the borders.
      const glm::dvec2 at = glm::dvec2(film_offset_px(int(i), 0, 0)) + 0.5 + 0.5 / double(count);
      columns[std::size_t(std::floor(at.x * double(count))) % count]++;
      rows[std::size_t(std::floor(at.y * double(count))) % count]++;
    }
    EXPECT_EQ(columns, std::vector<int>(count, 1));
    EXPECT_EQ(rows, std::vector<int>(count, 1));
  }
}

/**
 * Value of a pixel for the function \a radiance(x, y), computed like the film pass, after \a drawn samples of a picture
 * of \a count.
 */
template <typename Radiance>
double filmed(int drawn, int count, std::uint32_t seed, Radiance &&radiance)
{
  const double weight_sum = film_weight_sum(count, seed);
  double share = 0.0;
  double sum = 0.0;
  for (int i = 0; i < drawn; i++) {
    const glm::vec2 offset = film_offset_px(i, count, seed);
    const FilmWeights weights = film_weights(i, count, seed, weight_sum);
    share += film_share(i, count, seed, weight_sum);
    for (int y = 0; y < 3; y++) {
      for (int x = 0; x < 3; x++) {
        sum += double(weights.columns[x]) * double(weights.rows[y]) *
               radiance(double(x - 1) + double(offset.x), double(y - 1) + double(offset.y));
      }
    }
  }
  return sum / share;
}

template <typename Radiance>
double filmed(int count, std::uint32_t seed, Radiance &&radiance)
{
  return filmed(count, count, seed, radiance);
}

TEST(FilmWeights, KeepAnEvenPictureAsItIs)
{
  const auto one = [](double, double) { return 1.0; };
  for (const int count : {1, 2, 5, 16, 64, 1000}) {
    EXPECT_NEAR(filmed(count, 3, one), 1.0, 1e-5) << count << " samples";
    EXPECT_NEAR(filmed(count, 0, 3, one), 1.0, 1e-5) << count << " samples so far";
  }
  double share = 0.0;
  for (int i = 0; i < 64; i++) {
    share += film_share(i, 64, 3, film_weight_sum(64, 3));
  }
  EXPECT_NEAR(share, 1.0, 1e-12) << "the film holds the picture without a division";
}

/** The filter's mean of a function, by a grid of \a N x \a N points. */
template <int N = 600, typename Radiance>
double filtered(Radiance &&radiance)
{
  double sum = 0.0;
  double weights = 0.0;
  for (int j = 0; j < N; j++) {
    for (int i = 0; i < N; i++) {
      const double x = ((i + 0.5) / N - 0.5) * filter_support_px;
      const double y = ((j + 0.5) / N - 0.5) * filter_support_px;
      const double weight = filter_weight(x) * filter_weight(y);
      sum += weight * radiance(x, y);
      weights += weight;
    }
  }
  return sum / weights;
}

TEST(FilmWeights, ConvergeToTheFilterAtAnEdge)
{
  const auto edge = [](double x, double y) { return 0.8 * x + 0.6 * y > 0.23 ? 1.0 : 0.0; };
  const double truth = filtered(edge);
  const double error_16 = std::abs(filmed(16, 0, edge) - truth);
  const double error_1024 = std::abs(filmed(1024, 0, edge) - truth);
  EXPECT_LT(error_16, 0.05);
  EXPECT_LT(error_1024, 0.002);
}

/** The root mean square error at edges of many directions and positions, after \a drawn samples of \a count. */
double edge_error(int drawn, int count)
{
  constexpr int directions = 12;
  constexpr int positions = 9;
  static const std::vector<double> truths = [] {
    std::vector<double> all;
    for (int i = 0; i < directions * positions; i++) {
      const double angle = 0.1 + i % directions * 0.523;
      const double distance = -0.8 + i / directions * 0.2;
      all.push_back(
          filtered<150>([=](double x, double y) { return x * std::cos(angle) + y * std::sin(angle) > distance; }));
    }
    return all;
  }();
  double sum = 0.0;
  int terms = 0;
  for (const std::uint32_t seed : {0U, 1U, 2U, 3U, 4U, 5U, 6U, 7U}) {
    for (std::size_t i = 0; i < truths.size(); i++, terms++) {
      const double angle = 0.1 + double(i % directions) * 0.523;
      const double distance = -0.8 + double(i / directions) * 0.2;
      const auto edge = [=](double x, double y) { return x * std::cos(angle) + y * std::sin(angle) > distance; };
      const double error = filmed(drawn, count, seed, edge) - truths[i];
      sum += error * error;
    }
  }
  return std::sqrt(sum / terms);
}

TEST(FilmWeights, WithoutACountEachBeginningIsNearlyAsGoodAtEdgesAsThatManySamples)
{
  for (const int drawn : {4, 7, 16, 25, 64}) {
    EXPECT_LT(edge_error(drawn, 0), 1.25 * edge_error(drawn, drawn)) << drawn << " samples";
  }
  EXPECT_GT(edge_error(16, 256), 2.0 * edge_error(16, 16)) << "the first samples of a known count are a strip";
}

TEST(FilmWeights, ConvergeToTheFilterOfASlope)
{
  // The filter preserves the mean of even functions and removes odd ones.
  const auto slope = [](double x, double y) { return x + 2.0 * y; };
  EXPECT_NEAR(filmed(256, 0, slope), 0.0, 2e-2);
}

}  // namespace
}  // namespace gnomon::eevee
