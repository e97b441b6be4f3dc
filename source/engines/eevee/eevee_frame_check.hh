// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_command_list.hh"

#include <utility>
#include <vector>

namespace gnomon::eevee {

struct FrameStep;

/** Checks what steps name as read and written against their command lists. Internal to the engine. */
class FrameCheck {
 public:
  /**
   * A step must name what its \a list writes, and what it reads that checked lists have written. Uploads, copies and
   * read-backs are not in lists. \pre the list is valid on \a device
   * \throws gpu::InternalError with the step and the resource
   */
  void check(const FrameStep &step, const gpu::CommandList &list, const gpu::Device &device);

 private:
  /** A texture or a buffer. */
  using Resource = std::pair<gpu::ResourceKind, gpu::ResourceId>;
  struct Attachment {
    Resource texture;
    /** The state that writes it. */
    gpu::State write;
  };

  /** Sets reads_ and writes_. \a has_attachments: attachments count: as written if they are drawn or cleared, otherwise
   * as read. */
  void collect(const gpu::CommandList &list, const gpu::Device &device, bool has_attachments);

  // Members, because a frame like the previous one must not allocate.
  std::vector<Resource> reads_;
  std::vector<Resource> writes_;
  std::vector<Attachment> attachments_;
  /** Resources that the checked lists have written. Sorted, without duplicates. */
  std::vector<Resource> written_;
};

}  // namespace gnomon::eevee
