// SPDX-License-Identifier: MIT
// A host that owns the device and the swapchain of Vulkan: it draws a triangle, and Gnomon two views of a scene below
// it.
//   embed_vulkan SCENE [PICTURE.ppm]: with a picture's name, there is no window: the finished picture is saved.
#include "../write_ppm.hh"

#include <gnomon/gnomon.hh>

#include "shader_check_spirv.hh"

#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>
#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

using namespace gnomon;

static void check(VkResult result, const char *what)
{
  if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR) {
    throw std::runtime_error(std::string(what) + " failed with VkResult " + std::to_string(result));
  }
}

/** The instance, a device and its queue, with the features that Gnomon needs. */
class Host {
 public:
  explicit Host(bool has_window)
  {
    std::uint32_t count = 0;
    const char **names = has_window ? glfwGetRequiredInstanceExtensions(&count) : nullptr;
    const VkApplicationInfo application{
        VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "embed_vulkan", 0, nullptr, 0, VK_API_VERSION_1_3};
    VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    info.pApplicationInfo = &application;
    info.enabledExtensionCount = count;
    info.ppEnabledExtensionNames = names;
    check(vkCreateInstance(&info, nullptr, &instance), "vkCreateInstance");
    // The first device. A host with a choice asks each for the features below.
    count = 1;
    vkEnumeratePhysicalDevices(instance, &count, &physical_device);
    if (count == 0) {
      throw std::runtime_error("no device of Vulkan");
    }
    make_device(has_window);
  }
  ~Host()
  {
    vkDestroyCommandPool(device, pool, nullptr);
    vkDestroyDevice(device, nullptr);
    vkDestroyInstance(instance, nullptr);
  }
  Host(const Host &) = delete;
  Host &operator=(const Host &) = delete;

  /** For Gnomon. The queue needs no lock, because this program has one thread. */
  gpu::VulkanHost handles() const
  {
    return {.loader = vkGetInstanceProcAddr,
            .instance = instance,
            .physical_device = physical_device,
            .device = device,
            .queue = queue,
            .queue_family = family,
            .features = &features_,
            .extensions = {VK_EXT_PROVOKING_VERTEX_EXTENSION_NAME}};
  }

  VkSemaphore make_semaphore() const
  {
    const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, nullptr, 0};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    check(vkCreateSemaphore(device, &info, nullptr, &semaphore), "vkCreateSemaphore");
    return semaphore;
  }
  VkDeviceMemory allocate(const VkMemoryRequirements &needed, VkMemoryPropertyFlags flags) const
  {
    VkPhysicalDeviceMemoryProperties properties{};
    vkGetPhysicalDeviceMemoryProperties(physical_device, &properties);
    for (std::uint32_t type = 0; type < properties.memoryTypeCount; type++) {
      const bool has_flags = (properties.memoryTypes[type].propertyFlags & flags) == flags;
      if ((needed.memoryTypeBits >> type & 1U) != 0 && has_flags) {
        const VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needed.size, type};
        VkDeviceMemory memory = VK_NULL_HANDLE;
        check(vkAllocateMemory(device, &info, nullptr, &memory), "vkAllocateMemory");
        return memory;
      }
    }
    throw std::runtime_error("no memory of the needed type");
  }

  /** Records commands and submits them. A semaphore may be VK_NULL_HANDLE. */
  template <typename Record>
  void submit(Record &&record, VkSemaphore wait, VkSemaphore signal) const
  {
    VkCommandBufferAllocateInfo allocation{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocation.commandPool = pool;
    allocation.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    check(vkAllocateCommandBuffers(device, &allocation, &commands), "vkAllocateCommandBuffers");
    VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    vkBeginCommandBuffer(commands, &begin);
    record(commands);
    check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    constexpr VkPipelineStageFlags stages = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    VkSubmitInfo info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO};
    info.waitSemaphoreCount = wait ? 1 : 0;
    info.pWaitSemaphores = &wait;
    info.pWaitDstStageMask = &stages;
    info.commandBufferCount = 1;
    info.pCommandBuffers = &commands;
    info.signalSemaphoreCount = signal ? 1 : 0;
    info.pSignalSemaphores = &signal;
    check(vkQueueSubmit(queue, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit");
  }
  /** Ends the frame: one is drawn at a time. */
  void wait() const
  {
    check(vkQueueWaitIdle(queue), "vkQueueWaitIdle");
    check(vkResetCommandPool(device, pool, VK_COMMAND_POOL_RESET_RELEASE_RESOURCES_BIT), "vkResetCommandPool");
  }

  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;
  VkCommandPool pool = VK_NULL_HANDLE;

 private:
  void make_device(bool has_window)
  {
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical_device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical_device, &count, families.data());
    const auto can_draw = [&](std::uint32_t i) {
      return (families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0 &&
             (!has_window || glfwGetPhysicalDevicePresentationSupport(instance, physical_device, i));
    };
    while (family < count && !can_draw(family)) {
      family++;
    }
    if (family == count) {
      throw std::runtime_error("no queue that draws and presents");
    }
    features_.features.multiDrawIndirect = VK_TRUE;
    features_.features.drawIndirectFirstInstance = VK_TRUE;
    features_.features.depthClamp = VK_TRUE;
    v12_.timelineSemaphore = VK_TRUE;
    v12_.hostQueryReset = VK_TRUE;
    v13_.dynamicRendering = VK_TRUE;
    v13_.synchronization2 = VK_TRUE;
    const float priority = 1;
    const VkDeviceQueueCreateInfo queues{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, family, 1, &priority};
    const std::array<const char *, 2> extensions = {VK_EXT_PROVOKING_VERTEX_EXTENSION_NAME,
                                                    VK_KHR_SWAPCHAIN_EXTENSION_NAME};
    VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .pNext = &features_};
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queues;
    info.enabledExtensionCount = has_window ? 2 : 1;
    info.ppEnabledExtensionNames = extensions.data();
    check(vkCreateDevice(physical_device, &info, nullptr, &device), "vkCreateDevice");
    vkGetDeviceQueue(device, family, 0, &queue);
    const VkCommandPoolCreateInfo pools{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr,
                                        VK_COMMAND_POOL_CREATE_TRANSIENT_BIT, family};
    check(vkCreateCommandPool(device, &pools, nullptr, &pool), "vkCreateCommandPool");
  }

  VkPhysicalDeviceProvokingVertexFeaturesEXT provoking_vertex_{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROVOKING_VERTEX_FEATURES_EXT, .provokingVertexLast = VK_TRUE};
  VkPhysicalDeviceVulkan12Features v12_{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                        .pNext = &provoking_vertex_};
  VkPhysicalDeviceVulkan13Features v13_{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES, .pNext = &v12_};
  VkPhysicalDeviceFeatures2 features_{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v13_};
};

/** The host's own picture: a triangle of red, green and blue, which stands on the upper quarter. */
class Triangle {
 public:
  Triangle(const Host &host, VkFormat format) : host_(host)
  {
    const VkPipelineLayoutCreateInfo layout{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    check(vkCreatePipelineLayout(host.device, &layout, nullptr, &layout_), "vkCreatePipelineLayout");
    std::vector<VkPipelineShaderStageCreateInfo> stages;
    for (const gpu::SpirvStage &stage : shader_check::compile_spirv(
             "triangle", gpu::preprocess({"triangle", "triangle_vert.glsl", "", "triangle_frag.glsl", {}}, file))) {
      VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
      info.codeSize = stage.words.size() * sizeof(std::uint32_t);
      info.pCode = stage.words.data();
      VkPipelineShaderStageCreateInfo made{.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                           .pName = "main"};
      made.stage = stages.empty() ? VK_SHADER_STAGE_VERTEX_BIT : VK_SHADER_STAGE_FRAGMENT_BIT;
      check(vkCreateShaderModule(host.device, &info, nullptr, &made.module), "vkCreateShaderModule");
      stages.push_back(made);
    }
    const VkPipelineVertexInputStateCreateInfo vertices{.sType =
                                                            VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo rasterization{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo samples{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineColorBlendAttachmentState written{.colorWriteMask = 0xF};
    const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                    .attachmentCount = 1,
                                                    .pAttachments = &written};
    const std::array<VkDynamicState, 2> states = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                   .dynamicStateCount = std::uint32_t(states.size()),
                                                   .pDynamicStates = states.data()};
    const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                  .colorAttachmentCount = 1,
                                                  .pColorAttachmentFormats = &format};
    VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, .pNext = &rendering};
    info.stageCount = std::uint32_t(stages.size());
    info.pStages = stages.data();
    info.pVertexInputState = &vertices;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &rasterization;
    info.pMultisampleState = &samples;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = layout_;
    check(vkCreateGraphicsPipelines(host.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_),
          "vkCreateGraphicsPipelines");
    for (const VkPipelineShaderStageCreateInfo &stage : stages) {
      vkDestroyShaderModule(host.device, stage.module, nullptr);
    }
  }
  ~Triangle()
  {
    vkDestroyPipeline(host_.device, pipeline_, nullptr);
    vkDestroyPipelineLayout(host_.device, layout_, nullptr);
  }
  Triangle(const Triangle &) = delete;
  Triangle &operator=(const Triangle &) = delete;

  /** The image is then in the layout COLOR_ATTACHMENT_OPTIMAL. */
  void draw(VkCommandBuffer commands, VkImage image, VkImageView view, VkExtent2D extent) const
  {
    VkImageMemoryBarrier barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    barrier.newLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, 0,
                         0, nullptr, 0, nullptr, 1, &barrier);
    VkRenderingAttachmentInfo color{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    color.imageView = view;
    color.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    color.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO};
    info.renderArea = {{0, 0}, extent};
    info.layerCount = 1;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &color;
    vkCmdBeginRendering(commands, &info);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
    const VkViewport viewport{0, 0, float(extent.width), float(extent.height) / 4, 0, 1};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &info.renderArea);
    vkCmdDraw(commands, 3, 1, 0, 0);
    vkCmdEndRendering(commands);
  }

 private:
  static std::optional<std::string_view> file(std::string_view path)
  {
    return path == "triangle_vert.glsl" ? R"(#version 450 core
layout(location = 0) out vec3 color;
void main()
{
  color = vec3(gl_VertexIndex == 0, gl_VertexIndex == 1, gl_VertexIndex == 2);
  gl_Position = vec4(gl_VertexIndex - 1, gl_VertexIndex == 1 ? -1 : 1, 0, 1);
})"
                                        : R"(#version 450 core
layout(location = 0) in vec3 color;
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(color, 1.0);
})";
  }

  const Host &host_;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

static VkImageView make_view(const Host &host, VkImage image, VkFormat format)
{
  VkImageViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  info.image = image;
  info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  info.format = format;
  info.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  VkImageView view = VK_NULL_HANDLE;
  check(vkCreateImageView(host.device, &info, nullptr, &view), "vkCreateImageView");
  return view;
}

/** Two renderers of one scene on the host's device. */
class Views {
 public:
  Views(const Host &host, const char *scene_path)
      : device_(gpu::create_vulkan_device({.compile_spirv = shader_check::compile_spirv, .host = host.handles()})),
        scene_(gltf::import_gltf(scene_path)),
        cameras_{scene_.placed_cameras().at(0), scene_.placed_cameras().at(0)}
  {
    const glm::dvec3 middle = scene_.bounds().center();
    glm::dmat4 turn = glm::rotate(glm::translate(glm::dmat4(1), middle), glm::radians(90.0), glm::dvec3(0, 1, 0));
    turn = glm::translate(turn, -middle);
    cameras_[1].world_from_camera = turn * cameras_[1].world_from_camera;
  }

  gpu::Device &device()
  {
    return *device_;
  }
  gpu::Framebuffer make_framebuffer(VkImage image, VkFormat format, VkExtent2D extent)
  {
    return device_->create_framebuffer(
        "the host's image",
        gpu::HostImage{.image = image, .format = format, .size_px = {int(extent.width), int(extent.height)}});
  }
  /** Draws one more sample of both views, side by side in the lower three quarters. \return whether they are complete
   */
  bool draw(const gpu::Framebuffer &framebuffer)
  {
    const glm::ivec2 size_px(framebuffer.size_px().x / 2, framebuffer.size_px().y * 3 / 4);
    bool is_complete = true;
    for (std::size_t i = 0; i < renderers_.size(); i++) {
      renderers_[i].resize(size_px);
      renderers_[i].sync();
      const draw::Target target{.framebuffer = &framebuffer, .origin_px = {int(i) * size_px.x, 0}};
      is_complete &= renderers_[i].draw_sample(cameras_[i], target);
    }
    return is_complete;
  }

 private:
  std::unique_ptr<gpu::Device> device_;
  scene::Scene scene_;
  std::array<scene::PlacedCamera, 2> cameras_;
  std::array<eevee::SceneRenderer, 2> renderers_{eevee::SceneRenderer(*device_, scene_, {8, 8}, {.sample_count = 8}),
                                                 eevee::SceneRenderer(*device_, scene_, {8, 8}, {.sample_count = 8})};
};

/** Draws without a window, into an image whose texels are then saved. */
static void save(const Host &host, const char *scene_path, const char *picture_path)
{
  constexpr VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  constexpr VkExtent2D extent{640, 360};
  VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {extent.width, extent.height, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  VkImage image = VK_NULL_HANDLE;
  check(vkCreateImage(host.device, &info, nullptr, &image), "vkCreateImage");
  VkMemoryRequirements needed{};
  vkGetImageMemoryRequirements(host.device, image, &needed);
  VkDeviceMemory memory = host.allocate(needed, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  check(vkBindImageMemory(host.device, image, memory, 0), "vkBindImageMemory");
  VkImageView view = make_view(host, image, format);
  VkBufferCreateInfo bytes{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  bytes.size = VkDeviceSize(4) * extent.width * extent.height;
  bytes.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  check(vkCreateBuffer(host.device, &bytes, nullptr, &buffer), "vkCreateBuffer");
  vkGetBufferMemoryRequirements(host.device, buffer, &needed);
  VkDeviceMemory read_memory =
      host.allocate(needed, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  check(vkBindBufferMemory(host.device, buffer, read_memory, 0), "vkBindBufferMemory");
  VkSemaphore drawn = host.make_semaphore();
  VkSemaphore finished = host.make_semaphore();
  {
    const Triangle triangle(host, format);
    Views views(host, scene_path);
    const gpu::Framebuffer framebuffer = views.make_framebuffer(image, format, extent);
    for (bool is_complete = false; !is_complete;) {
      host.submit([&](VkCommandBuffer commands) { triangle.draw(commands, image, view, extent); }, VK_NULL_HANDLE,
                  drawn);
      views.device().begin_image(framebuffer, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, {drawn});
      is_complete = views.draw(framebuffer);
      views.device().end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, {finished});
      host.submit(
          [&](VkCommandBuffer commands) {
            VkBufferImageCopy region{};
            region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
            region.imageExtent = info.extent;
            vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &region);
          },
          finished, VK_NULL_HANDLE);
      host.wait();
    }
  }
  void *mapped = nullptr;
  check(vkMapMemory(host.device, read_memory, 0, bytes.size, 0, &mapped), "vkMapMemory");
  // The file wants the rows from the bottom.
  std::vector<std::byte> rgba;
  const std::size_t row_bytes = std::size_t(4) * extent.width;
  for (std::size_t row = extent.height; row-- > 0;) {
    const std::span texels(static_cast<const std::byte *>(mapped) + row * row_bytes, row_bytes);
    rgba.insert(rgba.end(), texels.begin(), texels.end());
  }
  write_ppm(picture_path, int(extent.width), int(extent.height), rgba);
  for (VkSemaphore semaphore : {drawn, finished}) {
    vkDestroySemaphore(host.device, semaphore, nullptr);
  }
  vkDestroyBuffer(host.device, buffer, nullptr);
  vkDestroyImageView(host.device, view, nullptr);
  vkDestroyImage(host.device, image, nullptr);
  vkFreeMemory(host.device, read_memory, nullptr);
  vkFreeMemory(host.device, memory, nullptr);
}

/** The images of the window, and a framebuffer of Gnomon for each. */
struct Swapchain {
  static constexpr VkFormat format = VK_FORMAT_B8G8R8A8_UNORM;
  struct Frame {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    VkSemaphore finished = VK_NULL_HANDLE;
    gpu::Framebuffer framebuffer;
  };

  Swapchain(const Host &of, VkSurfaceKHR surface, VkExtent2D size, Views &views) : host(of), extent(size)
  {
    VkSurfaceCapabilitiesKHR capabilities{};
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(host.physical_device, surface, &capabilities), "the surface");
    VkSwapchainCreateInfoKHR info{.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    info.surface = surface;
    info.minImageCount = std::max(capabilities.minImageCount, 2U);
    info.imageFormat = format;
    info.imageColorSpace = VK_COLOR_SPACE_SRGB_NONLINEAR_KHR;
    info.imageExtent = extent;
    info.imageArrayLayers = 1;
    info.imageUsage =
        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.preTransform = capabilities.currentTransform;
    info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
    info.clipped = VK_TRUE;
    check(vkCreateSwapchainKHR(host.device, &info, nullptr, &handle), "vkCreateSwapchainKHR");
    std::uint32_t count = 0;
    vkGetSwapchainImagesKHR(host.device, handle, &count, nullptr);
    std::vector<VkImage> images(count);
    vkGetSwapchainImagesKHR(host.device, handle, &count, images.data());
    for (VkImage image : images) {
      frames.push_back({image, make_view(host, image, format), host.make_semaphore(),
                        views.make_framebuffer(image, format, extent)});
    }
  }
  /** Before it, the queue and Gnomon's device have finished. */
  ~Swapchain()
  {
    for (const Frame &frame : frames) {
      vkDestroySemaphore(host.device, frame.finished, nullptr);
      vkDestroyImageView(host.device, frame.view, nullptr);
    }
    // Gnomon's framebuffers have views of the images, too.
    frames.clear();
    vkDestroySwapchainKHR(host.device, handle, nullptr);
  }
  Swapchain(const Swapchain &) = delete;
  Swapchain &operator=(const Swapchain &) = delete;

  const Host &host;
  VkExtent2D extent{};
  VkSwapchainKHR handle = VK_NULL_HANDLE;
  std::vector<Frame> frames;
};

static void show(const Host &host, GLFWwindow *window, VkSurfaceKHR surface, const char *scene_path)
{
  const Triangle triangle(host, Swapchain::format);
  Views views(host, scene_path);
  VkSemaphore acquired = host.make_semaphore();
  VkSemaphore drawn = host.make_semaphore();
  std::optional<Swapchain> swapchain;
  while (!glfwWindowShouldClose(window)) {
    glfwPollEvents();
    int width = 0;
    int height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    if (width < 2 || height < 2) {  // Minimised.
      glfwWaitEvents();
      continue;
    }
    const VkExtent2D extent{std::uint32_t(width), std::uint32_t(height)};
    if (!swapchain || swapchain->extent.width != extent.width || swapchain->extent.height != extent.height) {
      swapchain.reset();
      swapchain.emplace(host, surface, extent, views);
    }
    std::uint32_t index = 0;
    constexpr std::uint64_t forever = std::numeric_limits<std::uint64_t>::max();
    const VkResult result =
        vkAcquireNextImageKHR(host.device, swapchain->handle, forever, acquired, VK_NULL_HANDLE, &index);
    if (result == VK_ERROR_OUT_OF_DATE_KHR) {
      swapchain.reset();
      continue;
    }
    check(result, "vkAcquireNextImageKHR");
    const Swapchain::Frame &frame = swapchain->frames[index];
    host.submit([&](VkCommandBuffer commands) { triangle.draw(commands, frame.image, frame.view, extent); }, acquired,
                drawn);
    views.device().begin_image(frame.framebuffer, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, {drawn});
    views.draw(frame.framebuffer);
    views.device().end_image(frame.framebuffer, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, {frame.finished});
    VkPresentInfoKHR present{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    present.waitSemaphoreCount = 1;
    present.pWaitSemaphores = &frame.finished;
    present.swapchainCount = 1;
    present.pSwapchains = &swapchain->handle;
    present.pImageIndices = &index;
    const VkResult presented = vkQueuePresentKHR(host.queue, &present);
    host.wait();
    if (presented == VK_ERROR_OUT_OF_DATE_KHR) {
      swapchain.reset();
    }
    else {
      check(presented, "vkQueuePresentKHR");
    }
  }
  vkDestroySemaphore(host.device, acquired, nullptr);
  vkDestroySemaphore(host.device, drawn, nullptr);
}

int main(int argc, char **argv)
try {
  const bool has_window = argc == 2;
  if (argc < 2 || argc > 3 || (has_window && (!glfwInit() || !glfwVulkanSupported()))) {
    std::fprintf(stderr, "usage: embed_vulkan SCENE [PICTURE.ppm]; without a picture, with a display and Vulkan\n");
    return 2;
  }
  const std::unique_ptr<void, void (*)(void *)> at_exit(&argc, [](void *) { glfwTerminate(); });
  const Host host(has_window);
  if (!has_window) {
    save(host, argv[1], argv[2]);
    return 0;
  }
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  GLFWwindow *window = glfwCreateWindow(640, 360, "embed_vulkan", nullptr, nullptr);
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  if (!window) {
    throw std::runtime_error("no window");
  }
  check(glfwCreateWindowSurface(host.instance, window, nullptr, &surface), "glfwCreateWindowSurface");
  show(host, window, surface, argv[1]);
  vkDestroySurfaceKHR(host.instance, surface, nullptr);
  return 0;
}
catch (const std::exception &error) {
  std::fprintf(stderr, "embed_vulkan: %s\n", error.what());
  return 1;
}
