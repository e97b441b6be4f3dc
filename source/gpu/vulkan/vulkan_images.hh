// SPDX-License-Identifier: MIT
#pragma once

#include "vulkan_memory.hh"

#include "gpu_framebuffer.hh"

#include <array>
#include <map>
#include <set>
#include <vector>

namespace gnomon::gpu {

[[nodiscard]] VkFormat vulkan_format(Format format);
/** The same without the encoding of sRGB. */
[[nodiscard]] VkFormat unencoded(VkFormat format);

/** How commands use an image. */
struct ImageUse {
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  VkPipelineStageFlags2 stages = VK_PIPELINE_STAGE_2_NONE;
  VkAccessFlags2 access = VK_ACCESS_2_NONE;
  bool is_write = false;
};

/** All stages that look up textures and read blocks. */
inline constexpr VkPipelineStageFlags2 shader_stages =
    VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;

namespace use {
inline constexpr ImageUse sampled{VK_IMAGE_LAYOUT_READ_ONLY_OPTIMAL, shader_stages, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                                  false};
inline constexpr ImageUse color{VK_IMAGE_LAYOUT_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, true};
inline constexpr ImageUse depth{
    VK_IMAGE_LAYOUT_ATTACHMENT_OPTIMAL,
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT, true};
/** Any work of the host. */
inline constexpr ImageUse by_host(VkImageLayout layout)
{
  return {layout, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
          true};
}
inline constexpr ImageUse copied_from{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                      VK_ACCESS_2_TRANSFER_READ_BIT, false};
inline constexpr ImageUse copied_to{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                    VK_ACCESS_2_TRANSFER_WRITE_BIT, true};
}  // namespace use

/** An image, and its use by the commands that were recorded last. */
struct VulkanImage {
  VkImage handle = VK_NULL_HANDLE;
  MemoryPlace place;
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
  glm::ivec2 size_px{0};
  std::uint32_t layers = 1;
  std::uint32_t levels = 1;
  /** All levels and layers, for lookups. */
  VkImageView view = VK_NULL_HANDLE;
  ImageUse last_use;
};

/** Size of a mip level. */
[[nodiscard]] VkExtent3D extent_of(const VulkanImage &image, std::uint32_t level);

/** \a format: that of \a desc, or another one of colours. \throws Error that begins with \a what */
[[nodiscard]] VulkanImage make_image(VulkanContext &context, VulkanMemory &memory, std::string_view what,
                                     const TextureDesc &desc, VkFormat format);
void destroy_image(VulkanContext &context, VulkanMemory &memory, const VulkanImage &image);

/** \throws Error that begins with \a what */
[[nodiscard]] VkImageView make_view(VulkanContext &context, std::string_view what, const VulkanImage &image,
                                    VkFormat format, VkImageViewType type, const VkImageSubresourceRange &range);

struct VulkanBufferRange {
  /** VK_NULL_HANDLE: no buffer of the device. */
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset_bytes = 0;
  VkDeviceSize size_bytes = 0;
};

/**
 * Orders accesses to images and buffers. Barriers are gathered by the functions before_… and recorded as one command
 * before the accesses.
 */
class VulkanBarriers {
 public:
  explicit VulkanBarriers(const VulkanContext &context) : context_(context) {}

  void before_use(VulkanImage &image, const ImageUse &next);
  /** Before a copy that reads \a read and writes \a written; VK_NULL_HANDLE: no buffer of the device. */
  void before_copy(VkBuffer read, const VulkanBufferRange &written);
  /** Before draws, which read any buffers. */
  void before_draws();
  /** Records the barriers that were gathered. */
  void record(VkCommandBuffer commands);

 private:
  void add(VkPipelineStageFlags2 from, VkAccessFlags2 written, VkPipelineStageFlags2 to, VkAccessFlags2 accessed);

  /** The range was written since the last barrier between copies. */
  [[nodiscard]] bool is_written(const VulkanBufferRange &range) const;
  void note_written(const VulkanBufferRange &range);

  const VulkanContext &context_;
  std::vector<VkImageMemoryBarrier2> images_;
  VkMemoryBarrier2 buffers_{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr, 0, 0, 0, 0};
  // Since the last barrier between copies:
  std::set<VkBuffer> read_;
  /** The ends of ranges by their begins. They do not overlap, so that many parts of a buffer are written without
   * barriers. */
  std::map<VkBuffer, std::map<VkDeviceSize, VkDeviceSize>> written_;
  /** Draws since the last barrier before a copy. */
  bool has_draws_ = false;
  /** Buffers were written since the last barrier before draws. */
  bool has_written_for_draws_ = false;
};

}  // namespace gnomon::gpu
