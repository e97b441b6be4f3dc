// SPDX-License-Identifier: MIT
#pragma once

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** glTF's photometric units over radiometric ones, lm/W. */
constexpr double lumen_per_watt = 683.0;

/** The limit of numbers that have none of their own: products of a few such numbers stay finite in float. */
constexpr double large = 1e12;

/** A positive length below it would vanish in float once squared. */
constexpr double length_min = 1e-12;

}  // namespace gnomon::gltf
