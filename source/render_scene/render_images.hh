// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include "gpu_device.hh"

#include <array>
#include <map>

namespace gnomon::render_scene {

/**
 * The images and samplers of a scene on one device. An image is uploaded and mip-mapped when a pass first reads it, and
 * again when its content changes. It is uploaded a second time where one material takes it for colours, and another for
 * data. Textures with equal sampling share a sampler.
 */
class Images {
 public:
  struct Lookup {
    const gpu::Texture &image;
    const gpu::Sampler &sampler;
  };
  /**
   * \a handle's image and sampler; one white texel unless is_drawable. The references hold until the image changes, or
   * until free_removed. \a is_color: \see scene::TextureInput. \throws gpu::Error where the device cannot hold the
   * image.
   */
  Lookup get(gpu::Device &device, const scene::Scene &scene, scene::Handle<scene::Texture> handle, bool is_color);
  /** An image on the device; nullptr: no pass read it like that. */
  [[nodiscard]] const gpu::Texture *find(scene::Handle<scene::Image> handle, bool is_color = true) const;
  /** Images on the device. */
  [[nodiscard]] std::size_t count() const;
  /** Free images that were removed. */
  void free_removed(const scene::Pool<scene::Image> &images);

 private:
  const gpu::Sampler &sampler(gpu::Device &device, const scene::Texture &texture);

  struct Entry {
    gpu::Texture texture;
    scene::Handle<scene::Image> handle;
    scene::Revision content = 0;
  };
  /** By Handle::index: images of data, and of colours. */
  std::array<std::vector<Entry>, 2> entries_;
  gpu::Texture white_;
  /** By the sampler's settings. */
  std::map<std::uint32_t, gpu::Sampler> samplers_;
};

/** Whether \a handle names a texture of \a scene whose image is there. */
[[nodiscard]] bool is_drawable(const scene::Scene &scene, scene::Handle<scene::Texture> handle);

}  // namespace gnomon::render_scene
