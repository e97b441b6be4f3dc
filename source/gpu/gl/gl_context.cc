// SPDX-License-Identifier: MIT
#include "gl_context.hh"

#include "gpu_error.hh"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <vector>

namespace gnomon::gpu {

namespace {

/** Reasons gathered while one way after another fails. */
using Attempts = std::vector<std::string>;

bool has_extension(EGLDisplay display, const char *name)
{
  const char *all = eglQueryString(display, EGL_EXTENSIONS);
  return all && std::strstr(all, name);
}

class EglContext final : public GlContext {
 public:
  EglContext(EGLDisplay display, EGLContext context, std::string description)
      : display_(display), context_(context), description_(std::move(description))
  {
  }
  ~EglContext() override
  {
    if (eglGetCurrentContext() == context_) {
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    // The display is the process's: terminating it would take other contexts along.
    eglDestroyContext(display_, context_);
  }
  std::string description() const override
  {
    return description_;
  }

 private:
  EGLDisplay display_;
  EGLContext context_;
  std::string description_;
};

std::unique_ptr<GlContext> create_on(EGLDisplay display, const std::string &way, bool is_debug, Attempts &attempts)
{
  const auto failed = [&](std::string_view what) {
    attempts.push_back(fmt::format("{}: {} (EGL error 0x{:x})", way, what, eglGetError()));
    return nullptr;
  };
  if (display == EGL_NO_DISPLAY) {
    return failed("no display");
  }
  if (!eglInitialize(display, nullptr, nullptr)) {
    return failed("eglInitialize failed");
  }
  if (!has_extension(display, "EGL_KHR_surfaceless_context")) {
    return failed("no EGL_KHR_surfaceless_context");
  }
  if (!eglBindAPI(EGL_OPENGL_API)) {
    return failed("no desktop OpenGL");
  }
  const std::array<EGLint, 3> config_wanted = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = EGL_NO_CONFIG_KHR;
  EGLint config_count = 0;
  if (!has_extension(display, "EGL_KHR_no_config_context") &&
      (!eglChooseConfig(display, config_wanted.data(), &config, 1, &config_count) || config_count == 0)) {
    return failed("no config for OpenGL");
  }
  const std::array<EGLint, 9> wanted = {EGL_CONTEXT_MAJOR_VERSION,
                                        4,
                                        EGL_CONTEXT_MINOR_VERSION,
                                        5,
                                        EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                        EGL_CONTEXT_OPENGL_DEBUG,
                                        is_debug ? EGL_TRUE : EGL_FALSE,
                                        EGL_NONE};
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, wanted.data());
  if (context == EGL_NO_CONTEXT) {
    return failed("no OpenGL 4.5 core context");
  }
  if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    eglDestroyContext(display, context);
    return failed("eglMakeCurrent without a surface failed");
  }
  return std::make_unique<EglContext>(display, context, way);
}

template <typename Function>
Function egl_function(const char *name)
{
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

std::unique_ptr<GlContext> create_surfaceless(bool is_debug, Attempts &attempts)
{
  const std::string way = "EGL surfaceless";
  const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  if (!get_display || !has_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    attempts.push_back(way + ": no EGL_MESA_platform_surfaceless");
    return nullptr;
  }
  return create_on(get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr), way, is_debug, attempts);
}

std::unique_ptr<GlContext> create_on_device(bool is_debug, Attempts &attempts)
{
  const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  std::array<EGLDeviceEXT, 16> devices{};
  EGLint count = 0;
  if (!get_display || !query_devices || !query_devices(EGLint(devices.size()), devices.data(), &count) || count == 0) {
    attempts.emplace_back("EGL device: none found");
    return nullptr;
  }
  for (EGLint i = 0; i < count; i++) {
    const std::string way = fmt::format("EGL device {}", i);
    if (auto context = create_on(get_display(EGL_PLATFORM_DEVICE_EXT, devices[std::size_t(i)], nullptr), way, is_debug,
                                 attempts)) {
      return context;
    }
  }
  return nullptr;
}

class WindowContext final : public GlContext {
 public:
  explicit WindowContext(GLFWwindow *window) : window_(window) {}
  ~WindowContext() override
  {
    glfwDestroyWindow(window_);
  }
  std::string description() const override
  {
    return "hidden window";
  }

 private:
  GLFWwindow *window_;
};

std::unique_ptr<GlContext> create_hidden_window(bool is_debug, Attempts &attempts)
{
  const auto failed = [&](std::string_view what) {
    const char *reason = nullptr;
    glfwGetError(&reason);
    attempts.push_back(fmt::format("hidden window: {}{}{}", what, reason ? ": " : "", reason ? reason : ""));
    return nullptr;
  };
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) {
    return failed("neither DISPLAY nor WAYLAND_DISPLAY is set");
  }
  if (!glfwInit()) {
    return failed("glfwInit failed");
  }
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, is_debug ? GLFW_TRUE : GLFW_FALSE);
  GLFWwindow *window = glfwCreateWindow(16, 16, "gnomon", nullptr, nullptr);
  if (!window) {
    return failed("no OpenGL 4.5 core context");
  }
  glfwMakeContextCurrent(window);
  return std::make_unique<WindowContext>(window);
}

}  // namespace

std::unique_ptr<GlContext> create_headless_context(bool is_debug)
{
  Attempts attempts;
  for (const auto create : {create_surfaceless, create_on_device, create_hidden_window}) {
    if (auto context = create(is_debug, attempts)) {
      return context;
    }
  }
  throw Error("no OpenGL 4.5 context: {}", fmt::join(attempts, "; "));
}

bool has_current_context()
{
  if (eglGetCurrentContext() != EGL_NO_CONTEXT) {
    return true;
  }
  // A host that uses GLX has loaded it; nothing here should.
  using GetCurrent = void *(*)();
  const auto get_current = reinterpret_cast<GetCurrent>(dlsym(RTLD_DEFAULT, "glXGetCurrentContext"));
  return get_current && get_current();
}

}  // namespace gnomon::gpu
