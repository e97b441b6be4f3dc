// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include "gpu_device.hh"

#include <vector>

namespace gnomon::eevee {

/** The scene's textures on the device, each made when first asked for. Must go before its device. */
class Textures {
 public:
  struct Lookup {
    const gpu::Texture &texture;
    const gpu::Sampler &sampler;
  };

  /** Forget all. */
  void clear();
  /** A texture of the scene, whose images and textures stay as they are until clear(). */
  [[nodiscard]] Lookup get(gpu::Device &device, const scene::Scene &scene, std::size_t index);

  /** An image of the scene on the device; nullptr: nobody asked for it. */
  [[nodiscard]] const gpu::Texture *image(std::size_t index) const
  {
    return index < images_.size() && images_[index] ? &images_[index] : nullptr;
  }
  /** Images on the device. */
  [[nodiscard]] std::size_t image_count() const;

 private:
  /** One an image of the scene; empty until a texture of it is asked for. */
  std::vector<gpu::Texture> images_;
  /** One a texture of the scene. */
  std::vector<gpu::Sampler> samplers_;
};

}  // namespace gnomon::eevee
