// SPDX-License-Identifier: MIT
#pragma once

#include <volk.h>

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::gpu {

/** An instance with a device that has one queue, and the messages of the validation layers. */
class VulkanContext {
 public:
  /** \a sink: receives messages of the validation layers about the end of the device. \throws Error */
  VulkanContext(bool is_debug, std::function<void(std::string_view message)> sink);
  ~VulkanContext();
  VulkanContext(const VulkanContext &) = delete;
  VulkanContext &operator=(const VulkanContext &) = delete;

  /** The functions of the device. */
  VolkDeviceTable vk{};
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t queue_family = 0;
  /** Valid bits of timestamps; 0: the queue has none. */
  int timestamp_bits = 0;
  VkPhysicalDeviceLimits limits{};
  bool is_software = false;
  bool has_geometry_shader = false;
  bool has_vertex_layer = false;
  bool has_anisotropy = false;
  /** Version, names of the device and the driver. */
  std::string description;

  /** \throws Error that begins with \a what if \a result is a failure: TransientError, DeviceLost */
  void check(VkResult result, std::string_view what);
  /** For functions that do not throw: check_lost() throws afterwards if \a result says that the device is lost. */
  void note_lost(VkResult result)
  {
    is_lost_ = is_lost_ || result == VK_ERROR_DEVICE_LOST;
  }
  /** \throws DeviceLost if a result has said so */
  void check_lost(std::string_view what) const;
  /** \throws Error with the messages of the validation layers since the last call; DeviceLost */
  void check_messages(std::string_view what);
  /** The messages of the validation layers since the last call. */
  [[nodiscard]] std::vector<std::string> take_messages();
  /** Names an object in messages and debuggers. */
  template <typename Handle>
  void label(VkObjectType type, Handle handle, const std::string &name)
  {
    label_object(type, (std::uint64_t)(handle), name);
  }

 private:
  static VkBool32 VKAPI_PTR receive_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                            VkDebugUtilsMessageTypeFlagsEXT types,
                                            const VkDebugUtilsMessengerCallbackDataEXT *data, void *user);
  void create_instance(bool is_debug);
  void create_device();
  /** A function of an extension, which volk would have for the last instance only. */
  template <typename Function>
  [[nodiscard]] Function instance_function(const char *name) const
  {
    return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance_, name));
  }
  void label_object(VkObjectType type, std::uint64_t handle, const std::string &name);
  void destroy();

  std::function<void(std::string_view message)> sink_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  /** nullptr: the device has no validation layers. */
  PFN_vkSetDebugUtilsObjectNameEXT set_object_name_ = nullptr;
  bool is_lost_ = false;
  /** The layers may report on any thread that calls Vulkan. */
  std::mutex messages_mutex_;
  std::vector<std::string> messages_;
};

}  // namespace gnomon::gpu
