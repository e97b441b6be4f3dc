// SPDX-License-Identifier: MIT
#include "view_app.hh"

#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <utility>

namespace gnomon::view {

namespace {

/** Choices of the gizmo and its orientation. */
void show_gizmo_choice(Document &document)
{
  constexpr std::array<const char *, 4> kinds = {"No gizmo", "Move", "Rotate", "Scale"};
  int kind = document.gizmo ? 1 + int(*document.gizmo) : 0;
  ImGui::SetNextItemWidth(90.0F);
  if (ImGui::Combo("##gizmo", &kind, kinds.data(), int(kinds.size()))) {
    document.gizmo = kind == 0 ? std::nullopt : std::optional(TransformKind(kind - 1));
  }
  constexpr std::array<const char *, 2> orientations = {"World", "Local"};
  int orientation = int(document.orientation);
  ImGui::SetNextItemWidth(70.0F);
  if (ImGui::Combo("##orientation", &orientation, orientations.data(), int(orientations.size()))) {
    document.orientation = Orientation(orientation);
  }
}

}  // namespace

void App::show_additions()
{
  const Addition *before = nullptr;
  for (const Addition &addition : additions()) {
    // Separate objects, lamps and camera.
    if (before && (before->is_lamp != addition.is_lamp)) {
      ImGui::Separator();
    }
    if (ImGui::MenuItem(addition.label)) {
      add(addition);
    }
    before = &addition;
  }
}

void App::show_addition_popup()
{
  if (std::exchange(is_addition_asked_, false)) {
    ImGui::OpenPopup("Add");
  }
  if (ImGui::BeginPopup("Add")) {
    if (document_) {
      show_additions();
    }
    ImGui::EndPopup();
  }
}

void App::show_edit_menu()
{
  const bool is_selected = document_->scene().nodes().is_live(document_->selected);
  if (ImGui::MenuItem("Undo", "Ctrl+Z", false, document_->history().undo_count() > 0)) {
    undo();
  }
  if (ImGui::MenuItem("Redo", "Ctrl+Shift+Z", false, document_->history().redo_count() > 0)) {
    redo();
  }
  ImGui::Separator();
  if (ImGui::MenuItem("Move", "G", false, is_selected)) {
    begin_transform(TransformKind::Move);
  }
  if (ImGui::MenuItem("Rotate", "R", false, is_selected)) {
    begin_transform(TransformKind::Rotate);
  }
  if (ImGui::MenuItem("Scale", "S", false, is_selected)) {
    begin_transform(TransformKind::Scale);
  }
  ImGui::Separator();
  if (ImGui::MenuItem("Duplicate", "Shift+D", false, is_selected)) {
    duplicate_selected();
  }
  if (ImGui::MenuItem("Remove", "X", false, is_selected)) {
    remove_selected();
  }
}

void App::show_view_menu()
{
  for (const int count : {1, 2, 4}) {
    const std::string text = count == 1 ? "One viewport" : fmt::format("{} viewports", count);
    if (ImGui::MenuItem(text.c_str(), nullptr, viewport_count() == count)) {
      set_viewport_count(count);
    }
  }
  ImGui::Separator();
  if (ImGui::MenuItem("Frame selected", ".")) {
    frame(false);
  }
  if (ImGui::MenuItem("Frame all", "Home")) {
    frame(true);
  }
  if (ImGui::MenuItem("Perspective / parallel", "5")) {
    active().navigation.toggle_orthographic();
  }
  if (ImGui::MenuItem("Scene's camera", "0")) {
    look_through_camera();
  }
  if (ImGui::MenuItem("Fly", "F")) {
    begin_fly();
  }
  ImGui::Separator();
  if (ImGui::MenuItem("Isolate selected", "/")) {
    isolate_selected();
  }
  if (ImGui::MenuItem("Hide selected here", "Shift+H")) {
    hide_selected();
  }
  if (ImGui::MenuItem("Show all here", "Alt+H", false, active().is_hiding(document_->scene()))) {
    active().show_all();
  }
  if (ImGui::MenuItem("Clip to a rectangle", "Alt+B", active().is_clipped())) {
    active().toggle_clip();
  }
  if (ImGui::MenuItem("X-ray: see and select through objects", "Alt+Z", active().reach == overlay::Reach::Through)) {
    toggle_reach();
  }
  if (ImGui::MenuItem("Areas select what is wholly inside", "Alt+W", active().extent == overlay::Extent::Whole)) {
    toggle_extent();
  }
  ImGui::Separator();
  ImGui::MenuItem("Lamps, cameras and gizmo", nullptr, &active().has_overlays);
  ImGui::MenuItem("Wireframe of unlit", "Shift+Z", &active().has_wireframe);
}

void App::show_menu()
{
  if (!ImGui::BeginMenuBar()) {
    return;
  }
  if (ImGui::BeginMenu("File")) {
    if (ImGui::MenuItem("Open...", "Ctrl+O")) {
      ask_open();
    }
    if (ImGui::MenuItem("Save as...", "Ctrl+S", false, document_ != nullptr)) {
      ask_save();
    }
    if (ImGui::MenuItem("Save picture...", nullptr, false, document_ != nullptr)) {
      ask("Save the viewport as EXR or PNG", default_path(".exr"), [this](const std::string &path) {
        try {
          save_picture(path);
        }
        catch (const std::exception &error) {
          report(error);
        }
      });
    }
    if (ImGui::MenuItem("Screenshot...")) {
      ask_screenshot();
    }
    if (ImGui::MenuItem("Quit")) {
      leave([this] { quit(); });
    }
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Edit", document_ != nullptr)) {
    show_edit_menu();
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Add", document_ != nullptr)) {
    show_additions();
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("View", document_ != nullptr)) {
    show_view_menu();
    ImGui::EndMenu();
  }
  if (document_) {
    ImGui::Separator();
    show_gizmo_choice(*document_);
  }
  ImGui::EndMenuBar();
}

}  // namespace gnomon::view
