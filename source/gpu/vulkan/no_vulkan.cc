// SPDX-License-Identifier: MIT
#include "gpu_device.hh"

namespace gnomon::gpu {

std::unique_ptr<Device> create_vulkan_device(const VulkanDeviceDesc & /*desc*/)
{
  throw Error("this build has no Vulkan (GNOMON_VULKAN)");
}

}  // namespace gnomon::gpu
