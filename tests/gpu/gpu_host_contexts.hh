// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device_fixture.hh"

#include <epoxy/egl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>

namespace gnomon::test {

/** An OpenGL context of a host: current on this thread until it is destroyed. A context of EGL that was, then is again.
 */
class HostContext {
 public:
  HostContext()
  {
    // GLX makes no context current beside one of EGL.
    if (context_before_ != EGL_NO_CONTEXT) {
      eglMakeCurrent(display_before_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
  }
  HostContext(const HostContext &) = delete;
  HostContext &operator=(const HostContext &) = delete;
  virtual ~HostContext()
  {
    if (context_before_ != EGL_NO_CONTEXT) {
      eglMakeCurrent(display_before_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_before_);
    }
  }
  [[nodiscard]] virtual bool is_current() const = 0;
  /** Calls \a work in another context, which shares objects with this one. \return false: there is none. */
  [[nodiscard]] virtual bool in_shared_context(const std::function<void()> &work) = 0;

 private:
  EGLDisplay display_before_ = eglGetCurrentDisplay();
  EGLContext context_before_ = eglGetCurrentContext();
};

class EglHostContext final : public HostContext {
 public:
  explicit EglHostContext(bool is_debug = false)
  {
    const auto get_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    display_ = get_display ? get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr) : EGL_NO_DISPLAY;
    if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) {
      return;
    }
    wanted_[7] = is_debug ? EGL_TRUE : EGL_FALSE;
    context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted_.data());
    if (context_ != EGL_NO_CONTEXT) {
      make_current();
    }
  }
  ~EglHostContext() override
  {
    if (context_ != EGL_NO_CONTEXT) {
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(display_, context_);
    }
  }
  void make_current() const
  {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
  }
  [[nodiscard]] bool is_current() const override
  {
    return context_ != EGL_NO_CONTEXT && eglGetCurrentContext() == context_;
  }
  [[nodiscard]] bool in_shared_context(const std::function<void()> &work) override
  {
    EGLContext shared = eglCreateContext(display_, EGL_NO_CONFIG_KHR, context_, wanted_.data());
    const bool is_current =
        shared != EGL_NO_CONTEXT && eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, shared);
    if (is_current) {
      work();
    }
    make_current();
    eglDestroyContext(display_, shared);
    return is_current;
  }

 private:
  std::array<EGLint, 9> wanted_ = {EGL_CONTEXT_MAJOR_VERSION,
                                   4,
                                   EGL_CONTEXT_MINOR_VERSION,
                                   5,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_CONTEXT_OPENGL_DEBUG,
                                   EGL_FALSE,
                                   EGL_NONE};
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

/** An X server without a screen, for windows of tests. */
class Xvfb {
 public:
  Xvfb()
  {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) {
      return;
    }
    process_ = fork();
    if (process_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      close(ends[0]);
      const std::string end = std::to_string(ends[1]);
      if (!freopen("/dev/null", "w", stderr)) {
        _exit(126);
      }
      execlp("Xvfb", "Xvfb", "-displayfd", end.c_str(), "-screen", "0", "640x480x24", "-nolisten", "tcp", nullptr);
      _exit(127);
    }
    close(ends[1]);
    // The server writes its number when it accepts connections.
    constexpr int timeout_ms = 30000;
    pollfd readable{.fd = ends[0], .events = POLLIN, .revents = 0};
    char digit = 0;
    while (poll(&readable, 1, timeout_ms) == 1 && read(ends[0], &digit, 1) == 1 && digit != '\n') {
      number_ += digit;
    }
    close(ends[0]);
  }
  Xvfb(const Xvfb &) = delete;
  Xvfb &operator=(const Xvfb &) = delete;
  ~Xvfb()
  {
    if (process_ > 0) {
      kill(process_, SIGTERM);
      waitpid(process_, nullptr, 0);
    }
  }
  /** ":7"; empty: the server did not start. */
  [[nodiscard]] std::string display() const
  {
    return number_.empty() ? "" : ":" + number_;
  }

 private:
  pid_t process_ = -1;
  std::string number_;
};

/** A window of GLFW with a context of GLX, on a server of its own. */
class GlxHostContext final : public HostContext {
 public:
  GlxHostContext()
  {
    if (server_.display().empty()) {
      reason_ = "Xvfb does not start";
      return;
    }
    setenv("DISPLAY", server_.display().c_str(), 1);
    if (!glfwInit()) {
      reason_ = "glfwInit fails";
      return;
    }
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_NATIVE_CONTEXT_API);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(64, 48, "host", nullptr, nullptr);
    if (!window_) {
      reason_ = "GLX gives no OpenGL 4.5 core context";
      return;
    }
    glfwMakeContextCurrent(window_);
  }
  ~GlxHostContext() override
  {
    glfwTerminate();
    unsetenv("DISPLAY");
  }
  [[nodiscard]] bool is_current() const override
  {
    return window_ && glfwGetCurrentContext() == window_;
  }
  [[nodiscard]] bool in_shared_context(const std::function<void()> &work) override
  {
    GLFWwindow *shared = glfwCreateWindow(16, 16, "shared", nullptr, window_);
    if (!shared) {
      return false;
    }
    glfwMakeContextCurrent(shared);
    work();
    glfwMakeContextCurrent(window_);
    glfwDestroyWindow(shared);
    return true;
  }
  /** The reason for which there is no context; empty if there is one. */
  [[nodiscard]] const std::string &reason() const
  {
    return reason_;
  }
  [[nodiscard]] GLFWwindow *window() const
  {
    return window_;
  }

 private:
  Xvfb server_;
  GLFWwindow *window_ = nullptr;
  std::string reason_;
};

enum class HostKind { Egl, EglDebug, Glx };

inline std::string name_of_host(const testing::TestParamInfo<HostKind> &parameter)
{
  return parameter.param == HostKind::Egl ? "Egl" : parameter.param == HostKind::EglDebug ? "EglDebug" : "Glx";
}

/** Base of test cases that run in a host's context of each kind; skipped, or failed where CI is set and EGL has none.
 */
class HostContextTest : public testing::TestWithParam<HostKind> {
 protected:
  void SetUp() override
  {
    if (testing_backend() != "gl") {
      GTEST_SKIP() << "of OpenGL alone";
    }
    std::string reason = "EGL gives no surfaceless context";
    if (GetParam() != HostKind::Glx) {
      context = std::make_unique<EglHostContext>(GetParam() == HostKind::EglDebug);
    }
    else {
      auto glx = std::make_unique<GlxHostContext>();
      reason = glx->reason();
      context = std::move(glx);
    }
    if (!context->is_current()) {
      const char *ci = std::getenv("CI");
      if (GetParam() != HostKind::Glx && ci && *ci) {
        FAIL() << "CI is set and " << reason;
      }
      GTEST_SKIP() << reason;
    }
  }

  std::unique_ptr<HostContext> context;
};

}  // namespace gnomon::test
