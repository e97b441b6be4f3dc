// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_shadow_settings.hh"

#include <string>
#include <vector>

namespace gnomon::measure {

/** A shadow technique: settings for a picture's shadows. */
struct Technique {
  /** Shared by techniques that differ only in size. */
  std::string name;
  /** Size of the shadow map layers; 0 if there are none. */
  int size_px = 0;
  eevee::ShadowSettings settings{};
  /** Numbers of samples per pixel of the measured pictures. */
  std::vector<int> sample_counts;
  /** Options of `gnomon render` that select it; empty if there are none. */
  std::string options;
};

/** For example "hard 1024". Unique in each list of techniques. */
[[nodiscard]] std::string label(const Technique &technique);

/** The techniques that `gnomon report` compares. */
[[nodiscard]] std::vector<Technique> report_techniques();

/** The techniques among which `--max-error` and `--max-time` choose if there is no report of the scene. */
[[nodiscard]] std::vector<Technique> pilot_techniques();

}  // namespace gnomon::measure
