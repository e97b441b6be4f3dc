// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** glTF's photometric units over radiometric ones, lm/W. */
constexpr double lumen_per_watt = 683.0;

/** Upper limit of numbers for which glTF defines none. Products of a few such numbers are finite in float. */
constexpr double large = 1e12;

/**
 * Largest accepted coordinate, metres. Its square and its cube are finite in float, and so are all lengths, areas and
 * volumes of an imported scene.
 */
constexpr double coordinate_max = 1e12;

/** Smallest positive length. The square of a smaller one would underflow in float. */
constexpr double length_min = 1e-12;

/** The index of refraction that is used for \a ior of a file: 0, which stands for infinity, or at least 1. */
constexpr double valid_ior(double ior)
{
  // The limit of factors without one in glTF.
  return ior == 0.0 ? 0.0 : std::clamp(ior, 1.0, 1e9);
}

/**
 * Reflectance at normal incidence of an index of refraction over that of 1.5, which is 0.04. The scene multiplies the
 * specular colour by it. \a ior: 0 stands for infinity, at which all light is reflected.
 */
constexpr float reflectance_ratio(double ior)
{
  const double root = (ior - 1.0) / (ior + 1.0);
  return static_cast<float>(root * root / 0.04);
}

}  // namespace gnomon::gltf
