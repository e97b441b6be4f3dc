// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec4.hpp>

#include <vector>

namespace gnomon::reference {

/** Integrals of the GGX lobe times the cosine of the light, over all directions of the light. */
struct LobeIntegrals {
  /** 1 - the integral, for Fresnel terms of 1. */
  double missing = 0.0;
  /** The value of the lobe times Schlick's fifth power. */
  double schlick = 0.0;
};

/**
 * By microfacet normals that are visible from the other direction, whose cosine is \a cosine in [0, 1] (Heitz 2018,
 * "Sampling the GGX Distribution of Visible Normals"). \a alpha: in [ALPHA_MIN, 1].
 */
[[nodiscard]] LobeIntegrals integrated_lobe(double alpha, double cosine);

/**
 * Directional albedos of the GGX lobe, for light that microfacets reflect more than once, in a table whose layout
 * eevee_multiscatter_shared.h describes.
 */
class MultiscatterTable {
 public:
  /** \a size: rows and columns, at least 2. Takes 0.2 ms for each of their product, divided by the processors. */
  explicit MultiscatterTable(int size);

  /** The texel for \a alpha in [ALPHA_MIN, 1] and \a cosine in [0, 1], interpolated. \see shared lobe_albedo */
  [[nodiscard]] glm::dvec4 at(double alpha, double cosine) const;
  /** Rows of rising cosine; in each row, alpha rises. */
  [[nodiscard]] const std::vector<glm::dvec4> &texels() const
  {
    return texels_;
  }

 private:
  int size_ = 0;
  std::vector<glm::dvec4> texels_;
};

/** The table of all pictures, computed by the first call. Thread-safe. */
[[nodiscard]] const MultiscatterTable &multiscatter_table();

}  // namespace gnomon::reference
