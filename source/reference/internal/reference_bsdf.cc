// SPDX-License-Identifier: MIT
#include "internal/reference_bsdf.hh"

#include <algorithm>
#include <cmath>
#include <numbers>

// This header defines `float` as double, so it must come last.
#define SHARED_DOUBLE
#include "eevee_multiscatter_shared.h"

namespace gnomon::reference {

Bsdf make_bsdf(const Surface &surface)
{
  const glm::dvec3 dielectric = glm::min(0.04 * surface.specular_color, glm::dvec3(1.0)) * surface.specular;
  Bsdf bsdf;
  bsdf.diffuse = surface.base_color * (1.0 - surface.metallic);
  bsdf.alpha = std::max<double>(surface.roughness * surface.roughness, shared_double::ALPHA_MIN);
  bsdf.f0 = glm::mix(dielectric, surface.base_color, surface.metallic);
  bsdf.f90 = std::min(std::max({bsdf.f0.r, bsdf.f0.g, bsdf.f0.b}) / 0.02, 1.0);
  return bsdf;
}

glm::dvec3 reflected(const Bsdf &bsdf, const glm::dvec3 &normal, const glm::dvec3 &view, const glm::dvec3 &to_light)
{
  const double cos_l = glm::dot(normal, to_light);
  if (!(cos_l > 0.0)) {
    return glm::dvec3(0.0);
  }
  const glm::dvec3 sum = to_light + view;
  const double length = glm::length(sum);
  const glm::dvec3 half_vector = length > 0.0 ? sum / length : normal;
  // An interpolated normal may face away from the viewer.
  const double cos_v = std::clamp(glm::dot(normal, view), 0.0, 1.0);
  const double cos_h = std::clamp(glm::dot(normal, half_vector), 0.0, 1.0);
  const glm::dvec3 fresnel = shared_double::fresnel_schlick(bsdf.f0, bsdf.f90, glm::dot(view, half_vector));
  const double lobe = shared_double::ggx_lobe(cos_l, cos_v, cos_h, bsdf.alpha);
  const double seen = bsdf.smooth_normal ? shared_double::bump_visibility(*bsdf.smooth_normal, normal, to_light) : 1.0;
  if (bsdf.multiscatter) {
    const shared_double::LobeAlbedo light =
        shared_double::lobe_albedo(bsdf.multiscatter->at(bsdf.alpha, cos_l), bsdf.alpha, cos_l);
    const shared_double::Multiscatter multiscatter = shared_double::make_multiscatter(
        bsdf.multiscatter->at(bsdf.alpha, cos_v), bsdf.alpha, cos_v, bsdf.f0, bsdf.f90);
    const glm::dvec3 smooth = shared_double::smooth_brdf(multiscatter, light, bsdf.diffuse * seen, bsdf.f0, bsdf.f90);
    return (smooth + fresnel * lobe) * cos_l;
  }
  const double kept = 1.0 - std::max({fresnel.r, fresnel.g, fresnel.b});
  return (bsdf.diffuse * (seen * kept / std::numbers::pi) + fresnel * lobe) * cos_l;
}

glm::dvec3 lobe_direction(const Bsdf &bsdf, const glm::dvec3 &normal, const glm::dvec3 &view, const glm::dvec2 &u)
{
  const glm::dvec3 helper = std::abs(normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(helper, normal));
  const glm::dvec3 y = glm::cross(normal, x);
  // Walter et al. 2007, eq. 35 and 36.
  const double slope_sq = bsdf.alpha * bsdf.alpha * u.x / (1.0 - u.x);
  const double cos_h = 1.0 / std::sqrt(1.0 + slope_sq);
  const double sin_h = std::sqrt(slope_sq) * cos_h;
  const double angle = 2.0 * std::numbers::pi * u.y;
  const glm::dvec3 half_vector = sin_h * (std::cos(angle) * x + std::sin(angle) * y) + cos_h * normal;
  return 2.0 * glm::dot(view, half_vector) * half_vector - view;
}

double lobe_density(const Bsdf &bsdf, const glm::dvec3 &normal, const glm::dvec3 &view, const glm::dvec3 &to_light)
{
  const glm::dvec3 sum = to_light + view;
  const double length = glm::length(sum);
  if (!(length > 0.0)) {
    return 0.0;
  }
  const glm::dvec3 half_vector = sum / length;
  const double cos_h = glm::dot(normal, half_vector);
  const double across = glm::dot(view, half_vector);
  return cos_h > 0.0 && across > 0.0
             ? shared_double::ggx_distribution(std::min(cos_h, 1.0), bsdf.alpha) * cos_h / (4.0 * across)
             : 0.0;
}

}  // namespace gnomon::reference
