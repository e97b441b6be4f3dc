// SPDX-License-Identifier: MIT
#pragma once

#include "draw_target.hh"
#include "gpu_create_device.hh"

#include <functional>
#include <memory>
#include <optional>
#include <string_view>

struct GLFWwindow;

namespace gnomon::view {

/** A window of GLFW, and the device that draws into it. \pre GLFW is initialised */
class WindowDevice {
 public:
  /** The back buffer. */
  struct Screen {
    /** Covers it. */
    draw::Target target;
    glm::ivec2 size_px{1};
  };

  virtual ~WindowDevice() = default;

  [[nodiscard]] virtual GLFWwindow *window() const = 0;
  [[nodiscard]] virtual gpu::Device &device() = 0;
  /** OpenGl or Vulkan. */
  [[nodiscard]] virtual gpu::Backend backend() const = 0;
  /**
   * The back buffer for the next picture; its content is undefined. \a size_px: of the window. Empty: there is none
   * now, as while the window is minimised. \throws gpu::Error
   */
  [[nodiscard]] virtual std::optional<Screen> begin(glm::ivec2 size_px) = 0;
  /**
   * Show the back buffer. \pre begin() has returned it \return false: it may not be shown, and is to be drawn again
   * \throws gpu::Error
   */
  virtual bool present() = 0;
  /** Whether the driver has lost the context. Drawing then has no effect. */
  [[nodiscard]] virtual bool is_lost() const = 0;
  /** For scripts: simulate a lost context from now on. */
  virtual void inject_loss() = 0;
};

/** Receives a message of the driver or of the device. It must not throw. */
using DriverMessages = std::function<void(std::string_view text, bool is_error)>;

/**
 * Open a window of \a size_px. \a backend: Auto, OpenGl or Vulkan; if Auto takes Vulkan, \a messages gets a line that
 * says so and why. \a is_scripted: pictures do not wait for the screen's refresh, and OpenGL's driver reports its
 * errors to \a messages.
 *
 * \throws std::runtime_error with the reasons for which no window opens
 */
[[nodiscard]] std::unique_ptr<WindowDevice> open_window(gpu::Backend backend, glm::ivec2 size_px, bool is_scripted,
                                                        const DriverMessages &messages);

}  // namespace gnomon::view
