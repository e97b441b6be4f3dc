// SPDX-License-Identifier: MIT
#include "gpu_swapchain.hh"

namespace gnomon::gpu {

std::unique_ptr<Device> create_vulkan_device(const VulkanDeviceDesc & /*desc*/)
{
  throw Error("this build has no Vulkan (GNOMON_VULKAN)");
}

std::unique_ptr<Device> create_vulkan_device(const VulkanDeviceDesc &desc, GLFWwindow & /*window*/)
{
  return create_vulkan_device(desc);
}

std::unique_ptr<Swapchain> create_swapchain(Device & /*device*/, bool /*waits_for_refresh*/)
{
  throw Error("this build has no Vulkan (GNOMON_VULKAN)");
}

}  // namespace gnomon::gpu
