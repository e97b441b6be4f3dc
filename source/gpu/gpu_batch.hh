// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_resource.hh"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <span>
#include <string>

namespace gnomon::gpu {

/**
 * Vertex inputs are at the locations of `shaders/shared/slots_shared.h`.
 * All batches of a device stand in one set of buffers, so that one command draws many of them.
 */
struct BatchDesc {
  std::string name;
  std::span<const glm::vec3> positions;
  /** As many as positions, or none: zeros. */
  std::span<const glm::vec3> normals;
  /** Three a triangle, each below positions.size(). */
  std::span<const std::uint32_t> indices;
  /** As many as positions, or none: then no shader may read them. */
  std::span<const glm::vec2> uvs{};
};

/** Where a batch stands in its device's buffers: what an indexed draw needs. */
struct BatchRange {
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;
  std::int32_t base_vertex = 0;
  std::uint32_t vertex_count = 0;
};

/** Triangles on the device. */
class Batch : public Resource {
 public:
  Batch() = default;
  /** Fixed for the batch's life. */
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
