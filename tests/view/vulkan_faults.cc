// SPDX-License-Identifier: MIT
// Stands in for libvulkan.so.1 and passes all calls on to it, but for those that the environment variable
// VULKAN_FAULTS names: FUNCTION:CALL:RESULT, separated by commas, where CALL counts from 1. Such a call returns the
// VkResult; one of vkGetPhysicalDeviceSurfaceCapabilitiesKHR with 0 returns the size 0x0 of a window that is minimised;
// one of vkCmdPipelineBarrier2 changes layouts, but orders nothing.
//
// VULKAN_MASKS names what the device seems to lack, separated by commas: geometryShader, shaderOutputLayer, and
// `limits`, whose values are then the least that Vulkan requires. What needs more of them is printed as "exceeded:
// ...".
#include "gpu/gpu_weak_barrier.hh"

#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace {

template <typename Function>
Function real(const char *name)
{
  static void *library = dlopen(GNOMON_VULKAN_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  return library ? reinterpret_cast<Function>(dlsym(library, name)) : nullptr;
}

/** Whether the call \a number of \a function is a fault, and its result. */
bool is_fault(const char *function, int number, VkResult &result)
{
  const char *faults = std::getenv("VULKAN_FAULTS");
  const std::string prefix = std::string(function) + ":" + std::to_string(number) + ":";
  for (const char *at = faults; at && *at; at = std::strchr(at, ',')) {
    at += *at == ',' ? 1 : 0;
    if (std::strncmp(at, prefix.c_str(), prefix.size()) == 0) {
      result = VkResult(std::atoi(at + prefix.size()));
      std::fprintf(stderr, "fault: %s returns %d\n", function, int(result));
      return true;
    }
  }
  return false;
}

/** A function of the driver whose results may be replaced. */
template <typename Function>
struct Faulty {
  const char *name;
  Function function = nullptr;
  std::atomic<int> calls = 0;

  bool is_fault(VkResult &result)
  {
    return ::is_fault(name, ++calls, result);
  }
};

Faulty<PFN_vkAcquireNextImageKHR> acquire{"vkAcquireNextImageKHR"};
Faulty<PFN_vkQueuePresentKHR> present{"vkQueuePresentKHR"};
Faulty<PFN_vkQueueSubmit2> submit{"vkQueueSubmit2"};
Faulty<PFN_vkCreateSwapchainKHR> create{"vkCreateSwapchainKHR"};
Faulty<PFN_vkGetPhysicalDeviceSurfaceCapabilitiesKHR> capabilities{"vkGetPhysicalDeviceSurfaceCapabilitiesKHR"};
Faulty<PFN_vkCmdPipelineBarrier2> barrier{"vkCmdPipelineBarrier2"};

VkResult VKAPI_PTR faulty_acquire(VkDevice device, VkSwapchainKHR swapchain, std::uint64_t timeout,
                                  VkSemaphore semaphore, VkFence fence, std::uint32_t *index)
{
  VkResult result = VK_SUCCESS;
  const bool is_fault = acquire.is_fault(result);
  // After errors and timeouts, no image is acquired.
  if (is_fault && result != VK_SUBOPTIMAL_KHR) {
    return result;
  }
  const VkResult real_result = acquire.function(device, swapchain, timeout, semaphore, fence, index);
  return is_fault && real_result == VK_SUCCESS ? result : real_result;
}

VkResult VKAPI_PTR faulty_present(VkQueue queue, const VkPresentInfoKHR *info)
{
  VkResult result = VK_SUCCESS;
  const bool is_fault = present.is_fault(result);
  // Also after an error, the semaphores are waited for.
  const VkResult real_result = present.function(queue, info);
  return is_fault ? result : real_result;
}

VkResult VKAPI_PTR faulty_submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo2 *infos, VkFence fence)
{
  VkResult result = VK_SUCCESS;
  return submit.is_fault(result) ? result : submit.function(queue, count, infos, fence);
}

VkResult VKAPI_PTR faulty_create(VkDevice device, const VkSwapchainCreateInfoKHR *info,
                                 const VkAllocationCallbacks *allocator, VkSwapchainKHR *swapchain)
{
  VkResult result = VK_SUCCESS;
  if (create.is_fault(result)) {
    // No swapchain, as the output of a call that fails may be.
    *swapchain = VkSwapchainKHR(std::uintptr_t(16));
    return result;
  }
  return create.function(device, info, allocator, swapchain);
}

VkResult VKAPI_PTR faulty_capabilities(VkPhysicalDevice device, VkSurfaceKHR surface, VkSurfaceCapabilitiesKHR *of)
{
  VkResult result = VK_SUCCESS;
  const bool is_fault = capabilities.is_fault(result);
  const VkResult real_result = capabilities.function(device, surface, of);
  if (is_fault) {
    of->currentExtent = {0, 0};
  }
  return is_fault ? result : real_result;
}

void VKAPI_PTR faulty_barrier(VkCommandBuffer commands, const VkDependencyInfo *info)
{
  VkResult result = VK_SUCCESS;
  if (!barrier.is_fault(result)) {
    barrier.function(commands, info);
    return;
  }
  gnomon::test::record_weak_barrier(barrier.function, commands, *info);
}

/** Whether VULKAN_MASKS names \a what. */
bool is_masked(std::string_view what)
{
  const char *masks = std::getenv("VULKAN_MASKS");
  return masks && ("," + std::string(masks) + ",").find("," + std::string(what) + ",") != std::string::npos;
}

/** The table "Required Limits" of Vulkan 1.3. */
constexpr std::uint32_t texels_max = 65536;
constexpr std::uint32_t sets_max = 4;
constexpr std::uint32_t push_constant_bytes_max = 128;
constexpr std::uint32_t vertex_inputs_max = 16;
constexpr std::uint32_t offset_alignment = 256;

template <typename Function>
struct Masked {
  const char *name;
  Function function = nullptr;
};

Masked<PFN_vkGetPhysicalDeviceFeatures2> features{"vkGetPhysicalDeviceFeatures2"};
Masked<PFN_vkGetPhysicalDeviceProperties2> properties{"vkGetPhysicalDeviceProperties2"};
Masked<PFN_vkCreateBufferView> create_view{"vkCreateBufferView"};
Masked<PFN_vkCreatePipelineLayout> create_layout{"vkCreatePipelineLayout"};
Masked<PFN_vkCreateGraphicsPipelines> create_pipelines{"vkCreateGraphicsPipelines"};
Masked<PFN_vkUpdateDescriptorSets> update_sets{"vkUpdateDescriptorSets"};

void VKAPI_PTR masked_features(VkPhysicalDevice device, VkPhysicalDeviceFeatures2 *of)
{
  features.function(device, of);
  of->features.geometryShader = of->features.geometryShader && !is_masked("geometryShader");
  for (auto *next = static_cast<VkBaseOutStructure *>(of->pNext); next; next = next->pNext) {
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES) {
      auto *v12 = reinterpret_cast<VkPhysicalDeviceVulkan12Features *>(next);
      v12->shaderOutputLayer = v12->shaderOutputLayer && !is_masked("shaderOutputLayer");
    }
  }
}

void VKAPI_PTR masked_properties(VkPhysicalDevice device, VkPhysicalDeviceProperties2 *of)
{
  properties.function(device, of);
  if (is_masked("limits")) {
    VkPhysicalDeviceLimits &limits = of->properties.limits;
    limits.maxTexelBufferElements = texels_max;
    limits.maxBoundDescriptorSets = sets_max;
    limits.maxPushConstantsSize = push_constant_bytes_max;
    limits.maxVertexInputAttributes = limits.maxVertexInputBindings = vertex_inputs_max;
    limits.minUniformBufferOffsetAlignment = limits.minStorageBufferOffsetAlignment = offset_alignment;
    limits.minTexelBufferOffsetAlignment = offset_alignment;
  }
}

void check_limit(const char *what, std::uint64_t used, std::uint64_t most)
{
  if (is_masked("limits") && used > most) {
    std::fprintf(stderr, "exceeded: %s %llu\n", what, static_cast<unsigned long long>(used));
  }
}

VkResult VKAPI_PTR masked_create_view(VkDevice device, const VkBufferViewCreateInfo *info,
                                      const VkAllocationCallbacks *allocator, VkBufferView *view)
{
  // The engine has texels of one and of four 32-bit floats.
  const std::uint64_t texel_bytes = info->format == VK_FORMAT_R32G32B32A32_SFLOAT ? 16 : 4;
  check_limit("maxTexelBufferElements", info->range / texel_bytes, texels_max);
  check_limit("minTexelBufferOffsetAlignment", info->offset % offset_alignment, 0);
  return create_view.function(device, info, allocator, view);
}

VkResult VKAPI_PTR masked_create_layout(VkDevice device, const VkPipelineLayoutCreateInfo *info,
                                        const VkAllocationCallbacks *allocator, VkPipelineLayout *layout)
{
  check_limit("maxBoundDescriptorSets", info->setLayoutCount, sets_max);
  for (const VkPushConstantRange &range : std::span(info->pPushConstantRanges, info->pushConstantRangeCount)) {
    check_limit("maxPushConstantsSize", std::uint64_t(range.offset) + range.size, push_constant_bytes_max);
  }
  return create_layout.function(device, info, allocator, layout);
}

VkResult VKAPI_PTR masked_create_pipelines(VkDevice device, VkPipelineCache cache, std::uint32_t count,
                                           const VkGraphicsPipelineCreateInfo *infos,
                                           const VkAllocationCallbacks *allocator, VkPipeline *pipelines)
{
  for (const VkGraphicsPipelineCreateInfo &info : std::span(infos, count)) {
    const VkPipelineVertexInputStateCreateInfo &input = *info.pVertexInputState;
    for (const auto &attribute : std::span(input.pVertexAttributeDescriptions, input.vertexAttributeDescriptionCount)) {
      check_limit("maxVertexInputAttributes", attribute.location + 1, vertex_inputs_max);
    }
    for (const auto &binding : std::span(input.pVertexBindingDescriptions, input.vertexBindingDescriptionCount)) {
      check_limit("maxVertexInputBindings", binding.binding + 1, vertex_inputs_max);
    }
  }
  return create_pipelines.function(device, cache, count, infos, allocator, pipelines);
}

void VKAPI_PTR masked_update_sets(VkDevice device, std::uint32_t count, const VkWriteDescriptorSet *writes,
                                  std::uint32_t copy_count, const VkCopyDescriptorSet *copies)
{
  for (const VkWriteDescriptorSet &write : std::span(writes, count)) {
    const bool is_block = write.descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER ||
                          write.descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    for (std::uint32_t i = 0; is_block && i < write.descriptorCount; i++) {
      check_limit("offset of a block", write.pBufferInfo[i].offset % offset_alignment, 0);
    }
  }
  update_sets.function(device, count, writes, copy_count, copies);
}

/** \a of itself, or the function of this file that stands in for it. */
PFN_vkVoidFunction standing_in(const char *name, PFN_vkVoidFunction of)
{
  const auto replace = [&](auto &faulty, auto function) {
    if (of && std::strcmp(name, faulty.name) == 0) {
      faulty.function = reinterpret_cast<decltype(faulty.function)>(of);
      of = reinterpret_cast<PFN_vkVoidFunction>(function);
    }
  };
  replace(acquire, &faulty_acquire);
  replace(present, &faulty_present);
  replace(submit, &faulty_submit);
  replace(create, &faulty_create);
  replace(capabilities, &faulty_capabilities);
  replace(barrier, &faulty_barrier);
  replace(features, &masked_features);
  replace(properties, &masked_properties);
  replace(create_view, &masked_create_view);
  replace(create_layout, &masked_create_layout);
  replace(create_pipelines, &masked_create_pipelines);
  replace(update_sets, &masked_update_sets);
  return of;
}

PFN_vkGetDeviceProcAddr real_get_device = nullptr;

PFN_vkVoidFunction VKAPI_PTR get_device_function(VkDevice device, const char *name)
{
  return standing_in(name, real_get_device(device, name));
}

}  // namespace

extern "C" __attribute__((visibility("default"))) PFN_vkVoidFunction vkGetInstanceProcAddr(VkInstance instance,
                                                                                           const char *name)
{
  const auto get = real<PFN_vkGetInstanceProcAddr>("vkGetInstanceProcAddr");
  const PFN_vkVoidFunction of = get(instance, name);
  if (of && std::strcmp(name, "vkGetDeviceProcAddr") == 0) {
    real_get_device = reinterpret_cast<PFN_vkGetDeviceProcAddr>(of);
    return reinterpret_cast<PFN_vkVoidFunction>(&get_device_function);
  }
  return standing_in(name, of);
}
