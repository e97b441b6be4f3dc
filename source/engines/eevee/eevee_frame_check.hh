// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_command_list.hh"

#include <set>
#include <utility>

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
  /** Textures and buffers that the checked lists have written. */
  std::set<std::pair<gpu::ResourceKind, gpu::ResourceId>> written_;
};

}  // namespace gnomon::eevee
