// SPDX-License-Identifier: MIT
#pragma once

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** glTF's photometric units over radiometric ones, lm/W. */
constexpr double lumen_per_watt = 683.0;

/** Upper limit of numbers for which glTF defines none. Products of a few such numbers are finite in float. */
constexpr double large = 1e12;

/** Smallest positive length. The square of a smaller one would underflow in float. */
constexpr double length_min = 1e-12;

}  // namespace gnomon::gltf
