// SPDX-License-Identifier: MIT
#pragma once

#include "view_imgui.hh"
#include "view_window_device.hh"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::view {

/** A pressed key: GLFW_KEY_… and a mask of GLFW_MOD_…. */
struct KeyPress {
  int key = 0;
  int mods = 0;

  bool operator==(const KeyPress &) const = default;
};

/** A message of the driver or of the device. */
struct DriverMessage {
  std::string text;
  bool is_error = false;
};

/**
 * The window, its device and the state of the user interface. With OpenGL, the context is current while the object
 * exists. Only one object may exist at a time.
 */
class Window {
 public:
  /** \see open_window \throws std::runtime_error if there is no display, or as open_window */
  Window(gpu::Backend backend, glm::ivec2 size_px, bool is_scripted);
  Window(const Window &) = delete;
  Window &operator=(const Window &) = delete;
  ~Window();

  /** \pre there is a window, as for all functions but make_context_anew */
  [[nodiscard]] gpu::Device &device()
  {
    return device_->device();
  }
  /** The graphics API of the device: OpenGl or Vulkan. */
  [[nodiscard]] gpu::Backend backend() const
  {
    return backend_;
  }

  /**
   * Process pending events and begin a frame of the user interface. \a waits: first wait for an event. \a seconds_max:
   * maximum wait; 0: no limit.
   */
  void begin_frame(bool waits, double seconds_max);
  /** Draw the user interface into the back buffer. \throws gpu::Error */
  void end_frame();
  /** Show the back buffer. \return false: the frame may not be seen, and is to be drawn again \throws gpu::Error */
  bool swap();
  /** Pixels of the last frame: rows from the bottom, four bytes for each pixel. \throws gpu::Error */
  [[nodiscard]] std::vector<std::uint8_t> read_pixels();

  /** Whether the driver has lost the context. Drawing then has no effect. */
  [[nodiscard]] bool is_context_lost() const
  {
    return device_->is_lost();
  }
  /**
   * Replace window, context and device. Position, size and the state of the user interface stay; resources of the old
   * device must be destroyed before. \pre no frame of the user interface has begun \throws std::runtime_error as the
   * constructor; there is then no window, and only this function or the destructor may be called
   */
  void make_context_anew();
  /**
   * For scripts: simulate a GPU reset, reported until make_context_anew succeeds. The first \a failures calls of
   * make_context_anew fail.
   */
  void inject_context_loss(int failures);

  /** Whether the user has closed the window. */
  [[nodiscard]] bool is_closed() const;
  /** Mark the window as closed by the user, or clear that mark. */
  void set_closed(bool is_closed);
  [[nodiscard]] glm::ivec2 size_px() const;
  void resize(glm::ivec2 size_px);
  void set_title(const std::string &title);

  /** \a key: GLFW_KEY_…. Returns false while a field of the user interface has the keyboard focus. */
  [[nodiscard]] bool is_key_down(int key) const;
  /** Hide the pointer and let it move without limits. */
  void capture_pointer(bool is_captured);

  /** Keys pressed since the last call, except while a field of the user interface had the keyboard focus. */
  [[nodiscard]] std::vector<KeyPress> take_keys();
  /**
   * For scripts: during the next frames, move the pointer to \a from_px, press the left button, move to \a to_px, and
   * release the button. Pixels from the upper left corner.
   */
  void drag_pointer(glm::ivec2 from_px, glm::ivec2 to_px);
  /** Number of frames that drag_pointer takes. */
  static constexpr int drag_frames = 5;

  /** Files dropped on the window since the last call. */
  [[nodiscard]] std::vector<std::filesystem::path> take_dropped();
  /** Messages since the last call. */
  [[nodiscard]] std::vector<DriverMessage> take_driver_messages();

 private:
  struct Pointer {
    glm::ivec2 at_px{0};
    bool is_down = false;
  };
  [[nodiscard]] GLFWwindow *window() const
  {
    return device_->window();
  }
  /** The window with its device. \throws std::runtime_error */
  void open(glm::ivec2 size_px);
  /** Connect the user interface to the window. \throws gpu::Error */
  void connect();
  void disconnect();
  /** Destroy the window, and print messages that nobody has taken. */
  void close();

  /** At first that of the constructor, then that of the device. */
  gpu::Backend backend_;
  bool is_scripted_;
  std::vector<DriverMessage> driver_messages_;
  /** nullptr: make_context_anew has failed; it may also have failed where renderer_ is empty. */
  std::unique_ptr<WindowDevice> device_;
  std::optional<ImGuiBackend> renderer_;
  /** The back buffer of this frame has been drawn. */
  bool has_screen_ = false;
  /** Number of further calls of make_context_anew that fail. */
  int injected_failures_ = 0;
  std::string title_;
  /** The place of the window that was lost last. */
  glm::ivec2 lost_place_px_{0};
  glm::ivec2 lost_size_px_{0};
  std::vector<KeyPress> keys_;
  std::vector<std::filesystem::path> dropped_;
  /** States of the pointer that drag_pointer still has to show; the last element is the next. */
  std::vector<Pointer> pointers_;
};

}  // namespace gnomon::view
