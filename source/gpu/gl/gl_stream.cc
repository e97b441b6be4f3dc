// SPDX-License-Identifier: MIT
#include "gl_stream.hh"

#include "gpu_error.hh"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>

namespace gnomon::gpu {

void StreamRing::begin(std::size_t size_bytes)
{
  if (size_bytes > segment_bytes_) {
    grow(size_bytes);
  }
  segment_ = (segment_ + 1) % segment_count;
  next_ = segment_ * segment_bytes_;
  if (GLsync &fence = fences_[segment_]) {
    constexpr GLuint64 forever = ~GLuint64(0);
    glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, forever);
    glDeleteSync(fence);
    fence = nullptr;
  }
}

void StreamRing::grow(std::size_t size_bytes)
{
  constexpr std::size_t size_min = std::size_t(1) << 16U;
  const std::size_t grown_bytes = std::bit_ceil(std::max(size_bytes, size_min));
  constexpr GLbitfield access = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  const auto total_bytes = GLsizeiptr(segment_count * grown_bytes);
  const GLuint grown = names_.create_buffer();
  glNamedBufferStorage(grown, total_bytes, nullptr, access);
  constexpr std::string_view name = "stream";
  glObjectLabel(GL_BUFFER, grown, GLsizei(name.size()), name.data());
  auto *mapped = static_cast<std::byte *>(glMapNamedBufferRange(grown, 0, total_bytes, access));
  if (!mapped) {
    names_.delete_buffers({&grown, 1});
    throw TransientError("submit: {} bytes of draws, instances and constants: the driver is out of memory", size_bytes);
  }
  destroy();
  buffer_ = grown;
  mapped_ = mapped;
  segment_bytes_ = grown_bytes;
}

std::size_t StreamRing::write(std::span<const std::byte> bytes, std::size_t alignment)
{
  const std::size_t offset = (next_ + alignment - 1) / alignment * alignment;
  if (!bytes.empty()) {
    std::memcpy(mapped_ + offset, bytes.data(), bytes.size());
  }
  next_ = offset + bytes.size();
  return offset;
}

void StreamRing::end()
{
  glDeleteSync(fences_[segment_]);
  fences_[segment_] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

void StreamRing::destroy()
{
  for (GLsync &fence : fences_) {
    glDeleteSync(fence);
    fence = nullptr;
  }
  // This also unmaps the buffer.
  names_.delete_buffers({&buffer_, 1});
  buffer_ = 0;
  mapped_ = nullptr;
  segment_bytes_ = 0;
}

}  // namespace gnomon::gpu
