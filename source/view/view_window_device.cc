// SPDX-License-Identifier: MIT
#include "view_window_device.hh"

#include "view_window_gl.hh"

#include "gpu_swapchain.hh"
#include "shader_check_spirv.hh"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <stdexcept>

namespace gnomon::view {

namespace {

class VulkanWindow final : public WindowDevice {
 public:
  VulkanWindow(glm::ivec2 size_px, bool is_scripted, const DriverMessages &messages)
  {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window_ = glfwCreateWindow(size_px.x, size_px.y, "gnomon", nullptr, nullptr);
    if (!window_) {
      throw std::runtime_error(fmt::format("view: no window: {}", glfw_reason()));
    }
    try {
      device_ = gpu::create_vulkan_device({.compile_spirv = shader_check::compile_spirv,
                                           .sink = [messages](std::string_view text) { messages(text, false); },
                                           .shader_cache_folder = gpu::default_shader_cache_folder()},
                                          *window_);
      swapchain_ = gpu::create_swapchain(*device_, !is_scripted);
    }
    catch (...) {
      close();
      throw;
    }
  }
  ~VulkanWindow() override
  {
    close();
  }
  VulkanWindow(const VulkanWindow &) = delete;
  VulkanWindow &operator=(const VulkanWindow &) = delete;

  GLFWwindow *window() const override
  {
    return window_;
  }
  gpu::Device &device() override
  {
    return *device_;
  }
  gpu::Backend backend() const override
  {
    return gpu::Backend::Vulkan;
  }
  std::optional<Screen> begin(glm::ivec2 size_px) override
  {
    const gpu::Framebuffer *framebuffer = swapchain_->acquire(size_px);
    return framebuffer ? std::optional(Screen{{.framebuffer = framebuffer}, framebuffer->size_px()}) : std::nullopt;
  }
  bool present() override
  {
    return swapchain_->present();
  }
  bool is_lost() const override
  {
    return is_lost_;
  }
  void inject_loss() override
  {
    is_lost_ = true;
  }

 private:
  void close()
  {
    swapchain_.reset();
    device_.reset();
    glfwDestroyWindow(window_);
  }

  GLFWwindow *window_ = nullptr;
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<gpu::Swapchain> swapchain_;
  /** Only of simulated losses: those of the driver are errors of the functions that meet them. */
  bool is_lost_ = false;
};

std::unique_ptr<WindowDevice> open_vulkan_window(glm::ivec2 size_px, bool is_scripted, const DriverMessages &messages)
{
  return std::make_unique<VulkanWindow>(size_px, is_scripted, messages);
}

}  // namespace

std::unique_ptr<WindowDevice> open_window(gpu::Backend backend, glm::ivec2 size_px, bool is_scripted,
                                          const DriverMessages &messages)
{
  if (backend == gpu::Backend::Vulkan) {
    return open_vulkan_window(size_px, is_scripted, messages);
  }
  std::string reason;
  try {
    return open_gl_window(size_px, is_scripted, messages);
  }
  catch (const std::runtime_error &error) {
    if (backend == gpu::Backend::OpenGl) {
      throw;
    }
    reason = error.what();
  }
  try {
    std::unique_ptr<WindowDevice> opened = open_vulkan_window(size_px, is_scripted, messages);
    messages(fmt::format("backend: {}, because OpenGL does not start: {}", opened->device().description(), reason),
             false);
    return opened;
  }
  catch (const std::runtime_error &error) {
    throw std::runtime_error(fmt::format("{}; {}", reason, error.what()));
  }
}

}  // namespace gnomon::view
