// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_command_list.hh"

#include <utility>
#include <vector>

namespace gnomon::eevee {

struct FrameState;
struct FrameStep;

/** Checks the names of a step's reads and writes against its command list. Internal to the engine. */
class FrameCheck {
 public:
  /**
   * \pre the list is valid on \a device
   * \throws gpu::InternalError with the step and the resource, if \a list writes a resource, or reads one that an
   * earlier list wrote, and \a step does not name it; or if \a list draws and does not bind a resource that an earlier
   * list wrote and that \a step names as read. Uploads, copies and read-backs are not in lists.
   */
  void check(const FrameStep &step, const FrameState &state, const gpu::CommandList &list, const gpu::Device &device);

 private:
  /** A texture or a buffer. */
  using Resource = std::pair<gpu::ResourceKind, gpu::ResourceId>;
  struct Attachment {
    Resource texture;
    /** The state that writes it. */
    gpu::State write;
  };

  /** \throws gpu::InternalError if \a step names a read that its list lacks, after collect */
  void check_bound(const FrameStep &step, const FrameState &state, const gpu::Device &device) const;
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
