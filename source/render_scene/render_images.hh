// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include "gpu_device.hh"

#include <map>

namespace gnomon::render_scene {

/**
 * The images and samplers of a scene on one device. An image is uploaded and mip-mapped when a pass first reads it, and
 * again when its content changes. Textures with equal sampling share a sampler.
 */
class Images {
 public:
  struct Lookup {
    const gpu::Texture &image;
    const gpu::Sampler &sampler;
  };
  /**
   * \a handle's image and sampler. The references hold until the image changes, or until free_removed.
   * \throws gpu::Error where the device cannot hold the image. \pre is_drawable
   */
  Lookup get(gpu::Device &device, const scene::Scene &scene, scene::Handle<scene::Texture> handle);
  /** An image on the device; nullptr: no pass read it. */
  [[nodiscard]] const gpu::Texture *find(scene::Handle<scene::Image> handle) const;
  /** Images on the device. */
  [[nodiscard]] std::size_t count() const;
  /** Free images that were removed. */
  void free_removed(const scene::Pool<scene::Image> &images);

 private:
  struct Entry {
    gpu::Texture texture;
    scene::Handle<scene::Image> handle;
    scene::Revision content = 0;
  };
  /** By Handle::index. */
  std::vector<Entry> entries_;
  /** By the sampler's settings. */
  std::map<std::uint32_t, gpu::Sampler> samplers_;
};

/** Whether \a handle names a texture of \a scene whose image is there. */
[[nodiscard]] bool is_drawable(const scene::Scene &scene, scene::Handle<scene::Texture> handle);

}  // namespace gnomon::render_scene
