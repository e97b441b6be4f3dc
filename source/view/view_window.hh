// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

struct GLFWwindow;

namespace gnomon::view {

/** A pressed key: GLFW_KEY_… and a mask of GLFW_MOD_…. */
struct KeyPress {
  int key = 0;
  int mods = 0;

  bool operator==(const KeyPress &) const = default;
};

/**
 * The window, its OpenGL context and the state of the user interface. The context is current while the object exists.
 * Only one object may exist at a time.
 */
class Window {
 public:
  /**
   * \a is_debug: the driver reports its errors to take_driver_messages.
   * \throws std::runtime_error if there is no display or no OpenGL 4.5 core context
   */
  Window(glm::ivec2 size_px, bool is_debug);
  Window(const Window &) = delete;
  Window &operator=(const Window &) = delete;
  ~Window();

  /**
   * Process pending events and begin a frame of the user interface. \a waits: first wait for an event. \a seconds_max:
   * maximum wait; 0: no limit.
   */
  void begin_frame(bool waits, double seconds_max);
  /** Draw the user interface into the back buffer. */
  void end_frame();
  /** Show the back buffer. */
  void swap();
  /** The back buffer: rows from the bottom, four bytes each. */
  [[nodiscard]] std::vector<std::uint8_t> read_pixels() const;

  /** Whether the driver has lost the context. Drawing then has no effect. */
  [[nodiscard]] bool is_context_lost() const;
  /**
   * Replace window and context. Position, size and the state of the user interface stay; objects of the old context are
   * lost. \pre no frame of the user interface has begun \throws std::runtime_error as the constructor; there is then no
   * window, and only this function or the destructor may be called
   */
  void make_context_anew();
  /**
   * For scripts: simulate a GPU reset, reported until make_context_anew succeeds. The first \a failures calls of
   * make_context_anew fail.
   */
  static void inject_context_loss(int failures);

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
  /** Errors that the driver reported since the last call. */
  [[nodiscard]] std::vector<std::string> take_driver_messages();

 private:
  struct Pointer {
    glm::ivec2 at_px{0};
    bool is_down = false;
  };
  /** The window with its context. \throws std::runtime_error */
  void open(glm::ivec2 size_px);
  /** Connect the user interface to the window. */
  void connect();
  void disconnect();

  bool is_debug_;
  /** nullptr: make_context_anew has failed. */
  GLFWwindow *window_ = nullptr;
  std::string title_;
  /** The place of the window that was lost last. */
  glm::ivec2 lost_place_px_{0};
  glm::ivec2 lost_size_px_{0};
  std::vector<KeyPress> keys_;
  std::vector<std::filesystem::path> dropped_;
  /** States of the pointer that drag_pointer still has to show; the last element is the next. */
  std::vector<Pointer> pointers_;
  std::vector<std::string> driver_messages_;
};

}  // namespace gnomon::view
