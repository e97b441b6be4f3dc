// SPDX-License-Identifier: MIT
#include "view_window.hh"

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace gnomon::view {

namespace {

/** Debian's fonts-dejavu-core. Without it, the user interface has its own bitmap font. */
constexpr const char *font_path = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

/** The driver's function while a loss is simulated. nullptr: no loss is simulated. */
PFNGLGETGRAPHICSRESETSTATUSPROC reset_status_of_driver = nullptr;
/** Number of further calls of make_context_anew that fail. */
int injected_failures = 0;

std::string glfw_reason()
{
  const char *reason = nullptr;
  glfwGetError(&reason);
  return reason ? reason : "no reason given";
}

Window &window_of(GLFWwindow *window)
{
  return *static_cast<Window *>(glfwGetWindowUserPointer(window));
}

void GLAPIENTRY take_debug_message(GLenum source, GLenum type, GLuint /*id*/, GLenum severity, GLsizei length,
                                   const GLchar *text, const void *messages)
{
  // A mistake in a shader's source is no error of the program; the device names its file and line.
  if (source == GL_DEBUG_SOURCE_SHADER_COMPILER) {
    return;
  }
  if (type == GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_HIGH) {
    static_cast<std::vector<std::string> *>(const_cast<void *>(messages))->emplace_back(text, std::size_t(length));
  }
}

void set_style(float scale)
{
  ImGui::StyleColorsDark();
  ImGuiStyle &style = ImGui::GetStyle();
  style.WindowRounding = 0.0F;
  style.FrameRounding = 3.0F;
  style.GrabRounding = 3.0F;
  style.WindowBorderSize = 0.0F;
  style.ItemSpacing = {6.0F, 4.0F};
  const auto set = [&](ImGuiCol color, float r, float g, float b) { style.Colors[color] = {r, g, b, 1.0F}; };
  set(ImGuiCol_WindowBg, 0.14F, 0.14F, 0.15F);
  set(ImGuiCol_ChildBg, 0.16F, 0.16F, 0.17F);
  set(ImGuiCol_MenuBarBg, 0.11F, 0.11F, 0.12F);
  set(ImGuiCol_FrameBg, 0.24F, 0.24F, 0.26F);
  set(ImGuiCol_FrameBgHovered, 0.30F, 0.30F, 0.33F);
  set(ImGuiCol_FrameBgActive, 0.36F, 0.36F, 0.40F);
  set(ImGuiCol_Header, 0.24F, 0.33F, 0.47F);
  set(ImGuiCol_HeaderHovered, 0.28F, 0.38F, 0.54F);
  set(ImGuiCol_HeaderActive, 0.30F, 0.42F, 0.60F);
  set(ImGuiCol_Button, 0.26F, 0.27F, 0.30F);
  set(ImGuiCol_Tab, 0.18F, 0.19F, 0.21F);
  set(ImGuiCol_TabActive, 0.24F, 0.33F, 0.47F);
  style.ScaleAllSizes(scale);
}

}  // namespace

Window::Window(glm::ivec2 size_px, bool is_debug) : is_debug_(is_debug)
{
  if (!glfwInit()) {
    throw std::runtime_error(fmt::format("view: no window: {}", glfw_reason()));
  }
  try {
    open(size_px);
  }
  catch (...) {
    glfwTerminate();
    throw;
  }
  ImGui::CreateContext();
  ImGuiIO &io = ImGui::GetIO();
  io.IniFilename = nullptr;
  float scale = 1.0F;
  glfwGetWindowContentScale(window_, &scale, nullptr);
  if (std::filesystem::exists(font_path)) {
    io.Fonts->AddFontFromFileTTF(font_path, 14.0F * scale);
  }
  set_style(scale);
  connect();
}

Window::~Window()
{
  if (window_) {
    disconnect();
  }
  ImGui::DestroyContext();
  glfwTerminate();
}

void Window::open(glm::ivec2 size_px)
{
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, is_debug_ ? GLFW_TRUE : GLFW_FALSE);
  // Required for glGetGraphicsResetStatus to report a reset of the GPU.
  glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
  window_ = glfwCreateWindow(size_px.x, size_px.y, "gnomon", nullptr, nullptr);
  if (!window_) {
    throw std::runtime_error(fmt::format("view: no window with an OpenGL 4.5 core context: {}", glfw_reason()));
  }
  glfwMakeContextCurrent(window_);
  // Scripts do not wait for the vertical refresh.
  glfwSwapInterval(is_debug_ ? 0 : 1);
  if (is_debug_) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(take_debug_message, &driver_messages_);
  }
  glfwSetWindowUserPointer(window_, this);
  // The user interface's own callbacks, which it sets below, call these.
  glfwSetKeyCallback(window_, [](GLFWwindow *window, int key, int /*scancode*/, int action, int mods) {
    if (action != GLFW_RELEASE && !ImGui::GetIO().WantTextInput) {
      window_of(window).keys_.push_back({key, mods & (GLFW_MOD_SHIFT | GLFW_MOD_CONTROL | GLFW_MOD_ALT)});
    }
  });
  glfwSetDropCallback(window_, [](GLFWwindow *window, int count, const char **paths) {
    window_of(window).dropped_.insert(window_of(window).dropped_.end(), paths, paths + count);
  });
}

void Window::connect()
{
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init();
}

void Window::disconnect()
{
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
}

bool Window::is_context_lost() const
{
  return glGetGraphicsResetStatus() != GL_NO_ERROR;
}

void Window::make_context_anew()
{
  if (reset_status_of_driver) {
    epoxy_glGetGraphicsResetStatus = std::exchange(reset_status_of_driver, nullptr);
  }
  if (window_) {
    glfwGetWindowPos(window_, &lost_place_px_.x, &lost_place_px_.y);
    glfwGetWindowSize(window_, &lost_size_px_.x, &lost_size_px_.y);
    disconnect();
    glfwDestroyWindow(std::exchange(window_, nullptr));
    title_.clear();
  }
  if (injected_failures > 0) {
    injected_failures--;
    throw std::runtime_error("view: no window with an OpenGL 4.5 core context: injected by a script");
  }
  open(lost_size_px_);
  glfwSetWindowPos(window_, lost_place_px_.x, lost_place_px_.y);
  connect();
}

void Window::inject_context_loss(int failures)
{
  injected_failures = failures;
  if (!reset_status_of_driver) {
    reset_status_of_driver = epoxy_glGetGraphicsResetStatus;
    epoxy_glGetGraphicsResetStatus = +[]() -> GLenum { return GL_GUILTY_CONTEXT_RESET; };
  }
}

void Window::begin_frame(bool waits, double seconds_max)
{
  if (!waits) {
    glfwPollEvents();
  }
  else if (seconds_max > 0.0) {
    glfwWaitEventsTimeout(seconds_max);
  }
  else {
    glfwWaitEvents();
  }
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  if (!pointers_.empty()) {
    const Pointer pointer = pointers_.back();
    pointers_.pop_back();
    ImGui::GetIO().MousePos = {float(pointer.at_px.x), float(pointer.at_px.y)};
    ImGui::GetIO().MouseDown[ImGuiMouseButton_Left] = pointer.is_down;
  }
  ImGui::NewFrame();
}

void Window::end_frame()
{
  ImGui::Render();
  glClearColor(0.14F, 0.14F, 0.15F, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::swap()
{
  glfwSwapBuffers(window_);
}

std::vector<std::uint8_t> Window::read_pixels() const
{
  const glm::ivec2 size = size_px();
  std::vector<std::uint8_t> rgba(4 * std::size_t(size.x) * std::size_t(size.y));
  glReadPixels(0, 0, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  return rgba;
}

bool Window::is_closed() const
{
  return glfwWindowShouldClose(window_) == GLFW_TRUE;
}

void Window::set_closed(bool is_closed)
{
  glfwSetWindowShouldClose(window_, is_closed ? GLFW_TRUE : GLFW_FALSE);
}

glm::ivec2 Window::size_px() const
{
  glm::ivec2 size(0);
  glfwGetFramebufferSize(window_, &size.x, &size.y);
  return size;
}

void Window::resize(glm::ivec2 size_px)
{
  glfwSetWindowSize(window_, size_px.x, size_px.y);
}

void Window::set_title(const std::string &title)
{
  // Each change of the title causes an event, which would end the next wait.
  if (title != title_) {
    title_ = title;
    glfwSetWindowTitle(window_, title.c_str());
  }
}

bool Window::is_key_down(int key) const
{
  return !ImGui::GetIO().WantTextInput && glfwGetKey(window_, key) == GLFW_PRESS;
}

void Window::capture_pointer(bool is_captured)
{
  glfwSetInputMode(window_, GLFW_CURSOR, is_captured ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
  // The user interface ignores a hidden pointer.
  int &flags = ImGui::GetIO().ConfigFlags;
  flags = is_captured ? flags | ImGuiConfigFlags_NoMouse : flags & ~ImGuiConfigFlags_NoMouse;
}

void Window::drag_pointer(glm::ivec2 from_px, glm::ivec2 to_px)
{
  // An item is pressed only if the pointer was over it in the frame before.
  pointers_ = {{to_px, false}, {to_px, true}, {from_px, true}, {from_px, false}};
  static_assert(drag_frames > 4);
}

std::vector<KeyPress> Window::take_keys()
{
  return std::exchange(keys_, {});
}

std::vector<std::filesystem::path> Window::take_dropped()
{
  return std::exchange(dropped_, {});
}

std::vector<std::string> Window::take_driver_messages()
{
  return std::exchange(driver_messages_, {});
}

}  // namespace gnomon::view
