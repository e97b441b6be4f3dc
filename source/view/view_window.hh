// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

struct GLFWwindow;

namespace gnomon::view {

/** A key that was pressed: GLFW_KEY_… and a mask of GLFW_MOD_…. */
struct KeyPress {
  int key = 0;
  int mods = 0;

  bool operator==(const KeyPress &) const = default;
};

/** The window, its OpenGL context, which is current while it exists, and the user interface's state. One at a time. */
class Window {
 public:
  /**
   * \a is_debug: the driver reports its errors to take_driver_messages.
   * \throws std::runtime_error where there is no display, or no OpenGL 4.5 core context
   */
  Window(glm::ivec2 size_px, bool is_debug);
  Window(const Window &) = delete;
  Window &operator=(const Window &) = delete;
  ~Window();

  /**
   * Wait for an event, or take those that are there, and begin a frame of the user interface. \a seconds_max: waits no
   * longer; 0: without end
   */
  void begin_frame(bool waits, double seconds_max);
  /** Draw the user interface into the back buffer. */
  void end_frame();
  /** Show the back buffer. */
  void swap();
  /** The back buffer: rows from the bottom, four bytes each. */
  [[nodiscard]] std::vector<std::uint8_t> read_pixels() const;

  /** Whether the driver has lost the context. Nothing that is drawn is shown then. */
  [[nodiscard]] bool is_context_lost() const;
  /**
   * Replace window and context; place, size and the state of the user interface stay. Objects of the old context are
   * gone. \pre no frame of the user interface has begun \throws std::runtime_error as the constructor: there is no
   * window then, and all that may follow is another call or the destructor
   */
  void make_context_anew();
  /**
   * For scripts: until make_context_anew, the driver seems to report a reset of the GPU, and the first \a failures
   * calls of make_context_anew fail.
   */
  static void inject_context_loss(int failures);

  /** Whether the user has closed it. */
  [[nodiscard]] bool is_closed() const;
  /** Close it as the user does, or keep it open after that. */
  void set_closed(bool is_closed);
  [[nodiscard]] glm::ivec2 size_px() const;
  void resize(glm::ivec2 size_px);
  void set_title(const std::string &title);

  /** GLFW_KEY_…; false while a field of the user interface has the keys. */
  [[nodiscard]] bool is_key_down(int key) const;
  /** Hide the pointer, and let it move without end. */
  void capture_pointer(bool is_captured);

  /** Keys that were pressed since the last call, other than while a field of the user interface had them. */
  [[nodiscard]] std::vector<KeyPress> take_keys();
  /**
   * For scripts: in the next frames the pointer goes to \a from_px, its left button goes down, it goes to \a to_px, and
   * the button is released. Pixels from the upper left corner.
   */
  void drag_pointer(glm::ivec2 from_px, glm::ivec2 to_px);
  /** Number of frames that drag_pointer takes. */
  static constexpr int drag_frames = 5;

  /** Files that were dropped on the window. */
  [[nodiscard]] std::vector<std::filesystem::path> take_dropped();
  /** Errors that the driver reported. */
  [[nodiscard]] std::vector<std::string> take_driver_messages();

 private:
  struct Pointer {
    glm::ivec2 at_px{0};
    bool is_down = false;
  };
  /** The window with its context. \throws std::runtime_error */
  void open(glm::ivec2 size_px);
  /** Of the user interface to the window. */
  void connect();
  void disconnect();

  bool is_debug_;
  /** nullptr: there is none, as it could not be made anew. */
  GLFWwindow *window_ = nullptr;
  std::string title_;
  /** Of the window that was lost last. */
  glm::ivec2 lost_place_px_{0};
  glm::ivec2 lost_size_px_{0};
  std::vector<KeyPress> keys_;
  std::vector<std::filesystem::path> dropped_;
  /** States of the pointer that drag_pointer still has to show; the last element is the next. */
  std::vector<Pointer> pointers_;
  std::vector<std::string> driver_messages_;
};

}  // namespace gnomon::view
