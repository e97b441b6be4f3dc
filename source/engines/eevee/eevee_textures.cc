// SPDX-License-Identifier: MIT
#include "eevee_textures.hh"

#include <algorithm>
#include <bit>

namespace gnomon::eevee {

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

gpu::Texture make_image(gpu::Device &device, const scene::Image &image)
{
  gpu::Texture texture =
      device.create_texture({.name = image.name,
                             .format = gpu::Format::SRGB8A8,
                             .width = int(image.width),
                             .height = int(image.height),
                             .mip_levels = int(std::bit_width(std::max(image.width, image.height)))});
  // Their first row has v = 0 in the scene as on the device.
  device.upload(texture, 0, std::as_bytes(std::span(image.texels)));
  device.generate_mipmaps(texture);
  return texture;
}

}  // namespace

void Textures::clear()
{
  images_.clear();
  samplers_.clear();
}

Textures::Lookup Textures::get(gpu::Device &device, const scene::Scene &scene, std::size_t index)
{
  images_.resize(scene.images.size());
  samplers_.resize(scene.textures.size());
  const scene::Texture &texture = scene.textures[index];
  gpu::Texture &image = images_[texture.image];
  if (!image) {
    image = make_image(device, scene.images[texture.image]);
  }
  gpu::Sampler &sampler = samplers_[index];
  if (!sampler) {
    sampler = device.create_sampler({.name = image.desc().name,
                                     .filter = gpu_filter(texture.magnified),
                                     .minified = gpu_filter(texture.minified),
                                     .mip = gpu_mip_filter(texture.mip),
                                     .wrap_u = gpu_wrap(texture.wrap_u),
                                     .wrap_v = gpu_wrap(texture.wrap_v)});
  }
  return {image, sampler};
}

std::size_t Textures::image_count() const
{
  return std::size_t(std::ranges::count_if(images_, [](const gpu::Texture &image) { return bool(image); }));
}

}  // namespace gnomon::eevee
