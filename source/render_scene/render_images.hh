// SPDX-License-Identifier: MIT
#pragma once

#include "render_host_resources.hh"

#include "scene.hh"

#include "gpu_device.hh"

#include <array>
#include <map>

namespace gnomon::render_scene {

/**
 * The images and samplers of a scene on one device. An image is uploaded, with mip levels, when a pass first reads it,
 * and again after its content has changed. An image has one texture for each use and each cover of masks. Textures with
 * the same sampling settings share a sampler. An image that has a texture of the host is not uploaded.
 */
class Images {
 public:
  struct Lookup {
    const gpu::Texture &image;
    const gpu::Sampler &sampler;
  };
  /**
   * Image and sampler of the texture \a handle; a white texel if the texture is not drawable. The references are valid
   * until the next get() after an edit of the scene's images, or until update(). \a mask_cutoff: \see
   * scene::MaskCover
   * \throws gpu::Error if the device cannot create the image
   */
  Lookup get(gpu::Device &device, const scene::Scene &scene, scene::Handle<scene::Texture> handle, scene::ImageUse use,
             float mask_cutoff = 0.0F);
  /** The texture of an image; nullptr if no pass has read the image for this use. */
  [[nodiscard]] const gpu::Texture *find(scene::Handle<scene::Image> handle,
                                         scene::ImageUse use = scene::ImageUse::Color) const;
  /** Number of textures that images have on the device. */
  [[nodiscard]] std::size_t count() const;
  /** \see RenderScene::set_host_texture */
  [[nodiscard]] HostResources<scene::Image, gpu::HostTexture> &host_textures()
  {
    return host_textures_;
  }
  [[nodiscard]] const HostResources<scene::Image, gpu::HostTexture> &host_textures() const
  {
    return host_textures_;
  }
  /**
   * Apply the changes of the host's textures, and free the textures of images that were removed from the scene or were
   * looked up in a texture that the host has taken back, and those of cutoffs that no material has any more.
   */
  HostChanges update(const scene::Scene &scene);

 private:
  /** \a has_mip_levels: whether the sampled image has any. */
  const gpu::Sampler &sampler(gpu::Device &device, const scene::Texture &texture, bool has_mip_levels);

  struct Entry {
    gpu::Texture texture;
    scene::Handle<scene::Image> handle;
    scene::Revision content = 0;
    /** The number in `host_textures_`; 0: the image was uploaded. */
    std::uint64_t host_resource = 0;
  };
  /** Indexed by the use with its mask, and by Handle::index. */
  std::map<std::pair<scene::ImageUse, scene::MaskCover>, std::vector<Entry>> entries_;
  HostResources<scene::Image, gpu::HostTexture> host_textures_;
  gpu::Texture white_;
  /** By the sampler's settings, packed into a number. */
  std::map<std::uint32_t, gpu::Sampler> samplers_;
};

/** Whether \a handle is a texture of \a scene and its image exists. */
[[nodiscard]] bool is_drawable(const scene::Scene &scene, scene::Handle<scene::Texture> handle);

}  // namespace gnomon::render_scene
