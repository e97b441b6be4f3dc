// SPDX-License-Identifier: MIT
// Integrals of the light of lamps with an extent against closed forms, and the errors of its approximations.
#include "measure_light.hh"

#include "eevee_shape_shared.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

namespace gnomon::measure {
namespace {

constexpr double pi = std::numbers::pi;

SpecularLobe lobe_of(double roughness, double view_angle)
{
  return {.alpha = roughness * roughness, .view = {std::sin(view_angle), 0.0, std::cos(view_angle)}};
}

TEST(IntegratedDiffuse, IsTheFormFactor)
{
  // Above the point and parallel to it: Howell's form factor B-3 of a corner, four times, and that of an ellipse.
  const double a = 1.5;
  const double b = 0.5;
  const double across = std::sqrt(1.0 + a * a);
  const double along = std::sqrt(1.0 + b * b);
  const double rectangle = 4.0 / (2.0 * pi) * (a / across * std::atan(b / across) + b / along * std::atan(a / along));
  for (const auto &[outline, expected] :
       {std::pair(LampOutline::Rectangle, rectangle), {LampOutline::Ellipse, a * b / (across * along)}}) {
    const LampShape lamp{.outline = outline, .center = {0, 0, 1}, .axis_x = {a, 0, 0}, .axis_y = {0, b, 0}};
    const Integral integral = integrated_diffuse(lamp, 256);
    EXPECT_NEAR(integral.value, expected, 5.0 * integral.standard_error);
    EXPECT_LT(integral.standard_error, 5e-3 * expected);
  }
}

TEST(IntegratedSpecular, OverAllDirectionsIsTheAlbedo)
{
  for (const double roughness : {0.3, 0.6, 1.0}) {
    for (const double view_angle : {0.3, 1.0, 1.4}) {
      const SpecularLobe lobe = lobe_of(roughness, view_angle);
      const LampShape sky{.center = {0, 0, 1}, .axis_x = {1e4, 0, 0}, .axis_y = {0, 1e4, 0}};
      const Integral integral = integrated_specular(sky, lobe, 256);
      const glm::vec2 texco = shared::ltc_texco(float(lobe.alpha), float(lobe.view.z)) + glm::vec2(0.5F, 0.0F);
      // The table is interpolated.
      EXPECT_NEAR(integral.value, double(ltc_texel(texco).x), 3e-3 + 5.0 * integral.standard_error)
          << roughness << ' ' << view_angle;
    }
  }
}

TEST(IntegratedSpecular, StatesItsError)
{
  const LampShape lamp{.center = {-1.0, 0.2, 0.3}, .axis_x = {0, 0.5, 0}, .axis_y = {0.15, 0, 0.5}};
  for (const double roughness : {0.1, 0.4, 1.0}) {
    const SpecularLobe lobe = lobe_of(roughness, 1.2);
    const Integral coarse = integrated_specular(lamp, lobe, 32);
    const Integral fine = integrated_specular(lamp, lobe, 1024);
    EXPECT_LT(fine.standard_error, 0.5 * coarse.standard_error);
    EXPECT_LT(fine.standard_error, 2e-3 * fine.value);
    EXPECT_NEAR(coarse.value, fine.value, 5.0 * coarse.standard_error);
  }
}

TEST(LightApproximations, OfASmallLampAreTheIntegral)
{
  const glm::dvec3 to_lamp = glm::normalize(glm::dvec3(-0.4, 0.3, 0.8));
  const glm::dvec3 across = glm::normalize(glm::cross(to_lamp, glm::dvec3(0, 0, 1)));
  for (const LampOutline outline : {LampOutline::Round, LampOutline::Rectangle, LampOutline::Ellipse}) {
    const LampShape lamp{
        .outline = outline, .center = to_lamp, .axis_x = 1e-4 * across, .axis_y = 1e-4 * glm::cross(to_lamp, across)};
    const double diffuse = integrated_diffuse(lamp, 64).value;
    EXPECT_NEAR(whole_diffuse(lamp) / diffuse, 1.0, 1e-5);
    EXPECT_NEAR(point_diffuse(lamp) / diffuse, 1.0, 1e-5);
    for (const double roughness : {0.4, 0.8}) {
      const SpecularLobe lobe = lobe_of(roughness, 0.6);
      const double specular = integrated_specular(lamp, lobe, 64).value;
      EXPECT_NEAR(whole_specular(lamp, lobe).light / specular, 1.0, 1e-3);
      EXPECT_NEAR(point_specular(lamp, lobe) / specular, 1.0, 2e-3);
    }
  }
}

/** Far from its peak, the transformed cosine ends before the lobe does. */
TEST(LightApproximations, OfASmallLampNearTheHorizonAreTheIntegral)
{
  for (const double roughness : {0.5, 0.75}) {
    for (const double view_angle : {0.15, 0.6}) {
      const SpecularLobe lobe = lobe_of(roughness, view_angle);
      const double size = 0.09 * lobe.alpha;
      for (const double elevation : {0.1, 0.3}) {
        for (int i = 0; i < 8; i++) {
          const double azimuth = 0.25 * pi * i;
          const glm::dvec3 to_lamp(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                   std::sin(elevation));
          const glm::dvec3 across = glm::normalize(glm::cross(to_lamp, glm::dvec3(0, 0, 1)));
          const LampShape lamp{
              .center = to_lamp, .axis_x = size * across, .axis_y = size * glm::cross(to_lamp, across)};
          EXPECT_NEAR(whole_specular(lamp, lobe).light / integrated_specular(lamp, lobe, 256).value, 1.0, 0.02)
              << roughness << ' ' << view_angle << ' ' << elevation << ' ' << azimuth;
        }
      }
    }
  }
}

TEST(LightApproximations, OfALampAroundANarrowLobeAreItsAlbedo)
{
  for (const double roughness : {0.03, 0.05, 0.08, 0.12}) {
    for (double view_angle = 0.05; view_angle < 1.4; view_angle += 0.05) {
      const SpecularLobe lobe = lobe_of(roughness, view_angle);
      const glm::dvec3 mirrored(-lobe.view.x, 0.0, lobe.view.z);
      const LampShape lamp{.outline = LampOutline::Rectangle,
                           .center = mirrored,
                           .axis_x = {0, 0.25, 0},
                           .axis_y = 0.25 * glm::cross(mirrored, glm::dvec3(0, 1, 0))};
      const double truth = integrated_specular(lamp, lobe, 512).value;
      EXPECT_NEAR(whole_specular(lamp, lobe).light / truth, 1.0, 0.01) << roughness << ' ' << view_angle;
    }
  }
}

TEST(LightErrors, OfWholeLampsAreBelowThoseOfPoints)
{
  for (const LightErrorRow &row : light_errors(4)) {
    EXPECT_EQ(row.whole.bad_count + row.point.bad_count, 0U) << row.light << ' ' << row.parameter << ' ' << row.value;
    if (row.parameter == "all") {
      EXPECT_EQ(row.case_count, row.light == "diffuse" ? 3U * 3 * 3 * 4 : 3U * 3 * 3 * 5 * 4 * 10);
      EXPECT_LT(row.whole.p95, 0.5 * row.point.p95) << row.light;
    }
  }
}

}  // namespace
}  // namespace gnomon::measure
