// SPDX-License-Identifier: MIT
#include "view_window.hh"

#include "view_window_gl.hh"

#include "gpu_read.hh"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace gnomon::view {

namespace {

/** Debian's fonts-dejavu-core. Without it, the user interface has its own bitmap font. */
constexpr const char *font_path = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

Window &window_of(GLFWwindow *window)
{
  return *static_cast<Window *>(glfwGetWindowUserPointer(window));
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

Window::Window(gpu::Backend backend, glm::ivec2 size_px, bool is_scripted)
    : backend_(backend), is_scripted_(is_scripted)
{
  if (!glfwInit()) {
    throw std::runtime_error(fmt::format("view: no window: {}", glfw_reason()));
  }
  try {
    open(size_px);
    ImGui::CreateContext();
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr;
    float scale = 1.0F;
    glfwGetWindowContentScale(window(), &scale, nullptr);
    if (std::filesystem::exists(font_path)) {
      io.Fonts->AddFontFromFileTTF(font_path, 14.0F * scale);
    }
    set_style(scale);
    connect();
  }
  catch (...) {
    close();
    throw;
  }
}

Window::~Window()
{
  if (device_) {
    disconnect();
  }
  close();
}

void Window::close()
{
  device_.reset();
  if (ImGui::GetCurrentContext()) {
    ImGui::DestroyContext();
  }
  glfwTerminate();
  for (const DriverMessage &message : driver_messages_) {
    gpu::send_message({}, message.text);
  }
}

void Window::open(glm::ivec2 size_px)
{
  device_ = open_window(backend_, size_px, is_scripted_, [this](std::string_view text, bool is_error) {
    driver_messages_.push_back({std::string(text), is_error});
  });
  backend_ = device_->backend();
  glfwSetWindowUserPointer(window(), this);
  // The user interface's own callbacks, which it sets below, call these.
  glfwSetKeyCallback(window(), [](GLFWwindow *window, int key, int /*scancode*/, int action, int mods) {
    if (action != GLFW_RELEASE && !ImGui::GetIO().WantTextInput) {
      window_of(window).keys_.push_back({key, mods & (GLFW_MOD_SHIFT | GLFW_MOD_CONTROL | GLFW_MOD_ALT)});
    }
  });
  glfwSetDropCallback(window(), [](GLFWwindow *window, int count, const char **paths) {
    window_of(window).dropped_.insert(window_of(window).dropped_.end(), paths, paths + count);
  });
}

void Window::connect()
{
  renderer_.emplace(device());
  ImGui_ImplGlfw_InitForOther(window(), true);
}

void Window::disconnect()
{
  if (renderer_) {
    ImGui_ImplGlfw_Shutdown();
    renderer_.reset();
  }
}

void Window::make_context_anew()
{
  if (device_) {
    glfwGetWindowPos(window(), &lost_place_px_.x, &lost_place_px_.y);
    glfwGetWindowSize(window(), &lost_size_px_.x, &lost_size_px_.y);
    disconnect();
    device_.reset();
    title_.clear();
  }
  if (injected_failures_ > 0) {
    injected_failures_--;
    throw std::runtime_error("view: no window: injected by a script");
  }
  open(lost_size_px_);
  glfwSetWindowPos(window(), lost_place_px_.x, lost_place_px_.y);
  connect();
}

void Window::inject_context_loss(int failures)
{
  injected_failures_ = failures;
  device_->inject_loss();
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
  ImGui_ImplGlfw_NewFrame();
  if (!pointers_.empty()) {
    const Pointer pointer = pointers_.back();
    pointers_.pop_back();
    ImGuiIO &io = ImGui::GetIO();
#if IMGUI_VERSION_NUM >= 18700
    // Later than the event with the real place of the pointer, which the call above has added.
    io.AddMousePosEvent(float(pointer.at_px.x), float(pointer.at_px.y));
    io.AddMouseButtonEvent(ImGuiMouseButton_Left, pointer.is_down);
#else
    io.MousePos = {float(pointer.at_px.x), float(pointer.at_px.y)};
    io.MouseDown[ImGuiMouseButton_Left] = pointer.is_down;
#endif
  }
  ImGui::NewFrame();
}

void Window::end_frame()
{
  ImGui::Render();
  has_screen_ = false;
  const glm::ivec2 size = size_px();
  if (size.x == 0 || size.y == 0) {
    return;
  }
  if (const std::optional<WindowDevice::Screen> screen = device_->begin(size)) {
    renderer_->draw(screen->target, screen->size_px);
    has_screen_ = true;
  }
}

bool Window::swap()
{
  const glm::ivec2 size = size_px();
  // A window without pixels shows nothing.
  return std::exchange(has_screen_, false) ? device_->present() : size.x == 0 || size.y == 0;
}

std::vector<std::uint8_t> Window::read_pixels()
{
  const draw::TargetTexture picture(device(), "window", gpu::Format::RGBA8, size_px());
  renderer_->draw(picture.target(), size_px());
  return gpu::read_as<std::uint8_t>(device(), picture.texture());
}

bool Window::is_closed() const
{
  return glfwWindowShouldClose(window()) == GLFW_TRUE;
}

void Window::set_closed(bool is_closed)
{
  glfwSetWindowShouldClose(window(), is_closed ? GLFW_TRUE : GLFW_FALSE);
}

glm::ivec2 Window::size_px() const
{
  glm::ivec2 size(0);
  glfwGetFramebufferSize(window(), &size.x, &size.y);
  return size;
}

void Window::resize(glm::ivec2 size_px)
{
  glfwSetWindowSize(window(), size_px.x, size_px.y);
}

void Window::set_title(const std::string &title)
{
  // Each change of the title causes an event, which would end the next wait.
  if (title != title_) {
    title_ = title;
    glfwSetWindowTitle(window(), title.c_str());
  }
}

bool Window::is_key_down(int key) const
{
  return !ImGui::GetIO().WantTextInput && glfwGetKey(window(), key) == GLFW_PRESS;
}

void Window::capture_pointer(bool is_captured)
{
  glfwSetInputMode(window(), GLFW_CURSOR, is_captured ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
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

std::vector<DriverMessage> Window::take_driver_messages()
{
  return std::exchange(driver_messages_, {});
}

}  // namespace gnomon::view
