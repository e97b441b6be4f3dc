// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_resource.hh"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <span>
#include <string>

namespace gnomon::gpu {

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
  /** One for each position, or none: then no shader may read them. */
  std::span<const glm::vec2> uvs{};
};

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
