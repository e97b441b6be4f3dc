// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

namespace gnomon::reference {

/** A material as glTF 2.0, appendix B, and KHR_materials_specular have it, with the fade of `doc/conventions.md`. */
struct Bsdf {
  glm::dvec3 diffuse{0.0};
  /** GGX. */
  double alpha = 1.0;
  /** Reflection at normal incidence, and at grazing. */
  glm::dvec3 f0{0.0};
  double f90 = 0.0;
};

/** \a base_color: the material's, with its texture. */
[[nodiscard]] Bsdf make_bsdf(const scene::Material &material, const glm::dvec3 &base_color);

/** Scattered from \a to_light to \a view, 1/sr, times the cosine of the light. All unit vectors. Finite. */
[[nodiscard]] glm::dvec3 reflected(const Bsdf &bsdf, const glm::dvec3 &normal, const glm::dvec3 &view,
                                   const glm::dvec3 &to_light);

}  // namespace gnomon::reference
