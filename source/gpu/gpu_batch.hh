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

/** Memory layout and shader location of a vertex stream. */
struct VertexFormat {
  /** Attribute location, from `shaders/shared/slots_shared.h`. */
  std::uint32_t attribute;
  int component_count;
  enum class Type : std::uint8_t { Float, Snorm16, Unorm16 } type;
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

/** Location of a batch in the shared vertex and index buffers, for indexed draws. */
struct BatchRange {
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;
  std::int32_t base_vertex = 0;
  std::uint32_t vertex_count = 0;
};

/** Owns vertices and indices on the device. */
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
