// SPDX-License-Identifier: MIT
#pragma once

#include "view.hh"
#include "view_document.hh"
#include "view_panels.hh"
#include "view_shader_watch.hh"
#include "view_viewport.hh"
#include "view_window.hh"

#include "gltf_background_import.hh"

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
  /** Whether all viewports have all their samples, and nothing is being opened. */
  [[nodiscard]] bool is_complete() const
  {
    return is_complete_ && !is_opening();
  }

  /** Open a file. A file that cannot be read is an error message, and what was open stays. \return whether it is open
   */
  bool open(const std::filesystem::path &path);
  /** The same in the background, while the window shows how far it is. An earlier one that is not done is cancelled. */
  void begin_open(const std::filesystem::path &path);
  /** A file that was dropped on the window: a picture lights the scene, others are opened in the background. */
  void drop(const std::filesystem::path &path);
  /**
   * Light the scene by an equirectangular picture. One that cannot be read is an error message, and the world stays.
   * \return whether it was read
   */
  bool set_world_picture(const std::filesystem::path &path);
  [[nodiscard]] bool is_opening() const
  {
    return opening_ != nullptr;
  }
  /** What is opened in the background is not to be opened. */
  void cancel_open();
  /**
   * Measure error against time of the active viewport's picture in the background. The tab Error shows it. A message
   * where that is not possible, and when it has ended.
   */
  void begin_measurement();
  /** \return false: nothing is being measured */
  bool cancel_measurement();
  /** \return whether it was written; otherwise there is an error message */
  bool save(const std::filesystem::path &path);
  /** The active viewport's picture: EXR is scene-linear, PNG the window's pixels of it. \throws std::runtime_error */
  void save_picture(const std::filesystem::path &path);
  /** Write the window at the end of the next frame, whose draw_frame throws std::runtime_error if that fails. */
  void request_screenshot(const std::filesystem::path &path)
  {
    screenshot_ = {.path = path};
    frames_to_draw_ = std::max(frames_to_draw_, 1);
  }
  /**
   * Compile the shaders of a folder, now and whenever a file of it changes. What is wrong with them is a message.
   * \throws std::runtime_error where there is no such folder
   */
  void use_shaders(const std::filesystem::path &folder);
  void quit()
  {
    is_quit_ = true;
  }
  /** As the button that closes the window: asks if edits are not saved. */
  void close()
  {
    window_.set_closed(true);
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
  void look_through_camera();

  /** Do what a key does. */
  void take_key(const KeyPress &press);
  /** Lets the selected node follow the pointer in the active viewport; a message where that is not possible. */
  void begin_transform(TransformKind kind);
  /** \a change: returns whether it has changed the operation. No effect where none has begun. */
  void change_transform(const std::function<bool(TransformOperation &operation)> &change);
  void end_transform(bool is_kept);
  /** At the point that the active viewport turns around; a camera where its eye is. \pre a document */
  void add(const Addition &addition);
  /** \return false: nothing is selected, which is a message */
  bool remove_selected();
  bool duplicate_selected();
  /** Keys and pointer move the eye of the active viewport, until Enter, Escape or a button. */
  void begin_fly();
  void end_fly(bool is_kept);
  /** Show a menu, or a window that asks for a path. */
  void ask_addition();
  void ask_open();
  /** \a then: what follows once it is saved */
  void ask_save(std::function<void()> then = {});
  void ask_screenshot();
  void ask_world_picture();

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
  /** Show a layer in the tab Shadow. \pre a document \see ShadowPanel::select */
  void show_layer(const std::string &name)
  {
    shadow_panel_.select(*document_, active(), name);
    frames_to_draw_ = 3;
  }

  void message(std::string text, bool is_error);
  /** A message about what could not be done. After gpu::DeviceLost, the context is made anew before the next frame. */
  void report(const std::exception &error);
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
  /** Of the window. */
  struct Screenshot {
    std::filesystem::path path;
    /** To be drawn before, until the question for the path is closed. */
    int frames = 0;
    /** A user has asked for it, so that a failure is a message. */
    bool is_asked = false;
  };
  /** Do what gives up the scene. If it has edits that are not saved, the user is asked before. */
  void leave(std::function<void()> action);
  void write_screenshot();
  /**
   * Wait for what is opened in the background, and show it. If the scene was edited meanwhile, the user is asked
   * before. \return false: it could not be read
   */
  bool finish_open();
  void finish_measurement();
  void show_document(scene::Scene scene);
  void make_device();
  /**
   * Replace the lost context, the device on it and all that is on the device. \throws std::runtime_error if that fails
   * several times: what was not saved is then written beside the scene's file, which the message names
   */
  void make_context_anew();
  /** Write the scene if it is not saved. \return a sentence about it; may be empty */
  [[nodiscard]] std::string rescue();
  void take_events();
  /** What is done before each frame, outside of the user interface. */
  void update_document();
  void step_fly();
  void update_shaders();
  void ask(std::string title, std::string path, std::function<void(const std::string &)> answer);
  [[nodiscard]] std::string default_path(const char *suffix) const;
  // view_menus.cc
  void show_menu();
  void show_edit_menu();
  void show_view_menu();
  void show_additions();
  void show_addition_popup();
  /** \throws output::Error where a picture cannot be written to \a path, or would replace a file that the window reads
   */
  void check_output(const std::filesystem::path &path) const;
  // view_layout.cc
  void show_window();
  void show_left(float height);
  void show_viewports(float width, float height);
  void show_viewport(std::size_t index, glm::vec2 size);
  void show_viewport_header(Viewport &viewport);
  void show_tabs();
  void show_status();
  void show_question();
  void show_leaving();
  void try_draw(Viewport &viewport);

  Options options_;
  Window window_;
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<Document> document_;
  /** nullptr: nothing is being opened. */
  std::unique_ptr<gltf::BackgroundImport> opening_;
  /** scene::Scene::revision of the document when the opening began: later edits are not given up without a question. */
  scene::Revision opening_revision_ = 0;
  /** To be shown by the next frame: the window of this one still uses the pictures of the scene that is open. */
  std::shared_ptr<scene::Scene> next_scene_;
  /** After the document, which they show. */
  std::vector<std::unique_ptr<Viewport>> viewports_;
  std::size_t active_ = 0;
  bool is_complete_ = true;
  /** The user interface takes some frames to settle after an event. */
  int frames_to_draw_ = 3;
  /** A call has thrown gpu::DeviceLost. */
  bool is_device_lost_ = false;
  bool is_quit_ = false;
  bool is_staying_ = false;
  std::vector<Message> messages_;
  int driver_error_count_ = 0;
  std::optional<Screenshot> screenshot_;
  /** Nothing: those of the build. */
  std::optional<ShaderWatch> shader_watch_;
  std::optional<PathQuestion> question_;
  bool is_question_new_ = false;
  /** What gives up the scene, while the user is asked; empty: nothing. */
  std::function<void()> leaving_;
  bool is_leaving_new_ = false;
  bool is_addition_asked_ = false;

  SceneTree scene_tree_;
  FramePanel frame_panel_;
  ShadowPanel shadow_panel_;
  ErrorPanel error_panel_;
  /** To be brought to the front. */
  std::string shown_tab_;
  float left_width_ = 230.0F;
  float right_width_ = 340.0F;
};

}  // namespace gnomon::view
