// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <glm/gtc/packing.hpp>
#include <glm/packing.hpp>

#include <vector>

namespace gnomon::test {

/** Writes all streams of a vertex to the picture, one after the other from left to right. */
inline constexpr const char *streams_vert = R"(
layout(location = ATTRIBUTE_POSITION) in vec3 position;
layout(location = ATTRIBUTE_NORMAL) in vec3 normal;
layout(location = ATTRIBUTE_UV) in vec2 uv;
layout(location = ATTRIBUTE_SECOND_UV) in vec2 second_uv;
layout(location = ATTRIBUTE_TANGENT) in vec4 tangent;
layout(location = ATTRIBUTE_COLOR) in vec4 color;
layout(location = ATTRIBUTE_DRAW_INSTANCE) in uvec2 draw_instance;
layout(location = 0) flat out mat4 values;
layout(location = 4) flat out vec4 more;
void main()
{
  gl_Position = vec4(position, 1.0);
  values = mat4(vec4(normal, float(draw_instance.y)), vec4(uv, second_uv), tangent, color);
  more = vec4(position.z);
})";
inline constexpr const char *streams_frag = R"(
layout(location = 0) flat in mat4 values;
layout(location = 4) flat in vec4 more;
layout(location = 0) out vec4 result;
void main()
{
  const int column = int(gl_FragCoord.x) % 5;
  result = column < 4 ? values[column] : more;
})";

/** Three vertices that cover the target; the last one of a triangle gives the values of flat inputs. */
struct Vertices {
  std::vector<glm::vec3> positions{{-1, -1, 0.25F}, {3, -1, 0.25F}, {-1, 3, 0.25F}};
  std::vector<glm::vec3> normals{3, glm::vec3(0.25F, -0.5F, 1.0F)};
  std::vector<glm::vec2> uvs{3, glm::vec2(2.0F, -3.0F)};
  std::vector<glm::vec2> second_uvs{3, glm::vec2(0.5F, 0.125F)};
  std::vector<glm::vec4> tangents{3, glm::vec4(1.0F, 0.0F, 0.0F, -1.0F)};
  std::vector<glm::vec4> colors{3, glm::vec4(0.0F, 1.0F, 0.0F, 1.0F)};
  std::vector<std::uint32_t> indices{0, 1, 2};

  [[nodiscard]] gpu::Batch make_batch(gpu::Device &device) const
  {
    std::vector<glm::i16vec4> packed_tangents;
    std::vector<glm::u16vec4> packed_colors;
    for (std::size_t i = 0; i < positions.size(); i++) {
      packed_tangents.push_back(glm::packSnorm<glm::int16>(tangents[i]));
      packed_colors.push_back(glm::packUnorm<glm::uint16>(colors[i]));
    }
    return device.create_batch({.name = "copy",
                                .positions = positions,
                                .normals = normals,
                                .indices = indices,
                                .uvs = uvs,
                                .second_uvs = second_uvs,
                                .tangents = packed_tangents,
                                .colors = packed_colors});
  }
};

/** The same in one buffer of the host, with types of all kinds. */
class InterleavedVertices {
 public:
  explicit InterleavedVertices(const Vertices &vertices)
  {
    for (std::size_t i = 0; i < vertices.positions.size(); i++) {
      const std::size_t first = bytes.size();
      append(vertices.positions[i]);
      append(glm::packHalf4x16(glm::vec4(vertices.normals[i], 0)));
      append(glm::packHalf2x16(vertices.uvs[i]));
      append(vertices.second_uvs[i]);
      append(glm::packSnorm4x8(vertices.tangents[i]));
      append(glm::packUnorm4x8(vertices.colors[i]));
      append(std::uint32_t(0xdeadbeef));
      stride_ = std::uint32_t(bytes.size() - first);
      indices.push_back(std::uint16_t(i));
    }
  }

  [[nodiscard]] gpu::HostBatch batch(gpu::HostHandle vertex_buffer, gpu::HostHandle index_buffer) const
  {
    const auto at = [&](std::uint32_t offset, gpu::VertexType type) {
      return gpu::HostStream{vertex_buffer, 8 + offset, stride_, type};
    };
    return {.positions = at(0, gpu::VertexType::Float),
            .normals = at(12, gpu::VertexType::Half),
            .uvs = at(20, gpu::VertexType::Half),
            .second_uvs = at(24, gpu::VertexType::Float),
            .tangents = at(32, gpu::VertexType::Snorm8),
            .colors = at(36, gpu::VertexType::Unorm8),
            .vertex_count = 3,
            .index_buffer = index_buffer,
            .index_offset_bytes = 4,
            .index_count = 3,
            .index_type = gpu::HostBatch::IndexType::Uint16};
  }

  /** Unused words come before the first vertex, as a host has them that draws several meshes from a buffer. */
  std::vector<std::byte> bytes = std::vector<std::byte>(8);
  std::vector<std::uint16_t> indices = {7, 7};

 private:
  template <typename T>
  void append(const T &value)
  {
    const auto value_bytes = std::as_bytes(std::span(&value, 1));
    bytes.insert(bytes.end(), value_bytes.begin(), value_bytes.end());
  }

  std::uint32_t stride_ = 0;
};

}  // namespace gnomon::test
