// SPDX-License-Identifier: MIT
#pragma once

#include "scene_shadows.hh"
#include "shadow_octahedral_store.hh"
#include "shadow_technique.hh"

#include <array>

namespace gnomon::eevee {

struct SceneShadows::State {
  ShadowPlan plan;
  /** Slots of the lamps whose layers all viewports share, in the order of the lamps. */
  std::vector<ShadowSlot> slots;
  ShadowCasters casters;
  /** Indexed by ShadowArrayId. */
  std::array<LayerArray, shadow_array_count> arrays = {LayerArray("shadow_cubes", gpu::Format::Depth32F),
                                                       LayerArray("shadow_maps", gpu::Format::Depth32F),
                                                       LayerArray("shadow_distance_cube", gpu::Format::Depth32F)};
  std::array<draw::TextureBinding, shadow_array_count> bindings;
  LayerRuns map_runs;
  /** The requests of the lamps with an octahedral layer. */
  std::vector<EsmLamp> esm_lamps;
  OctahedralStore octahedral;
};

}  // namespace gnomon::eevee
