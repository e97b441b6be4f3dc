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

/** Vertex attributes. BatchDesc documents their content. */
enum class VertexStream : std::uint8_t { Position, Normal, Uv, SecondUv, Tangent, Color };
/** Returns "positions", "normals" and so on. */
[[nodiscard]] std::string_view to_string(VertexStream stream);

/** Type of one component. Snorm and Unorm: integers that stand for [-1, 1] and [0, 1]. */
enum class VertexType : std::uint8_t { Float, Half, Snorm8, Unorm8, Snorm16, Unorm16 };
[[nodiscard]] std::uint32_t size_bytes(VertexType type);

/** Memory layout and shader location of a vertex stream. */
struct VertexFormat {
  /** Attribute location, from `shaders/shared/slots_shared.h`. */
  std::uint32_t attribute;
  int component_count;
  VertexType type;
  std::uint32_t size_bytes;
};

inline constexpr std::size_t vertex_stream_count = 6;

/** The formats, indexed by VertexStream. */
[[nodiscard]] const std::array<VertexFormat, vertex_stream_count> &vertex_formats();

/**
 * Triangles, lines or points with vertex attributes; the State of the draw decides which. Shaders read the attributes
 * at the locations of `shaders/shared/slots_shared.h`. All batches of a device share one set of buffers, so that one
 * command can draw many batches.
 */
struct BatchDesc {
  std::string name;
  std::span<const glm::vec3> positions;
  /** One for each position, or empty. If empty, shaders read zeros. */
  std::span<const glm::vec3> normals;
  /** Three for each triangle, two for each line, one for each point, each less than positions.size(). */
  std::span<const std::uint32_t> indices;
  /**
   * First set of texture coordinates. This and the following streams have one value for each position, or are empty. If
   * a stream is empty, no shader that draws the batch may read it.
   */
  std::span<const glm::vec2> uvs{};
  std::span<const glm::vec2> second_uvs{};
  /** Signed normalised: 32767 is 1. xyz: unit vector. w: 1 or -1, the sign of the bitangent. */
  std::span<const glm::i16vec4> tangents{};
  /** Unsigned normalised: 65535 is 1. */
  std::span<const glm::u16vec4> colors{};

  /** The values of a stream; may be empty. */
  [[nodiscard]] std::span<const std::byte> bytes(VertexStream stream) const;
};

/** Bytes of all attributes and indices. */
[[nodiscard]] std::size_t size_bytes(const BatchDesc &desc);

/** Largest stride of a stream of the host: the least that OpenGL 4.5 promises. */
inline constexpr std::uint32_t host_stride_bytes_max = 2048;

/** A vertex stream in a buffer of the host: as many components for each vertex as the stream has in a BatchDesc. */
struct HostStream {
  /** 0: there is no such stream. */
  HostHandle buffer = 0;
  /** The offset of the first vertex, and the stride from one vertex to the next, which is not 0. */
  std::uint32_t offset_bytes = 0;
  std::uint32_t stride_bytes = 0;
  VertexType type = VertexType::Float;

  bool operator==(const HostStream &) const = default;
};

/**
 * Triangles, lines or points in buffers that the host created. Requires ContextKind::Host, or a VulkanHost; its buffers
 * need the usages VERTEX_BUFFER and INDEX_BUFFER. This is plain data, and the host keeps the ownership. The buffers
 * must live until the last submission of a list that draws them, and with Vulkan until the device has executed it. The
 * host may write them between calls; with Vulkan, it makes the writes visible to vertex inputs, and waits for the draws
 * before it writes.
 */
struct HostBatch {
  /** Required. Object space, metres. */
  HostStream positions;
  /**
   * Streams as in a BatchDesc. If one is absent, shaders read zeros, and white for colours. A mesh of a scene requires
   * normals.
   */
  HostStream normals{};
  HostStream uvs{};
  HostStream second_uvs{};
  HostStream tangents{};
  HostStream colors{};
  std::uint32_t vertex_count = 0;
  /** The buffer of indices; not 0. An index that is not below `vertex_count` has an undefined result. */
  HostHandle index_buffer = 0;
  /** A multiple of the size of an index. */
  std::uint32_t index_offset_bytes = 0;
  /** 0: nothing is drawn. */
  std::uint32_t index_count = 0;
  enum class IndexType : std::uint8_t { Uint16, Uint32 } index_type = IndexType::Uint32;

  [[nodiscard]] const HostStream &stream(VertexStream stream) const;
  /** The size of one index. */
  [[nodiscard]] std::uint32_t index_size_bytes() const
  {
    return index_type == IndexType::Uint16 ? 2 : 4;
  }
  bool operator==(const HostBatch &) const = default;
};

/** Location of a batch in the shared vertex and index buffers, or in those of the host, for indexed draws. */
struct BatchRange {
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;
  std::int32_t base_vertex = 0;
  std::uint32_t vertex_count = 0;
  /** The batch itself, if it is in buffers of the host; 0: it is in the shared buffers. */
  ResourceId host_batch = 0;
};

/** Owns vertices and indices on the device, or names those of the host. */
class Batch : public Resource {
 public:
  Batch() = default;
  /** Does not change during the lifetime of the batch. */
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
