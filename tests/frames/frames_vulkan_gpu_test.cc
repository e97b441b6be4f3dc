// SPDX-License-Identifier: MIT
// Frames of a driver of Vulkan that fails on demand. These need no GNOMON_TEST_BACKEND.
#include "frames/frames_failures.hh"
#include "gpu_device_fixture.hh"

#include "vulkan/vulkan_device.hh"

#include <utility>

namespace gnomon::eevee {
namespace {

using test::Bytes;
using test::FailingAllocation;

/** The functions of the driver that make what needs memory. */
gpu::VulkanDeviceTable real;

template <auto Member, typename Function>
struct OrOutOfMemory;
template <auto Member, typename... Arguments>
struct OrOutOfMemory<Member, VkResult(VKAPI_PTR *)(Arguments...)> {
  static VkResult VKAPI_PTR call(Arguments... arguments)
  {
    return FailingAllocation::fails() ? VK_ERROR_OUT_OF_DEVICE_MEMORY : (real.*Member)(arguments...);
  }
};

TEST(VulkanFrames, WhoseAllocationsFailOneAtATimeAreFollowedByTheRightPicture)
{
  // Skips the test with the reason if there is none.
  if (!test::testing_vulkan_device()) {
    return;
  }
  auto made =
      std::make_unique<gpu::VulkanContext>(true, nullptr, [](std::string_view message) { ADD_FAILURE() << message; });
  gpu::VulkanDeviceTable &vk = made->vk;
  gpu::VulkanDevice device(std::move(made), gpu::VulkanDeviceDesc{.compile_spirv = shader_check::compile_spirv});
  const Bytes expected = test::fresh_picture(device, 1);
  real = vk;
  const auto hook = [&]<auto Member>()
  {
    using Function = std::remove_reference_t<decltype(vk.*Member)>;
    vk.*Member = &OrOutOfMemory<Member, Function>::call;
  };
  hook.operator()<&gpu::VulkanDeviceTable::vkAllocateMemory>();
  hook.operator()<&gpu::VulkanDeviceTable::vkCreateBuffer>();
  hook.operator()<&gpu::VulkanDeviceTable::vkCreateImage>();
  hook.operator()<&gpu::VulkanDeviceTable::vkCreateImageView>();
  hook.operator()<&gpu::VulkanDeviceTable::vkAllocateDescriptorSets>();
  test::expect_pictures_after_each_failed_allocation(device, expected);
  vk = real;
}

}  // namespace
}  // namespace gnomon::eevee
