// SPDX-License-Identifier: MIT
#include "eevee_esm_shared.h"
#include "eevee_octahedral_shared.h"

#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace gnomon::shared {
namespace {

/** Number of taps of the prefilter. */
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
        // 32 sums of about 1 have an error of at most 1e-6. Its logarithm is divided by the exponent.
        const float rounding = 1e-6F / exponent + 1e-7F * high;
        ASSERT_GE(result, low - rounding) << exponent << " " << spread;
        ASSERT_LE(result, high + rounding) << exponent << " " << spread;
      }
    }
  }
}

// Promise: an error of at most 1e-4 m at 1 km.
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
  // Rounding of numbers up to 32.
  EXPECT_NEAR(filtered(values, 80.0F), once + 16.0F, 4e-6F);
}

TEST(LogSum, OfEqualValuesIsTheirs)
{
  for (const float value : {0.0F, 1e-3F, 17.0F, 1e6F, 1e30F}) {
    EXPECT_EQ(filtered(std::vector<float>(tap_count, value), 80.0F), value);
  }
}

/** Adds a tap in the naive form: it subtracts the running value instead of the larger one, and has no exponent. */
float naive_sum(float weight_x, float x, float weight_y, float y)
{
  return x + std::log(weight_x + weight_y * std::exp(y - x));
}

// hazards.md: the tests above detect the naive form.
TEST(LogSum, NaiveFormOverflowsAt89MetresOfSpread)
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
TEST(EsmVisibility, IsFiniteWhereTheNaiveFormOverflowsAt18Metres)
{
  const auto naive = [](float stored, float distance) {
    return std::min(1.0F, std::exp(-5.0F * distance) * std::exp(5.0F * stored));
  };
  EXPECT_TRUE(std::isfinite(std::exp(5.0F * 17.74F)));
  EXPECT_EQ(std::exp(5.0F * 17.75F), std::numeric_limits<float>::infinity());
  EXPECT_NEAR(naive(17.0F, 17.2F), std::exp(-1.0F), 1e-4F);
  EXPECT_EQ(naive(18.0F, 18.2F), 1.0F) << "lit in the shadow";
  // 18.2 - 18 has the rounding error of 18, about 1e-6, and the exponent multiplies it.
  EXPECT_NEAR(esm_visibility(5.0F, 18.0F, 18.2F), std::exp(-1.0F), 4e-6F);
}

// hazards.md: exp(5 d) is infinite in halves beyond 2.2 m.
TEST(EsmVisibility, NaiveFormOverflowsInHalvesAtThreeMetres)
{
  const auto half = [](float value) { return glm::unpackHalf1x16(glm::packHalf1x16(value)); };
  EXPECT_TRUE(std::isfinite(half(std::exp(5.0F * 2.2F))));
  EXPECT_EQ(half(std::exp(5.0F * 2.3F)), std::numeric_limits<float>::infinity());
  for (const float distance : {2.2F, 2.3F, 1e3F, 1e30F}) {
    EXPECT_TRUE(std::isfinite(half(esm_encoded(distance, distance, ESM_HALF))));
  }
}

// hazards.md: with fp16 storage of linear distance, half an ulp is 1.6 cm at 40 m; with c = 80 that is a 249 % error.
TEST(EsmFormat, ErrorIsHalfAStepAndHalfOfThatOfLinearHalves)
{
  const float linear_error = std::ldexp(0.5F, 5 - 10);
  EXPECT_NEAR(linear_error, 0.016F, 4e-4F);
  EXPECT_NEAR(std::exp(80.0F * linear_error) - 1.0F, 2.49F, 0.01F);
  const float range = 64.0F;
  EXPECT_FLOAT_EQ(esm_format_error(range, ESM_HALF), 0.5F * linear_error);
  float worst = 0.0F;
  for (int i = 0; i <= 100000; i++) {
    const float distance = range * float(i) / 100000.0F;
    const float encoded = esm_encoded(distance, range, ESM_HALF);
    ASSERT_EQ(glm::unpackHalf1x16(glm::packHalf1x16(encoded)), encoded) << "a half holds it, however a driver rounds";
    worst = std::max(worst, std::abs(esm_decoded(encoded, range, ESM_HALF) - distance));
  }
  EXPECT_LE(worst, esm_format_error(range, ESM_HALF) * 1.001F);
  EXPECT_GE(worst, esm_format_error(range, ESM_HALF) * 0.99F);
  EXPECT_EQ(esm_decoded(esm_encoded(range, range, ESM_HALF), range, ESM_HALF), range) << "far is far";
  EXPECT_EQ(esm_format_error(range, ESM_FLOAT), 0.0F);
}

TEST(EsmDisk, PointsHaveTheDisksMoments)
{
  for (const int count : {4, 32}) {
    glm::dvec2 mean(0.0);
    double xx = 0.0;
    double yy = 0.0;
    double xy = 0.0;
    for (int i = 0; i < count; i++) {
      const glm::dvec2 p(esm_disk_point(i, count));
      EXPECT_LE(glm::length(p), 1.0);
      mean += p / double(count);
      xx += p.x * p.x / count;
      yy += p.y * p.y / count;
      xy += p.x * p.y / count;
    }
    EXPECT_NEAR(glm::length(mean), 0.0, 1e-7);
    EXPECT_NEAR(xx, 0.25, 1e-6);
    EXPECT_NEAR(yy, 0.25, 1e-6);
    EXPECT_NEAR(xy, 0.0, 1e-6);
  }
}

// hazards.md: with a tangent frame from an un-normalised octahedral vector the blur's angle varies by up to √3 over the
// map.
TEST(EsmCone, HasTheSameAngleEverywhereUnlikeTheNaiveForm)
{
  constexpr float angle = 0.01F;
  const float versine = 2.0F * std::pow(std::sin(0.5F * angle), 2.0F);
  float low = 1.0F;
  float high = 0.0F;
  for (int y = 0; y <= 48; y++) {
    for (int x = 0; x <= 48; x++) {
      const vec3 axis = octahedral_to_direction(vec2(float(x), float(y)) / 48.0F);
      for (int i = 0; i < 8; i++) {
        const vec2 point(std::cos(float(i)), std::sin(float(i)));
        const vec3 direction = esm_cone_direction(axis, point, versine);
        ASSERT_NEAR(glm::length(direction), 1.0F, 3e-7F);
        ASSERT_NEAR(glm::length(glm::cross(axis, direction)), std::sin(angle), 3e-7F);
      }
      // The naive form: a fixed offset from a vector whose length is between 1 / √3 and 1.
      const float length = 1.0F / (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
      const float naive = std::atan(angle / length);
      low = std::min(low, naive);
      high = std::max(high, naive);
    }
  }
  EXPECT_NEAR(high / low, std::sqrt(3.0F), 1e-3F);
}

TEST(EsmCone, OfNoOpeningIsItsAxis)
{
  for (const vec3 axis : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(0.6F, 0, -0.8F)}) {
    EXPECT_EQ(esm_cone_direction(axis, vec2(0.5F, -0.5F), 0.0F), axis);
  }
}

TEST(EsmBias, IsFiniteAndGrowsWithDistanceTiltAndTexel)
{
  float before = 0.0F;
  for (int degrees = 0; degrees <= 90; degrees++) {
    const float cosine = std::cos(float(degrees) * 0.017453292F);
    const float bias = esm_bias(10.0F, cosine, 0.01F, 0.0F);
    ASSERT_TRUE(bias >= before && bias <= 10.0F * shared::ESM_BIAS_TEXELS * 0.01F * shared::ESM_TANGENT_MAX * 1.001F)
        << degrees;
    EXPECT_EQ(bias, esm_bias(10.0F, -cosine, 0.01F, 0.0F)) << "either side of the plane";
    EXPECT_GT(esm_bias(11.0F, cosine, 0.01F, 0.0F), bias);
    EXPECT_GT(esm_bias(10.0F, cosine, 0.01F, 0.1F), bias);
    before = bias;
  }
}

TEST(EsmGathered, BlendsVisibilitiesAndNotDistances)
{
  // A near texel beside an empty one: visibility equals the weight of the empty texel, and is not dark almost up to its
  // centre.
  const vec4 stored(100.0F, 100.0F, 100.0F, 1.0F);
  for (const float fraction : {0.0F, 0.25F, 0.75F, 1.0F}) {
    EXPECT_NEAR(esm_gathered_visibility(10.0F, stored, 50.0F, vec2(fraction, 0.0F)), fraction, 1e-6F);
    const float blended = 1.0F + fraction * 99.0F;
    EXPECT_TRUE(fraction != 0.25F || esm_visibility(10.0F, blended, 50.0F) == 0.0F) << "what a linear sampler gives";
  }
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
