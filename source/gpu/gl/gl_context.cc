// SPDX-License-Identifier: MIT
#include "gl_context.hh"

#include "gpu_error.hh"
#include "trace.hh"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <dlfcn.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <vector>

namespace gnomon::gpu {

namespace {

/** Reasons for which the tried kinds of context failed. */
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
    // Do not terminate the display: the whole process shares it, and other contexts would be destroyed.
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
  std::array<EGLint, 11> wanted = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_CONTEXT_OPENGL_DEBUG, is_debug ? EGL_TRUE : EGL_FALSE,
                                   // Required for glGetGraphicsResetStatus to report a reset of the GPU.
                                   EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET, EGL_NONE};
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, wanted.data());
  if (context == EGL_NO_CONTEXT) {
    // Try again without reset notification, which some drivers do not support.
    wanted[8] = EGL_NONE;
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, wanted.data());
  }
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

struct EglDevice {
  EGLDeviceEXT device = nullptr;
  /** For example "EGL device 0 (/dev/dri/card0)". */
  std::string name;
  bool is_software = false;
};

std::vector<EglDevice> egl_devices()
{
  const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto query_string = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  std::array<EGLDeviceEXT, 16> handles{};
  EGLint count = 0;
  std::vector<EglDevice> devices;
  if (!query_devices || !query_devices(EGLint(handles.size()), handles.data(), &count)) {
    return devices;
  }
  for (EGLint i = 0; i < count; i++) {
    EglDevice device{handles[std::size_t(i)], fmt::format("EGL device {}", i), true};
    const char *extensions = query_string ? query_string(device.device, EGL_EXTENSIONS) : nullptr;
    if (extensions) {
      device.is_software = std::strstr(extensions, "EGL_MESA_device_software") != nullptr;
      const char *file = std::strstr(extensions, "EGL_EXT_device_drm")
                             ? query_string(device.device, EGL_DRM_DEVICE_FILE_EXT)
                             : nullptr;
      device.name += device.is_software ? " (software)" : file ? fmt::format(" ({})", file) : "";
    }
    devices.push_back(std::move(device));
  }
  return devices;
}

std::unique_ptr<GlContext> create_on_devices(bool is_software, bool is_debug, Attempts &attempts)
{
  const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  bool is_found = false;
  for (const EglDevice &device : get_display ? egl_devices() : std::vector<EglDevice>()) {
    if (device.is_software != is_software) {
      continue;
    }
    is_found = true;
    if (auto context =
            create_on(get_display(EGL_PLATFORM_DEVICE_EXT, device.device, nullptr), device.name, is_debug, attempts)) {
      return context;
    }
  }
  if (!is_found) {
    attempts.push_back(fmt::format("EGL device: no {} device found", is_software ? "software" : "hardware"));
  }
  return nullptr;
}

std::unique_ptr<GlContext> create_on_hardware(bool is_debug, Attempts &attempts)
{
  // Mesa's environment variable that requests software rasterisation.
  const char *software = std::getenv("LIBGL_ALWAYS_SOFTWARE");
  if (software && *software && std::strcmp(software, "0") != 0 && std::strcmp(software, "false") != 0) {
    attempts.emplace_back("EGL device: LIBGL_ALWAYS_SOFTWARE is set");
    return nullptr;
  }
  return create_on_devices(false, is_debug, attempts);
}

std::unique_ptr<GlContext> create_on_software(bool is_debug, Attempts &attempts)
{
  return create_on_devices(true, is_debug, attempts);
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
  glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
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
  const trace::Span span("OpenGL context");
  Attempts attempts;
  for (const auto create : {create_on_hardware, create_surfaceless, create_on_software, create_hidden_window}) {
    if (auto context = create(is_debug, attempts)) {
      return context;
    }
  }
  throw TransientError("no OpenGL 4.5 context: {}", fmt::join(attempts, "; "));
}

namespace {

/**
 * Address of glXGetCurrentContext in a library that is already loaded; nullptr if there is none. Hosts may load the
 * library without making its symbols global, as GLFW does, so RTLD_DEFAULT does not suffice. Loads no library.
 */
void *loaded_glx_function()
{
  constexpr const char *name = "glXGetCurrentContext";
  if (void *function = dlsym(RTLD_DEFAULT, name)) {
    return function;
  }
  for (const char *library : {"libGLX.so.0", "libGL.so.1", "libGL.so"}) {
    if (void *handle = dlopen(library, RTLD_LAZY | RTLD_NOLOAD)) {
      void *function = dlsym(handle, name);
      // The library stays loaded, because the host holds a reference too.
      dlclose(handle);
      if (function) {
        return function;
      }
    }
  }
  return nullptr;
}

}  // namespace

const void *current_context()
{
  if (const void *context = eglGetCurrentContext()) {
    return context;
  }
  using GetCurrent = void *(*)();
  // The host may load the library later.
  static std::atomic<void *> found = nullptr;
  if (!found) {
    found = loaded_glx_function();
  }
  const auto get_current = reinterpret_cast<GetCurrent>(found.load());
  return get_current ? get_current() : nullptr;
}

}  // namespace gnomon::gpu
