// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_resource.hh"
#include "gpu_vulkan_host.hh"
#include "vulkan/vulkan_functions.hh"

#include <dlfcn.h>

#include <array>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

namespace gnomon::test {

/** A host with an instance, the validation layers, a device and a queue of its own. It throws std::runtime_error. */
class VulkanTestHost {
 public:
  /** \a missing: a name of a feature or an extension that is not enabled */
  explicit VulkanTestHost(std::string_view missing = {}, std::uint32_t version = VK_API_VERSION_1_3)
  {
    library_ = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    loader = library_ ? PFN_vkGetInstanceProcAddr(dlsym(library_, "vkGetInstanceProcAddr")) : nullptr;
    if (!loader) {
      throw std::runtime_error("no loader of Vulkan");
    }
    make_instance(version);
    make_device(missing);
    vkGetDeviceProcAddr = of_instance<PFN_vkGetDeviceProcAddr>("vkGetDeviceProcAddr");
    const VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr,
                                            VK_COMMAND_POOL_CREATE_TRANSIENT_BIT, 0};
    check(of_device<PFN_vkCreateCommandPool>("vkCreateCommandPool")(device, &pool_info, nullptr, &pool_), "pool");
  }
  ~VulkanTestHost()
  {
    if (device) {
      of_device<PFN_vkDestroyCommandPool>("vkDestroyCommandPool")(device, pool_, nullptr);
      // The layers report what was not destroyed.
      of_device<PFN_vkDestroyDevice>("vkDestroyDevice")(device, nullptr);
    }
    for (const std::string &message : take_messages()) {
      ADD_FAILURE() << message;
    }
    of_instance<PFN_vkDestroyDebugUtilsMessengerEXT>("vkDestroyDebugUtilsMessengerEXT")(instance, messenger_, nullptr);
    of_instance<PFN_vkDestroyInstance>("vkDestroyInstance")(instance, nullptr);
  }
  VulkanTestHost(const VulkanTestHost &) = delete;
  VulkanTestHost &operator=(const VulkanTestHost &) = delete;

  [[nodiscard]] gpu::VulkanHost handles() const
  {
    return {.loader = loader,
            .instance = instance,
            .physical_device = physical_device,
            .device = device,
            .queue = queue,
            .queue_family = 0,
            .features = &features_,
            .extensions = extensions_};
  }
  template <typename Function>
  [[nodiscard]] Function of_instance(const char *name) const
  {
    return reinterpret_cast<Function>(loader(instance, name));
  }
  template <typename Function>
  [[nodiscard]] Function of_device(const char *name) const
  {
    return reinterpret_cast<Function>(vkGetDeviceProcAddr(device, name));
  }
  static void check(VkResult result, const char *what)
  {
    if (result != VK_SUCCESS) {
      throw std::runtime_error(std::string(what) + ": VkResult " + std::to_string(result));
    }
  }
  std::vector<std::string> take_messages()
  {
    const std::scoped_lock lock(mutex_);
    return std::exchange(messages_, {});
  }

  VkSemaphore make_semaphore(bool is_timeline)
  {
    const VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO, nullptr,
                                         is_timeline ? VK_SEMAPHORE_TYPE_TIMELINE : VK_SEMAPHORE_TYPE_BINARY, 0};
    const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type, 0};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    check(of_device<PFN_vkCreateSemaphore>("vkCreateSemaphore")(device, &info, nullptr, &semaphore), "semaphore");
    return semaphore;
  }
  void destroy(VkSemaphore semaphore)
  {
    of_device<PFN_vkDestroySemaphore>("vkDestroySemaphore")(device, semaphore, nullptr);
  }

  struct Image {
    VkImage image = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
  };
  Image make_image(VkFormat format, std::uint32_t width, std::uint32_t height,
                   VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT)
  {
    VkImageCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent = {width, height, 1};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = samples;
    info.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                 VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    Image image{.width = width, .height = height};
    check(of_device<PFN_vkCreateImage>("vkCreateImage")(device, &info, nullptr, &image.image), "image");
    VkMemoryRequirements needed{};
    of_device<PFN_vkGetImageMemoryRequirements>("vkGetImageMemoryRequirements")(device, image.image, &needed);
    image.memory = allocate(needed, 0);
    check(of_device<PFN_vkBindImageMemory>("vkBindImageMemory")(device, image.image, image.memory, 0), "image");
    return image;
  }
  void destroy(const Image &image)
  {
    of_device<PFN_vkDestroyImage>("vkDestroyImage")(device, image.image, nullptr);
    of_device<PFN_vkFreeMemory>("vkFreeMemory")(device, image.memory, nullptr);
  }

  /** Records and submits commands, and waits for them. The caller holds the queue's lock. */
  template <typename Record>
  void submit(Record &&record, gpu::HostSemaphore wait = {}, gpu::HostSemaphore signal = {})
  {
    VkCommandBufferAllocateInfo allocate_info{};
    allocate_info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate_info.commandPool = pool_;
    allocate_info.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    check(of_device<PFN_vkAllocateCommandBuffers>("vkAllocateCommandBuffers")(device, &allocate_info, &commands),
          "commands");
    VkCommandBufferBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check(of_device<PFN_vkBeginCommandBuffer>("vkBeginCommandBuffer")(commands, &begin), "begin");
    record(commands);
    check(of_device<PFN_vkEndCommandBuffer>("vkEndCommandBuffer")(commands), "end");
    const auto info_of = [](const gpu::HostSemaphore &semaphore) {
      return VkSemaphoreSubmitInfo{
          VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, semaphore.semaphore, semaphore.value,
          VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,    0};
    };
    const VkSemaphoreSubmitInfo waits = info_of(wait);
    const VkSemaphoreSubmitInfo signals = info_of(signal);
    const VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, commands, 0};
    const VkSubmitInfo2 submit{
        VK_STRUCTURE_TYPE_SUBMIT_INFO_2, nullptr, 0, wait.semaphore ? 1U : 0U, &waits, 1, &buffer,
        signal.semaphore ? 1U : 0U,      &signals};
    check(of_device<PFN_vkQueueSubmit2>("vkQueueSubmit2")(queue, 1, &submit, VK_NULL_HANDLE), "submit");
    check(of_device<PFN_vkQueueWaitIdle>("vkQueueWaitIdle")(queue), "wait");
    of_device<PFN_vkFreeCommandBuffers>("vkFreeCommandBuffers")(device, pool_, 1, &commands);
  }
  void change_layout(VkCommandBuffer commands, const Image &image, VkImageLayout from, VkImageLayout to) const
  {
    VkImageMemoryBarrier2 barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image.image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkDependencyInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &barrier;
    of_device<PFN_vkCmdPipelineBarrier2>("vkCmdPipelineBarrier2")(commands, &info);
  }
  /** Fills the image, which then has the layout TRANSFER_DST_OPTIMAL. */
  void clear(const Image &image, const std::array<float, 4> &color, gpu::HostSemaphore signal = {})
  {
    submit(
        [&](VkCommandBuffer commands) {
          change_layout(commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
          VkClearColorValue value{};
          std::memcpy(&value, color.data(), sizeof(color));
          const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
          of_device<PFN_vkCmdClearColorImage>("vkCmdClearColorImage")(
              commands, image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &value, 1, &range);
        },
        {}, signal);
  }
  struct Buffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    /** The content, which needs no flush. */
    void *mapped = nullptr;

    [[nodiscard]] gpu::HostHandle handle() const
    {
      return (gpu::HostHandle)buffer;
    }
  };
  Buffer make_buffer(std::size_t size_bytes, VkBufferUsageFlags usage)
  {
    VkBufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = size_bytes;
    info.usage = usage;
    Buffer buffer;
    check(of_device<PFN_vkCreateBuffer>("vkCreateBuffer")(device, &info, nullptr, &buffer.buffer), "buffer");
    VkMemoryRequirements needed{};
    of_device<PFN_vkGetBufferMemoryRequirements>("vkGetBufferMemoryRequirements")(device, buffer.buffer, &needed);
    buffer.memory = allocate(needed, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    check(of_device<PFN_vkBindBufferMemory>("vkBindBufferMemory")(device, buffer.buffer, buffer.memory, 0), "buffer");
    check(of_device<PFN_vkMapMemory>("vkMapMemory")(device, buffer.memory, 0, size_bytes, 0, &buffer.mapped), "map");
    return buffer;
  }
  /** A buffer of vertices or indices. */
  template <typename T>
  Buffer make_buffer(const std::vector<T> &values)
  {
    const std::size_t size_bytes = values.size() * sizeof(T);
    const Buffer buffer = make_buffer(size_bytes, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    std::memcpy(buffer.mapped, values.data(), size_bytes);
    return buffer;
  }
  void destroy(const Buffer &buffer)
  {
    of_device<PFN_vkDestroyBuffer>("vkDestroyBuffer")(device, buffer.buffer, nullptr);
    of_device<PFN_vkFreeMemory>("vkFreeMemory")(device, buffer.memory, nullptr);
  }
  /** The texels of an image of four bytes a texel in the layout TRANSFER_SRC_OPTIMAL, first row first. */
  std::vector<std::array<std::uint8_t, 4>> read(const Image &image, gpu::HostSemaphore wait = {})
  {
    const std::size_t size = std::size_t(image.width) * image.height * 4;
    const Buffer buffer = make_buffer(size, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    submit(
        [&](VkCommandBuffer commands) {
          VkBufferImageCopy region{};
          region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
          region.imageExtent = {image.width, image.height, 1};
          of_device<PFN_vkCmdCopyImageToBuffer>("vkCmdCopyImageToBuffer")(
              commands, image.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer.buffer, 1, &region);
        },
        wait);
    std::vector<std::array<std::uint8_t, 4>> texels(std::size_t(image.width) * image.height);
    std::memcpy(texels.data(), buffer.mapped, size);
    destroy(buffer);
    return texels;
  }

  /** Whether vertices in buffers may have attributes of \a format. */
  [[nodiscard]] bool reads_vertices(VkFormat format) const
  {
    VkFormatProperties properties{};
    of_instance<PFN_vkGetPhysicalDeviceFormatProperties>("vkGetPhysicalDeviceFormatProperties")(physical_device, format,
                                                                                                &properties);
    return (properties.bufferFeatures & VK_FORMAT_FEATURE_VERTEX_BUFFER_BIT) != 0;
  }

  PFN_vkGetInstanceProcAddr loader = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;

 private:
  static VkBool32 VKAPI_PTR receive(VkDebugUtilsMessageSeverityFlagBitsEXT /*severity*/,
                                    VkDebugUtilsMessageTypeFlagsEXT /*types*/,
                                    const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
  {
    auto *host = static_cast<VulkanTestHost *>(user);
    const std::scoped_lock lock(host->mutex_);
    host->messages_.emplace_back(data->pMessage);
    return VK_FALSE;
  }
  void make_instance(std::uint32_t version)
  {
    const VkApplicationInfo application{
        VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "test host", 0, nullptr, 0, version};
    const VkValidationFeatureEnableEXT synchronisation = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkValidationFeaturesEXT validation{
        VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, nullptr, 1, &synchronisation, 0, nullptr};
    const std::array<const char *, 1> layers = {"VK_LAYER_KHRONOS_validation"};
    const std::array<const char *, 2> names = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                                               VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
    const VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    &validation,
                                    0,
                                    &application,
                                    1,
                                    layers.data(),
                                    names.size(),
                                    names.data()};
    check(of_instance<PFN_vkCreateInstance>("vkCreateInstance")(&info, nullptr, &instance), "instance");
    VkDebugUtilsMessengerCreateInfoEXT messenger{};
    messenger.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    messenger.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = &receive;
    messenger.pUserData = this;
    check(of_instance<PFN_vkCreateDebugUtilsMessengerEXT>("vkCreateDebugUtilsMessengerEXT")(instance, &messenger,
                                                                                            nullptr, &messenger_),
          "messenger");
  }
  void make_device(std::string_view missing)
  {
    std::uint32_t count = 1;
    of_instance<PFN_vkEnumeratePhysicalDevices>("vkEnumeratePhysicalDevices")(instance, &count, &physical_device);
    if (count == 0) {
      throw std::runtime_error("no device of Vulkan");
    }
    features_.features.multiDrawIndirect = missing != "multiDrawIndirect";
    features_.features.drawIndirectFirstInstance = VK_TRUE;
    features_.features.depthClamp = VK_TRUE;
    timeline_.timelineSemaphore = VK_TRUE;
    v13_.dynamicRendering = VK_TRUE;
    v13_.synchronization2 = VK_TRUE;
    query_reset_.hostQueryReset = missing != "hostQueryReset";
    provoking_.provokingVertexLast = missing != "provokingVertexLast";
    if (missing != VK_EXT_PROVOKING_VERTEX_EXTENSION_NAME) {
      extensions_.emplace_back(VK_EXT_PROVOKING_VERTEX_EXTENSION_NAME);
    }
    else {
      query_reset_.pNext = nullptr;
    }
    std::vector<const char *> names;
    for (const std::string &name : extensions_) {
      names.push_back(name.c_str());
    }
    const float priority = 1.0F;
    const VkDeviceQueueCreateInfo queues{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, 0, 1, &priority};
    VkDeviceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = &features_;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queues;
    info.enabledExtensionCount = std::uint32_t(names.size());
    info.ppEnabledExtensionNames = names.data();
    check(of_instance<PFN_vkCreateDevice>("vkCreateDevice")(physical_device, &info, nullptr, &device), "device");
    const auto get = of_instance<PFN_vkGetDeviceProcAddr>("vkGetDeviceProcAddr");
    reinterpret_cast<PFN_vkGetDeviceQueue>(get(device, "vkGetDeviceQueue"))(device, 0, 0, &queue);
  }
  VkDeviceMemory allocate(const VkMemoryRequirements &needed, VkMemoryPropertyFlags flags)
  {
    VkPhysicalDeviceMemoryProperties properties{};
    of_instance<PFN_vkGetPhysicalDeviceMemoryProperties>("vkGetPhysicalDeviceMemoryProperties")(physical_device,
                                                                                                &properties);
    std::uint32_t type = 0;
    while ((needed.memoryTypeBits >> type & 1U) == 0 || (properties.memoryTypes[type].propertyFlags & flags) != flags) {
      type++;
    }
    const VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needed.size, type};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    check(of_device<PFN_vkAllocateMemory>("vkAllocateMemory")(device, &info, nullptr, &memory), "memory");
    return memory;
  }

  void *library_ = nullptr;
  PFN_vkGetDeviceProcAddr vkGetDeviceProcAddr = nullptr;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::vector<std::string> extensions_;
  // One structure of Vulkan 1.3, and single ones that those of 1.2 replace.
  VkPhysicalDeviceProvokingVertexFeaturesEXT provoking_{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROVOKING_VERTEX_FEATURES_EXT,
                                                        nullptr, VK_FALSE, VK_FALSE};
  VkPhysicalDeviceHostQueryResetFeatures query_reset_{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_HOST_QUERY_RESET_FEATURES,
                                                      &provoking_, VK_FALSE};
  VkPhysicalDeviceTimelineSemaphoreFeatures timeline_{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES,
                                                      &query_reset_, VK_FALSE};
  VkPhysicalDeviceVulkan13Features v13_ = [this] {
    VkPhysicalDeviceVulkan13Features features{};
    features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    features.pNext = &timeline_;
    return features;
  }();
  VkPhysicalDeviceFeatures2 features_{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &v13_, {}};
  std::mutex mutex_;
  std::vector<std::string> messages_;
};

}  // namespace gnomon::test
