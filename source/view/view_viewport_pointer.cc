// SPDX-License-Identifier: MIT
// The pointer in a viewport.
#include "view_viewport.hh"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

namespace gnomon::view {

namespace {

constexpr float lamp_radius_px = 6.0F;
/** The turn for a pointer that moves by the picture's height, radians. */
constexpr double orbit_angle = 3.0;

std::ptrdiff_t count_live(const scene::Scene &scene, std::span<const scene::Handle<scene::Node>> nodes)
{
  return std::ranges::count_if(nodes, [&](auto node) { return scene.nodes().is_live(node); });
}

}  // namespace

std::optional<glm::vec2> WindowViewport::place_of(const glm::dvec3 &position_ws) const
{
  const std::optional<glm::dvec2> pixel = map_.pixel_of(position_ws);
  const bool is_inside =
      pixel && pixel->x >= 0.0 && pixel->y >= 0.0 && pixel->x <= double(size_px_.x) && pixel->y <= double(size_px_.y);
  return is_inside ? std::optional(glm::vec2(*pixel)) : std::nullopt;
}

void WindowViewport::pick(Document &document, glm::ivec2 pixel_px, bool adds)
{
  const auto is_at = [&](const glm::dmat4 &world) {
    const std::optional<glm::vec2> place = place_of(glm::dvec3(world[3]));
    return place && glm::distance(*place, glm::vec2(pixel_px) + 0.5F) <= lamp_radius_px + 2.0F;
  };
  const auto select = [&](scene::Handle<scene::Node> node) {
    // The click met no surface.
    document.click(std::nullopt, adds);
    document.select(node, adds);
  };
  if (has_overlays) {
    for (const scene::PlacedLamp &lamp : document.scene().placed_lamps()) {
      if (is_at(lamp.world_from_lamp) && !is_hidden(document.scene(), lamp.node)) {
        select(lamp.node);
        return;
      }
    }
    for (const scene::PlacedCamera &camera : document.scene().placed_cameras()) {
      if (is_at(camera.world_from_camera) && document.scene().is_visible(camera.node) &&
          !is_hidden(document.scene(), camera.node)) {
        select(camera.node);
        return;
      }
    }
  }
  const glm::ivec2 from_below(pixel_px.x, size_px_.y - 1 - pixel_px.y);
  document.click(overlay_->pick(drawn_view_, size_px_, from_below), adds);
}

void WindowViewport::select_area(Document &document, std::span<const glm::dvec2> outline_px, bool adds)
{
  std::vector<glm::dvec2> from_below;
  for (const glm::dvec2 &corner : outline_px) {
    from_below.emplace_back(corner.x, double(size_px_.y) - corner.y);
  }
  std::vector<scene::Handle<scene::Node>> nodes = overlay_->select(drawn_view_, size_px_, from_below, reach, extent);
  const auto add = [&](scene::Handle<scene::Node> node, const glm::dmat4 &world) {
    const std::optional<glm::vec2> place = place_of(glm::dvec3(world[3]));
    if (place && overlay::is_inside(outline_px, glm::dvec2(*place)) && !is_hidden(document.scene(), node) &&
        std::ranges::find(nodes, node) == nodes.end()) {
      nodes.push_back(node);
    }
  };
  if (has_overlays) {
    for (const scene::PlacedLamp &lamp : document.scene().placed_lamps()) {
      add(lamp.node, lamp.world_from_lamp);
    }
    for (const scene::PlacedCamera &camera : document.scene().placed_cameras()) {
      if (document.scene().is_visible(camera.node)) {
        add(camera.node, camera.world_from_camera);
      }
    }
  }
  document.select(nodes, adds);
}

void WindowViewport::hide(const Document &document)
{
  std::ranges::copy_if(document.selection(), std::back_inserter(hidden_),
                       [&](auto node) { return std::ranges::find(hidden_, node) == hidden_.end(); });
}

void WindowViewport::clip(const glm::dvec2 &from_px, const glm::dvec2 &to_px)
{
  const auto upwards = [&](const glm::dvec2 &point) { return glm::dvec2(point.x, size_px_.y - point.y); };
  unclip();
  clip_planes_ws_ = overlay_->planes_around(drawn_view_, size_px_, upwards(from_px), upwards(to_px));
}

void WindowViewport::unclip()
{
  clip_planes_ws_.clear();
  is_clip_asked_ = false;
}

void WindowViewport::toggle_clip()
{
  const bool is_asked = !is_clipped() && !is_clip_asked_;
  unclip();
  is_clip_asked_ = is_asked;
}

void WindowViewport::isolate(const Document &document)
{
  isolated_ = is_isolated(document.scene()) ? std::vector<scene::Handle<scene::Node>>() : document.selection();
}

bool WindowViewport::is_isolated(const scene::Scene &scene) const
{
  return count_live(scene, isolated_) > 0;
}

bool WindowViewport::is_hiding(const scene::Scene &scene) const
{
  return is_isolated(scene) || count_live(scene, hidden_) > 0;
}

void WindowViewport::show_all()
{
  hidden_.clear();
  isolated_.clear();
}

bool WindowViewport::is_hidden(const scene::Scene &scene, scene::Handle<scene::Node> node) const
{
  bool is_shown = !is_isolated(scene);
  for (scene::Handle<scene::Node> one = node; one; one = scene.parent(one)) {
    if (std::ranges::find(hidden_, one) != hidden_.end()) {
      return true;
    }
    is_shown |= std::ranges::find(isolated_, one) != isolated_.end();
  }
  return !is_shown;
}

std::vector<glm::dvec2> WindowViewport::Area::outline_px() const
{
  if (is_lasso) {
    return points_px;
  }
  const auto corners = overlay::rectangle(points_px.front(), points_px.back());
  return {corners.begin(), corners.end()};
}

void WindowViewport::show_notes(const Document &document, glm::vec2 corner, glm::vec2 size) const
{
  const auto write = [&](float y, const std::string &text) {
    ImGui::GetWindowDrawList()->AddText(ImGui::GetFont(), ImGui::GetFontSize(), {corner.x + 8.0F, corner.y + y},
                                        IM_COL32(255, 255, 255, 255), text.c_str(), nullptr, size.x - 16.0F);
  };
  if (const auto isolated_count = count_live(document.scene(), isolated_); isolated_count > 0) {
    write(size.y - 24.0F, fmt::format("{} isolated: / shows all", isolated_count));
  }
  else if (const auto hidden_count = count_live(document.scene(), hidden_); hidden_count > 0) {
    write(size.y - 24.0F, fmt::format("{} hidden: Alt+H shows all", hidden_count));
  }
  if (is_clip_asked_ || is_clipped()) {
    write(size.y - 44.0F, is_clipped() ? "Clipped: Alt+B shows all" : "Drag a rectangle: it clips the view");
  }
  if (const auto node = dark_inside(); node && document.scene().nodes().is_live(*node)) {
    write(0.5F * size.y, fmt::format("All that is seen is the unlit back of {}: the eye may be inside. Home shows all.",
                                     document.scene().nodes()[*node].name));
  }
}

bool WindowViewport::take_area(Document &document, glm::vec2 corner)
{
  const ImGuiIO &io = ImGui::GetIO();
  if (!is_dragged_ && ImGui::IsItemActive() && ImGui::IsMouseDragging(ImGuiMouseButton_Left) && !io.KeyAlt) {
    const ImVec2 &from = io.MouseClickedPos[ImGuiMouseButton_Left];
    area_ = {{glm::dvec2(from.x - corner.x, from.y - corner.y)}, io.KeyCtrl && !is_clip_asked_};
    is_dragged_ = true;
  }
  if (!area_) {
    return false;
  }
  if (ImGui::IsMouseClicked(ImGuiMouseButton_Right)) {
    // The press stays used: is_dragged_.
    area_.reset();
    is_clip_asked_ = false;
    return true;
  }
  if (area_->is_lasso ? area_->points_px.back() != pointer_px_ : area_->points_px.size() == 1) {
    area_->points_px.push_back(pointer_px_);
  }
  area_->points_px.back() = pointer_px_;
  if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
    const Area area = *std::exchange(area_, std::nullopt);
    if (is_clip_asked_) {
      clip(area.points_px.front(), area.points_px.back());
    }
    else {
      select_area(document, area.outline_px(), io.KeyShift);
    }
  }
  return true;
}

void WindowViewport::show_area(glm::vec2 corner) const
{
  std::vector<ImVec2> points;
  for (const glm::dvec2 &point : area_->outline_px()) {
    points.emplace_back(corner.x + float(point.x), corner.y + float(point.y));
  }
  ImGui::GetWindowDrawList()->AddPolyline(points.data(), int(points.size()), IM_COL32(255, 255, 255, 220), true, 1.0F);
}

std::optional<Gizmo> WindowViewport::gizmo_of(Document &document) const
{
  if (!document.gizmo || !document.scene().nodes().is_live(document.selected) ||
      is_hidden(document.scene(), document.selected)) {
    return std::nullopt;
  }
  return Gizmo{document.scene().world_from_node(document.selected), *document.gizmo, document.orientation};
}

void WindowViewport::begin_transform(Document &document, TransformKind kind)
{
  document.begin_transform({kind, TransformAxis::All, document.orientation}, map_, pointer_px_);
  is_transforming_ = true;
  is_handle_dragged_ = false;
}

bool WindowViewport::drag_handle(Document &document, const glm::dvec2 &from_px, const glm::dvec2 &to_px)
{
  const std::optional<Gizmo> gizmo = gizmo_of(document);
  const std::optional<TransformAxis> axis = gizmo ? gizmo->handle_at(map_, from_px) : std::nullopt;
  if (!axis) {
    return false;
  }
  document.begin_transform({gizmo->kind, *axis, gizmo->orientation}, map_, from_px);
  document.operation()->point(to_px);
  document.update_transform();
  document.end_transform(true);
  return true;
}

void WindowViewport::show_lamps(Document &document, glm::vec2 corner, glm::vec2 size)
{
  ImDrawList &list = *ImGui::GetWindowDrawList();
  list.PushClipRect({corner.x, corner.y}, {corner.x + size.x, corner.y + size.y}, true);
  for (const scene::PlacedLamp &lamp : document.scene().placed_lamps()) {
    const std::optional<glm::vec2> place = place_of(glm::dvec3(lamp.world_from_lamp[3]));
    if (place && !is_hidden(document.scene(), lamp.node)) {
      const ImVec2 middle(corner.x + place->x, corner.y + place->y);
      const bool is_selected = document.is_selected(lamp.node);
      const ImU32 color = is_selected ? IM_COL32(255, 150, 40, 255) : IM_COL32(255, 245, 200, 220);
      list.AddCircle(middle, lamp_radius_px, IM_COL32(0, 0, 0, 160), 0, 3.5F);
      list.AddCircle(middle, lamp_radius_px, color, 0, 1.5F);
      list.AddCircleFilled(middle, 2.0F, color);
    }
  }
  list.PopClipRect();
}

bool WindowViewport::take_operation(Document &document)
{
  TransformOperation *operation = document.operation();
  is_transforming_ &= operation != nullptr;
  if (!is_transforming_) {
    return operation != nullptr;
  }
  const ImGuiIO &io = ImGui::GetIO();
  if (io.MouseDelta.x != 0.0F || io.MouseDelta.y != 0.0F) {
    operation->point(pointer_px_);
    document.update_transform();
  }
  const bool is_done =
      is_handle_dragged_ ? ImGui::IsMouseReleased(ImGuiMouseButton_Left) : ImGui::IsMouseClicked(ImGuiMouseButton_Left);
  if (is_done || ImGui::IsMouseClicked(ImGuiMouseButton_Right)) {
    document.end_transform(is_done);
    // The release of the button selects nothing.
    is_dragged_ = true;
  }
  return true;
}

void WindowViewport::take_navigation(bool is_hovered)
{
  const ImGuiIO &io = ImGui::GetIO();
  const glm::dvec2 moved = glm::dvec2(io.MouseDelta.x, io.MouseDelta.y) / double(size_px_.y);
  if (is_hovered && io.MouseWheel != 0.0F) {
    navigation.zoom(std::pow(0.85, double(io.MouseWheel)));
  }
  if (!ImGui::IsItemActive() || (io.MouseDelta.x == 0.0F && io.MouseDelta.y == 0.0F)) {
    return;
  }
  // Alt with the left button acts as the middle button, as in Blender's emulation of a three-button mouse.
  const bool turns =
      ImGui::IsMouseDown(ImGuiMouseButton_Middle) || (io.KeyAlt && ImGui::IsMouseDown(ImGuiMouseButton_Left));
  is_dragged_ |= turns || ImGui::IsMouseDragging(ImGuiMouseButton_Left);
  if (turns && io.KeyShift) {
    navigation.pan({moved.x, -moved.y});
  }
  else if (turns && io.KeyCtrl) {
    navigation.zoom(std::exp(2.0 * moved.y));
  }
  else if (turns) {
    navigation.orbit(-orbit_angle * moved);
  }
}

void WindowViewport::take_pointer(Document &document, glm::vec2 corner)
{
  const ImGuiIO &io = ImGui::GetIO();
  const bool is_hovered = ImGui::IsItemHovered();
  // Without a valid pointer position, transforms start in the middle of the picture.
  pointer_px_ = ImGui::IsMousePosValid() ? glm::dvec2(io.MousePos.x - corner.x, io.MousePos.y - corner.y)
                                         : 0.5 * glm::dvec2(size_px_);
  if (fly) {
    pointed_.reset();
    // The release of the button that ends the flight selects nothing.
    is_dragged_ = true;
    return;
  }
  const bool had_operation = std::exchange(had_operation_, document.operation() != nullptr);
  if (ImGui::IsItemActivated()) {
    // A press that ended the operation of another viewport selects nothing.
    is_dragged_ = had_operation;
  }
  if (take_operation(document)) {
    pointed_.reset();
    area_.reset();
    return;
  }
  if (!ImGui::IsItemActive()) {
    const std::optional<Gizmo> gizmo = is_hovered && has_overlays ? gizmo_of(document) : std::nullopt;
    pointed_ = gizmo ? gizmo->handle_at(map_, pointer_px_) : std::nullopt;
  }
  if (ImGui::IsItemActivated() && pointed_ && !io.KeyAlt && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
    document.begin_transform({*document.gizmo, *pointed_, document.orientation}, map_, pointer_px_);
    is_transforming_ = true;
    is_handle_dragged_ = true;
    is_dragged_ = true;
    return;
  }
  if (take_area(document, corner)) {
    return;
  }
  take_navigation(is_hovered);
  if (is_hovered && ImGui::IsItemDeactivated() && ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !is_dragged_ &&
      !io.KeyAlt) {
    pick(document, glm::ivec2(pointer_px_), io.KeyShift);
  }
}

bool WindowViewport::show(Document &document, glm::vec2 size, bool is_active)
{
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const glm::vec2 corner(at.x, at.y);
  set_size(glm::ivec2(size));
  canvas_.show(size);
  ImGui::SetCursorScreenPos(at);
  ImGui::InvisibleButton("picture", {size.x, size.y},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle);
  const bool is_hovered = ImGui::IsItemHovered();
  if (viewport_) {
    take_pointer(document, corner);
    if (area_) {
      show_area(corner);
    }
    if (has_overlays) {
      show_lamps(document, corner, size);
    }
    if (document.settings().has_texel_density && engine == "eevee") {
      show_density_scale(document, corner, size);
    }
    show_notes(document, corner, size);
    if (is_transforming_ && document.operation()) {
      const std::string text = document.operation()->text();
      ImGui::GetWindowDrawList()->AddText({at.x + 9.0F, at.y + 7.0F}, IM_COL32(0, 0, 0, 200), text.c_str());
      ImGui::GetWindowDrawList()->AddText({at.x + 8.0F, at.y + 6.0F}, IM_COL32(255, 255, 255, 255), text.c_str());
    }
  }
  if (is_active) {
    ImGui::GetWindowDrawList()->AddRect(at, {at.x + size.x, at.y + size.y}, IM_COL32(90, 130, 190, 255));
  }
  return is_hovered;
}

}  // namespace gnomon::view
