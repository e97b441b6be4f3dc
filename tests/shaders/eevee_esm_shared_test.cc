// SPDX-License-Identifier: MIT
#include "eevee_esm_shared.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace gnomon::shared {
namespace {

/** As many as the prefilter takes. */
constexpr int tap_count = 32;

float filtered(const std::vector<float> &values, float exponent)
{
  const float weight = 1.0F / float(values.size());
  LogSum sum = log_sum_begin(values.at(0), weight);
  for (std::size_t i = 1; i < values.size(); i++) {
    sum = log_sum_add(sum, exponent, values[i], weight);
  }
  return log_sum_value(sum, exponent);
}

double exactly_filtered(const std::vector<float> &values, float exponent)
{
  const long double highest = *std::ranges::max_element(values);
  long double sum = 0.0L;
  for (const float value : values) {
    sum += std::exp((value - highest) * exponent);
  }
  return double(highest + std::log(sum / static_cast<long double>(values.size())) / exponent);
}

std::vector<float> taps(float base, float spread, unsigned seed)
{
  std::mt19937 random(seed);
  std::vector<float> values;
  for (int i = 0; i < tap_count; i++) {
    values.push_back(base + spread * (float(random()) / float(std::mt19937::max())));
  }
  return values;
}

TEST(LogSum, IsFiniteAndBetweenItsValuesAtAnySpreadAndExponent)
{
  for (float exponent = 0.01F; exponent <= 1.01e4F; exponent *= 10.0F) {
    for (float spread = 1e-6F; spread <= 1.01e30F; spread *= 10.0F) {
      for (unsigned seed = 0; seed < 5; seed++) {
        const std::vector<float> values = taps(1.0F, spread, seed);
        const float result = filtered(values, exponent);
        ASSERT_TRUE(std::isfinite(result)) << exponent << " " << spread;
        const auto [low, high] = std::ranges::minmax(values);
        // 32 sums of about 1 are off by 1e-6 at most, and the logarithm of that is divided by the exponent.
        const float rounding = 1e-6F / exponent + 1e-7F * high;
        ASSERT_GE(result, low - rounding) << exponent << " " << spread;
        ASSERT_LE(result, high + rounding) << exponent << " " << spread;
      }
    }
  }
}

// design.md: exact to 1e-4 m at 1 km.
TEST(LogSum, Of32TapsIsExactToATenthOfAMillimetreAtAKilometre)
{
  for (float exponent = 0.1F; exponent <= 1.01e4F; exponent *= 10.0F) {
    for (const float spread : {0.0F, 1e-3F, 0.1F, 1.0F, 10.0F, 87.0F, 89.0F, 500.0F}) {
      for (unsigned seed = 0; seed < 20; seed++) {
        const std::vector<float> values = taps(1000.0F - spread, spread, seed);
        ASSERT_NEAR(filtered(values, exponent), exactly_filtered(values, exponent), 1e-4) << exponent << " " << spread;
      }
    }
  }
}

TEST(LogSum, IsTheSameInAnyOrderAndAtAnyDistance)
{
  std::vector<float> values = taps(10.0F, 2.0F, 1);
  const float once = filtered(values, 80.0F);
  std::ranges::sort(values);
  EXPECT_NEAR(filtered(values, 80.0F), once, 2e-6F);
  std::ranges::reverse(values);
  EXPECT_NEAR(filtered(values, 80.0F), once, 2e-6F);
  for (float &value : values) {
    value += 16.0F;
  }
  // Roundings of numbers up to 32.
  EXPECT_NEAR(filtered(values, 80.0F), once + 16.0F, 4e-6F);
}

TEST(LogSum, OfEqualValuesIsTheirs)
{
  for (const float value : {0.0F, 1e-3F, 17.0F, 1e6F, 1e30F}) {
    EXPECT_EQ(filtered(std::vector<float>(tap_count, value), 80.0F), value);
  }
}

/** A tap more, as in the seed: the running value is subtracted, not the larger one, and the exponent is not in the sum.
 */
float naive_sum(float weight_x, float x, float weight_y, float y)
{
  return x + std::log(weight_x + weight_y * std::exp(y - x));
}

// hazards.md: what the tests above would see.
TEST(LogSum, NaivelyIsInfiniteFrom89MetresOfSpread)
{
  const float weight = 1.0F / tap_count;
  EXPECT_TRUE(std::isfinite(naive_sum(weight, 1.0F, weight, 1.0F + 88.0F)));
  const float lost = naive_sum(weight, 1.0F, weight, 1.0F + 89.0F);
  EXPECT_EQ(lost, std::numeric_limits<float>::infinity());
  EXPECT_EQ(naive_sum(1.0F, lost, weight, 1.0F), lost) << "for ever";
  EXPECT_EQ(esm_visibility(1.0F, lost, 1e6F), 1.0F) << "and lit";
  const LogSum ours = log_sum_add(log_sum_begin(1.0F, weight), 1.0F, 1.0F + 89.0F, weight);
  EXPECT_FLOAT_EQ(log_sum_value(ours, 1.0F), 90.0F + std::log(weight));
}

// hazards.md: exp(5 d) is infinite in floats beyond 17.74 m.
TEST(EsmVisibility, NaivelyIsInfiniteFrom18MetresAndOursIsNot)
{
  const auto naive = [](float stored, float distance) {
    return std::min(1.0F, std::exp(-5.0F * distance) * std::exp(5.0F * stored));
  };
  EXPECT_TRUE(std::isfinite(std::exp(5.0F * 17.74F)));
  EXPECT_EQ(std::exp(5.0F * 17.75F), std::numeric_limits<float>::infinity());
  EXPECT_NEAR(naive(17.0F, 17.2F), std::exp(-1.0F), 1e-4F);
  EXPECT_EQ(naive(18.0F, 18.2F), 1.0F) << "lit in the shadow";
  // 18.2 - 18 is off by a rounding of 18, a millionth, which the exponent multiplies.
  EXPECT_NEAR(esm_visibility(5.0F, 18.0F, 18.2F), std::exp(-1.0F), 4e-6F);
}

TEST(EsmVisibility, IsOneInFrontAndFallsBehind)
{
  for (const float exponent : {0.01F, 5.0F, 80.0F, 1e4F}) {
    EXPECT_EQ(esm_visibility(exponent, 3.0F, 3.0F), 1.0F);
    EXPECT_EQ(esm_visibility(exponent, 1e30F, 3.0F), 1.0F) << "nothing was drawn";
    float before = 1.0F;
    for (float distance = 1e-3F; distance < 1e30F; distance *= 1.1F) {
      const float visibility = esm_visibility(exponent, 3.0F, distance);
      ASSERT_TRUE(visibility >= 0.0F && visibility <= before) << exponent << " " << distance;
      before = visibility;
    }
    EXPECT_EQ(before, 0.0F);
  }
}

}  // namespace
}  // namespace gnomon::shared
