// SPDX-License-Identifier: MIT
// Stands in for libvulkan.so.1 and passes all calls on to it, but for those that the environment variable
// VULKAN_FAULTS names: FUNCTION:CALL:RESULT, separated by commas, where CALL counts from 1. Such a call returns the
// VkResult; one of vkGetPhysicalDeviceSurfaceCapabilitiesKHR with 0 returns the size 0x0 of a window that is minimised;
// one of vkCmdPipelineBarrier2 changes layouts, but orders nothing.
#include "gpu/gpu_weak_barrier.hh"

#include <dlfcn.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

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
