// SPDX-License-Identifier: MIT
#pragma once

#include "view.hh"
#include "view_document.hh"
#include "view_panels.hh"
#include "view_shader_watch.hh"
#include "view_time_line.hh"
#include "view_viewport.hh"
#include "view_window.hh"

#include "gltf_background_import.hh"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::view {

/** A message to the user, shown in the status line. */
struct Message {
  std::string text;
  bool is_error = false;
};

/** The window with its document, viewports and panels. Menus, keys and scripts call its functions. */
class App {
 public:
  explicit App(const Options &options);
  ~App();

  /**
   * Process events, draw the changes, and present the frame. \a may_wait: wait for an event first if the frame
   * would not differ from the last.
   */
  void draw_frame(bool may_wait);
  [[nodiscard]] bool is_closed() const
  {
    return is_quit_ || window_.is_closed();
  }
  /** Whether all viewports have all their samples and no file is being opened. */
  [[nodiscard]] bool is_complete() const
  {
    return is_complete_ && !is_opening();
  }

  /**
   * Open a file. If it cannot be read, show an error message and keep the open scene. \return whether the file was
   * opened
   */
  bool open(const std::filesystem::path &path);
  /** Open a file in the background and show the progress. Cancels an earlier background opening. */
  void begin_open(const std::filesystem::path &path);
  /**
   * Use a file that was dropped on the window: a picture becomes the world's picture; any other file is opened in the
   * background.
   */
  void drop(const std::filesystem::path &path);
  /**
   * Light the scene by an equirectangular picture. If it cannot be read, show an error message and keep the world.
   * \return whether it was read
   */
  bool set_world_picture(const std::filesystem::path &path);
  [[nodiscard]] bool is_opening() const
  {
    return opening_ != nullptr;
  }
  /** Cancel opening. */
  void cancel_open();
  /**
   * Measure error against time for the active viewport's picture in the background. The tab Error shows the result. A
   * message tells when the measurement ends, or why it cannot begin.
   */
  void begin_measurement();
  /** \return false if no measurement is running */
  bool cancel_measurement();
  /** \return whether the file was written; if not, an error message is shown */
  bool save(const std::filesystem::path &path);
  /**
   * Write the active viewport's picture: EXR holds scene-linear radiance, PNG the pixels as displayed. \throws
   * std::runtime_error
   */
  void save_picture(const std::filesystem::path &path);
  /**
   * Write a picture of the window at the end of the next frame. That call of draw_frame throws std::runtime_error if
   * writing fails.
   */
  void request_screenshot(const std::filesystem::path &path)
  {
    screenshot_ = {.path = path};
    frames_to_draw_ = std::max(frames_to_draw_, 1);
  }
  /**
   * Compile the shaders of a folder, now and whenever one of its files changes. Errors in them are shown as messages.
   * \throws std::runtime_error if the folder does not exist
   */
  void use_shaders(const std::filesystem::path &folder);
  void quit()
  {
    is_quit_ = true;
  }
  /** Act as the window's close button: ask first if there are unsaved edits. */
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

  /** Run the action of a key. */
  void take_key(const KeyPress &press);
  /**
   * Start to transform the selected node with the pointer in the active viewport. Shows a message if that is not
   * possible.
   */
  void begin_transform(TransformKind kind);
  /** Play the time line, or stop it. A message says if the scene has no animation. */
  void play(bool is_playing);
  [[nodiscard]] bool is_playing() const
  {
    return time_line_.is_playing();
  }
  /** Pose the scene by the animation of the time line. \pre a document is open \throws std::runtime_error */
  void set_time(double seconds);
  /** Apply \a change, which returns whether it changed the operation. No effect without an operation. */
  void change_transform(const std::function<bool(TransformOperation &operation)> &change);
  void end_transform(bool is_kept);
  /** Add at the orbit centre; a camera at the eye. \pre a document is open */
  void add(const Addition &addition);
  /** \return false if no node is selected; a message says so */
  bool remove_selected();
  bool duplicate_selected();
  /** Leave the selected nodes out of the active viewport, or all others. A message says if none is selected. */
  void hide_selected();
  void isolate_selected();
  /** Areas in the active viewport select also covered objects, or again only visible ones. */
  void toggle_reach();
  void toggle_extent();
  /**
   * Start fly mode: keys and pointer move the eye of the active viewport until Enter, Escape or a mouse button ends it.
   */
  void begin_fly();
  void end_fly(bool is_kept);
  /** These functions open a menu or a dialog that asks for a path. */
  void ask_addition();
  void ask_open();
  /** \a then: called after the scene is saved */
  void ask_save(std::function<void()> then = {});
  void ask_screenshot();
  void ask_world_picture();

  /** \a count: 1, 2 or 4. */
  void set_viewport_count(int count);
  void set_active(int index)
  {
    active_ = std::size_t(index);
  }
  [[nodiscard]] int viewport_count() const
  {
    return int(viewports_.size());
  }
  [[nodiscard]] WindowViewport &active()
  {
    return *viewports_[active_];
  }
  /** nullptr: no document is open. */
  [[nodiscard]] Document *document()
  {
    return document_.get();
  }
  [[nodiscard]] Window &window()
  {
    return window_;
  }
  /** Show the tab \a name of the right panel. \return false if there is no such tab */
  bool show_tab(const std::string &name);
  /** Show a shadow layer in the tab Shadow. \pre a document is open \see ShadowPanel::select */
  void show_layer(const std::string &name)
  {
    shadow_panel_.select(*document_, active(), name);
    frames_to_draw_ = 3;
  }

  void message(std::string text, bool is_error);
  /** Show \a error as a message. After gpu::DeviceLost, the device is created again before the next frame. */
  void report(const std::exception &error);
  [[nodiscard]] const std::vector<Message> &messages() const
  {
    return messages_;
  }
  /** Number of errors that the driver has reported. */
  [[nodiscard]] int driver_error_count() const
  {
    return driver_error_count_;
  }

 private:
  /** A dialog that asks for a path. */
  struct PathQuestion {
    std::string title;
    std::string path;
    std::function<void(const std::string &)> answer;
  };
  /** A picture of the window that is to be written. */
  struct Screenshot {
    std::filesystem::path path;
    /** The number of frames to draw before, until the question for the path is closed. */
    int frames = 0;
    /** The user requested it: a failure is shown as a message. */
    bool is_asked = false;
  };
  /** Run an action that discards the scene; ask first if it is not saved. */
  void leave(std::function<void()> action);
  void write_screenshot();
  /**
   * Wait for the background opening and show its scene. If the open scene was edited meanwhile, ask first. \return
   * false if the file could not be read
   */
  bool finish_open();
  void finish_measurement();
  void show_document(scene::Scene scene);
  /**
   * Replace the lost context, its device and all resources of the device. \throws std::runtime_error if that fails
   * several times; unsaved edits are then written to a file beside the scene's file, and the message names it
   */
  void make_context_anew();
  /** Write the scene to a rescue file if it is not saved. \return a sentence that names the file; may be empty */
  [[nodiscard]] std::string rescue();
  /** Run \a work of the window. After a failure, which becomes a message, the device is created again. */
  void present(const std::function<void()> &work);
  void take_events();
  /** Bring the document up to date before each frame, outside of the user interface. */
  void update_document();
  void step_fly();
  /** Undo or redo. \a nothing: the message if there is no such step */
  void step_history(bool (Document::*step)(), const char *nothing);
  void update_shaders();
  void ask(std::string title, std::string path, std::function<void(const std::string &)> answer);
  [[nodiscard]] std::string default_path(const char *suffix) const;
  // view_menus.cc
  void show_menu();
  void show_edit_menu();
  void show_view_menu();
  void show_additions();
  void show_addition_popup();
  /** \throws output::Error if \a path cannot be written or is a file that the window reads */
  void check_output(const std::filesystem::path &path) const;
  // view_layout.cc
  void show_window();
  void show_left(float height);
  void show_viewports(float width, float height);
  void show_viewport(std::size_t index, glm::vec2 size);
  void show_viewport_header(WindowViewport &viewport);
  void show_tabs();
  void show_status();
  void show_question();
  void show_leaving();
  void try_draw(WindowViewport &viewport);

  Options options_;
  Window window_;
  std::unique_ptr<Document> document_;
  /** nullptr: no file is being opened. */
  std::unique_ptr<gltf::BackgroundImport> opening_;
  /**
   * scene::Scene::revision of the document when the opening began. Later edits are discarded only after confirmation.
   */
  scene::Revision opening_revision_ = 0;
  /** The scene for the next frame: the window of this one still uses the pictures of the open scene. */
  std::shared_ptr<scene::Scene> next_scene_;
  /** Declared after the document, because viewports must be destroyed before it. */
  std::vector<std::unique_ptr<WindowViewport>> viewports_;
  std::size_t active_ = 0;
  bool is_complete_ = true;
  /** The user interface takes some frames to settle after an event. */
  int frames_to_draw_ = 3;
  /** A call has thrown gpu::DeviceLost. */
  bool is_device_lost_ = false;
  /** Frames since the last one that was shown. */
  int lost_frames_ = 0;
  bool is_quit_ = false;
  bool is_staying_ = false;
  std::vector<Message> messages_;
  int driver_error_count_ = 0;
  std::optional<Screenshot> screenshot_;
  /** Empty: the shaders of the build are used. */
  std::optional<ShaderWatch> shader_watch_;
  std::optional<PathQuestion> question_;
  bool is_question_new_ = false;
  /** The action that discards the scene, while the user is asked; empty: there is none. */
  std::function<void()> leaving_;
  bool is_leaving_new_ = false;
  bool is_addition_asked_ = false;

  TimeLine time_line_;
  SceneTree scene_tree_;
  FramePanel frame_panel_;
  ShadowPanel shadow_panel_;
  ErrorPanel error_panel_;
  /** The tab to bring to the front. */
  std::string shown_tab_;
  float left_width_ = 230.0F;
  float right_width_ = 340.0F;
};

}  // namespace gnomon::view
