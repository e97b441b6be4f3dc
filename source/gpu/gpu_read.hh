// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <cstring>
#include <type_traits>
#include <vector>

namespace gnomon::gpu {

/** Calls Device::read and returns the bytes as values of T, for example float channels or glm::vec4 texels. */
template <typename T>
[[nodiscard]] std::vector<T> read_as(Device &device, const Texture &texture, int layer = 0)
{
  static_assert(std::is_trivially_copyable_v<T>);
  const std::vector<std::byte> bytes = device.read(texture, layer);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/** The \a region of \a texels, which have \a width_px columns. */
template <typename T>
[[nodiscard]] std::vector<T> cropped(std::vector<T> texels, int width_px, const Rectangle &region)
{
  if (texels.size() == std::size_t(region.size_px.x) * std::size_t(region.size_px.y)) {
    return texels;
  }
  std::vector<T> crop;
  crop.reserve(std::size_t(region.size_px.x) * std::size_t(region.size_px.y));
  for (int y = region.origin_px.y; y < region.origin_px.y + region.size_px.y; y++) {
    const auto row = texels.begin() + std::ptrdiff_t(y) * width_px + region.origin_px.x;
    crop.insert(crop.end(), row, row + region.size_px.x);
  }
  return crop;
}

}  // namespace gnomon::gpu
