// SPDX-License-Identifier: MIT
#include "internal/reference_bsdf.hh"

#include <algorithm>
#include <numbers>

// This header defines `float` as double, so it must come last.
#define SHARED_DOUBLE
#include "eevee_bsdf_shared.h"

namespace gnomon::reference {

Bsdf make_bsdf(const scene::Material &material, const glm::dvec3 &base_color)
{
  const double metallic = material.metallic;
  const glm::dvec3 dielectric =
      glm::min(0.04 * glm::dvec3(material.specular_color), glm::dvec3(1.0)) * double(material.specular);
  Bsdf bsdf;
  bsdf.diffuse = base_color * (1.0 - metallic);
  bsdf.alpha = std::max<double>(double(material.roughness) * double(material.roughness), shared_double::ALPHA_MIN);
  bsdf.f0 = glm::mix(dielectric, base_color, metallic);
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
  const double kept = 1.0 - std::max({fresnel.r, fresnel.g, fresnel.b});
  const double lobe = shared_double::ggx_lobe(cos_l, cos_v, cos_h, bsdf.alpha);
  return (bsdf.diffuse * (kept / std::numbers::pi) + fresnel * lobe) * cos_l;
}

}  // namespace gnomon::reference
