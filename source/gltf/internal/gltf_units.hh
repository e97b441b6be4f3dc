// SPDX-License-Identifier: MIT
#pragma once

#include "scene_properties.hh"

#include <algorithm>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** glTF's photometric units over radiometric ones, lm/W. */
constexpr double lumen_per_watt = 683.0;

/** Largest accepted coordinate, metres: all lengths, areas and volumes of an imported scene are finite in float. */
constexpr double coordinate_max = scene::number_max;

/** The index of refraction that is used for \a ior of a file: 0, which stands for infinity, or at least 1. */
constexpr double valid_ior(double ior)
{
  const scene::Description row = scene::description_of<scene::Material>("ior");
  return ior == 0.0 ? 0.0 : std::clamp(ior, row.min, row.max);
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
