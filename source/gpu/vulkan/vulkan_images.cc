// SPDX-License-Identifier: MIT
#include "vulkan_images.hh"

#include "gpu_error.hh"

#include <algorithm>
#include <utility>

namespace gnomon::gpu {

VkFormat vulkan_format(Format format)
{
  switch (format) {
    case Format::RGBA8: return VK_FORMAT_R8G8B8A8_UNORM;
    case Format::SRGB8A8: return VK_FORMAT_R8G8B8A8_SRGB;
    case Format::RGBA16F: return VK_FORMAT_R16G16B16A16_SFLOAT;
    case Format::RGBA32F: return VK_FORMAT_R32G32B32A32_SFLOAT;
    case Format::R16F: return VK_FORMAT_R16_SFLOAT;
    case Format::R32F: return VK_FORMAT_R32_SFLOAT;
    case Format::RG32F: return VK_FORMAT_R32G32_SFLOAT;
    case Format::Depth32F: return VK_FORMAT_D32_SFLOAT;
    case Format::Depth16: return VK_FORMAT_D16_UNORM;
    case Format::Host: break;
  }
  return VK_FORMAT_UNDEFINED;
}

VkFormat unencoded(VkFormat format)
{
  switch (format) {
    case VK_FORMAT_R8G8B8A8_SRGB: return VK_FORMAT_R8G8B8A8_UNORM;
    case VK_FORMAT_B8G8R8A8_SRGB: return VK_FORMAT_B8G8R8A8_UNORM;
    case VK_FORMAT_A8B8G8R8_SRGB_PACK32: return VK_FORMAT_A8B8G8R8_UNORM_PACK32;
    default: return format;
  }
}

VkExtent3D extent_of(const VulkanImage &image, std::uint32_t level)
{
  return {std::max(std::uint32_t(image.size_px.x) >> level, 1U), std::max(std::uint32_t(image.size_px.y) >> level, 1U),
          1};
}

VulkanImage make_image(VulkanContext &context, VulkanMemory &memory, std::string_view what, const TextureDesc &desc,
                       VkFormat format)
{
  VulkanImage image;
  image.format = format;
  image.aspect = is_depth(desc.format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  image.size_px = {desc.width, desc.height};
  image.layers = std::uint32_t(desc.layers);
  image.levels = std::uint32_t(desc.mip_levels);
  const bool is_encoded = unencoded(image.format) != image.format;
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  // Passes that do not encode colours attach a view without the encoding.
  info.flags = is_encoded ? VkImageCreateFlags(VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT) : 0;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = image.format;
  info.extent = {std::uint32_t(desc.width), std::uint32_t(desc.height), 1};
  info.mipLevels = image.levels;
  info.arrayLayers = image.layers;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage =
      VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
      (is_depth(desc.format) ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
  image.handle = memory.make_image(what, info, image.place);
  try {
    image.view = make_view(context, what, image, image.format,
                           desc.kind == TextureKind::Array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
                           {image.aspect, 0, image.levels, 0, image.layers});
  }
  catch (...) {
    memory.destroy(image.handle, image.place);
    throw;
  }
  context.label(VK_OBJECT_TYPE_IMAGE, image.handle, desc.name);
  return image;
}

void destroy_image(VulkanContext &context, VulkanMemory &memory, const VulkanImage &image)
{
  context.vk.vkDestroyImageView(context.device, image.view, nullptr);
  memory.destroy(image.handle, image.place);
}

VkImageView make_view(VulkanContext &context, std::string_view what, const VulkanImage &image, VkFormat format,
                      VkImageViewType type, const VkImageSubresourceRange &range)
{
  VkImageViewCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  info.image = image.handle;
  info.viewType = type;
  info.format = format;
  info.subresourceRange = range;
  VkImageView view = VK_NULL_HANDLE;
  context.check(context.vk.vkCreateImageView(context.device, &info, nullptr, &view), what);
  context.label(VK_OBJECT_TYPE_IMAGE_VIEW, view, std::string(what));
  return view;
}

void VulkanBarriers::before_use(VulkanImage &image, const ImageUse &next)
{
  const ImageUse last = std::exchange(image.last_use, next);
  if (last.layout == next.layout && !last.is_write && !next.is_write) {
    // Uses of one layout that only read have the same stages.
    return;
  }
  VkImageMemoryBarrier2 barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  barrier.srcStageMask = last.stages;
  barrier.srcAccessMask = last.is_write ? last.access : VK_ACCESS_2_NONE;
  barrier.dstStageMask = next.stages;
  barrier.dstAccessMask = next.access;
  barrier.oldLayout = last.layout;
  barrier.newLayout = next.layout;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.handle;
  barrier.subresourceRange = {image.aspect, 0, image.levels, 0, image.layers};
  images_.push_back(barrier);
}

void VulkanBarriers::add(VkPipelineStageFlags2 from, VkAccessFlags2 written, VkPipelineStageFlags2 to,
                         VkAccessFlags2 accessed)
{
  buffers_.srcStageMask |= from;
  buffers_.srcAccessMask |= written;
  buffers_.dstStageMask |= to;
  buffers_.dstAccessMask |= accessed;
}

bool VulkanBarriers::is_written(const VulkanBufferRange &range) const
{
  const auto ranges = written_.find(range.buffer);
  if (ranges == written_.end()) {
    return false;
  }
  const auto next = ranges->second.upper_bound(range.offset_bytes);
  return (next != ranges->second.begin() && std::prev(next)->second > range.offset_bytes) ||
         (next != ranges->second.end() && next->first < range.offset_bytes + range.size_bytes);
}

void VulkanBarriers::note_written(const VulkanBufferRange &range)
{
  std::map<VkDeviceSize, VkDeviceSize> &ranges = written_[range.buffer];
  const auto next = ranges.upper_bound(range.offset_bytes);
  const VkDeviceSize end = range.offset_bytes + range.size_bytes;
  if (next != ranges.begin() && std::prev(next)->second == range.offset_bytes) {
    std::prev(next)->second = end;
  }
  else {
    ranges.emplace_hint(next, range.offset_bytes, end);
  }
}

void VulkanBarriers::before_copy(VkBuffer read, const VulkanBufferRange &written)
{
  const bool is_read_written = read != VK_NULL_HANDLE && written_.contains(read);
  const bool is_written_used =
      written.buffer != VK_NULL_HANDLE && (has_draws_ || is_written(written) || read_.contains(written.buffer));
  if (is_read_written || is_written_used) {
    add(VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | (has_draws_ ? VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT : 0),
        VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
        VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    read_.clear();
    written_.clear();
    has_draws_ = false;
  }
  if (read != VK_NULL_HANDLE) {
    read_.insert(read);
  }
  if (written.buffer != VK_NULL_HANDLE) {
    note_written(written);
    has_written_for_draws_ = true;
  }
}

void VulkanBarriers::before_draws()
{
  if (std::exchange(has_written_for_draws_, false)) {
    add(VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
        VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | shader_stages,
        VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT |
            VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
  }
  has_draws_ = true;
}

void VulkanBarriers::record(VkCommandBuffer commands)
{
  const bool has_buffers = buffers_.srcStageMask != VK_PIPELINE_STAGE_2_NONE;
  if (images_.empty() && !has_buffers) {
    return;
  }
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.memoryBarrierCount = has_buffers ? 1 : 0;
  info.pMemoryBarriers = &buffers_;
  info.imageMemoryBarrierCount = std::uint32_t(images_.size());
  info.pImageMemoryBarriers = images_.data();
  context_.vk.vkCmdPipelineBarrier2(commands, &info);
  images_.clear();
  buffers_ = {VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr, 0, 0, 0, 0};
}

}  // namespace gnomon::gpu
