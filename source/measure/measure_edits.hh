// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <cstdint>
#include <string>
#include <vector>

namespace gnomon::measure {

/**
 * Size of the edited scene: boxes with four meshes and materials on a grid, and point lamps that each reach a few
 * boxes.
 */
inline constexpr int edited_object_count = 10000;
inline constexpr int edited_lamp_count = 50;

/** The work that one edit causes in the next sync and picture. */
struct EditCost {
  /** Name of the edit, for example "move an object near a lamp". */
  std::string edit;
  /** Excludes the bytes that every picture uploads: its view, draws and instances. */
  std::uint64_t upload_bytes = 0;
  /** Number of lamps whose shadow layers were drawn, at least one layer each. */
  std::uint64_t shadows_drawn = 0;
  /** Number of passes that were recorded again. */
  std::uint64_t pass_recordings = 0;
  std::uint64_t textures_made = 0;
  std::uint64_t shaders_made = 0;
};

/**
 * Measures each kind of edit in turn, in a scene of edited_object_count objects and edited_lamp_count lamps that has
 * been drawn before. The first entry is the first picture, the second a picture without an edit.
 */
[[nodiscard]] std::vector<EditCost> edit_costs(gpu::Device &device);

}  // namespace gnomon::measure
