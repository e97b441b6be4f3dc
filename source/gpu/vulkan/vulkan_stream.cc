// SPDX-License-Identifier: MIT
#include "vulkan_stream.hh"

#include <algorithm>
#include <cstring>

namespace gnomon::gpu {

namespace {

constexpr VkDeviceSize chunk_bytes = VkDeviceSize(1) << 20U;
/** Chunks that are kept for later submissions. Those for large data are not. */
constexpr std::size_t unused_chunks_max = 16;

constexpr VkDeviceSize aligned(VkDeviceSize offset, VkDeviceSize alignment)
{
  return (offset + alignment - 1) / alignment * alignment;
}

}  // namespace

VulkanStream::VulkanStream(VulkanContext &context, VulkanMemory &memory, VulkanSubmissions &submissions)
    : context_(context), memory_(memory), submissions_(submissions)
{
}

VulkanStream::~VulkanStream()
{
  for (const Chunk &chunk : used_) {
    memory_.destroy(chunk.buffer);
  }
  for (const VulkanBuffer &buffer : unused_) {
    memory_.destroy(buffer);
  }
}

VulkanStream::Place VulkanStream::write(std::span<const std::byte> bytes, VkDeviceSize alignment)
{
  make_room(bytes.size(), alignment);
  Chunk &chunk = used_.back();
  const VkDeviceSize offset = aligned(chunk.used_bytes, alignment);
  if (!bytes.empty()) {
    std::memcpy(chunk.buffer.place.mapped() + offset, bytes.data(), bytes.size());
    memory_.flush(chunk.buffer, {offset, bytes.size()});
  }
  chunk.used_bytes = offset + bytes.size();
  chunk.number = submissions_.number();
  return {chunk.buffer.handle, offset};
}

void VulkanStream::make_room(VkDeviceSize size_bytes, VkDeviceSize alignment)
{
  const auto has_room = [&](const Chunk &chunk) {
    return aligned(chunk.used_bytes, alignment) + size_bytes <= chunk.buffer.size_bytes;
  };
  if (!used_.empty() && has_room(used_.back())) {
    return;
  }
  collect();
  if (size_bytes <= chunk_bytes && !unused_.empty()) {
    used_.push_back({unused_.back()});
    unused_.pop_back();
  }
  else {
    constexpr VkBufferUsageFlags usage =
        VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
    used_.push_back({memory_.make_buffer("data of draws and uploads", std::max(size_bytes, chunk_bytes), usage,
                                         MemoryUse::Upload)});
    context_.label(VK_OBJECT_TYPE_BUFFER, used_.back().buffer.handle, "stream");
  }
  used_bytes_ += used_.back().buffer.size_bytes;
}

void VulkanStream::collect()
{
  const std::uint64_t done = submissions_.done();
  while (!used_.empty() && used_.front().number <= done) {
    const VulkanBuffer buffer = used_.front().buffer;
    used_.pop_front();
    used_bytes_ -= buffer.size_bytes;
    if (buffer.size_bytes == chunk_bytes && unused_.size() < unused_chunks_max) {
      unused_.push_back(buffer);
    }
    else {
      memory_.destroy(buffer);
    }
  }
}

}  // namespace gnomon::gpu
