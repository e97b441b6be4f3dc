// SPDX-License-Identifier: MIT
// The functions of Vulkan that the backend uses. They are members: a host that links the library of Vulkan has
// functions of these names, which global variables of the same names would hide.
#pragma once

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

// clang-format off
#define GNOMON_VULKAN_INSTANCE_FUNCTIONS(DO) \
  DO(vkCreateDevice) DO(vkDestroyInstance) DO(vkEnumerateDeviceExtensionProperties) \
  DO(vkEnumeratePhysicalDevices) DO(vkGetDeviceProcAddr) DO(vkGetPhysicalDeviceFeatures2) \
  DO(vkGetPhysicalDeviceFormatProperties) DO(vkGetPhysicalDeviceMemoryProperties) \
  DO(vkGetPhysicalDeviceProperties2) DO(vkGetPhysicalDeviceQueueFamilyProperties)

#define GNOMON_VULKAN_DEVICE_FUNCTIONS(DO) \
  DO(vkAllocateCommandBuffers) DO(vkAllocateDescriptorSets) DO(vkAllocateMemory) DO(vkBeginCommandBuffer) \
  DO(vkBindBufferMemory) DO(vkBindImageMemory) DO(vkCmdBeginRendering) DO(vkCmdBindDescriptorSets) \
  DO(vkCmdBindIndexBuffer) DO(vkCmdBindPipeline) DO(vkCmdBindVertexBuffers2) DO(vkCmdBlitImage) \
  DO(vkCmdClearColorImage) DO(vkCmdClearDepthStencilImage) DO(vkCmdCopyBuffer) DO(vkCmdCopyBufferToImage) \
  DO(vkCmdCopyImage) DO(vkCmdCopyImageToBuffer) DO(vkCmdDraw) DO(vkCmdDrawIndexedIndirect) \
  DO(vkCmdEndRendering) DO(vkCmdFillBuffer) DO(vkCmdPipelineBarrier2) DO(vkCmdPushConstants) \
  DO(vkCmdSetCullMode) DO(vkCmdSetDepthBias) DO(vkCmdSetDepthBiasEnable) DO(vkCmdSetDepthCompareOp) \
  DO(vkCmdSetDepthTestEnable) DO(vkCmdSetDepthWriteEnable) DO(vkCmdSetFrontFace) DO(vkCmdSetScissor) \
  DO(vkCmdSetViewport) DO(vkCmdWriteTimestamp2) DO(vkCreateBuffer) DO(vkCreateBufferView) \
  DO(vkCreateCommandPool) DO(vkCreateDescriptorPool) DO(vkCreateDescriptorSetLayout) \
  DO(vkCreateGraphicsPipelines) DO(vkCreateImage) DO(vkCreateImageView) DO(vkCreatePipelineLayout) \
  DO(vkCreateQueryPool) DO(vkCreateSampler) DO(vkCreateSemaphore) DO(vkCreateShaderModule) DO(vkDestroyBuffer) \
  DO(vkDestroyBufferView) DO(vkDestroyCommandPool) DO(vkDestroyDescriptorPool) DO(vkDestroyDescriptorSetLayout) \
  DO(vkDestroyDevice) DO(vkDestroyImage) DO(vkDestroyImageView) DO(vkDestroyPipeline) \
  DO(vkDestroyPipelineLayout) DO(vkDestroyQueryPool) DO(vkDestroySampler) DO(vkDestroySemaphore) \
  DO(vkDestroyShaderModule) DO(vkEndCommandBuffer) DO(vkFlushMappedMemoryRanges) DO(vkFreeMemory) \
  DO(vkGetBufferMemoryRequirements) DO(vkGetDeviceQueue) DO(vkGetImageMemoryRequirements) \
  DO(vkGetQueryPoolResults) DO(vkGetSemaphoreCounterValue) DO(vkInvalidateMappedMemoryRanges) DO(vkMapMemory) \
  DO(vkQueueSubmit2) DO(vkResetDescriptorPool) DO(vkResetQueryPool) DO(vkUpdateDescriptorSets) \
  DO(vkWaitSemaphores)

// Only for devices with a window.
#define GNOMON_VULKAN_SURFACE_FUNCTIONS(DO) \
  DO(vkDestroySurfaceKHR) DO(vkGetPhysicalDeviceSurfaceCapabilitiesKHR) DO(vkGetPhysicalDeviceSurfaceFormatsKHR) \
  DO(vkGetPhysicalDeviceSurfacePresentModesKHR) DO(vkGetPhysicalDeviceSurfaceSupportKHR)

#define GNOMON_VULKAN_SWAPCHAIN_FUNCTIONS(DO) \
  DO(vkAcquireNextImageKHR) DO(vkCreateFence) DO(vkCreateSwapchainKHR) DO(vkDestroyFence) DO(vkDestroySwapchainKHR) \
  DO(vkDeviceWaitIdle) DO(vkGetSwapchainImagesKHR) DO(vkQueuePresentKHR) DO(vkResetFences) DO(vkWaitForFences)
// clang-format on

namespace gnomon::gpu {

#define GNOMON_VULKAN_MEMBER(NAME) PFN_##NAME NAME = nullptr;

struct VulkanInstanceTable {
  GNOMON_VULKAN_INSTANCE_FUNCTIONS(GNOMON_VULKAN_MEMBER)
};

struct VulkanDeviceTable {
  GNOMON_VULKAN_DEVICE_FUNCTIONS(GNOMON_VULKAN_MEMBER)
};

struct VulkanSurfaceTable {
  GNOMON_VULKAN_SURFACE_FUNCTIONS(GNOMON_VULKAN_MEMBER)
};

struct VulkanSwapchainTable {
  GNOMON_VULKAN_SWAPCHAIN_FUNCTIONS(GNOMON_VULKAN_MEMBER)
};

#undef GNOMON_VULKAN_MEMBER

}  // namespace gnomon::gpu
