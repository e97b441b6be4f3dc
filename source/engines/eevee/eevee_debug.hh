// SPDX-License-Identifier: MIT
#pragma once

#include "shadows/shadows.hh"

namespace gnomon::eevee {

/** Longer edge of a picture of shadow layers, pixels: larger layers are thinned to every so many texels. */
inline constexpr int shadow_picture_edge_max_px = 2048;

/**
 * Pictures of the layers of lamps' shadows, for people who look for mistakes. Made by the device, for a host to show
 * or to read. Nothing is made before the first is asked for. Must go before its device.
 */
class ShadowPicture {
 public:
  /**
   * Draw one layer of \a layers, or, without \a layer, all: a cube's six as the box unfolds, seen from outside; others
   * side by side. A cube's face has its first row of texels above, as cube maps have; others have it below.
   *
   * \return RGBA32F, until the next call. rgb: what to look at, display-referred: near dark, far bright (linear for
   * suns, else by the distance's square root), blue where nothing was drawn, red where the layer was not drawn at all.
   * a: distance in metres, 0 where there is none: along the face's axis for cubes and spots, along the light from where
   * its first caster may be for suns, from the lamp for octahedral layers. \pre \a layer is one of them
   */
  const gpu::Texture &draw(gpu::Device &device, ShaderCache &shaders, const ShadowLayers &layers,
                           std::optional<int> layer);
  /** Empty before the first draw. */
  [[nodiscard]] const gpu::Texture &texture() const
  {
    return texture_;
  }

 private:
  void fit_target(gpu::Device &device, glm::ivec2 size_px);

  gpu::Texture texture_;
  gpu::Framebuffer framebuffer_;
  gpu::Sampler sampler_;
};

}  // namespace gnomon::eevee
