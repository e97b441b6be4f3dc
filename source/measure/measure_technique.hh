// SPDX-License-Identifier: MIT
#pragma once

#include "shadows/shadows.hh"

#include <string>
#include <vector>

namespace gnomon::measure {

/** A way of making a picture's shadows. */
struct Technique {
  /** Those that differ in size alone share it. */
  std::string name;
  /** Of the layers that are looked up; 0: there are none. */
  int size_px = 0;
  eevee::ShadowSettings settings{};
  /** Samples a pixel that pictures are made with. */
  std::vector<int> sample_counts;
  /** What chooses it in `gnomon render`; empty where no option does. */
  std::string options;
};

/** "hard 1024": unique among the techniques of a grid. */
[[nodiscard]] std::string label(const Technique &technique);

/** What `gnomon report` compares. */
[[nodiscard]] std::vector<Technique> report_techniques();

/** What `--max-error` and `--max-time` choose among, where nothing is known of the scene yet. */
[[nodiscard]] std::vector<Technique> pilot_techniques();

}  // namespace gnomon::measure
