// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

/**
 * White furnace: a white surface in a world of radiance 1. A surface that loses and adds no light sends a radiance of 1
 * to every viewer, so that it cannot be seen before that world.
 */
namespace gnomon::measure {

/** Least and largest radiance over the views of white_furnace. */
struct FurnaceRange {
  double least = 0.0;
  double largest = 0.0;
};

/** A white surface of one roughness. */
struct FurnaceRow {
  /** "metal" or "dielectric": with a metallic of 1 or 0. */
  std::string material{};
  double roughness = 0.0;
  /** Integrals of the BRDF. \see eevee::Settings::has_multiscatter */
  FurnaceRange single{};
  FurnaceRange multi{};
  /** With multiple scattering, as one frame has it if the world is one sun whose angle is π. */
  FurnaceRange multi_sun{};
};

/**
 * Rows for both materials and roughnesses from 0.03 to 1, over views from 0° to 87° to the normal. The tables are those
 * of the engine. \a point_count: points of an integral of diffuse light along each of two dimensions, above 0.
 */
[[nodiscard]] std::vector<FurnaceRow> white_furnace(int point_count);

}  // namespace gnomon::measure
