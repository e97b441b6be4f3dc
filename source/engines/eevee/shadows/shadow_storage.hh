// SPDX-License-Identifier: MIT
#pragma once

#include "draw_pass.hh"
#include "gpu_device.hh"

#include <map>
#include <string>
#include <utility>

namespace gnomon::eevee {

/**
 * An array texture whose layers keep their places, and their texels, while its size changes. Shadows smaller than the
 * array's edge lie in the lower left corner of their layers.
 *
 * Must be destroyed before its device.
 */
class LayerArray {
 public:
  /** \a format: of depth or of colour. */
  LayerArray(std::string name, gpu::Format format) : name_(std::move(name)), format_(format) {}

  /**
   * Have \a layers layers with an edge of \a size_px texels; 0 layers free the texture. Where the old texels are kept,
   * both textures exist until they are copied.
   *
   * \a has_content: whether any layer holds texels that are needed.
   * \return whether the texture is a new one. \throws gpu::Error; the array is then unchanged, or empty where it had no
   * content.
   */
  bool resize(gpu::Device &device, int size_px, int layers, bool has_content);

  /** What draws into \a count layers from \a first on; made when first asked for. \a count 1: into that layer alone. */
  [[nodiscard]] const gpu::Framebuffer &framebuffer(gpu::Device &device, int first, int count = 1);

  [[nodiscard]] const std::string &name() const
  {
    return name_;
  }
  /** Empty while there are no layers. */
  [[nodiscard]] const gpu::Texture &texture() const
  {
    return texture_;
  }
  [[nodiscard]] int layer_count() const
  {
    return texture_ ? texture_.desc().layers : 0;
  }

 private:
  std::string name_;
  gpu::Format format_;
  gpu::Texture texture_;
  /** By first layer and count. */
  std::map<std::pair<int, int>, gpu::Framebuffer> framebuffers_;
};

}  // namespace gnomon::eevee
