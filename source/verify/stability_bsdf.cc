// SPDX-License-Identifier: MIT
// Reflection: roughness 0, grazing angles, and the textbook form of the distribution, which cancels.
#include "internal/stability_cases.hh"

#include "eevee_bsdf_shared.h"
#include "render_materials.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gnomon::verify {

namespace {

constexpr const char *bsdf_group = "bsdf";
constexpr std::array<float, 5> roughnesses = {0.0F, 0.04F, 0.2F, 0.5F, 1.0F};

float alpha_of(float roughness)
{
  scene::Material material;
  material.roughness = roughness;
  return render_scene::material_data(material).alpha;
}

/** The textbook form of GGX: a² / (π (cos² (a² - 1) + 1)²). */
double textbook_distribution(float cos_h, float alpha)
{
  const float a2 = alpha * alpha;
  const float t = cos_h * cos_h * (a2 - 1.0F) + 1.0F;
  return a2 / (std::numbers::pi_v<float> * t * t);
}

}  // namespace

void add_bsdf_cases(std::vector<StabilityCase> &cases)
{
  for (const float roughness : roughnesses) {
    const float alpha = alpha_of(roughness);
    const std::string of = fmt::format("roughness {:g}", roughness);
    cases.push_back(
        case_of({bsdf_group, "distribution near its peak, " + of, "ggx_distribution", "GGX distribution of normals",
                 "1 - cosine of the half vector", log_steps(1e-7, 1.0, 113), [=](double versine) {
                   return Arguments<float>{.a = {float(1.0 - versine), alpha, 0.0F, 0.0F}};
                 }}));
    cases.push_back(case_of({bsdf_group, "masking to grazing, " + of, "ggx_masking_over_2cos",
                             "Smith's masking over 2 cos", "cosine", log_steps(1e-6, 1.0, 121), [=](double cosine) {
                               return Arguments<float>{.a = {float(cosine), alpha, 0.0F, 0.0F}};
                             }}));
    cases.push_back(
        case_of({bsdf_group, "lobe to grazing, " + of, "ggx_lobe", "microfacet lobe, same view and light direction",
                 "cosine of view and light", log_steps(1e-6, 1.0, 121), [=](double cosine) {
                   return Arguments<float>{.a = {float(cosine), float(cosine), 1.0F, alpha}};
                 }}));
    cases.push_back(
        case_of({bsdf_group, "light that meets a second microfacet, " + of, "missing_scale",
                 "scale of the light that the lobe misses", "cosine", log_steps(1e-6, 1.0, 121), [=](double cosine) {
                   return Arguments<float>{.a = {alpha, float(cosine), 0.0F, 0.0F}};
                 }}));
  }
  for (const bool is_textbook : {true, false}) {
    cases.push_back(
        {.group = bsdf_group,
         .name = is_textbook ? "distribution as in textbooks, alpha to 1e-6" : "distribution, alpha to ALPHA_MIN",
         .quantity = "GGX distribution of normals, 0.001 rad from its peak",
         .parameter = "alpha",
         .reference = "double",
         .unit = epsilon_unit,
         // The bound of the function's sweep.
         .bound = 4.0,
         .is_baseline = is_textbook,
         .run = swept(log_steps(is_textbook ? 1e-6 : double(shared::ALPHA_MIN), 1.0, 121), [=](double a) {
           const auto cos_h = float(std::cos(1e-3));
           const auto alpha = float(a);
           const double sin_sq = (1.0 - double(cos_h)) * (1.0 + double(cos_h));
           const double t = sin_sq + std::pow(double(alpha) * double(cos_h), 2.0);
           const double truth = std::pow(double(alpha), 2.0) / (std::numbers::pi * t * t);
           const double given =
               is_textbook ? textbook_distribution(cos_h, alpha) : double(shared::ggx_distribution(cos_h, alpha));
           return std::abs(given / truth - 1.0) / float_epsilon;
         })});
  }
  cases.push_back({.group = bsdf_group,
                   .name = "distribution's normalisation",
                   .quantity = "projected area of all microfacets: 1",
                   .parameter = "alpha",
                   .reference = "closed form: 1",
                   .unit = "relative",
                   // The midpoint rule with 2000 steps, and cosines in float: a quarter of an epsilon is 3e-8 / alpha²
                   // of the peak's width.
                   .bound = 5e-3,
                   .run = swept(log_steps(double(shared::ALPHA_MIN), 1.0, 41), [](double alpha) {
                     // Equal steps of tan² / (a² + tan²), the fraction of area up to an angle.
                     double sum = 0.0;
                     constexpr int count = 2000;
                     for (int i = 0; i < count; i++) {
                       const double share = (i + 0.5) / count;
                       const double tan_sq = alpha * alpha * share / (1.0 - share);
                       const double cos_sq = 1.0 / (1.0 + tan_sq);
                       const double truth =
                           std::pow(alpha * (1.0 + tan_sq) / (alpha * alpha + tan_sq), 2.0) / std::numbers::pi;
                       sum += double(shared::ggx_distribution(float(std::sqrt(cos_sq)), float(alpha))) / truth / count;
                     }
                     return std::abs(sum - 1.0);
                   })});
  for (const float f0 : {0.0F, 0.04F, 1.0F}) {
    cases.push_back(case_of({bsdf_group, fmt::format("Fresnel of {:g}", f0), "fresnel_schlick", "Schlick's reflection",
                             "cosine", even_steps(-0.001, 1.001, 101), [=](double cosine) {
                               return Arguments<float>{.a = {f0, f0, f0, 1.0F}, .b = {float(cosine), 0.0F, 0.0F, 0.0F}};
                             }}));
  }
  for (const float f0 : {0.0F, 0.04F, 1.0F}) {
    cases.push_back(case_of(
        {bsdf_group, fmt::format("colour of multiple scattering for a Fresnel of {:g}", f0), "multiscatter_color",
         "part of the light that leaves after several reflections", "mean light that meets a second microfacet",
         log_steps(1e-7, 0.7, 101), [=](double missing) {
           return Arguments<float>{.a = {f0, f0, f0, f0 > 0.0F ? 1.0F : 0.0F}, .b = {float(missing), 0.0F, 0.0F, 0.0F}};
         }}));
  }
  cases.push_back({.group = bsdf_group,
                   .name = "materials of every roughness",
                   .quantity = "alpha of material_block: roughness², in [ALPHA_MIN, 1]",
                   .parameter = "roughness",
                   .reference = "closed form",
                   .unit = epsilon_unit,
                   .bound = 1.0,
                   .run = swept(zero_and_log_steps(1e-38, 1.0, 115), [](double roughness) {
                     const double truth = std::max(roughness * roughness, double(shared::ALPHA_MIN));
                     return std::abs(double(alpha_of(float(roughness))) / truth - 1.0) / float_epsilon;
                   })});
  cases.push_back(
      {.group = bsdf_group,
       .name = "specular colours of 0 to the largest",
       .quantity = "reflection of material_block: finite, in [0, 1]",
       .parameter = "specular colour",
       .reference = "closed form",
       .unit = violation_unit,
       .bound = 0.0,
       .run = swept(log_steps(1e-45, 3.4e38, 169), [](double color) {
         double worst = 0.0;
         for (const float metallic : {0.0F, 1e-30F, 0.5F, 1.0F}) {
           scene::Material material;
           material.metallic = metallic;
           material.specular_color = glm::vec3(float(color), 0.0F, 1.0F);
           const shared::MaterialData data = shared::tinted(render_scene::material_data(material), {1.0F, 0.0F, 0.5F});
           for (const float f : {data.specular_f0.x, data.specular_f0.y, data.specular_f0.z, data.specular_f90}) {
             worst = std::max(worst, violated(f >= 0.0F && f <= 1.0F));
           }
         }
         return worst;
       })});
}

}  // namespace gnomon::verify
