// SPDX-License-Identifier: MIT
#include "gpu_batch.hh"

#include "slots_shared.h"

namespace gnomon::gpu {

const std::array<VertexFormat, vertex_stream_count> &vertex_formats()
{
  using enum VertexFormat::Type;
  static constexpr std::array<VertexFormat, vertex_stream_count> formats = {{
      {ATTRIBUTE_POSITION, 3, Float, 12},
      {ATTRIBUTE_NORMAL, 3, Float, 12},
      {ATTRIBUTE_UV, 2, Float, 8},
      {ATTRIBUTE_SECOND_UV, 2, Float, 8},
      {ATTRIBUTE_TANGENT, 4, Snorm16, 8},
      {ATTRIBUTE_COLOR, 4, Unorm16, 8},
  }};
  return formats;
}

std::span<const std::byte> BatchDesc::bytes(VertexStream stream) const
{
  switch (stream) {
    case VertexStream::Position: return std::as_bytes(positions);
    case VertexStream::Normal: return std::as_bytes(normals);
    case VertexStream::Uv: return std::as_bytes(uvs);
    case VertexStream::SecondUv: return std::as_bytes(second_uvs);
    case VertexStream::Tangent: return std::as_bytes(tangents);
    case VertexStream::Color: return std::as_bytes(colors);
  }
  return {};
}

std::size_t size_bytes(const BatchDesc &desc)
{
  std::size_t size = desc.indices.size_bytes();
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    size += desc.bytes(VertexStream(i)).size();
  }
  return size;
}

}  // namespace gnomon::gpu
