// SPDX-License-Identifier: MIT
// Edits of the scene and the camera, for keys, menus and scripts.
#include "view_app.hh"
#include "view_keys.hh"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <utility>

namespace gnomon::view {

void App::take_key(const KeyPress &press)
{
  if (active().fly) {
    if (press.key == GLFW_KEY_ENTER || press.key == GLFW_KEY_ESCAPE) {
      end_fly(press.key == GLFW_KEY_ENTER);
    }
    return;
  }
  if (document_ && document_->operation()) {
    run_transform_key(*this, press);
    return;
  }
  run_key(*this, press);
}

void App::begin_transform(TransformKind kind)
{
  const scene::Node *node = document_ ? document_->scene().nodes().find(document_->selected) : nullptr;
  if (!node || !active().viewport()) {
    message("Nothing is selected", false);
    return;
  }
  if (active().is_hidden(document_->scene(), document_->selected)) {
    message(fmt::format("{}: is hidden in this viewport", node->name), false);
    return;
  }
  try {
    active().begin_transform(*document_, kind);
  }
  catch (const std::exception &error) {
    report(error);
  }
}

void App::change_transform(const std::function<bool(TransformOperation &operation)> &change)
{
  TransformOperation *operation = document_ ? document_->operation() : nullptr;
  try {
    if (operation && change(*operation)) {
      document_->update_transform();
    }
  }
  catch (const std::exception &error) {
    report(error);
  }
}

void App::end_transform(bool is_kept)
{
  if (document_) {
    document_->end_transform(is_kept);
  }
}

void App::add(const Addition &addition)
{
  const Navigation &navigation = active().navigation;
  document_->add(addition, navigation.target_ws(), navigation.camera(0.0).world_from_camera);
}

bool App::remove_selected()
{
  const bool is_removed = document_ && document_->remove_selected();
  if (!is_removed) {
    message("Nothing is selected", false);
  }
  return is_removed;
}

bool App::duplicate_selected()
{
  const bool is_duplicated = document_ && document_->duplicate_selected();
  if (!is_duplicated) {
    message("Nothing is selected", false);
  }
  return is_duplicated;
}

void App::hide_selected()
{
  if (!document_ || document_->selection().empty()) {
    message("Nothing is selected", false);
    return;
  }
  active().hide(*document_);
}

void App::isolate_selected()
{
  if (!document_ || (!active().is_isolated(document_->scene()) && document_->selection().empty())) {
    message("Nothing is selected", false);
    return;
  }
  active().isolate(*document_);
}

void App::toggle_reach()
{
  const bool is_through = active().reach == overlay::Reach::Through;
  active().reach = is_through ? overlay::Reach::Visible : overlay::Reach::Through;
  message(is_through ? "An area selects visible objects" : "An area selects visible and covered objects", false);
}

void App::toggle_extent()
{
  const bool is_whole = active().extent == overlay::Extent::Whole;
  active().extent = is_whole ? overlay::Extent::Part : overlay::Extent::Whole;
  message(
      is_whole ? "An area selects objects of which a part is inside" : "An area selects objects that are wholly inside",
      false);
}

void App::play(bool is_playing)
{
  if (time_line_.is_empty()) {
    message("The scene has no animation", false);
  }
  time_line_.play(is_playing);
}

void App::set_time(double seconds)
{
  if (time_line_.is_empty()) {
    throw std::runtime_error("the scene has no animation");
  }
  time_line_.set_time(*document_, seconds);
}

void App::begin_fly()
{
  if (document_) {
    active().fly.emplace(active().navigation);
    window_.capture_pointer(true);
    message("Fly: W A S D, Q and E to move; Shift: fast; wheel: speed; Enter or left button: stay; Escape: back",
            false);
  }
}

void App::end_fly(bool is_kept)
{
  if (std::optional<Fly> fly = std::exchange(active().fly, std::nullopt)) {
    active().navigation = is_kept ? active().navigation : fly->before();
    window_.capture_pointer(false);
  }
}

void App::step_fly()
{
  WindowViewport &viewport = active();
  if (!viewport.fly) {
    return;
  }
  const ImGuiIO &io = ImGui::GetIO();
  const auto is_down = [&](int key) { return window_.is_key_down(key) ? 1.0 : 0.0; };
  FlyInput input;
  input.direction = {is_down(GLFW_KEY_D) - is_down(GLFW_KEY_A), is_down(GLFW_KEY_E) - is_down(GLFW_KEY_Q),
                     is_down(GLFW_KEY_S) - is_down(GLFW_KEY_W)};
  input.looked = glm::dvec2(io.MouseDelta.x, io.MouseDelta.y) / double(viewport.size_px().y);
  input.wheel = double(io.MouseWheel);
  input.is_fast = io.KeyShift;
  input.seconds = double(io.DeltaTime);
  viewport.fly->step(viewport.navigation, input);
  // Held keys cause no events; draw frames continuously.
  frames_to_draw_ = std::max(frames_to_draw_, 1);
  const bool is_left = ImGui::IsMouseClicked(ImGuiMouseButton_Left);
  if (is_left || ImGui::IsMouseClicked(ImGuiMouseButton_Right)) {
    end_fly(is_left);
  }
}

void App::ask_addition()
{
  is_addition_asked_ = document_ != nullptr;
}

}  // namespace gnomon::view
