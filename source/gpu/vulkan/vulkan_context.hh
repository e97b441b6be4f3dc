// SPDX-License-Identifier: MIT
#pragma once

#include "vulkan_functions.hh"

#include "gpu_vulkan_host.hh"

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

struct GLFWwindow;

namespace gnomon::gpu {

/** A device that has one queue, its own or the host's, and the messages of the validation layers. */
class VulkanContext {
 public:
  /**
   * \a window: the queue can present to it; nullptr: to none. \a sink: receives messages of the validation layers about
   * the end of the device. \throws Error
   */
  VulkanContext(bool is_debug, GLFWwindow *window, std::function<void(std::string_view message)> sink);
  /** The device of a host. \throws Error that names the features that it lacks */
  explicit VulkanContext(const VulkanHost &host);
  ~VulkanContext();
  VulkanContext(const VulkanContext &) = delete;
  VulkanContext &operator=(const VulkanContext &) = delete;

  VulkanInstanceTable instance{};
  /** The functions of the device. */
  VulkanDeviceTable vk{};
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t queue_family = 0;
  /** The window's surface. VK_NULL_HANDLE: there is no window, and no functions of surfaces and swapchains. */
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  VulkanSurfaceTable surfaces{};
  VulkanSwapchainTable swapchains{};
  /** Valid bits of timestamps; 0: the queue has none. */
  int timestamp_bits = 0;
  VkPhysicalDeviceLimits limits{};
  bool is_software = false;
  bool has_geometry_shader = false;
  bool has_wireframe = false;
  bool has_vertex_layer = false;
  bool has_anisotropy = false;
  /** Version, names of the device and the driver. */
  std::string description;

  /** The instance and the device are the host's. */
  [[nodiscard]] bool is_host() const
  {
    return is_host_;
  }
  /** Uses the queue. */
  [[nodiscard]] VkResult submit(const VkSubmitInfo2 &info);
  /** Replace the lost surface of the window, which has no swapchain. \throws Error if the queue cannot present to it */
  void make_surface_anew();
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
  /** Names the commands until end_label() in debuggers. */
  void begin_label(VkCommandBuffer commands, std::string_view name) const;
  void end_label(VkCommandBuffer commands) const;

 private:
  static VkBool32 VKAPI_PTR receive_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                            VkDebugUtilsMessageTypeFlagsEXT types,
                                            const VkDebugUtilsMessengerCallbackDataEXT *data, void *user);
  void create_instance(bool is_debug);
  void create_surface();
  void create_device();
  /** Whether a queue of \a family presents to the window, or there is no window. */
  [[nodiscard]] bool can_present(VkPhysicalDevice candidate, std::uint32_t family);
  /** The first family whose queues draw and present; the number of families: there is none. */
  [[nodiscard]] std::uint32_t usable_family(VkPhysicalDevice candidate);
  /** The names of the features and extensions that \a candidate lacks. */
  [[nodiscard]] std::vector<std::string> missing_in(VkPhysicalDevice candidate,
                                                    const VkPhysicalDeviceProperties &properties);
  /** Sets the members that follow from the physical device and from the features that are enabled. */
  void describe(const VkPhysicalDeviceFeatures &enabled, bool has_layer_output);
  /** Load the functions of the instance, and of the device. \throws Error that names the first one that is missing */
  void load_instance();
  void load_device();
  /** A function of the instance; nullptr: it has none of this name. */
  template <typename Function>
  [[nodiscard]] Function instance_function(const char *name) const
  {
    return reinterpret_cast<Function>(loader_(instance_, name));
  }
  void label_object(VkObjectType type, std::uint64_t handle, const std::string &name);
  void destroy();

  std::function<void(std::string_view message)> sink_;
  GLFWwindow *window_ = nullptr;
  PFN_vkGetInstanceProcAddr loader_ = nullptr;
  VkInstance instance_ = VK_NULL_HANDLE;
  bool is_host_ = false;
  std::function<void()> lock_queue_;
  std::function<void()> unlock_queue_;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  /** nullptr: the instance is made without VK_EXT_debug_utils. */
  PFN_vkSetDebugUtilsObjectNameEXT set_object_name_ = nullptr;
  PFN_vkCmdBeginDebugUtilsLabelEXT begin_label_ = nullptr;
  PFN_vkCmdEndDebugUtilsLabelEXT end_label_ = nullptr;
  bool is_lost_ = false;
  /** The layers may report on any thread that calls Vulkan. */
  std::mutex messages_mutex_;
  std::vector<std::string> messages_;
};

}  // namespace gnomon::gpu
