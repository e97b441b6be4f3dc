// SPDX-License-Identifier: MIT
#include "eevee_bsdf_shared.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace gnomon::shared {
namespace {

/** Integral of f(cos θ) · cos θ over the hemisphere, by the midpoint rule in sin² θ, refined at the peak of f. */
template <typename F>
double hemisphere_integral(F &&f)
{
  constexpr int count = 400000;
  double sum = 0.0;
  for (int i = 0; i < count; i++) {
    // t = s⁴ places most points near the pole.
    const double s = (i + 0.5) / count;
    const double sin_sq = s * s * s * s;
    sum += f(std::sqrt(1.0 - sin_sq)) * 4.0 * s * s * s / count;
  }
  return std::numbers::pi * sum;
}

TEST(GgxDistribution, ProjectsToOne)
{
  // Walter et al. 2007, eq. 4: the projected area of the microfacets equals that of the surface.
  for (const float alpha : {0.01F, 0.0625F, 0.3F, 0.7225F, 1.0F}) {
    const double area = hemisphere_integral([&](double c) { return double(ggx_distribution(float(c), alpha)); });
    // The float resolution near cos = 1 limits narrow lobes. Measured error: 4e-4 at alpha 0.01.
    EXPECT_NEAR(area, 1.0, alpha < 0.05F ? 2e-3 : 1e-4) << "alpha " << alpha;
  }
}

TEST(GgxLobe, IsReciprocal)
{
  EXPECT_FLOAT_EQ(ggx_lobe(0.3F, 0.8F, 0.9F, 0.4F), ggx_lobe(0.8F, 0.3F, 0.9F, 0.4F));
}

TEST(GgxLobe, ReflectsNoMoreThanItReceives)
{
  // Directional albedo for a viewer at cos_v, by quadrature over the directions of the light.
  constexpr int count = 512;
  for (const float alpha : {0.1F, 0.4F, 1.0F}) {
    for (const double cos_v : {0.1, 0.5, 0.95}) {
      const double sin_v = std::sqrt(1.0 - cos_v * cos_v);
      double albedo = 0.0;
      for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
          const double cos_l = (i + 0.5) / count;
          const double sin_l = std::sqrt(1.0 - cos_l * cos_l);
          const double phi = 2.0 * std::numbers::pi * (j + 0.5) / count;
          const double x = sin_l * std::cos(phi) + sin_v;
          const double y = sin_l * std::sin(phi);
          const double z = cos_l + cos_v;
          const double cos_h = z / std::sqrt(x * x + y * y + z * z);
          albedo += double(ggx_lobe(float(cos_l), float(cos_v), float(cos_h), alpha)) * cos_l;
        }
      }
      albedo *= 2.0 * std::numbers::pi / (count * count);
      EXPECT_LE(albedo, 1.01) << "alpha " << alpha << ", cos " << cos_v;
      EXPECT_GE(albedo, 0.2);
    }
  }
}

TEST(GgxLobe, IsFiniteAtTheEnds)
{
  for (const float alpha : {ALPHA_MIN, 1.0F}) {
    for (const float c : {1e-6F, 1.0F}) {
      EXPECT_TRUE(std::isfinite(ggx_lobe(c, c, 1.0F, alpha)));
      EXPECT_TRUE(std::isfinite(ggx_lobe(c, 1e-4F, 0.0F, alpha)));
    }
  }
}

/** Unit vector of a polar angle's cosine and an azimuth. */
vec3 direction(float cosine, float azimuth)
{
  const float sine = std::sqrt(1.0F - cosine * cosine);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

TEST(AnisotropicGgxLobe, IsTheRoundOneForEqualAlphas)
{
  for (const float alpha : {0.01F, 0.3F, 1.0F}) {
    for (const float azimuth : {0.0F, 0.7F, 3.0F}) {
      const vec3 to_light = direction(0.4F, azimuth);
      const vec3 to_viewer = direction(0.7F, 2.0F);
      const vec3 half_vector = normalize(to_light + to_viewer);
      const float expected = ggx_lobe(to_light.z, to_viewer.z, half_vector.z, alpha);
      // Tolerance for rounding of float near the centre of the lobe of a small alpha.
      EXPECT_NEAR(anisotropic_ggx_lobe(to_light, to_viewer, half_vector, vec2(alpha)), expected, 1e-4F * expected);
    }
  }
}

TEST(AnisotropicGgxLobe, IsReciprocalAndFiniteAtTheEnds)
{
  const vec2 alphas(0.5F, 0.1F);
  const vec3 a = direction(0.4F, 0.3F);
  const vec3 b = direction(0.9F, 2.0F);
  const vec3 h = normalize(a + b);
  EXPECT_FLOAT_EQ(anisotropic_ggx_lobe(a, b, h, alphas), anisotropic_ggx_lobe(b, a, h, alphas));
  for (const float c : {1e-6F, 1.0F}) {
    for (const float cos_h : {0.0F, 1.0F}) {
      EXPECT_TRUE(std::isfinite(anisotropic_ggx_lobe(direction(c, 0.0F), direction(1e-4F, 1.0F), direction(cos_h, 2.0F),
                                                     vec2(1.0F, ALPHA_MIN))));
    }
  }
}

/** The same as GgxDistribution.ProjectsToOne. Over slopes r (α_x cos φ, α_y sin φ) with r² = u / (1 - u), the integrand
 * is constant. */
TEST(AnisotropicGgxLobe, DistributionProjectsToOne)
{
  for (const vec2 alphas : {vec2(1.0F, 0.01F), vec2(0.3F, 0.1F)}) {
    constexpr int count = 256;
    double area = 0.0;
    for (int i = 0; i < count; i++) {
      for (int j = 0; j < count; j++) {
        const double u = (i + 0.5) / count;
        const double r = std::sqrt(u / (1.0 - u));
        const double azimuth = 2.0 * std::numbers::pi * (j + 0.5) / count;
        const vec3 half_vector =
            normalize(vec3(float(r * std::cos(azimuth)) * alphas.x, float(r * std::sin(azimuth)) * alphas.y, 1.0F));
        const vec3 up(0.0F, 0.0F, 1.0F);
        // Without masking: both factors are 1/2 for the normal.
        const double distribution = 4.0 * double(anisotropic_ggx_lobe(up, up, half_vector, alphas));
        const double solid_angle = std::pow(double(half_vector.z), 3.0) * double(alphas.x) * double(alphas.y) *
                                   std::numbers::pi / ((1.0 - u) * (1.0 - u)) / (double(count) * count);
        area += distribution * double(half_vector.z) * solid_angle;
      }
    }
    // The roundings of floats where alphas differ by a factor of 100. Measured: 2e-6.
    EXPECT_NEAR(area, 1.0, 1e-4) << alphas.x << ' ' << alphas.y;
  }
}

TEST(AnisotropicAlphas, AreEqualWithoutAnisotropyAndOneAlongItForAllOfIt)
{
  EXPECT_EQ(anisotropic_alphas(0.25F, 0.0F), vec2(0.25F));
  EXPECT_EQ(anisotropic_alphas(0.25F, 1.0F), vec2(1.0F, 0.25F));
}

/** Mean of a lobe's distribution over normals around its centre, whose slopes have the variance \a variance along each
 * axis. */
double mean_distribution(double alpha, double variance)
{
  constexpr int count = 4000;
  double sum = 0.0;
  double weights = 0.0;
  for (int i = 0; i < count; i++) {
    const double slope = 8.0 * std::sqrt(variance) * (i + 0.5) / count;
    const double weight = slope * std::exp(-0.5 * slope * slope / variance);
    sum += weight * double(ggx_distribution(float(1.0 / std::sqrt(1.0 + slope * slope)), float(alpha)));
    weights += weight;
  }
  return sum / weights;
}

TEST(FilteredAlpha, IsNearTheMeanOfTheLobes)
{
  for (const float alpha : {0.01F, 0.05F, 0.2F}) {
    for (const float deviation : {0.01F, 0.05F, 0.1F}) {
      const float variance = deviation * deviation;
      const double mean = mean_distribution(double(alpha), double(variance));
      const float change_sq = 2.0F * variance / PIXEL_VARIANCE;
      const double filtered = double(ggx_distribution(1.0F, filtered_alpha(alpha, change_sq, 1.0F, 1.0F)));
      // Measured: 1.00 to 1.24. Without the filter, the ratio is up to 205.
      EXPECT_GT(filtered / mean, 0.98) << alpha << ' ' << deviation;
      EXPECT_LT(filtered / mean, 1.3) << alpha << ' ' << deviation;
    }
  }
}

TEST(FilteredAlpha, IsBoundedAndTheSameForFlatSurfacesRimsAndManySamples)
{
  for (const float alpha : {ALPHA_MIN, 0.25F, 1.0F}) {
    EXPECT_FLOAT_EQ(filtered_alpha(alpha, 0.0F, 1.0F, 1.0F), alpha);
    EXPECT_FLOAT_EQ(filtered_alpha(alpha, 8.0F, 1.0F, 0.0F), alpha);
    EXPECT_FLOAT_EQ(filtered_alpha(alpha, 8.0F, 0.0F, 1.0F), alpha) << "at the rim";
    EXPECT_LE(filtered_alpha(alpha, 8.0F, 1.0F, 1.0F), std::min(1.0F, std::sqrt(alpha * alpha + 0.18F) + 1e-6F));
    EXPECT_GE(filtered_alpha(alpha, 0.1F, 1.0F, 1.0F), filtered_alpha(alpha, 0.1F, 1.0F, 0.25F));
  }
}

TEST(CharlieDistribution, ProjectsToOne)
{
  for (const float alpha : {SHEEN_ALPHA_MIN, 0.1F, 0.5F, 1.0F}) {
    const double area = hemisphere_integral([&](double c) { return double(charlie_distribution(float(c), alpha)); });
    EXPECT_NEAR(area, 1.0, 1e-3) << "alpha " << alpha;
  }
}

TEST(SheenLobe, IsReciprocalAndFiniteAtTheEnds)
{
  EXPECT_FLOAT_EQ(sheen_lobe(0.3F, 0.8F, 0.6F, 0.4F), sheen_lobe(0.8F, 0.3F, 0.6F, 0.4F));
  for (const float alpha : {SHEEN_ALPHA_MIN, 1.0F}) {
    for (const float cos_h : {0.0F, 1.0F}) {
      EXPECT_TRUE(std::isfinite(sheen_lobe(0.0F, 1e-4F, cos_h, alpha)));
      EXPECT_TRUE(std::isfinite(sheen_lobe(1.0F, 1.0F, cos_h, alpha)));
    }
  }
}

TEST(FresnelSchlick, GoesFromNormalToGrazing)
{
  const vec3 f0(0.04F, 0.5F, 1.0F);
  EXPECT_EQ(fresnel_schlick(f0, 1.0F, 1.0F), f0);
  EXPECT_EQ(fresnel_schlick(f0, 1.0F, 0.0F), vec3(1.0F));
  EXPECT_EQ(fresnel_schlick(vec3(0.0F), 0.0F, 0.3F), vec3(0.0F));
}

}  // namespace
}  // namespace gnomon::shared
