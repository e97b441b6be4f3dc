// SPDX-License-Identifier: MIT
#include "eevee_light_shared.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::shared {
namespace {

// hazards.md: spot mask with z = 0, blend 0, size 180°.
TEST(SpotMask, IsFiniteAndMonotoneForEveryAngleAndBlend)
{
  for (int degrees = 0; degrees <= 180; degrees += 3) {
    const float drop_outer = 1.0F - std::cos(float(degrees) * 0.5F * float(std::numbers::pi) / 180.0F);
    for (const float blend : {0.0F, 1e-6F, 0.01F, 0.5F, 1.0F}) {
      const float inv_width = spot_inv_width(drop_outer, blend);
      ASSERT_TRUE(std::isfinite(inv_width));
      float before = 0.0F;
      for (int i = 0; i <= 2000; i++) {
        const float drop = 2.0F - float(i) / 1000.0F;
        const float mask = spot_mask(drop, drop_outer, inv_width);
        ASSERT_TRUE(mask >= 0.0F && mask <= 1.0F);
        ASSERT_GE(mask, before) << degrees << "° blend " << blend;
        if (drop >= drop_outer) {
          ASSERT_EQ(mask, 0.0F);
        }
        before = mask;
      }
      if (degrees > 0) {
        EXPECT_EQ(before, 1.0F) << "on the axis, " << degrees << "° blend " << blend;
      }
    }
  }
}

TEST(SpotMask, NarrowConesAreAsAccurateAsWideOnes)
{
  // The middle of a blend of 1, for narrow cones. The cosines of these angles are 1 in float.
  for (const double angle : {1e-6, 1e-5, 1e-4, 1e-3, 0.1}) {
    const auto unit = [](double a) { return vec3(float(std::sin(a)), 0.0F, float(std::cos(a))); };
    const double sine = std::sin(0.5 * angle);
    const auto drop_outer = float(2.0 * sine * sine);
    // 1 - cos is half of its outer value at √½ of the outer angle.
    const float drop = one_minus_cos(unit(0.0), unit(std::sqrt(0.5) * angle));
    EXPECT_NEAR(spot_mask(drop, drop_outer, spot_inv_width(drop_outer, 1.0F)), 0.5F, 1e-3F) << angle;
  }
}

TEST(DistanceFalloff, IsInverseSquareWithTheDisksRadius)
{
  EXPECT_FLOAT_EQ(distance_falloff(4.0F, 0.0F, 0.0F), 0.25F);
  EXPECT_FLOAT_EQ(distance_falloff(4.0F, 1.0F, 0.0F), 0.2F);
  EXPECT_TRUE(std::isfinite(distance_falloff(0.0F, 0.0F, 0.0F)));
}

TEST(DistanceFalloff, EndsAtTheRange)
{
  const float range_inv_sq = 1.0F / 9.0F;
  EXPECT_EQ(distance_falloff(9.0F, 0.0F, range_inv_sq), 0.0F);
  EXPECT_EQ(distance_falloff(100.0F, 0.0F, range_inv_sq), 0.0F);
  // KHR_lights_punctual: 1 - (d / range)⁴ over d².
  EXPECT_FLOAT_EQ(distance_falloff(4.0F, 0.0F, range_inv_sq), (1.0F - 16.0F / 81.0F) / 4.0F);
}

TEST(HemiIrradiance, IsTheShareOfTheSkyAboveTheHorizon)
{
  // Cosine-weighted fraction of the sky that a plane tilted by t sees, by quadrature.
  for (const double tilt : {0.0, 0.7, std::numbers::pi / 2.0, 2.5, std::numbers::pi}) {
    constexpr int count = 700;
    double sum = 0.0;
    for (int i = 0; i < count; i++) {
      for (int j = 0; j < count; j++) {
        const double z = (i + 0.5) / count;
        const double phi = 2.0 * std::numbers::pi * (j + 0.5) / count;
        const double x = std::sqrt(1.0 - z * z) * std::cos(phi);
        sum += std::max(0.0, x * std::sin(tilt) + z * std::cos(tilt)) * 2.0 / (double(count) * count);
      }
    }
    EXPECT_NEAR(hemi_irradiance(float(std::cos(tilt))), sum, 2e-3) << tilt;
  }
}

}  // namespace
}  // namespace gnomon::shared
