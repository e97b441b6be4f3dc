// SPDX-License-Identifier: MIT
#include "gpu_texture.hh"

#include <algorithm>
#include <bit>

namespace gnomon::gpu {

bool is_depth(Format format)
{
  return format == Format::Depth32F || format == Format::Depth16;
}

int texel_size_bytes(Format format)
{
  switch (format) {
    case Format::R16F:
    case Format::Depth16: return 2;
    case Format::RGBA8:
    case Format::SRGB8A8:
    case Format::R32F:
    case Format::Depth32F: return 4;
    case Format::RGBA16F:
    case Format::RG32F: return 8;
    case Format::RGBA32F: return 16;
    case Format::Host: return 0;
  }
  return 0;
}

std::string_view to_string(Format format)
{
  switch (format) {
    case Format::RGBA8: return "RGBA8";
    case Format::SRGB8A8: return "SRGB8A8";
    case Format::RGBA16F: return "RGBA16F";
    case Format::RGBA32F: return "RGBA32F";
    case Format::R16F: return "R16F";
    case Format::R32F: return "R32F";
    case Format::RG32F: return "RG32F";
    case Format::Depth32F: return "Depth32F";
    case Format::Depth16: return "Depth16";
    case Format::Host: return "of the host";
  }
  return "?";
}

std::size_t TextureDesc::size_bytes() const
{
  std::size_t texels = 0;
  for (int level = 0; level < mip_levels; level++) {
    texels += std::size_t(std::max(width >> level, 1)) * std::size_t(std::max(height >> level, 1));
  }
  return texels * std::size_t(layers) * std::size_t(texel_size_bytes(format));
}

TextureDesc texture_desc(std::string name, const HostTexture &texture)
{
  const auto longer = unsigned(std::max({texture.size_px.x, texture.size_px.y, 1}));
  return {.name = std::move(name),
          .format = Format::Host,
          .width = texture.size_px.x,
          .height = texture.size_px.y,
          .mip_levels = texture.has_mip_levels ? int(std::bit_width(longer)) : 1,
          .host = texture};
}

}  // namespace gnomon::gpu
