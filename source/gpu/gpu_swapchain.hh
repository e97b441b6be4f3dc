// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include <memory>

struct GLFWwindow;

namespace gnomon::gpu {

/**
 * A device of Vulkan that can present to \a window, made by GLFW with GLFW_NO_API, which must outlive it. \pre
 * desc.host is empty
 *
 * \throws Error as create_vulkan_device, or if no device can present to the window
 */
[[nodiscard]] std::unique_ptr<Device> create_vulkan_device(const VulkanDeviceDesc &desc, GLFWwindow &window);

/** The images of a window, which are presented one after the other. It must be destroyed before its device. */
class Swapchain {
 public:
  virtual ~Swapchain() = default;

  /**
   * Take the next image for draws, until present(). Its content is undefined; positions in it are from its lower left
   * corner. Waits at most a second for an image, and then until the window system
   * has released it. The images are made anew if \a size_px, of the window, has changed, if
   * the window system asks for it, and after the loss of the surface, which the message sink is told.
   *
   * \return nullptr: there is no image now, as while the window is minimised. The size may differ from \a size_px
   * \throws Error if the window's images cannot be used; DeviceLost
   */
  [[nodiscard]] virtual const Framebuffer *acquire(glm::ivec2 size_px) = 0;
  /**
   * Submit all work and present the image. \pre acquire() has returned one
   * \return false: the image may not be shown, and its picture is to be drawn again \throws as acquire()
   */
  virtual bool present() = 0;
};

/**
 * The swapchain of the window of \a device. \a waits_for_refresh: each picture is shown for one refresh of the screen
 * at least; false: at once, if the driver allows it. \throws Error if the device is not made for a window
 */
[[nodiscard]] std::unique_ptr<Swapchain> create_swapchain(Device &device, bool waits_for_refresh);

}  // namespace gnomon::gpu
