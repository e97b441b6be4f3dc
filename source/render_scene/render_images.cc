// SPDX-License-Identifier: MIT
#include "render_images.hh"

#include "render_materials.hh"

#include "scene_image.hh"

#include <algorithm>
#include <bit>

namespace gnomon::render_scene {

namespace {

gpu::Filter gpu_filter(scene::TextureFilter filter)
{
  return filter == scene::TextureFilter::Linear ? gpu::Filter::Linear : gpu::Filter::Nearest;
}

gpu::Wrap gpu_wrap(scene::TextureWrap wrap)
{
  switch (wrap) {
    case scene::TextureWrap::Repeat: return gpu::Wrap::Repeat;
    case scene::TextureWrap::MirroredRepeat: return gpu::Wrap::MirroredRepeat;
    case scene::TextureWrap::ClampToEdge: return gpu::Wrap::ClampToEdge;
  }
  return gpu::Wrap::Repeat;
}

gpu::MipFilter gpu_mip_filter(scene::MipFilter filter)
{
  switch (filter) {
    case scene::MipFilter::None: return gpu::MipFilter::None;
    case scene::MipFilter::Nearest: return gpu::MipFilter::Nearest;
    case scene::MipFilter::Linear: return gpu::MipFilter::Linear;
  }
  return gpu::MipFilter::None;
}

/** Largest ratio of a pixel's footprint that textures are filtered for. */
constexpr int texture_anisotropy = 8;

/**
 * Only for filters that are all linear, as others are undefined, and not on the CPU: Mesa's llvmpipe 22.3 took seconds
 * instead of milliseconds for a frame of a textured plane at a grazing angle.
 */
int anisotropy(const gpu::Limits &limits, const scene::Texture &texture)
{
  const bool is_linear = texture.magnified == scene::TextureFilter::Linear &&
                         texture.minified == scene::TextureFilter::Linear && texture.mip == scene::MipFilter::Linear;
  return is_linear && !limits.is_software ? std::min(texture_anisotropy, limits.anisotropy_max) : 1;
}

/** Whether any texel has alpha. */
bool is_seen(const scene::Image &image)
{
  for (std::size_t i = 3; i < image.texels.size(); i += 4) {
    if (image.texels[i] != 0) {
      return true;
    }
  }
  return false;
}

gpu::Texture make_image(gpu::Device &device, const scene::Image &image, scene::ImageUse use,
                        const scene::MaskCover &mask)
{
  gpu::Texture texture =
      device.create_texture({.name = image.name,
                             .format = use == scene::ImageUse::Data ? gpu::Format::RGBA8 : gpu::Format::SRGB8A8,
                             .width = int(image.width),
                             .height = int(image.height),
                             .mip_levels = int(std::bit_width(std::max(image.width, image.height)))});
  // Rows need not be reversed: v = 0 is the first row both in the scene and on the device.
  if (use == scene::ImageUse::Mask || (use == scene::ImageUse::Coverage && is_seen(image))) {
    const std::vector<std::uint8_t> levels = coverage_levels(image, mask);
    device.upload(texture, 0, std::as_bytes(std::span(levels)));
    return texture;
  }
  device.upload(texture, 0, std::as_bytes(std::span(image.texels)));
  if (texture.desc().mip_levels > 1) {
    device.generate_mipmaps(texture);
  }
  return texture;
}

}  // namespace

Images::Lookup Images::get(gpu::Device &device, const scene::Scene &scene, scene::Handle<scene::Texture> handle,
                           scene::ImageUse use, float mask_cutoff)
{
  if (!is_drawable(scene, handle)) {
    if (!white_) {
      white_ = make_image(device, {"white", 1, 1, {255, 255, 255, 255}}, scene::ImageUse::Data, {});
    }
    return {white_, sampler(device, {}, false)};
  }
  const scene::Texture &texture = scene.textures()[handle];
  const scene::Revision content = scene.images().revision(texture.image, scene::Image::Aspect::Content);
  const scene::MaskCover mask{mask_cutoff, mask_cutoff > 0.0F && texture.magnified == scene::TextureFilter::Linear};
  std::vector<Entry> &entries = entries_[{use, mask}];
  if (entries.size() <= texture.image.index) {
    entries.resize(scene.images().index_end());
  }
  Entry &entry = entries[texture.image.index];
  const gpu::HostTexture *host = host_textures_.find(texture.image);
  const std::uint64_t resource = host_textures_.resource_revision(texture.image);
  if (!entry.texture || entry.handle != texture.image || entry.content != content || entry.host_resource != resource) {
    const scene::Image &image = scene.images()[texture.image];
    entry = {host ? device.create_texture(gpu::texture_desc(image.name, *host)) : make_image(device, image, use, mask),
             texture.image, content, resource};
  }
  // A host's texture of one level is incomplete for a sampler that reads others, and looked up as black.
  return {entry.texture, sampler(device, texture, !host || host->has_mip_levels)};
}

const gpu::Sampler &Images::sampler(gpu::Device &device, const scene::Texture &texture, bool has_mip_levels)
{
  const scene::MipFilter mip = has_mip_levels ? texture.mip : scene::MipFilter::None;
  const std::uint32_t key = std::uint32_t(texture.magnified) | std::uint32_t(texture.minified) << 4U |
                            std::uint32_t(mip) << 8U | std::uint32_t(texture.wrap_u) << 12U |
                            std::uint32_t(texture.wrap_v) << 16U;
  gpu::Sampler &sampler = samplers_[key];
  if (!sampler) {
    // The name mentions no image, because textures of different images share the sampler.
    sampler = device.create_sampler({.name = "texture_sampler",
                                     .filter = gpu_filter(texture.magnified),
                                     .minified = gpu_filter(texture.minified),
                                     .mip = gpu_mip_filter(mip),
                                     .wrap_u = gpu_wrap(texture.wrap_u),
                                     .wrap_v = gpu_wrap(texture.wrap_v),
                                     .anisotropy = has_mip_levels ? anisotropy(device.limits(), texture) : 1});
  }
  return sampler;
}

const gpu::Texture *Images::find(scene::Handle<scene::Image> handle, scene::ImageUse use) const
{
  for (const auto &[key, entries] : entries_) {
    const bool is_made =
        handle.index < entries.size() && entries[handle.index].handle == handle && entries[handle.index].texture;
    if (key.first == use && is_made) {
      return &entries[handle.index].texture;
    }
  }
  return nullptr;
}

std::size_t Images::count() const
{
  std::size_t count = 0;
  for (const auto &[key, entries] : entries_) {
    count += std::size_t(std::ranges::count_if(entries, [](const Entry &entry) { return bool(entry.texture); }));
  }
  return count;
}

HostChanges Images::update(const scene::Scene &scene)
{
  const scene::Pool<scene::Image> &images = scene.images();
  const HostChanges changes =
      host_textures_.update([&](scene::Handle<scene::Image> handle) { return images.is_live(handle); });
  for (auto &[key, entries] : entries_) {
    for (Entry &entry : entries) {
      if (entry.texture &&
          (!images.is_live(entry.handle) || (entry.host_resource != 0 && !host_textures_.find(entry.handle)))) {
        entry = {};
      }
    }
  }
  const auto is_used = [&](float cutoff) {
    return cutoff == 0.0F || std::ranges::any_of(scene.materials(), [&](const auto &item) {
             return material_data(item.value).mask_cutoff == cutoff;
           });
  };
  std::erase_if(entries_, [&](const auto &entries) { return !is_used(entries.first.second.cutoff); });
  return changes;
}

bool is_drawable(const scene::Scene &scene, scene::Handle<scene::Texture> handle)
{
  const scene::Texture *texture = scene.textures().find(handle);
  return texture && scene.images().is_live(texture->image);
}

}  // namespace gnomon::render_scene
