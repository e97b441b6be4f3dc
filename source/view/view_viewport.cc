// SPDX-License-Identifier: MIT
#include "view_viewport.hh"

#include "draw_target.hh"
#include "gpu_read.hh"
#include "render_camera.hh"

#include <imgui.h>

#include <cmath>

namespace gnomon::view {

namespace {

constexpr glm::vec4 outline_color(1.0F, 0.55F, 0.1F, 1.0F);
constexpr glm::vec4 backdrop(0.22F, 0.22F, 0.23F, 1.0F);
constexpr float lamp_radius_px = 6.0F;
/** Of a pointer that moves by the picture's height. */
constexpr double orbit_angle = 3.0;

}  // namespace

void Viewport::close()
{
  viewport_.reset();
  synced_ = {};
  is_complete_ = false;
}

void Viewport::look_at(const Document &document)
{
  const scene::Bounds bounds = document.scene().bounds();
  const std::vector<scene::PlacedCamera> cameras = document.scene().placed_cameras();
  if (cameras.empty()) {
    navigation.frame(bounds);
    return;
  }
  navigation.look_through(cameras.front(), bounds);
}

bool Viewport::draw(Document &document)
{
  render_scene::RenderScene &render_scene = document.render_scene();
  const Key key{document.scene().revision(), document.settings_revision(), engine, size_px_, render_scene.origin_ws()};
  const bool is_same = viewport_ && key == synced_;
  const bool is_synced = is_same && !has_failed_;
  const scene::PlacedCamera camera = navigation.camera(double(document.scene().bounds().radius()));
  const draw::View view = render_scene::view_of(camera, size_px_, render_scene.origin_ws());
  if (is_same && is_complete_ && view == drawn_view_ && outlined_ == document.selected) {
    return true;
  }
  // Noted first: what cannot be drawn is tried again when something changes.
  synced_ = key;
  drawn_view_ = view;
  outlined_ = document.selected;
  is_complete_ = true;
  has_failed_ = true;

  canvas_.resize(size_px_);
  canvas_.clear(backdrop);
  if (!viewport_) {
    viewport_ = std::make_unique<draw::Viewport>(device_, size_px_);
  }
  if (viewport_->size_px() != size_px_) {
    viewport_->resize(size_px_);
  }
  draw::Engine *one = &document.engine(engine);
  if (!is_synced) {
    viewport_->sync(std::span(&one, 1), render_scene.objects());
  }
  draw::Target target = canvas_.target();
  target.composition = draw::Composition::Over;
  target.view_transform = document.settings().view_transform;
  target.exposure = document.settings().exposure;
  viewport_->draw(std::span(&one, 1), view, target);
  document.overlay().draw_outline(view, size_px_, document.selected_nodes(), outline_color, target);
  auto *eevee = dynamic_cast<eevee::Engine *>(one);
  has_failed_ = false;
  is_complete_ = !eevee || eevee->is_complete(*viewport_);
  return is_complete_;
}

std::vector<float> Viewport::radiance(Document &document)
{
  const draw::TargetTexture picture(device_, "saved_picture", gpu::Format::RGBA32F, size_px_);
  draw::Target target = picture.target();
  target.encoding = draw::Encoding::SceneLinear;
  draw::Engine *one = &document.engine(engine);
  viewport_->draw(std::span(&one, 1), drawn_view_, target);
  return gpu::read_as<float>(device_, picture.texture());
}

std::optional<glm::vec2> Viewport::place_of(const scene::PlacedLamp &lamp) const
{
  const glm::vec4 clip = drawn_view_.clip_from_world() * glm::vec4(glm::vec3(lamp.world_from_lamp[3]), 1.0F);
  if (!(clip.w > 0.0F)) {
    return std::nullopt;
  }
  const glm::vec2 ndc = glm::vec2(clip) / clip.w;
  if (std::abs(ndc.x) > 1.0F || std::abs(ndc.y) > 1.0F) {
    return std::nullopt;
  }
  return glm::vec2(0.5F + 0.5F * ndc.x, 0.5F - 0.5F * ndc.y) * glm::vec2(size_px_);
}

void Viewport::pick(Document &document, glm::ivec2 pixel_px)
{
  for (const scene::PlacedLamp &lamp : document.render_scene().lamps()) {
    const std::optional<glm::vec2> place = place_of(lamp);
    if (place && glm::distance(*place, glm::vec2(pixel_px) + 0.5F) <= lamp_radius_px + 2.0F) {
      document.selected = lamp.node;
      return;
    }
  }
  const glm::ivec2 from_below(pixel_px.x, size_px_.y - 1 - pixel_px.y);
  const std::optional<overlay::Hit> hit = document.overlay().pick(drawn_view_, size_px_, from_below);
  document.selected = hit ? hit->node : scene::Handle<scene::Node>();
}

void Viewport::show_overlays(Document &document, glm::vec2 corner, glm::vec2 size)
{
  ImDrawList &list = *ImGui::GetWindowDrawList();
  list.PushClipRect({corner.x, corner.y}, {corner.x + size.x, corner.y + size.y}, true);
  for (const scene::PlacedLamp &lamp : document.render_scene().lamps()) {
    if (const std::optional<glm::vec2> place = place_of(lamp)) {
      const ImVec2 middle(corner.x + place->x, corner.y + place->y);
      const bool is_selected = lamp.node == document.selected;
      const ImU32 color = is_selected ? IM_COL32(255, 150, 40, 255) : IM_COL32(255, 245, 200, 220);
      list.AddCircle(middle, lamp_radius_px, IM_COL32(0, 0, 0, 160), 0, 3.5F);
      list.AddCircle(middle, lamp_radius_px, color, 0, 1.5F);
      list.AddCircleFilled(middle, 2.0F, color);
    }
  }
  list.PopClipRect();
}

void Viewport::take_pointer(Document &document, glm::vec2 corner)
{
  const ImGuiIO &io = ImGui::GetIO();
  const glm::dvec2 moved = glm::dvec2(io.MouseDelta.x, io.MouseDelta.y) / double(size_px_.y);
  const bool is_hovered = ImGui::IsItemHovered();
  if (is_hovered && io.MouseWheel != 0.0F) {
    navigation.zoom(std::pow(0.85, double(io.MouseWheel)));
  }
  if (ImGui::IsItemActivated()) {
    is_dragged_ = false;
  }
  if (ImGui::IsItemActive() && (io.MouseDelta.x != 0.0F || io.MouseDelta.y != 0.0F)) {
    // With Alt, the left button stands for the middle one, as Blender's emulation of three buttons.
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
  if (is_hovered && ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !is_dragged_ && !io.KeyAlt) {
    pick(document, glm::ivec2(int(io.MousePos.x - corner.x), int(io.MousePos.y - corner.y)));
  }
}

bool Viewport::show(Document &document, glm::vec2 size, bool is_active)
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
    show_overlays(document, corner, size);
  }
  if (is_active) {
    ImGui::GetWindowDrawList()->AddRect(at, {at.x + size.x, at.y + size.y}, IM_COL32(90, 130, 190, 255));
  }
  return is_hovered;
}

}  // namespace gnomon::view
