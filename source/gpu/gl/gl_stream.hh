// SPDX-License-Identifier: MIT
#pragma once

#include "gl_names.hh"

#include <array>
#include <cstddef>
#include <span>

namespace gnomon::gpu {

/**
 * A persistently mapped buffer for the data of a submission: draws, instances, push constants and buffer updates. It
 * consists of segments that submissions use in turn. A segment is reused after the device has finished the submission
 * that used it before.
 */
class StreamRing {
 public:
  /** \a names: of the device; must outlive the ring */
  explicit StreamRing(DeviceNames &names) : names_(names) {}
  StreamRing(const StreamRing &) = delete;
  StreamRing &operator=(const StreamRing &) = delete;

  /** Begins the next segment, with room for \a size_bytes. Waits if the device still reads it. */
  void begin(std::size_t size_bytes);
  /** Copies \a bytes into the segment. \return their offset in buffer(), a multiple of \a alignment */
  std::size_t write(std::span<const std::byte> bytes, std::size_t alignment);
  /** Ends the segment. Call this after the last command that reads it. */
  void end();
  /** Frees the buffer. \pre the context is current */
  void destroy();

  [[nodiscard]] GLuint buffer() const
  {
    return buffer_;
  }

 private:
  static constexpr std::size_t segment_count = 3;

  /** Replaces the buffer by a larger one. The driver keeps the old buffer until the device no longer uses it. */
  void grow(std::size_t size_bytes);

  DeviceNames &names_;
  GLuint buffer_ = 0;
  std::byte *mapped_ = nullptr;
  std::size_t segment_bytes_ = 0;
  std::size_t segment_ = 0;
  /** Offset in the buffer of the next byte to write. */
  std::size_t next_ = 0;
  std::array<GLsync, segment_count> fences_{};
};

}  // namespace gnomon::gpu
