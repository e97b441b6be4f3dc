// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_texture.hh"

#include "eevee_depth_shared.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <vector>

namespace gnomon::eevee {

/** A set of layers of a lamp's shadow: bit i is set for layer i. */
using LayerMask = std::uint32_t;

/** Description of the layers of one light, for debugging views. */
struct ShadowLayers {
  /** Number of layers. 0 if no caster of the light can shadow a visible surface. */
  int count = 0;
  /** The array texture of the layers; nullptr if count is 0. */
  const gpu::Texture *texture = nullptr;
  /** Index of the first layer in `texture`. */
  int first_layer = 0;
  /** The layers that are in `texture`, where they follow each other. */
  LayerMask placed = ~0U;
  /** Edge of the shadow in each layer without its border, texels. It is in the lower left corner of the layer. */
  int size_px = 0;
  /** Width of the border around the shadow, texels. */
  int border = 0;
  /** The layers are the six faces of a cube, in OpenGL's order. */
  bool is_cube = false;
  /** The layers that were drawn. */
  LayerMask drawn = 0;
  /** Projection of the depths, PROJECTION_… */
  int projection = PROJECTION_PERSPECTIVE_INFINITE;
  /** Format of an octahedral layer of distances, ESM_…; -1 for layers of depths. */
  int esm_format = -1;
  /**
   * The distances of the depths 1 (x) and 0 (y), metres. For suns, one entry for each cascade, measured along the light
   * from the highest point of the near planes. For other lamps, one entry for all layers, measured from the lamp.
   */
  std::vector<glm::vec2> near_far;
  /**
   * For each entry of `near_far` of a sun: how much larger both distances are at the right and at the upper edge of the
   * layer, metres. `near_far` is that of the lower left corner. Empty for other lamps.
   */
  std::vector<glm::vec2> tilts{};
  /** Range of distances that contains all casters within the lamp's range, metres. */
  glm::vec2 shown{0.0F};
};

}  // namespace gnomon::eevee
