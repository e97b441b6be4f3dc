// SPDX-License-Identifier: MIT
// Light that microfacets reflect more than once: albedos against integration, reciprocity, and its range for random
// input.
#include "measure_light.hh"

#include "eevee_material_shared.h"
#include "eevee_multiscatter_shared.h"
#include "eevee_shape_shared.h"
#include "reference_multiscatter.hh"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace gnomon::eevee {
namespace {

using glm::dvec3;
using shared::LobeAlbedo;
using shared::MaterialData;
using shared::Multiscatter;
using shared::vec3;
using shared::vec4;

using std::numbers::pi;

/** The same as in the engine's programs. */
LobeAlbedo albedo_of(float alpha, float cosine)
{
  return shared::lobe_albedo(measure::multiscatter_texel(double(alpha), double(cosine)), alpha, cosine);
}

/** BRDF of \a material, 1/sr, with multiple scattering. \a light, \a view: unit vectors above the surface with the
 * normal +z. */
vec3 brdf(const MaterialData &material, const vec3 &light, const vec3 &view)
{
  const vec3 half_vector = glm::normalize(light + view);
  const vec3 fresnel =
      shared::fresnel_schlick(material.specular_f0, material.specular_f90, glm::dot(view, half_vector));
  const vec4 texel = measure::multiscatter_texel(double(material.alpha), double(view.z));
  const Multiscatter multiscatter =
      shared::make_multiscatter(texel, material.alpha, view.z, material.specular_f0, material.specular_f90);
  return shared::smooth_brdf(multiscatter, albedo_of(material.alpha, light.z), material.diffuse, material.specular_f0,
                             material.specular_f90) +
         fresnel * shared::ggx_lobe(light.z, view.z, std::min(half_vector.z, 1.0F), material.alpha);
}

struct Random {
  std::mt19937 engine{1};

  float uniform(float low, float high)
  {
    return std::uniform_real_distribution<float>(low, high)(engine);
  }
  bool chance(float probability)
  {
    return uniform(0.0F, 1.0F) < probability;
  }
  /** A unit vector above the surface, often near the horizon. */
  vec3 above()
  {
    const float z = chance(0.3F) ? std::pow(10.0F, uniform(-4.0F, 0.0F)) : uniform(1e-4F, 1.0F);
    const float angle = uniform(0.0F, 6.28F);
    return {std::sqrt((1.0F - z) * (1.0F + z)) * vec3(std::cos(angle), std::sin(angle), 0.0F) + vec3(0.0F, 0.0F, z)};
  }
  /** Components of any size, some of which are 0. */
  dvec3 any()
  {
    const double size = std::pow(10.0, double(uniform(-6.0F, 6.0F)));
    dvec3 v(0.0);
    for (int i = 0; i < 3; i++) {
      v[i] = chance(0.1F) ? 0.0 : size * double(uniform(-1.0F, 1.0F));
    }
    return v;
  }
  MaterialData material()
  {
    const vec3 color = chance(0.2F) ? vec3(1.0F) : vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1));
    const float metallic = chance(0.6F) ? float(chance(0.5F)) : uniform(0.0F, 1.0F);
    return shared::metallic_roughness_material(color, metallic, chance(0.1F) ? 0.0F : uniform(0.0F, 1.0F), vec3(1.0F),
                                               chance(0.1F) ? 0.0F : 1.0F);
  }
};

TEST(MultiscatterTable, HasTheAlbedosOfTheLobe)
{
  constexpr int count = 400;
  for (const double roughness : {0.2, 0.27, 0.5, 0.83, 1.0}) {
    const auto alpha = float(roughness * roughness);
    for (const double cosine : {0.07, 0.3, 0.6, 0.9}) {
      // Over directions of the light, most of which are near the mirrored view. The table integrates over normals.
      const vec3 view(float(std::sqrt((1.0 - cosine) * (1.0 + cosine))), 0.0F, float(cosine));
      double whole = 0.0;
      double schlick = 0.0;
      for (int i = 0; i < count; i++) {
        const double cos_l = (i + 0.5) / count;
        const double sin_l = std::sqrt((1.0 - cos_l) * (1.0 + cos_l));
        for (int j = 0; j < count; j++) {
          const double share = (j + 0.5) / count;
          const double angle = pi * (1.0 - share * share);
          const vec3 light(dvec3(sin_l * std::cos(angle), sin_l * std::sin(angle), cos_l));
          const vec3 half_vector = glm::normalize(light + view);
          const double solid_angle = 4.0 * pi * share / (double(count) * count);
          const double lobe =
              double(shared::ggx_lobe(light.z, view.z, std::min(half_vector.z, 1.0F), alpha)) * cos_l * solid_angle;
          whole += lobe;
          schlick += lobe * std::pow(1.0 - double(glm::dot(view, half_vector)), 5.0);
        }
      }
      const LobeAlbedo albedo = albedo_of(alpha, view.z);
      // Measured: 6.2e-4, by the interpolation between texels.
      EXPECT_NEAR(1.0 - double(albedo.missing), whole, 1e-3) << roughness << ' ' << cosine;
      EXPECT_NEAR((1.0 - double(albedo.missing)) * double(albedo.schlick), schlick, 1e-3) << roughness << ' ' << cosine;
    }
  }
}

TEST(MultiscatterTable, IsThatOfTheReference)
{
  // Also where the lobe is narrow and grazing, and integrals over its normals converge slowly. Measured: 2.1e-3.
  Random random;
  for (int i = 0; i < 2000; i++) {
    const float roughness = random.uniform(0.0317F, 1.0F);
    const float alpha = roughness * roughness;
    const float cosine = random.above().z;
    const LobeAlbedo engine = albedo_of(alpha, cosine);
    const LobeAlbedo reference =
        shared::lobe_albedo(vec4(reference::multiscatter_table().at(double(alpha), double(cosine))), alpha, cosine);
    EXPECT_NEAR(engine.missing, reference.missing, 3e-3F) << roughness << ' ' << cosine;
    EXPECT_NEAR(engine.schlick, reference.schlick, 3e-3F) << roughness << ' ' << cosine;
  }
}

TEST(Multiscatter, IsReciprocal)
{
  Random random;
  for (int i = 0; i < 20000; i++) {
    const MaterialData material = random.material();
    const vec3 light = random.above();
    const vec3 view = random.above();
    const vec3 there = brdf(material, light, view);
    const vec3 back = brdf(material, view, light);
    for (int channel = 0; channel < 3; channel++) {
      // Roundings of the peak's half vector are magnified by 1 / alpha².
      EXPECT_NEAR(there[channel], back[channel], 1e-4F * there[channel] + 1e-6F)
          << "alpha " << material.alpha << ", cosines " << light.z << ' ' << view.z;
    }
  }
}

TEST(Multiscatter, OfABlackSpecularColourIsLambertian)
{
  const MaterialData material = shared::metallic_roughness_material(vec3(0.25F), 0.0F, 0.6F, vec3(0.0F), 1.0F);
  Random random;
  for (int i = 0; i < 100; i++) {
    EXPECT_FLOAT_EQ(brdf(material, random.above(), random.above()).x, 0.25F * shared::INV_PI);
  }
}

TEST(MultiscatterColor, OfAWhiteMetalIsOneAndFallsWithEachReflection)
{
  EXPECT_FLOAT_EQ(shared::multiscatter_color(vec3(1.0F), 1.0F, 0.6F).x, 1.0F);
  // On a dark surface, only two reflections contribute.
  const float dark = shared::multiscatter_color(vec3(1e-3F), 1e-3F, 0.6F).x;
  EXPECT_NEAR(dark, 0.4e-6F, 1e-9F);
  EXPECT_FLOAT_EQ(shared::multiscatter_color(vec3(0.0F), 0.0F, 0.6F).x, 0.0F);
}

/** Numbers of results that are negative or not finite, for random lamps, views and materials. */
std::size_t bad_light(int count)
{
  Random random;
  std::size_t bad = 0;
  const auto check = [&](double value) { bad += std::isfinite(value) && value >= 0.0 ? 0 : 1; };
  for (int i = 0; i < count; i++) {
    const MaterialData material = random.material();
    const vec3 view = random.above();
    measure::LampShape lamp{.center = random.any(), .axis_x = random.any()};
    lamp.outline = measure::LampOutline(i % 3);
    // Test any outline, also degenerate ones from matrices with shear or without area. Round lamps face the shaded
    // point.
    lamp.axis_y = i % 16 == 0 ? 2.0 * lamp.axis_x : random.any();
    if (lamp.outline == measure::LampOutline::Round) {
      const dvec3 across = glm::cross(lamp.center, dvec3(0.3, 0.5, 0.9));
      const double radius = glm::length(lamp.axis_x);
      lamp.center = glm::length(across) > 0.0 ? lamp.center : dvec3(0.0, 0.0, 1.0);
      lamp.axis_x = glm::length(across) > 0.0 ? radius * glm::normalize(across) : dvec3(radius, 0.0, 0.0);
      lamp.axis_y = glm::cross(glm::normalize(lamp.center), lamp.axis_x);
    }
    const double form_factor = measure::whole_diffuse(lamp);
    // Views are in the plane of x and z.
    const double sine = std::sqrt((1.0 - double(view.z)) * (1.0 + double(view.z)));
    const measure::WholeSpecular specular =
        measure::whole_specular(lamp, {double(material.alpha), {sine, 0.0, double(view.z)}});
    check(form_factor);
    check(specular.light);
    check(specular.covered);
    const Multiscatter multiscatter =
        shared::make_multiscatter(measure::multiscatter_texel(double(material.alpha), double(view.z)), material.alpha,
                                  view.z, material.specular_f0, material.specular_f90);
    const LobeAlbedo light = shared::albedo_over_lamp(albedo_of(material.alpha, random.uniform(0.0F, 1.0F)),
                                                      multiscatter.mean, float(form_factor));
    const vec3 smooth =
        shared::smooth_brdf(multiscatter, light, material.diffuse, material.specular_f0, material.specular_f90);
    const vec3 whole = brdf(material, random.above(), view);
    for (int channel = 0; channel < 3; channel++) {
      check(double(smooth[channel]));
      check(double(whole[channel]));
    }
  }
  return bad;
}

TEST(WholeLight, IsFiniteForRandomLampsViewsAndMaterials)
{
  EXPECT_EQ(bad_light(20'000), 0U);
}

TEST(SlowWholeLight, IsFiniteForTenMillionRandomLampsViewsAndMaterials)
{
  EXPECT_EQ(bad_light(10'000'000), 0U);
}

}  // namespace
}  // namespace gnomon::eevee
