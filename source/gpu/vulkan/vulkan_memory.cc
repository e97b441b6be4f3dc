// SPDX-License-Identifier: MIT
#include "vulkan_memory.hh"

#include "gpu_error.hh"

#include <algorithm>
#include <bit>
#include <optional>

namespace gnomon::gpu {

namespace {

/** Most resources need no greater alignment. */
constexpr VkDeviceSize granule_bytes = 256;
constexpr VkDeviceSize block_bytes_max = VkDeviceSize(16) << 20U;
/** Least number of blocks in a heap, so that one block does not use up a small heap. */
constexpr VkDeviceSize blocks_in_heap_min = 16;

/** Flags that memory for \a use must have, and those that it should and should not have. */
struct Wanted {
  VkMemoryPropertyFlags required = 0;
  VkMemoryPropertyFlags better = 0;
  VkMemoryPropertyFlags worse = 0;
};

Wanted wanted_for(MemoryUse use)
{
  constexpr VkMemoryPropertyFlags seldom = VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT | VK_MEMORY_PROPERTY_PROTECTED_BIT;
  switch (use) {
    case MemoryUse::Device:
      return {0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, seldom | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT};
    case MemoryUse::Upload:
      return {VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT, VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
              seldom | VK_MEMORY_PROPERTY_HOST_CACHED_BIT};
    case MemoryUse::Readback:
      return {VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT,
              VK_MEMORY_PROPERTY_HOST_CACHED_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, seldom};
  }
  return {};
}

/** Place of \a count granules of which the first is a multiple of \a alignment; empty: \a block has none. */
std::optional<MemoryPlace> place_in(MemoryBlock &block, std::uint32_t count, VkDeviceSize alignment)
{
  const auto granules = std::uint32_t(block.size_bytes / granule_bytes);
  // The first granules may be needed to align the rest.
  const auto taken = count + std::uint32_t(std::max(alignment, granule_bytes) / granule_bytes) - 1;
  const std::uint32_t first = block.ranges.allocate(taken);
  if (std::size_t(first) + taken > granules) {
    block.ranges.free(first, taken);
    block.ranges.shrink(granules);
    return std::nullopt;
  }
  const VkDeviceSize offset = (first * granule_bytes + alignment - 1) / alignment * alignment;
  block.allocation_count++;
  return MemoryPlace{&block, {offset, count * granule_bytes}, first, taken};
}

}  // namespace

std::vector<std::uint32_t> memory_types_of(const VkPhysicalDeviceMemoryProperties &properties, std::uint32_t type_bits,
                                           MemoryUse use)
{
  const Wanted wanted = wanted_for(use);
  std::vector<std::pair<int, std::uint32_t>> ranked;
  for (std::uint32_t i = 0; i < properties.memoryTypeCount; i++) {
    const VkMemoryPropertyFlags flags = properties.memoryTypes[i].propertyFlags;
    if ((type_bits >> i & 1U) != 0 && (flags & wanted.required) == wanted.required) {
      // One preferred flag outweighs all unwanted flags.
      constexpr int most_flags = 32;
      ranked.emplace_back(std::popcount(flags & wanted.worse) - most_flags * std::popcount(flags & wanted.better), i);
    }
  }
  // The driver lists the faster one of two types with the same flags first.
  std::ranges::sort(ranked);
  std::vector<std::uint32_t> types;
  for (const auto &[rank, type] : ranked) {
    types.push_back(type);
  }
  return types;
}

MemoryRange whole_atoms(const MemoryRange &range, VkDeviceSize atom_bytes, VkDeviceSize memory_bytes)
{
  const VkDeviceSize first = range.offset / atom_bytes * atom_bytes;
  const VkDeviceSize end = (range.offset + range.size + atom_bytes - 1) / atom_bytes * atom_bytes;
  return {first, std::min(end, memory_bytes) - first};
}

VulkanMemory::VulkanMemory(VulkanContext &context) : context_(context)
{
  context.instance.vkGetPhysicalDeviceMemoryProperties(context.physical_device, &properties_);
}

VulkanMemory::~VulkanMemory()
{
  for (const MemoryBlock &block : blocks_) {
    context_.vk.vkFreeMemory(context_.device, block.memory, nullptr);
  }
}

VkDeviceSize VulkanMemory::block_bytes(std::uint32_t type) const
{
  const VkDeviceSize heap_bytes = properties_.memoryHeaps[properties_.memoryTypes[type].heapIndex].size;
  return std::clamp(heap_bytes / blocks_in_heap_min / granule_bytes * granule_bytes, granule_bytes, block_bytes_max);
}

MemoryBlock *VulkanMemory::add_block(VkDeviceSize size_bytes, std::uint32_t type, bool is_image, std::string_view what)
{
  MemoryBlock block;
  block.size_bytes = size_bytes;
  block.type = type;
  block.is_image = is_image;
  VkMemoryAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  info.allocationSize = size_bytes;
  info.memoryTypeIndex = type;
  const VkResult result = context_.vk.vkAllocateMemory(context_.device, &info, nullptr, &block.memory);
  if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY) {
    return nullptr;
  }
  context_.check(result, what);
  const VkMemoryPropertyFlags flags = properties_.memoryTypes[type].propertyFlags;
  block.is_coherent = (flags & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT) != 0;
  if ((flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0 && !is_image) {
    void *mapped = nullptr;
    const VkResult mapping = context_.vk.vkMapMemory(context_.device, block.memory, 0, VK_WHOLE_SIZE, 0, &mapped);
    if (mapping != VK_SUCCESS) {
      context_.vk.vkFreeMemory(context_.device, block.memory, nullptr);
      context_.check(mapping, what);
    }
    block.mapped = static_cast<std::byte *>(mapped);
  }
  return &blocks_.emplace_back(std::move(block));
}

MemoryPlace VulkanMemory::allocate(const VkMemoryRequirements &needed, MemoryUse use, bool is_image,
                                   std::string_view what)
{
  const VkDeviceSize granules = (needed.size + granule_bytes - 1) / granule_bytes;
  const VkDeviceSize size = granules * granule_bytes;
  for (const std::uint32_t type : memory_types_of(properties_, needed.memoryTypeBits, use)) {
    const VkDeviceSize usual = block_bytes(type);
    // A large resource has a block of its own. Buffers and images do not share blocks (bufferImageGranularity).
    const bool is_large = size + needed.alignment > usual / 2;
    for (MemoryBlock &block : blocks_) {
      if (!is_large && block.type == type && block.is_image == is_image) {
        if (const auto place = place_in(block, std::uint32_t(granules), needed.alignment)) {
          return *place;
        }
      }
    }
    // An offset of 0 has any alignment.
    if (MemoryBlock *block = add_block(is_large ? size : usual, type, is_image, what)) {
      if (is_large) {
        static_cast<void>(block->ranges.allocate(std::uint32_t(granules)));
        block->allocation_count++;
        return {block, {0, size}, 0, std::uint32_t(granules)};
      }
      return place_in(*block, std::uint32_t(granules), needed.alignment).value();
    }
  }
  context_.check(VK_ERROR_OUT_OF_DEVICE_MEMORY, what);
  return {};
}

void VulkanMemory::free(const MemoryPlace &place)
{
  if (place.block == nullptr) {
    return;
  }
  MemoryBlock &block = *place.block;
  block.ranges.free(place.first_granule, place.granule_count);
  if (--block.allocation_count > 0) {
    return;
  }
  // One empty block of a kind is kept for the next resource.
  const bool is_kept =
      block.size_bytes == block_bytes(block.type) && std::ranges::none_of(blocks_, [&](const MemoryBlock &other) {
        return &other != &block && other.allocation_count == 0 && other.type == block.type &&
               other.is_image == block.is_image;
      });
  if (!is_kept) {
    context_.vk.vkFreeMemory(context_.device, block.memory, nullptr);
    std::erase_if(blocks_, [&](const MemoryBlock &other) { return &other == &block; });
  }
}

bool VulkanMemory::trim()
{
  return std::erase_if(blocks_, [&](const MemoryBlock &block) {
           if (block.allocation_count == 0) {
             context_.vk.vkFreeMemory(context_.device, block.memory, nullptr);
           }
           return block.allocation_count == 0;
         }) > 0;
}

VulkanBuffer VulkanMemory::make_buffer(std::string_view what, VkDeviceSize size_bytes, VkBufferUsageFlags usage,
                                       MemoryUse use)
{
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = size_bytes;
  info.usage = usage;
  VulkanBuffer buffer;
  buffer.size_bytes = size_bytes;
  context_.check(context_.vk.vkCreateBuffer(context_.device, &info, nullptr, &buffer.handle), what);
  try {
    VkMemoryRequirements needed{};
    context_.vk.vkGetBufferMemoryRequirements(context_.device, buffer.handle, &needed);
    buffer.place = allocate(needed, use, false, what);
    context_.check(context_.vk.vkBindBufferMemory(context_.device, buffer.handle, buffer.place.block->memory,
                                                  buffer.place.range.offset),
                   what);
  }
  catch (...) {
    destroy(buffer);
    throw;
  }
  return buffer;
}

void VulkanMemory::destroy(const VulkanBuffer &buffer)
{
  context_.vk.vkDestroyBuffer(context_.device, buffer.handle, nullptr);
  free(buffer.place);
}

VkImage VulkanMemory::make_image(std::string_view what, const VkImageCreateInfo &info, MemoryPlace &place)
{
  VkImage image = VK_NULL_HANDLE;
  context_.check(context_.vk.vkCreateImage(context_.device, &info, nullptr, &image), what);
  place = {};
  try {
    VkMemoryRequirements needed{};
    context_.vk.vkGetImageMemoryRequirements(context_.device, image, &needed);
    place = allocate(needed, MemoryUse::Device, true, what);
    context_.check(context_.vk.vkBindImageMemory(context_.device, image, place.block->memory, place.range.offset),
                   what);
  }
  catch (...) {
    destroy(image, place);
    place = {};
    throw;
  }
  return image;
}

void VulkanMemory::destroy(VkImage image, const MemoryPlace &place)
{
  context_.vk.vkDestroyImage(context_.device, image, nullptr);
  free(place);
}

VkMappedMemoryRange VulkanMemory::mapped_range(const VulkanBuffer &buffer, const MemoryRange &bytes) const
{
  const MemoryRange range = whole_atoms({buffer.place.range.offset + bytes.offset, bytes.size},
                                        context_.limits.nonCoherentAtomSize, buffer.place.block->size_bytes);
  return {VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, buffer.place.block->memory, range.offset, range.size};
}

void VulkanMemory::flush(const VulkanBuffer &buffer, const MemoryRange &bytes)
{
  if (!buffer.place.block->is_coherent && bytes.size > 0) {
    const VkMappedMemoryRange range = mapped_range(buffer, bytes);
    context_.check(context_.vk.vkFlushMappedMemoryRanges(context_.device, 1, &range), "flush of memory");
  }
}

void VulkanMemory::invalidate(const VulkanBuffer &buffer)
{
  if (!buffer.place.block->is_coherent) {
    const VkMappedMemoryRange range = mapped_range(buffer, {0, buffer.size_bytes});
    context_.check(context_.vk.vkInvalidateMappedMemoryRanges(context_.device, 1, &range), "read of memory");
  }
}

}  // namespace gnomon::gpu
