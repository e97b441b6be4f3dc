// SPDX-License-Identifier: MIT
#pragma once

#include "view.hh"
#include "view_document.hh"
#include "view_panels.hh"
#include "view_viewport.hh"
#include "view_window.hh"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::view {

/** A line for the user. */
struct Message {
  std::string text;
  bool is_error = false;
};

/** The window with all that is in it. Its functions are what menus, keys and scripts do. */
class App {
 public:
  explicit App(const Options &options);
  ~App();

  /**
   * Take events, draw what has changed, and show it. \a may_wait: where another frame would show the same, first wait
   * for an event.
   */
  void draw_frame(bool may_wait);
  [[nodiscard]] bool is_closed() const
  {
    return is_quit_ || window_.is_closed();
  }
  /** Whether all viewports have all their samples. */
  [[nodiscard]] bool is_complete() const
  {
    return is_complete_;
  }

  /** Open a file. A file that cannot be read is an error message, and what was open stays. \return whether it is open
   */
  bool open(const std::filesystem::path &path);
  /** \return whether it was written; otherwise there is an error message */
  bool save(const std::filesystem::path &path);
  /** The active viewport's picture: EXR is scene-linear, PNG the window's pixels of it. \throws std::runtime_error */
  void save_picture(const std::filesystem::path &path);
  /** The window, at the end of the next frame. */
  void request_screenshot(const std::filesystem::path &path)
  {
    screenshot_ = path;
    frames_to_draw_ = std::max(frames_to_draw_, 1);
  }
  void quit()
  {
    is_quit_ = true;
  }
  /** Keep the window open after the script. */
  void stay()
  {
    is_staying_ = true;
  }
  [[nodiscard]] bool is_staying() const
  {
    return is_staying_;
  }
  void undo();
  void redo();
  void frame(bool is_all);

  /** 1, 2 or 4. */
  void set_viewport_count(int count);
  void set_active(int index)
  {
    active_ = std::size_t(index);
  }
  [[nodiscard]] int viewport_count() const
  {
    return int(viewports_.size());
  }
  [[nodiscard]] Viewport &active()
  {
    return *viewports_[active_];
  }
  /** nullptr: nothing is open. */
  [[nodiscard]] Document *document()
  {
    return document_.get();
  }
  [[nodiscard]] Window &window()
  {
    return window_;
  }
  /** Show the tab of that name on the right. \return false: there is none */
  bool show_tab(const std::string &name);

  void message(std::string text, bool is_error);
  [[nodiscard]] const std::vector<Message> &messages() const
  {
    return messages_;
  }
  /** Errors of the driver so far. */
  [[nodiscard]] int driver_error_count() const
  {
    return driver_error_count_;
  }

 private:
  /** A window that asks for a path. */
  struct PathQuestion {
    std::string title;
    std::string path;
    std::function<void(const std::string &)> answer;
  };
  void take_events();
  void take_key(const KeyPress &press);
  void ask(std::string title, std::string path, std::function<void(const std::string &)> answer);
  void ask_save();
  [[nodiscard]] std::string default_path(const char *suffix) const;
  // view_layout.cc
  void show_window();
  void show_menu();
  void show_left(float height);
  void show_viewports(float width, float height);
  void show_viewport(std::size_t index, glm::vec2 size);
  void show_tabs();
  void show_status();
  void show_question();
  void try_draw(Viewport &viewport);

  ImageWriters writers_;
  Window window_;
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<Document> document_;
  /** After the document, which they show. */
  std::vector<std::unique_ptr<Viewport>> viewports_;
  std::size_t active_ = 0;
  bool is_complete_ = true;
  /** The user interface takes some frames to settle after an event. */
  int frames_to_draw_ = 3;
  bool is_quit_ = false;
  bool is_staying_ = false;
  std::vector<Message> messages_;
  int driver_error_count_ = 0;
  std::filesystem::path screenshot_;
  std::optional<PathQuestion> question_;
  bool is_question_new_ = false;

  SceneTree scene_tree_;
  FramePanel frame_panel_;
  ShadowPanel shadow_panel_;
  /** To be brought to the front. */
  std::string shown_tab_;
  float left_width_ = 230.0F;
  float right_width_ = 340.0F;
};

}  // namespace gnomon::view
