// SPDX-License-Identifier: MIT
#include "gpu_batch.hh"

#include "slots_shared.h"

namespace gnomon::gpu {

std::string_view to_string(VertexStream stream)
{
  switch (stream) {
    case VertexStream::Position: return "positions";
    case VertexStream::Normal: return "normals";
    case VertexStream::Uv: return "uvs";
    case VertexStream::SecondUv: return "second uvs";
    case VertexStream::Tangent: return "tangents";
    case VertexStream::Color: return "colours";
  }
  return "?";
}

std::uint32_t size_bytes(VertexType type)
{
  switch (type) {
    case VertexType::Float: return 4;
    case VertexType::Half:
    case VertexType::Snorm16:
    case VertexType::Unorm16: return 2;
    case VertexType::Snorm8:
    case VertexType::Unorm8: return 1;
  }
  return 0;
}

const std::array<VertexFormat, vertex_stream_count> &vertex_formats()
{
  using enum VertexType;
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

const HostStream &HostBatch::stream(VertexStream stream) const
{
  switch (stream) {
    case VertexStream::Position: return positions;
    case VertexStream::Normal: return normals;
    case VertexStream::Uv: return uvs;
    case VertexStream::SecondUv: return second_uvs;
    case VertexStream::Tangent: return tangents;
    case VertexStream::Color: return colors;
  }
  return positions;
}

}  // namespace gnomon::gpu
