// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_resource.hh"

#include <cstddef>
#include <string>

namespace gnomon::gpu {

enum class BufferKind : std::uint8_t {
  /** Can be bound to uniform blocks. */
  Uniform,
  /** Can be bound to storage blocks and to uniform blocks. May be larger than one uniform block and bound in ranges. */
  Storage,
};

struct BufferDesc {
  std::string name;
  BufferKind kind = BufferKind::Uniform;
  /** Greater than 0. The content is undefined until it is written. */
  std::size_t size_bytes = 0;
};

/** Memory of a uniform or storage block, in std140 layout. Written by Device::update or CommandList::update. */
class Buffer : public Resource {
 public:
  Buffer() = default;
  [[nodiscard]] std::size_t size_bytes() const
  {
    return size_bytes_;
  }
  [[nodiscard]] BufferKind kind() const
  {
    return kind_;
  }

 private:
  friend class Device;
  Buffer(Resource resource, const BufferDesc &desc)
      : Resource(std::move(resource)), size_bytes_(desc.size_bytes), kind_(desc.kind)
  {
  }
  std::size_t size_bytes_ = 0;
  BufferKind kind_ = BufferKind::Uniform;
};

/** A part of a buffer that can be bound to a block. */
struct BufferRange {
  ResourceId buffer = 0;
  /** A multiple of Limits::uniform_offset_alignment. */
  std::uint32_t offset_bytes = 0;
  /** 0: up to the end of the buffer. */
  std::uint32_t size_bytes = 0;
};

}  // namespace gnomon::gpu
