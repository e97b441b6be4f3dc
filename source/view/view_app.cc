// SPDX-License-Identifier: MIT
#include "view_app.hh"

#include "output_roles.hh"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <thread>
#include <utility>

namespace gnomon::view {

namespace {

/** Number of frames after an event until the user interface has its final layout. */
constexpr int settling_frames = 3;
/** Number of attempts to create a context after a loss, and the pause between them. */
constexpr int context_attempts = 5;
constexpr std::chrono::milliseconds context_pause{500};

/** Whether the file extension is that of a world picture. */
bool is_picture(const std::filesystem::path &path)
{
  std::string suffix = path.extension().string();
  std::ranges::transform(suffix, suffix.begin(), [](unsigned char letter) { return char(std::tolower(letter)); });
  return suffix == ".hdr" || suffix == ".exr";
}

constexpr Side sides[] = {Side::Front, Side::Right, Side::Top, Side::Front};

}  // namespace

App::App(const Options &options) : options_(options), window_(options.backend, options.size_px, !options.script.empty())
{
  viewports_.push_back(std::make_unique<WindowViewport>());
  if (!options.shaders.empty()) {
    use_shaders(options.shaders);
  }
}

App::~App() = default;

void App::make_context_anew()
{
  const std::string_view lost = window_.backend() == gpu::Backend::Vulkan ? "The Vulkan device" : "The OpenGL context";
  end_fly(true);
  end_transform(true);
  for (const std::unique_ptr<WindowViewport> &viewport : viewports_) {
    viewport->close();
  }
  shadow_panel_.close();
  if (document_) {
    document_->leave_device();
  }
  for (int attempt = 1;; attempt++) {
    try {
      window_.make_context_anew();
      break;
    }
    catch (const std::exception &error) {
      if (attempt == context_attempts) {
        throw std::runtime_error(
            fmt::format("{} was lost, and none could be made. {}{}", lost, rescue(), error.what()));
      }
    }
    // A driver may need some time after a reset.
    std::this_thread::sleep_for(context_pause);
  }
  if (document_) {
    document_->use_device(window_.device());
  }
  is_device_lost_ = false;
  is_complete_ = false;
  message(fmt::format("{} was lost, and was made anew", lost), true);
}

std::string App::rescue()
{
  if (!document_ || document_->is_saved()) {
    return {};
  }
  const std::string path = default_path(".rescued.glb");
  try {
    const std::string left_out = document_->save(path);
    return fmt::format("The scene is saved as {}{}. ", path, left_out.empty() ? "" : ", without its " + left_out);
  }
  catch (const std::exception &error) {
    return fmt::format("The scene is not saved: {}. ", error.what());
  }
}

void App::message(std::string text, bool is_error)
{
  messages_.push_back({std::move(text), is_error});
  frames_to_draw_ = settling_frames;
}

void App::report(const std::exception &error)
{
  is_device_lost_ |= dynamic_cast<const gpu::DeviceLost *>(&error) != nullptr;
  message(error.what(), true);
}

bool App::open(const std::filesystem::path &path)
{
  begin_open(path);
  return finish_open();
}

void App::begin_open(const std::filesystem::path &path)
{
  opening_ = std::make_unique<gltf::BackgroundImport>(
      path, gltf::ImportOptions{.only_below = options_.only_below, .read_picture = options_.read_picture});
  opening_revision_ = document_ ? document_->scene().revision() : 0;
}

void App::drop(const std::filesystem::path &path)
{
  if (is_picture(path)) {
    set_world_picture(path);
  }
  else {
    begin_open(path);
  }
}

bool App::set_world_picture(const std::filesystem::path &path)
{
  if (!document_) {
    message("No scene is open", false);
    return false;
  }
  // The transform is a step of its own.
  end_transform(true);
  document_->history().end_gesture();
  try {
    document_->set_world_picture(std::make_shared<const scene::WorldPicture>(options_.read_picture(path)));
    message(fmt::format("{} lights the scene", path.string()), false);
    return true;
  }
  catch (const scene::InvalidEdit &fault) {
    message(fmt::format("{}: {}", path.string(), fault.what()), true);
  }
  catch (const std::exception &error) {
    report(error);
  }
  return false;
}

void App::cancel_open()
{
  if (opening_) {
    opening_->cancel();
  }
}

bool App::finish_open()
{
  const std::unique_ptr<gltf::BackgroundImport> opened = std::move(opening_);
  try {
    scene::Scene scene = Document::completed(opened->take());
    if (!document_ || document_->scene().revision() == opening_revision_) {
      show_document(std::move(scene));
    }
    else {
      leave([this, opened_scene = std::make_shared<scene::Scene>(std::move(scene))] { next_scene_ = opened_scene; });
    }
    return true;
  }
  catch (const gltf::ImportCancelled &cancelled) {
    message(cancelled.what(), false);
  }
  catch (const std::exception &error) {
    report(error);
  }
  return false;
}

void App::begin_measurement()
{
  if (!document_) {
    message("No scene is open", false);
    return;
  }
  try {
    error_panel_.begin(*document_, active(), window_.backend());
  }
  catch (const std::exception &error) {
    report(error);
  }
}

bool App::cancel_measurement()
{
  error_panel_.cancel();
  return error_panel_.is_measuring();
}

void App::finish_measurement()
{
  try {
    message(error_panel_.take(), false);
  }
  catch (const measure::Cancelled &cancelled) {
    message(cancelled.what(), false);
  }
  catch (const std::exception &error) {
    // App::report is not used: the measurement's context was lost, not the window's.
    message(error.what(), true);
  }
}

void App::show_document(scene::Scene scene)
{
  const WindowSettings settings = document_ ? document_->settings() : default_settings();
  end_fly(true);
  error_panel_.clear();
  for (const std::unique_ptr<WindowViewport> &viewport : viewports_) {
    viewport->close();
  }
  document_.reset();
  document_ = std::make_unique<Document>(window_.device(), std::move(scene), settings);
  time_line_.open(document_->scene());
  for (const std::unique_ptr<WindowViewport> &viewport : viewports_) {
    viewport->show_all();
    viewport->unclip();
    viewport->look_at(*document_);
  }
  const std::string &path = document_->scene().path;
  const std::size_t count = document_->scene().warnings.size();
  message(count == 0 ? fmt::format("{} is open", path) : fmt::format("{} is open, with {} warnings", path, count),
          false);
}

bool App::save(const std::filesystem::path &path)
{
  if (!document_) {
    return false;
  }
  try {
    const std::string left_out = document_->save(path);
    message(fmt::format("{} is written{}", path.string(), left_out.empty() ? "" : ", without its " + left_out), false);
    return true;
  }
  catch (const std::exception &error) {
    report(error);
    return false;
  }
}

void App::check_output(const std::filesystem::path &path) const
{
  namespace fs = std::filesystem;
  output::Roles roles;
  if (document_) {
    for (const std::string &file : document_->scene().files) {
      roles.add_input(file, "the scene's file");
    }
    const std::optional<scene::World> &world = document_->scene().world();
    if (world && world->picture) {
      roles.add_input(world->picture->path, "the world");
    }
  }
  roles.add_input(options_.script, "--script");
  std::error_code none;
  const fs::path shaders = shader_watch_ ? shader_watch_->folder() : fs::path();
  for (const fs::directory_entry &entry : fs::recursive_directory_iterator(shaders, none)) {
    roles.add_input(entry.path(), "the shader");
  }
  roles.add_output(path, "the picture");
}

void App::save_picture(const std::filesystem::path &path)
{
  if (!document_ || !active().viewport()) {
    throw std::runtime_error(fmt::format("{}: there is no picture to write", path.string()));
  }
  check_output(path);
  if (path.extension() == ".exr") {
    options_.writers.exr(path, active().size_px(), active().radiance(*document_));
  }
  else if (path.extension() == ".png") {
    options_.writers.png(path, active().size_px(), active().pixels());
  }
  else {
    throw std::runtime_error(fmt::format("{}: ends in neither .exr nor .png", path.string()));
  }
  message(fmt::format("{} is written", path.string()), false);
}

void App::use_shaders(const std::filesystem::path &folder)
{
  shader_watch_.emplace(folder);
  update_shaders();
}

void App::update_shaders()
{
  if (!shader_watch_ || !document_) {
    return;
  }
  const bool has_changed = shader_watch_->has_changed();
  if (!has_changed && document_->has_own_shaders()) {
    return;
  }
  const auto uses_eevee = [](const auto &viewport) { return viewport->viewport() && viewport->engine == "eevee"; };
  const auto found = std::ranges::find_if(viewports_, uses_eevee);
  std::vector<std::string> failures;
  if (found != viewports_.end()) {
    failures = document_->reload_shaders(*(*found)->viewport(), shader_watch_->files());
  }
  else {
    draw::Viewport none(window_.device(), glm::ivec2(1));
    failures = document_->reload_shaders(none, shader_watch_->files());
  }
  for (const std::string &failure : failures) {
    message(failure, true);
  }
  // No message when the same shaders are loaded again, for a new scene or a new context.
  if (failures.empty() && has_changed) {
    message(fmt::format("The shaders of {} are loaded", shader_watch_->folder().string()), false);
  }
}

void App::step_history(bool (Document::*step)(), const char *nothing)
{
  if (!document_) {
    return;
  }
  if (!((*document_).*step)()) {
    message(nothing, false);
    return;
  }
  // The step may restore matrices of another time.
  try {
    time_line_.pose_again(*document_);
  }
  catch (const scene::InvalidEdit &fault) {
    message(fault.what(), true);
  }
}

void App::undo()
{
  step_history(&Document::undo, "There is nothing to undo");
}

void App::redo()
{
  step_history(&Document::redo, "There is nothing to redo");
}

void App::frame(bool is_all)
{
  if (document_) {
    active().navigation.frame(is_all ? document_->scene().bounds() : document_->selected_bounds());
  }
}

void App::look_through_camera()
{
  if (document_) {
    active().look_at(*document_);
  }
}

void App::set_viewport_count(int count)
{
  end_fly(true);
  end_transform(true);
  while (viewports_.size() > std::size_t(count)) {
    viewports_.pop_back();
  }
  while (viewports_.size() < std::size_t(count)) {
    auto viewport = std::make_unique<WindowViewport>();
    viewport->navigation = viewports_.front()->navigation;
    if (document_) {
      viewport->navigation.look_from(sides[viewports_.size() % std::size(sides)]);
      viewport->navigation.frame(document_->scene().bounds());
    }
    viewports_.push_back(std::move(viewport));
  }
  active_ = std::min(active_, viewports_.size() - 1);
}

void App::ask(std::string title, std::string path, std::function<void(const std::string &)> answer)
{
  path.resize(4096);
  question_ = PathQuestion{std::move(title), std::move(path), std::move(answer)};
  is_question_new_ = true;
  leaving_ = nullptr;
}

void App::leave(std::function<void()> action)
{
  if (!document_ || document_->is_saved()) {
    action();
    return;
  }
  // Both capture the pointer, which the dialog needs.
  end_fly(true);
  end_transform(true);
  leaving_ = std::move(action);
  is_leaving_new_ = true;
  question_.reset();
}

std::string App::default_path(const char *suffix) const
{
  std::filesystem::path path = document_ ? document_->scene().path : "scene";
  return path.replace_extension().string() + suffix;
}

void App::ask_open()
{
  ask("Open", default_path(".glb"), [this](const std::string &path) { leave([this, path] { begin_open(path); }); });
}

void App::ask_save(std::function<void()> then)
{
  if (!document_) {
    return;
  }
  // The default path is not the opened file: an export lacks the parts that the import left out.
  ask("Save as glTF", default_path(".edited.glb"), [this, then = std::move(then)](const std::string &path) {
    if (save(path) && then) {
      then();
    }
  });
}

void App::ask_screenshot()
{
  ask("Save the window as PNG", default_path(".png"), [this](const std::string &path) {
    screenshot_ = {.path = path, .frames = 1, .is_asked = true};
    frames_to_draw_ = std::max(frames_to_draw_, 2);
  });
}

void App::write_screenshot()
{
  const Screenshot screenshot = *std::exchange(screenshot_, std::nullopt);
  try {
    check_output(screenshot.path);
    options_.writers.png(screenshot.path, window_.size_px(), window_.read_pixels());
  }
  catch (const std::exception &error) {
    if (!screenshot.is_asked) {
      throw;
    }
    report(error);
    return;
  }
  if (screenshot.is_asked) {
    message(fmt::format("{} is written", screenshot.path.string()), false);
  }
}

void App::ask_world_picture()
{
  ask("Light by an HDR or EXR picture", default_path(".hdr"),
      [this](const std::string &path) { set_world_picture(path); });
}

void App::take_events()
{
  const bool is_asking =
      question_ || leaving_ || is_addition_asked_ || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
  for (const KeyPress &press : window_.take_keys()) {
    if (!is_asking) {
      take_key(press);
    }
  }
  for (const std::filesystem::path &path : window_.take_dropped()) {
    if (is_picture(path)) {
      drop(path);
    }
    else {
      leave([this, path] { drop(path); });
    }
  }
  if (window_.is_closed() && document_ && !document_->is_saved()) {
    window_.set_closed(false);
    leave([this] { quit(); });
  }
  for (const DriverMessage &from_driver : window_.take_driver_messages()) {
    driver_error_count_ += from_driver.is_error ? 1 : 0;
    message(from_driver.text, from_driver.is_error);
  }
  step_fly();
  if (document_ && !document_->operation() && !ImGui::IsAnyItemActive()) {
    document_->history().end_gesture();
  }
}

void App::update_document()
{
  update_shaders();
  if (!document_) {
    return;
  }
  for (std::string &text : document_->reload_surface_functions()) {
    message(std::move(text), false);
  }
  try {
    time_line_.step(*document_, double(ImGui::GetIO().DeltaTime));
  }
  catch (const scene::InvalidEdit &fault) {
    message(fault.what(), true);
  }
  render_scene::RenderScene &render_scene = document_->render_scene();
  active().follow(*document_);
  const glm::dvec3 eye(active().navigation.camera(0.0).world_from_camera[3]);
  render_scene.set_origin(render_scene::origin_near(eye, render_scene.origin_ws(), render_scene.bounds()));
  render_scene.update();
  window_.set_title(fmt::format("{}{} - gnomon", document_->scene().path, document_->is_saved() ? "" : "*"));
}

void App::present(const std::function<void()> &work)
{
  try {
    work();
  }
  catch (const gpu::Error &error) {
    report(error);
    // Whatever the reason is, another window may show pictures.
    is_device_lost_ = true;
  }
}

void App::draw_frame(bool may_wait)
{
  // Drawing slows a running measurement down. Therefore the window also waits for events when a script runs.
  const bool waits = (may_wait || error_panel_.is_measuring()) && is_complete_ && frames_to_draw_ == 0;
  constexpr double progress_seconds = 0.05;
  constexpr double measurement_seconds = 0.5;
  constexpr double shader_seconds = 0.5;
  const bool has_functions = document_ && !document_->scene().surface_functions().empty();
  window_.begin_frame(waits, is_opening()                     ? progress_seconds
                             : error_panel_.is_measuring()    ? measurement_seconds
                             : shader_watch_ || has_functions ? shader_seconds
                                                              : 0.0);
  frames_to_draw_ = waits ? settling_frames : std::max(0, frames_to_draw_ - 1);
  take_events();
  if (opening_ && opening_->is_done() && !leaving_ && !question_) {
    finish_open();
  }
  if (const std::shared_ptr<scene::Scene> next = std::move(next_scene_)) {
    show_document(std::move(*next));
  }
  if (error_panel_.has_ended()) {
    finish_measurement();
  }
  // Frames follow each other while the scene moves.
  is_complete_ = !is_playing();
  try {
    update_document();
  }
  catch (const gpu::DeviceLost &error) {
    report(error);
  }
  show_window();
  present([this] { window_.end_frame(); });
  is_device_lost_ |= window_.is_context_lost();
  if (!is_device_lost_) {
    if (screenshot_ && screenshot_->frames-- == 0) {
      write_screenshot();
    }
    present([this] {
      if (!window_.swap()) {
        frames_to_draw_ = std::max(frames_to_draw_, 1);
      }
    });
  }
  lost_frames_ = is_device_lost_ ? lost_frames_ + 1 : 0;
  if (lost_frames_ > context_attempts) {
    throw std::runtime_error(fmt::format("{} frames in a row could not be shown. {}", lost_frames_, rescue()));
  }
  if (is_device_lost_) {
    make_context_anew();
  }
}

}  // namespace gnomon::view
