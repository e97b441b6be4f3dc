// SPDX-License-Identifier: MIT
#include "gpu_swapchain.hh"
#include "vulkan_device.hh"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace gnomon::gpu {

namespace {

constexpr const char *window_name = "window";
constexpr std::uint64_t second_ns = 1'000'000'000;

class VulkanSwapchain final : public Swapchain {
 public:
  VulkanSwapchain(VulkanDevice &device, bool waits_for_refresh)
      : device_(device), context_(device.context()), vk_(context_.swapchains), waits_for_refresh_(waits_for_refresh)
  {
    const VkFenceCreateInfo info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
    context_.check(vk_.vkCreateFence(context_.device, &info, nullptr, &acquired_), window_name);
  }
  ~VulkanSwapchain() override
  {
    destroy();
    vk_.vkDestroyFence(context_.device, acquired_, nullptr);
  }

  const Framebuffer *acquire(glm::ivec2 size_px) override;
  bool present() override;

 private:
  struct Image {
    Framebuffer framebuffer;
    /** Signalled when the image is drawn. */
    VkSemaphore drawn = VK_NULL_HANDLE;
  };

  /** Make the swapchain, unless the surface has no pixels or is lost. */
  void create(glm::ivec2 size_px);
  /** Get the swapchain's images, and make a framebuffer and a semaphore for each. */
  void make_images(VkFormat format, glm::ivec2 size_px);
  /** Wait for all work, and destroy the swapchain, if there is one. */
  void destroy();
  /** Whether a function has done its work. Otherwise another attempt may succeed. \throws Error */
  bool has_succeeded(VkResult result);
  [[nodiscard]] VkSurfaceFormatKHR choose_format();
  [[nodiscard]] VkPresentModeKHR choose_mode();

  VulkanDevice &device_;
  VulkanContext &context_;
  const VulkanSwapchainTable &vk_;
  bool waits_for_refresh_;
  VkFence acquired_ = VK_NULL_HANDLE;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  std::vector<Image> images_;
  /** Size of the window when the swapchain was made. */
  glm::ivec2 size_px_{0};
  /** The swapchain is to be replaced. */
  bool is_outdated_ = false;
  /** The image that is drawn now. Empty: none. */
  std::optional<std::uint32_t> drawn_;
};

bool VulkanSwapchain::has_succeeded(VkResult result)
{
  switch (result) {
    case VK_SUBOPTIMAL_KHR: is_outdated_ = true; return true;
    case VK_ERROR_OUT_OF_DATE_KHR: is_outdated_ = true; return false;
    case VK_ERROR_SURFACE_LOST_KHR:
      destroy();
      context_.make_surface_anew();
      device_.tell("The window's surface was lost, and was made anew");
      return false;
    default: context_.check(result, window_name); return true;
  }
}

VkSurfaceFormatKHR VulkanSwapchain::choose_format()
{
  std::uint32_t count = 0;
  const auto get = context_.surfaces.vkGetPhysicalDeviceSurfaceFormatsKHR;
  get(context_.physical_device, context_.surface, &count, nullptr);
  std::vector<VkSurfaceFormatKHR> formats(count);
  get(context_.physical_device, context_.surface, &count, formats.data());
  // Pictures have display colours, which are stored unchanged.
  const auto found = std::ranges::find_if(formats, [](const VkSurfaceFormatKHR &of) {
    return (of.format == VK_FORMAT_B8G8R8A8_UNORM || of.format == VK_FORMAT_R8G8B8A8_UNORM) &&
           of.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR;
  });
  if (found == formats.end()) {
    throw Error("{}: it has no images of 8 bits for each channel, with display colours", window_name);
  }
  return *found;
}

VkPresentModeKHR VulkanSwapchain::choose_mode()
{
  std::uint32_t count = 0;
  const auto get = context_.surfaces.vkGetPhysicalDeviceSurfacePresentModesKHR;
  get(context_.physical_device, context_.surface, &count, nullptr);
  std::vector<VkPresentModeKHR> modes(count);
  get(context_.physical_device, context_.surface, &count, modes.data());
  const bool is_immediate =
      !waits_for_refresh_ && std::ranges::find(modes, VK_PRESENT_MODE_IMMEDIATE_KHR) != modes.end();
  return is_immediate ? VK_PRESENT_MODE_IMMEDIATE_KHR : VK_PRESENT_MODE_FIFO_KHR;
}

void VulkanSwapchain::create(glm::ivec2 size_px)
{
  if (context_.surface == VK_NULL_HANDLE) {
    // An earlier attempt failed.
    context_.make_surface_anew();
  }
  VkSurfaceCapabilitiesKHR of{};
  if (!has_succeeded(context_.surfaces.vkGetPhysicalDeviceSurfaceCapabilitiesKHR(context_.physical_device,
                                                                                 context_.surface, &of))) {
    return;
  }
  VkExtent2D extent = of.currentExtent;
  if (extent.width == std::numeric_limits<std::uint32_t>::max()) {
    // The swapchain sets the size.
    extent = {std::clamp(std::uint32_t(size_px.x), of.minImageExtent.width, of.maxImageExtent.width),
              std::clamp(std::uint32_t(size_px.y), of.minImageExtent.height, of.maxImageExtent.height)};
  }
  if (extent.width == 0 || extent.height == 0) {
    return;
  }
  if ((of.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT) == 0) {
    throw Error("{}: its images cannot be copied to", window_name);
  }
  const VkSurfaceFormatKHR format = choose_format();
  VkSwapchainCreateInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR;
  info.surface = context_.surface;
  info.minImageCount = of.minImageCount + 1;
  if (of.maxImageCount != 0) {
    info.minImageCount = std::min(info.minImageCount, of.maxImageCount);
  }
  info.imageFormat = format.format;
  info.imageColorSpace = format.colorSpace;
  info.imageExtent = extent;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  info.preTransform = of.currentTransform;
  info.compositeAlpha = (of.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) != 0
                            ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  info.presentMode = choose_mode();
  info.clipped = VK_TRUE;
  // After a failure, the output is undefined.
  VkSwapchainKHR made = VK_NULL_HANDLE;
  if (!has_succeeded(vk_.vkCreateSwapchainKHR(context_.device, &info, nullptr, &made))) {
    return;
  }
  swapchain_ = made;
  size_px_ = size_px;
  is_outdated_ = false;
  try {
    make_images(format.format, {int(extent.width), int(extent.height)});
  }
  catch (...) {
    destroy();
    throw;
  }
}

void VulkanSwapchain::make_images(VkFormat format, glm::ivec2 size_px)
{
  std::uint32_t count = 0;
  context_.check(vk_.vkGetSwapchainImagesKHR(context_.device, swapchain_, &count, nullptr), window_name);
  std::vector<VkImage> handles(count);
  context_.check(vk_.vkGetSwapchainImagesKHR(context_.device, swapchain_, &count, handles.data()), window_name);
  for (VkImage handle : handles) {
    Image &image = images_.emplace_back();
    const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, nullptr, 0};
    context_.check(context_.vk.vkCreateSemaphore(context_.device, &semaphore, nullptr, &image.drawn), window_name);
    image.framebuffer =
        device_.create_framebuffer(window_name, HostImage{.image = handle, .format = format, .size_px = size_px});
  }
}

void VulkanSwapchain::destroy()
{
  drawn_.reset();
  if (swapchain_ == VK_NULL_HANDLE) {
    return;
  }
  std::vector<VkSemaphore> semaphores;
  for (Image &image : images_) {
    semaphores.push_back(image.drawn);
  }
  images_.clear();
  try {
    // Destroys the framebuffers' views of the images.
    device_.finish();
  }
  catch (const Error & /*error*/) {
    device_.destroy_retired();
  }
  // Also for an image that is being presented.
  vk_.vkDeviceWaitIdle(context_.device);
  for (VkSemaphore semaphore : semaphores) {
    context_.vk.vkDestroySemaphore(context_.device, semaphore, nullptr);
  }
  vk_.vkDestroySwapchainKHR(context_.device, std::exchange(swapchain_, VK_NULL_HANDLE), nullptr);
}

const Framebuffer *VulkanSwapchain::acquire(glm::ivec2 size_px)
{
  if (drawn_) {
    // The last picture has failed before it was presented.
    return &images_[*drawn_].framebuffer;
  }
  // The second attempt may have another size, and the third another surface.
  for (int attempt = 0; attempt < 3; attempt++) {
    if (is_outdated_ || size_px != size_px_) {
      destroy();
    }
    if (swapchain_ == VK_NULL_HANDLE) {
      create(size_px);
    }
    if (swapchain_ == VK_NULL_HANDLE) {
      continue;
    }
    std::uint32_t index = 0;
    const VkResult result =
        vk_.vkAcquireNextImageKHR(context_.device, swapchain_, second_ns, VK_NULL_HANDLE, acquired_, &index);
    if (result == VK_TIMEOUT || result == VK_NOT_READY) {
      return nullptr;
    }
    if (has_succeeded(result)) {
      // An image that is not presented is not given back, so that the swapchain is replaced unless all of this
      // succeeds.
      const bool was_outdated = std::exchange(is_outdated_, true);
      context_.check(
          vk_.vkWaitForFences(context_.device, 1, &acquired_, VK_TRUE, std::numeric_limits<std::uint64_t>::max()),
          window_name);
      context_.check(vk_.vkResetFences(context_.device, 1, &acquired_), window_name);
      device_.begin_image(images_[index].framebuffer, VK_IMAGE_LAYOUT_UNDEFINED);
      is_outdated_ = was_outdated;
      drawn_ = index;
      return &images_[index].framebuffer;
    }
  }
  return nullptr;
}

bool VulkanSwapchain::present()
{
  GNOMON_ASSERT(drawn_, "no image of the window is acquired");
  const std::uint32_t index = *std::exchange(drawn_, std::nullopt);
  const Image &image = images_[index];
  try {
    device_.end_image(image.framebuffer, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, {image.drawn});
  }
  catch (...) {
    // An image that is not presented is not given back.
    is_outdated_ = true;
    throw;
  }
  VkPresentInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR;
  info.waitSemaphoreCount = 1;
  info.pWaitSemaphores = &image.drawn;
  info.swapchainCount = 1;
  info.pSwapchains = &swapchain_;
  info.pImageIndices = &index;
  const bool is_shown = has_succeeded(vk_.vkQueuePresentKHR(context_.queue, &info));
  context_.check_messages(window_name);
  return is_shown;
}

}  // namespace

std::unique_ptr<Device> create_vulkan_device(const VulkanDeviceDesc &desc, GLFWwindow &window)
{
  GNOMON_ASSERT(!desc.host, "a device of a host for a window");
  return VulkanDevice::create(desc, &window);
}

std::unique_ptr<Swapchain> create_swapchain(Device &device, bool waits_for_refresh)
{
  auto *vulkan = dynamic_cast<VulkanDevice *>(&device);
  if (!vulkan || vulkan->context().surface == VK_NULL_HANDLE) {
    throw Error("swapchain: the device is not made for a window: {}", device.description());
  }
  return std::make_unique<VulkanSwapchain>(*vulkan, waits_for_refresh);
}

}  // namespace gnomon::gpu
