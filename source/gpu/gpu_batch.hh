// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_resource.hh"

#include <glm/ext/vector_int4_sized.hpp>
#include <glm/ext/vector_uint4_sized.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>

#include <span>
#include <string>

namespace gnomon::gpu {

/** The attributes of vertices. The comments of BatchDesc say what they hold. */
enum class VertexStream : std::uint8_t { Position, Normal, Uv, SecondUv, Tangent, Color };

/** How a stream lies in its buffer, and where shaders read it. */
struct VertexFormat {
  /** In `shaders/shared/slots_shared.h`. */
  std::uint32_t attribute;
  int component_count;
  enum class Type : std::uint8_t { Float, Snorm16, Unorm16 } type;
  std::uint32_t size_bytes;
};

inline constexpr std::size_t vertex_stream_count = 6;

/** One for each VertexStream, in order. */
[[nodiscard]] const std::array<VertexFormat, vertex_stream_count> &vertex_formats();

/**
 * Triangles with vertex attributes. Shaders read them at the locations of `shaders/shared/slots_shared.h`.
 * All batches of a device share one set of buffers, so that one command draws many of them.
 */
struct BatchDesc {
  std::string name;
  std::span<const glm::vec3> positions;
  /** One for each position, or none: the shader then reads zeros. */
  std::span<const glm::vec3> normals;
  /** Three for each triangle, each less than positions.size(). */
  std::span<const std::uint32_t> indices;
  /** These have one for each position, or none: then no shader may read them. */
  std::span<const glm::vec2> uvs{};
  std::span<const glm::vec2> second_uvs{};
  /** Signed, normalised: 32767 stands for 1. xyz: unit vector. w: 1 or -1. */
  std::span<const glm::i16vec4> tangents{};
  /** Unsigned, normalised: 65535 stands for 1. */
  std::span<const glm::u16vec4> colors{};

  /** A stream's values; empty where there are none. */
  [[nodiscard]] std::span<const std::byte> bytes(VertexStream stream) const;
};

/** Of all attributes and the indices. */
[[nodiscard]] std::size_t size_bytes(const BatchDesc &desc);

/** Location of a batch in the buffers of its device, for indexed draws. */
struct BatchRange {
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;
  std::int32_t base_vertex = 0;
  std::uint32_t vertex_count = 0;
};

/** Owner of triangles on the device. */
class Batch : public Resource {
 public:
  Batch() = default;
  /** Constant during the lifetime of the batch. */
  [[nodiscard]] const BatchRange &range() const
  {
    return range_;
  }

 private:
  friend class Device;
  Batch(Resource resource, const BatchRange &range) : Resource(std::move(resource)), range_(range) {}
  BatchRange range_;
};

}  // namespace gnomon::gpu
