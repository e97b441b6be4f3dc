// SPDX-License-Identifier: MIT
#include "view_app.hh"

#include <fmt/format.h>
#include <imgui.h>

#include <utility>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::view {

namespace {

constexpr float splitter_width = 5.0F;
constexpr std::array<const char *, 6> tab_names = {"Object", "World", "Render", "Frame", "Shadow", "Error"};

/**
 * A bar that the user drags to change \a width. \a sign: -1 if the resized part is to the right of the bar, otherwise
 * 1.
 */
void show_splitter(const char *name, float height, float sign, float &width)
{
  ImGui::SameLine(0.0F, 0.0F);
  ImGui::InvisibleButton(name, {splitter_width, height});
  if (ImGui::IsItemHovered() || ImGui::IsItemActive()) {
    ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  }
  if (ImGui::IsItemActive()) {
    width = std::clamp(width + sign * ImGui::GetIO().MouseDelta.x, 120.0F, 700.0F);
  }
  ImGui::SameLine(0.0F, 0.0F);
}

}  // namespace

void App::try_draw(WindowViewport &viewport)
{
  try {
    // The menus, the tree and the viewports before this one may have edited the scene in this frame.
    document_->render_scene().update();
    const double budget_seconds = 1e-3 * double(document_->settings().budget_ms) / double(viewports_.size());
    is_complete_ &= viewport.draw(*document_, budget_seconds);
  }
  catch (const gpu::Error &error) {
    report(error);
  }
}

void App::show_viewport_header(WindowViewport &viewport)
{
  ImGui::SetNextItemWidth(80.0F);
  if (ImGui::BeginCombo("##engine", viewport.engine.c_str())) {
    for (const std::string &name : document_->engine_names()) {
      if (ImGui::Selectable(name.c_str(), name == viewport.engine)) {
        viewport.engine = name;
      }
    }
    ImGui::EndCombo();
  }
  ImGui::SameLine();
  ImGui::SetNextItemWidth(140.0F);
  if (ImGui::BeginCombo("##camera", "Camera")) {
    for (const scene::PlacedCamera &camera : document_->scene().placed_cameras()) {
      // Names are not unique.
      ImGui::PushID(int(camera.node.index));
      if (ImGui::Selectable(camera.name.c_str())) {
        viewport.look_through(*document_, camera);
      }
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }
  ImGui::SameLine();
  const int samples = viewport.engine == "eevee" ? document_->settings().eevee.sample_count : 1;
  const eevee::BudgetReport *report = viewport.budget_report();
  if (report && report->kind == eevee::BudgetReport::Kind::Preview) {
    ImGui::TextDisabled("%dx%d", report->drawn_size_px.x, report->drawn_size_px.y);
  }
  else {
    const std::optional<double> error = viewport.error();
    ImGui::TextDisabled("%d/%d%s", std::min(viewport.samples_drawn(), samples), samples,
                        error ? fmt::format(", error {:.2g}", *error).c_str() : "");
  }
  if (report && ImGui::IsItemHovered()) {
    ImGui::SetTooltip("%s", report->text().c_str());
  }
}

void App::show_viewport(std::size_t index, glm::vec2 size)
{
  WindowViewport &viewport = *viewports_[index];
  ImGui::PushID(int(index));
  ImGui::BeginChild("viewport", {size.x, size.y}, false, ImGuiWindowFlags_NoScrollbar);
  show_viewport_header(viewport);
  const ImVec2 space = ImGui::GetContentRegionAvail();
  const glm::vec2 picture = glm::max(glm::floor(glm::vec2(space.x, space.y)), 1.0F);
  viewport.set_size(glm::ivec2(picture));
  try_draw(viewport);
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  try {
    const bool is_pointed = viewport.show(*document_, picture, index == active_ && viewports_.size() > 1);
    if (is_pointed && (moved.x != 0.0F || moved.y != 0.0F) && !active().fly && !document_->operation()) {
      active_ = index;
    }
  }
  catch (const std::exception &error) {
    // The transform that the pointer asked for is not possible.
    document_->end_transform(false);
    report(error);
  }
  ImGui::EndChild();
  ImGui::PopID();
}

void App::show_viewports(float width, float height)
{
  if (!document_) {
    ImGui::BeginChild("empty", {width, height});
    ImGui::SetCursorPos({0.5F * width - 140.0F, 0.5F * height});
    ImGui::TextDisabled("Drop a glTF file here, or press Ctrl+O.");
    ImGui::EndChild();
    return;
  }
  const std::size_t count = viewports_.size();
  const float gap = 4.0F;
  const int columns = count > 1 ? 2 : 1;
  const int rows = count > 2 ? 2 : 1;
  const glm::vec2 size((width - gap * float(columns - 1)) / float(columns),
                       (height - gap * float(rows - 1)) / float(rows));
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {gap, gap});
  ImGui::BeginChild("viewports", {width, height}, false, ImGuiWindowFlags_NoScrollbar);
  for (std::size_t i = 0; i < count; i++) {
    if (i % std::size_t(columns) != 0) {
      ImGui::SameLine();
    }
    show_viewport(i, size);
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
}

void App::show_left(float height)
{
  ImGui::BeginChild("scene", {left_width_, height}, false, ImGuiWindowFlags_AlwaysUseWindowPadding);
  if (document_) {
    scene_tree_.show(*document_);
  }
  ImGui::EndChild();
}

void App::show_tabs()
{
  if (!document_ || !ImGui::BeginTabBar("tabs")) {
    return;
  }
  const std::string shown = std::exchange(shown_tab_, {});
  for (const char *name : tab_names) {
    if (!ImGui::BeginTabItem(name, nullptr, shown == name ? ImGuiTabItemFlags_SetSelected : 0)) {
      continue;
    }
    const std::string_view tab = name;
    try {
      if (tab == "Object") {
        show_selection(*document_);
      }
      else if (tab == "World") {
        if (show_world(*document_)) {
          ask_world_picture();
        }
      }
      else if (tab == "Render") {
        show_settings(*document_);
      }
      else if (tab == "Frame") {
        frame_panel_.show(*document_, active());
      }
      else if (tab == "Shadow") {
        shadow_panel_.show(*document_, active(), window_.device());
      }
      else if (error_panel_.show(*document_)) {
        begin_measurement();
      }
    }
    catch (const gpu::Error &error) {
      report(error);
    }
    ImGui::EndTabItem();
  }
  ImGui::EndTabBar();
}

bool App::show_tab(const std::string &name)
{
  const bool is_one =
      std::ranges::find(tab_names, name, [](const char *text) { return std::string(text); }) != tab_names.end();
  if (is_one) {
    shown_tab_ = name;
    frames_to_draw_ = 3;
  }
  return is_one;
}

void App::show_status()
{
  if (opening_) {
    ImGui::ProgressBar(opening_->progress(), {200.0F, ImGui::GetTextLineHeight()});
    ImGui::SameLine();
    if (ImGui::SmallButton("Cancel")) {
      opening_->cancel();
    }
    ImGui::SameLine();
    ImGui::Text("Opening %s", opening_->path().c_str());
    return;
  }
  if (messages_.empty()) {
    ImGui::TextDisabled("Middle button: turn.  Shift: move.  Wheel: zoom.  Left: select.");
    return;
  }
  const Message &last = messages_.back();
  if (last.is_error) {
    ImGui::PushStyleColor(ImGuiCol_Text, {1.0F, 0.45F, 0.35F, 1.0F});
  }
  // The status line shows one line; messages of compilers have several.
  std::string line = last.text;
  std::ranges::replace(line, '\n', ' ');
  ImGui::TextUnformatted(line.c_str());
  if (last.is_error) {
    ImGui::PopStyleColor();
  }
  if (ImGui::IsItemHovered()) {
    ImGui::BeginTooltip();
    const std::size_t first = messages_.size() - std::min<std::size_t>(messages_.size(), 20);
    for (std::size_t i = first; i < messages_.size(); i++) {
      ImGui::TextUnformatted(messages_[i].text.c_str());
    }
    ImGui::EndTooltip();
  }
}

void App::show_question()
{
  if (!question_) {
    return;
  }
  if (std::exchange(is_question_new_, false)) {
    ImGui::OpenPopup(question_->title.c_str());
  }
  ImGui::SetNextWindowSize({520.0F, 0.0F});
  if (!ImGui::BeginPopupModal(question_->title.c_str(), nullptr, ImGuiWindowFlags_NoResize)) {
    return;
  }
  if (ImGui::IsWindowAppearing()) {
    ImGui::SetKeyboardFocusHere();
  }
  ImGui::SetNextItemWidth(-1.0F);
  bool is_answered =
      ImGui::InputText("##path", question_->path.data(), question_->path.size(), ImGuiInputTextFlags_EnterReturnsTrue);
  is_answered |= ImGui::Button("OK", {90.0F, 0.0F});
  ImGui::SameLine();
  const bool is_cancelled = ImGui::Button("Cancel", {90.0F, 0.0F});
  if (is_answered || is_cancelled) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
  if (is_answered || is_cancelled) {
    const PathQuestion question = *std::exchange(question_, std::nullopt);
    if (is_answered) {
      question.answer(question.path.c_str());
    }
  }
}

void App::show_leaving()
{
  constexpr const char *title = "Edits are not saved";
  if (!leaving_ || !document_) {
    return;
  }
  if (std::exchange(is_leaving_new_, false)) {
    ImGui::OpenPopup(title);
  }
  ImGui::SetNextWindowSize({420.0F, 0.0F});
  if (!ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_NoResize)) {
    return;
  }
  ImGui::TextWrapped("%s has edits that are not saved.", document_->scene().path.c_str());
  const bool is_saved = ImGui::Button("Save...", {90.0F, 0.0F});
  ImGui::SameLine();
  const bool is_discarded = ImGui::Button("Discard", {90.0F, 0.0F});
  ImGui::SameLine();
  const bool is_cancelled =
      ImGui::Button("Cancel", {90.0F, 0.0F}) || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  if (is_saved || is_discarded || is_cancelled) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
  if (is_saved || is_discarded || is_cancelled) {
    std::function<void()> action = std::exchange(leaving_, nullptr);
    if (is_saved) {
      ask_save(std::move(action));
    }
    else if (is_discarded) {
      action();
    }
  }
}

void App::show_window()
{
  const glm::vec2 size(window_.size_px());
  ImGui::SetNextWindowPos({0.0F, 0.0F});
  ImGui::SetNextWindowSize({size.x, size.y});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {4.0F, 4.0F});
  ImGui::Begin("gnomon", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_MenuBar | ImGuiWindowFlags_NoScrollWithMouse);
  show_menu();
  const ImVec2 space = ImGui::GetContentRegionAvail();
  const bool has_time_line = document_ && !time_line_.is_empty();
  const float lines =
      ImGui::GetTextLineHeightWithSpacing() + (has_time_line ? ImGui::GetFrameHeightWithSpacing() : 0.0F);
  const float height = std::max(1.0F, space.y - lines);
  const float middle = std::max(1.0F, space.x - left_width_ - right_width_ - 2.0F * splitter_width);
  show_left(height);
  show_splitter("left", height, 1.0F, left_width_);
  show_viewports(middle, height);
  show_splitter("right", height, -1.0F, right_width_);
  ImGui::BeginChild("properties", {0.0F, height}, false, ImGuiWindowFlags_AlwaysUseWindowPadding);
  show_tabs();
  ImGui::EndChild();
  if (has_time_line) {
    try {
      time_line_.show(*document_);
    }
    catch (const scene::InvalidEdit &fault) {
      message(fault.what(), true);
    }
  }
  show_status();
  show_question();
  show_leaving();
  show_addition_popup();
  ImGui::End();
  ImGui::PopStyleVar();
}

}  // namespace gnomon::view
