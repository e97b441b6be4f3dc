// SPDX-License-Identifier: MIT
#pragma once

#include "reference_multiscatter.hh"
#include "reference_tracer.hh"

#include <optional>

namespace gnomon::reference {

/** A material as defined by glTF 2.0, appendix B, and KHR_materials_specular, with the Fresnel fade of
 * `doc/conventions.md`. */
struct Bsdf {
  glm::dvec3 diffuse{0.0};
  /** GGX alpha: roughness². */
  double alpha = 1.0;
  /** Reflectance at normal incidence (f0) and at grazing incidence (f90). */
  glm::dvec3 f0{0.0};
  double f90 = 0.0;
  /** Albedos, if microfacets reflect light more than once; otherwise nullptr. */
  const MultiscatterTable *multiscatter = nullptr;
  /** If there is a normal texture: the normal without it, on the visible side. */
  std::optional<glm::dvec3> smooth_normal{};
};

[[nodiscard]] Bsdf make_bsdf(const Surface &surface);

/** BRDF from \a to_light to \a view, 1/sr, times the cosine of the light. All vectors have unit length. Finite. */
[[nodiscard]] glm::dvec3 reflected(const Bsdf &bsdf, const glm::dvec3 &normal, const glm::dvec3 &view,
                                   const glm::dvec3 &to_light);

/**
 * A direction that the specular lobe reflects to \a view, for \a u in [0, 1)²: normals by GGX's distribution times
 * their cosine. It may lie below the surface.
 */
[[nodiscard]] glm::dvec3 lobe_direction(const Bsdf &bsdf, const glm::dvec3 &normal, const glm::dvec3 &view,
                                        const glm::dvec2 &u);
/** Density of lobe_direction, 1/sr. */
[[nodiscard]] double lobe_density(const Bsdf &bsdf, const glm::dvec3 &normal, const glm::dvec3 &view,
                                  const glm::dvec3 &to_light);

}  // namespace gnomon::reference
