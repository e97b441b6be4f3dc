// SPDX-License-Identifier: MIT
#pragma once

#include "draw_pass.hh"
#include "gpu_device.hh"

#include <map>
#include <string>
#include <utility>

namespace gnomon::eevee {

/**
 * An array texture whose layers keep their index and their texels when the array is resized. Shadows that are smaller
 * than the array's edge are in the lower left corner of their layers.
 *
 * Must be destroyed before its device.
 */
class LayerArray {
 public:
  /** \a format: a depth or a colour format. */
  LayerArray(std::string name, gpu::Format format) : name_(std::move(name)), format_(format) {}

  /**
   * Resize the array to \a layers layers with an edge of \a size_px texels. 0 layers free the texture.
   *
   * \a has_content: whether at least one layer contains texels that are still needed. They are copied, and both
   * textures exist during the copy. \return whether the texture changed. \throws gpu::Error if the texture cannot be
   * created. The array is then unchanged, or empty without \a has_content.
   */
  bool resize(gpu::Device &device, int size_px, int layers, bool has_content);
  /** The format of the texture that the next resize creates. Another format frees the texture and its texels. */
  void set_format(gpu::Format format);

  /** A framebuffer of \a count layers from \a first on, created on first use. It is not layered if \a count is 1. */
  [[nodiscard]] const gpu::Framebuffer &framebuffer(gpu::Device &device, int first, int count = 1);

  [[nodiscard]] const std::string &name() const
  {
    return name_;
  }
  [[nodiscard]] gpu::Format format() const
  {
    return format_;
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
  /** Indexed by the first layer and the count. */
  std::map<std::pair<int, int>, gpu::Framebuffer> framebuffers_;
};

}  // namespace gnomon::eevee
