// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"

#include <string>
#include <vector>

namespace gnomon::measure {

/** A scene without one feature of the full scene, to show that an engine does no work for that feature. */
struct LeftOutCase {
  /** Unique name: "full", "no lamp", "no sun", … */
  std::string name;
  scene::Scene scene;
  eevee::Settings settings;
};

/**
 * The full scene, and then ten scenes that each lack one feature. The full scene has a point lamp, a sun and a spot
 * with filtered shadows, and boxes on a ground: one textured, one masked by a texture's alpha, one specular, one
 * one-sided. The view is the scene's first camera; in the case without a visible receiver it faces away from all
 * objects.
 */
[[nodiscard]] std::vector<LeftOutCase> left_out_cases();

}  // namespace gnomon::measure
