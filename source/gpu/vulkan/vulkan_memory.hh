// SPDX-License-Identifier: MIT
#pragma once

#include "vulkan_context.hh"

#include "gpu_range_allocator.hh"

#include <cstddef>
#include <list>
#include <string_view>
#include <vector>

namespace gnomon::gpu {

/** Device: read and written by the device. Upload: written by the CPU. Readback: read by the CPU. */
enum class MemoryUse { Device, Upload, Readback };

/** The types of \a properties in \a type_bits that serve \a use, the best one first. */
[[nodiscard]] std::vector<std::uint32_t> memory_types_of(const VkPhysicalDeviceMemoryProperties &properties,
                                                         std::uint32_t type_bits, MemoryUse use);

/** A part of a VkDeviceMemory, in bytes. */
struct MemoryRange {
  VkDeviceSize offset = 0;
  VkDeviceSize size = 0;

  bool operator==(const MemoryRange &) const = default;
};

/** \a range, extended to multiples of \a atom_bytes, or to the end of memory of \a memory_bytes. */
[[nodiscard]] MemoryRange whole_atoms(const MemoryRange &range, VkDeviceSize atom_bytes, VkDeviceSize memory_bytes);

/** The allocations of one VkDeviceMemory. Places are multiples of granule_bytes. */
struct MemoryBlock {
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceSize size_bytes = 0;
  std::uint32_t type = 0;
  bool is_image = false;
  bool is_coherent = true;
  /** nullptr: the CPU does not see it. */
  std::byte *mapped = nullptr;
  RangeAllocator ranges;
  std::size_t allocation_count = 0;
};

/** Owns nothing: VulkanMemory::free() frees it. */
struct MemoryPlace {
  MemoryBlock *block = nullptr;
  MemoryRange range;
  std::uint32_t first_granule = 0;
  std::uint32_t granule_count = 0;

  [[nodiscard]] std::byte *mapped() const
  {
    return block->mapped + range.offset;
  }
};

struct VulkanBuffer {
  VkBuffer handle = VK_NULL_HANDLE;
  MemoryPlace place;
  VkDeviceSize size_bytes = 0;
};

/** Buffers, images and their memory, which comes from blocks. */
class VulkanMemory {
 public:
  explicit VulkanMemory(VulkanContext &context);
  ~VulkanMemory();
  VulkanMemory(const VulkanMemory &) = delete;
  VulkanMemory &operator=(const VulkanMemory &) = delete;

  /** \throws Error that begins with \a what */
  [[nodiscard]] VulkanBuffer make_buffer(std::string_view what, VkDeviceSize size_bytes, VkBufferUsageFlags usage,
                                         MemoryUse use);
  void destroy(const VulkanBuffer &buffer);
  /** \throws Error that begins with \a what; then \a place is empty */
  [[nodiscard]] VkImage make_image(std::string_view what, const VkImageCreateInfo &info, MemoryPlace &place);
  void destroy(VkImage image, const MemoryPlace &place);

  /** Free the blocks that are kept for the next resource. \return whether there was one */
  bool trim();

  /** After writes of the CPU to \a bytes of a buffer, and before the device reads them. */
  void flush(const VulkanBuffer &buffer, const MemoryRange &bytes);
  /** Before reads of the CPU. */
  void invalidate(const VulkanBuffer &buffer);

 private:
  MemoryPlace allocate(const VkMemoryRequirements &needed, MemoryUse use, bool is_image, std::string_view what);
  void free(const MemoryPlace &place);
  /** nullptr: the heap has no more memory. */
  MemoryBlock *add_block(VkDeviceSize size_bytes, std::uint32_t type, bool is_image, std::string_view what);
  [[nodiscard]] VkDeviceSize block_bytes(std::uint32_t type) const;
  [[nodiscard]] VkMappedMemoryRange mapped_range(const VulkanBuffer &buffer, const MemoryRange &bytes) const;

  VulkanContext &context_;
  VkPhysicalDeviceMemoryProperties properties_{};
  /** In a list, because places refer to blocks. */
  std::list<MemoryBlock> blocks_;
};

}  // namespace gnomon::gpu
