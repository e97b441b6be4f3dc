// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"

#include <string>
#include <vector>

namespace gnomon::measure {

/** A scene that lacks something which a full one has, to see that an engine does no work for it. */
struct LeftOutCase {
  /** Unique: "full", "no lamp", "no sun", … */
  std::string name;
  scene::Scene scene;
  eevee::Settings settings;
};

/**
 * The full scene first: a point lamp, a sun and a spot with filtered shadows; boxes on a ground, of which one is
 * textured, one cut out by a texture's alpha, one specular, one one-sided. Then ten that lack one thing each. The view
 * is scenes' first camera; without a visible receiver it looks away from everything.
 */
[[nodiscard]] std::vector<LeftOutCase> left_out_cases();

}  // namespace gnomon::measure
