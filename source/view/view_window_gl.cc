// SPDX-License-Identifier: MIT
#include "view_window_gl.hh"

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace gnomon::view {

namespace {

/** The driver's function while a loss is simulated. nullptr: no loss is simulated. */
PFNGLGETGRAPHICSRESETSTATUSPROC reset_status_of_driver = nullptr;

void GLAPIENTRY take_debug_message(GLenum source, GLenum type, GLuint /*id*/, GLenum severity, GLsizei length,
                                   const GLchar *text, const void *messages)
{
  // A mistake in a shader's source is no error of the program; the device names its file and line.
  if (source == GL_DEBUG_SOURCE_SHADER_COMPILER) {
    return;
  }
  if (type == GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_HIGH) {
    const std::string_view message(text, std::size_t(length));
    (*static_cast<const DriverMessages *>(messages))(fmt::format("OpenGL: {}", message), true);
  }
}

class GlWindow final : public WindowDevice {
 public:
  GlWindow(glm::ivec2 size_px, bool is_scripted, const DriverMessages &messages) : messages_(messages)
  {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, is_scripted ? GLFW_TRUE : GLFW_FALSE);
    // Required for glGetGraphicsResetStatus to report a reset of the GPU.
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
    window_ = glfwCreateWindow(size_px.x, size_px.y, "gnomon", nullptr, nullptr);
    if (!window_) {
      throw std::runtime_error(fmt::format("view: no window with an OpenGL 4.5 core context: {}", glfw_reason()));
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(is_scripted ? 0 : 1);
    if (is_scripted) {
      glEnable(GL_DEBUG_OUTPUT);
      glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
      glDebugMessageCallback(take_debug_message, &messages_);
    }
    try {
      device_ = gpu::create_device(
          {.host = gpu::GlHost{}, .sink = [this](std::string_view text) { messages_(text, false); }});
    }
    catch (...) {
      glfwDestroyWindow(window_);
      throw;
    }
  }
  ~GlWindow() override
  {
    if (reset_status_of_driver) {
      epoxy_glGetGraphicsResetStatus = std::exchange(reset_status_of_driver, nullptr);
    }
    device_.reset();
    glfwDestroyWindow(window_);
  }
  GlWindow(const GlWindow &) = delete;
  GlWindow &operator=(const GlWindow &) = delete;

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
    return gpu::Backend::OpenGl;
  }
  std::optional<Screen> begin(glm::ivec2 size_px) override
  {
    return Screen{{.framebuffer = gpu::HostFramebuffer{0, size_px}}, size_px};
  }
  bool present() override
  {
    glfwSwapBuffers(window_);
    return true;
  }
  bool is_lost() const override
  {
    return glGetGraphicsResetStatus() != GL_NO_ERROR;
  }
  void inject_loss() override
  {
    if (!reset_status_of_driver) {
      reset_status_of_driver = epoxy_glGetGraphicsResetStatus;
      epoxy_glGetGraphicsResetStatus = +[]() -> GLenum { return GL_GUILTY_CONTEXT_RESET; };
    }
  }

 private:
  DriverMessages messages_;
  GLFWwindow *window_ = nullptr;
  std::unique_ptr<gpu::Device> device_;
};

}  // namespace

std::unique_ptr<WindowDevice> open_gl_window(glm::ivec2 size_px, bool is_scripted, const DriverMessages &messages)
{
  return std::make_unique<GlWindow>(size_px, is_scripted, messages);
}

std::string glfw_reason()
{
  const char *reason = nullptr;
  glfwGetError(&reason);
  return reason ? reason : "no reason given";
}

}  // namespace gnomon::view
