// SPDX-License-Identifier: MIT
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <cstddef>
#include <span>

namespace gnomon::gpu {

/**
 * A persistently mapped buffer for data that one submit writes and its draws read: draws, instances, push constants and
 * buffer updates. It consists of segments that are used in turn, one for each submit. A segment is written again once
 * the device has finished the submit that used it before.
 */
class StreamRing {
 public:
  StreamRing() = default;
  StreamRing(const StreamRing &) = delete;
  StreamRing &operator=(const StreamRing &) = delete;

  /** Takes the next segment; waits for the device where it still reads it. */
  void begin(std::size_t size_bytes);
  /** Copies \a bytes into the segment. \return their offset in buffer(), a multiple of \a alignment */
  std::size_t write(std::span<const std::byte> bytes, std::size_t alignment);
  /** To be called after the last command that reads the segment. */
  void end();
  /** To be called while the context is current. */
  void destroy();

  [[nodiscard]] GLuint buffer() const
  {
    return buffer_;
  }

 private:
  static constexpr std::size_t segment_count = 3;

  /** The segments of the new buffer are not in use; the driver keeps the old one until the device has finished with it.
   */
  void grow(std::size_t size_bytes);

  GLuint buffer_ = 0;
  std::byte *mapped_ = nullptr;
  std::size_t segment_bytes_ = 0;
  std::size_t segment_ = 0;
  /** Next byte of the current segment, from the begin of the buffer. */
  std::size_t next_ = 0;
  std::array<GLsync, segment_count> fences_{};
};

}  // namespace gnomon::gpu
