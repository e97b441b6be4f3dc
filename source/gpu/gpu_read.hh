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

}  // namespace gnomon::gpu
