// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <cstdint>
#include <string>
#include <vector>

namespace gnomon::measure {

/** The scene that is edited: boxes of four meshes and materials on a grid, and point lamps that each reach a few boxes.
 */
inline constexpr int edited_object_count = 10000;
inline constexpr int edited_lamp_count = 50;

/** The work that one edit causes in the next sync and picture. */
struct EditCost {
  /** "move an object near a lamp" */
  std::string edit;
  /** Beyond the bytes that the next picture uploads without an edit: its view, draws and instances. */
  std::uint64_t upload_bytes = 0;
  /** Lamps of which any shadow layer was drawn. */
  std::uint64_t shadows_drawn = 0;
  /** How often the passes of the picture were recorded. */
  std::uint64_t pass_recordings = 0;
  std::uint64_t textures_made = 0;
  std::uint64_t shaders_made = 0;
};

/**
 * The cost of each kind of edit, one after the other, in a scene of edited_object_count objects and edited_lamp_count
 * lamps that is drawn before. The first entry is that first picture; the second is no edit at all.
 */
[[nodiscard]] std::vector<EditCost> edit_costs(gpu::Device &device);

}  // namespace gnomon::measure
