// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <optional>

namespace gnomon::eevee {

class ShaderCache;
struct ShadowLayers;

/** Maximum edge of a picture of shadow layers, pixels. Larger layers are subsampled to fit. */
inline constexpr int shadow_picture_edge_max_px = 2048;

/**
 * Draws pictures of the shadow layers of a lamp, for debugging. GPU resources are created by the first call of draw.
 * Must be destroyed before its device.
 */
class ShadowPicture {
 public:
  /**
   * Draw one layer of \a layers, or all layers if \a layer is empty. All six faces of a cube are drawn as an unfolded
   * cube, seen from outside; other layers are drawn side by side. The first row of texels is at the top for cube faces,
   * as in cube maps, and at the bottom for other layers.
   *
   * \return an RGBA32F texture, valid until the next call. rgb: a display-referred colour. Near surfaces are dark and
   * far surfaces are bright (linear in the distance for suns, in its square root for other lamps), texels without a
   * caster are blue, layers that were not drawn are red. a: the distance in metres, or 0 for texels without one. It is
   * measured along the face's axis for cubes and spots, along the light from the near plane of the coarsest cascade for
   * suns, and from the lamp for octahedral layers.
   * \pre layers.count is above 0, and \a layer is below it.
   */
  const gpu::Texture &draw(gpu::Device &device, ShaderCache &shaders, const ShadowLayers &layers,
                           std::optional<int> layer);
  /** The last picture; empty before the first call of draw. */
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
