// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

// The types of Vulkan's headers, which hosts include and this library's interface does not need.
struct VkInstance_T;
struct VkPhysicalDevice_T;
struct VkDevice_T;
struct VkQueue_T;
struct VkImage_T;
struct VkSemaphore_T;
struct VkPhysicalDeviceFeatures2;

namespace gnomon::gpu {

/**
 * A VkDevice of the host, which must outlive the Device that uses it. Nothing of it is changed or destroyed. The
 * features and extensions that the Device needs are in doc/vulkan.md, "Hosts"; create_vulkan_device names those that
 * are missing.
 */
struct VulkanHost {
  /** The host's vkGetInstanceProcAddr. */
  void (*(*loader)(VkInstance_T *instance, const char *name))() = nullptr;
  /** Made for Vulkan 1.3 or later. */
  VkInstance_T *instance = nullptr;
  VkPhysicalDevice_T *physical_device = nullptr;
  VkDevice_T *device = nullptr;
  /** A queue for graphics. All submissions go there. */
  VkQueue_T *queue = nullptr;
  std::uint32_t queue_family = 0;
  /**
   * The features that the host has enabled, as in VkDeviceCreateInfo::pNext. The Device reads the structures of Vulkan
   * 1.2 and 1.3, the ones that these replace, and that of VK_EXT_provoking_vertex when it is made.
   */
  const VkPhysicalDeviceFeatures2 *features = nullptr;
  /** The extensions of the device that the host has enabled. */
  std::vector<std::string> extensions{};
  /**
   * Called before and after each use of the queue, on the device's thread; not within another pair. Both are empty if
   * no other thread uses the queue. They must not throw.
   */
  std::function<void()> lock_queue{};
  std::function<void()> unlock_queue{};
};

/** Order of the rows of an image of the host. A picture that is presented has its top row first. */
enum class RowOrder : std::uint8_t { TopFirst, BottomFirst };

/**
 * An image of Vulkan that the host owns, as the only attachment of a framebuffer: 2D, one layer, one level, and usable
 * by the queue family of the Device. It must live until the framebuffer is destroyed and the device has finished.
 */
struct HostImage {
  VkImage_T *image = nullptr;
  /** VkFormat, of colours. */
  int format = 0;
  glm::ivec2 size_px{0};
  /** Above 1, the rows must be BottomFirst. */
  int samples = 1;
  /**
   * TopFirst: passes draw into another image, which is copied to this one, so that it needs
   * VK_IMAGE_USAGE_TRANSFER_DST_BIT, and _SRC_BIT if its content is kept. BottomFirst: it needs
   * VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT.
   */
  RowOrder rows = RowOrder::TopFirst;
};

/** A binary semaphore, or a timeline semaphore with the value to wait for or to set. nullptr: none. */
struct HostSemaphore {
  VkSemaphore_T *semaphore = nullptr;
  /** 0: the semaphore is binary. */
  std::uint64_t value = 0;
};

}  // namespace gnomon::gpu
