// SPDX-License-Identifier: MIT
#pragma once

#include "vulkan_memory.hh"
#include "vulkan_submission.hh"

#include <deque>
#include <span>
#include <vector>

namespace gnomon::gpu {

/** Data of the CPU for the open submission: draws, instances, and what is copied to buffers and textures. */
class VulkanStream {
 public:
  VulkanStream(VulkanContext &context, VulkanMemory &memory, VulkanSubmissions &submissions);
  ~VulkanStream();
  VulkanStream(const VulkanStream &) = delete;
  VulkanStream &operator=(const VulkanStream &) = delete;

  struct Place {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset_bytes = 0;
  };
  /** Copies \a bytes. The offset is a multiple of \a alignment. Valid until the open submission is submitted. */
  [[nodiscard]] Place write(std::span<const std::byte> bytes, VkDeviceSize alignment);
  /** Frees the memory of submissions that the device has finished. */
  void collect();
  /** Bytes in use by submissions that collect() has not found finished. */
  [[nodiscard]] VkDeviceSize used_bytes() const
  {
    return used_bytes_;
  }

 private:
  struct Chunk {
    VulkanBuffer buffer;
    VkDeviceSize used_bytes = 0;
    /** The last submission that reads it. */
    std::uint64_t number = 0;
  };
  /** Room for \a size_bytes in the last chunk. */
  void make_room(VkDeviceSize size_bytes, VkDeviceSize alignment);

  VulkanContext &context_;
  VulkanMemory &memory_;
  VulkanSubmissions &submissions_;
  /** Oldest first. Data is written to the last one. */
  std::deque<Chunk> used_;
  std::vector<VulkanBuffer> unused_;
  VkDeviceSize used_bytes_ = 0;
};

}  // namespace gnomon::gpu
