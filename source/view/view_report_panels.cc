// SPDX-License-Identifier: MIT
#include "view_panels.hh"

#include "eevee_frame_text.hh"
#include "gpu_read.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace gnomon::view {

namespace {

void show_text(const std::string &text)
{
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
}

PanelKey key_of(Document &document, const WindowViewport &viewport, int layer = 0)
{
  return {document.scene().revision(), document.settings_revision(), viewport.samples_drawn(), document.selected,
          layer};
}

/**
 * Show the first and the last sample of a picture only, so that the panel costs little time. A limit of error or time
 * may end the picture.
 */
bool is_worth_showing(const WindowViewport &viewport)
{
  return viewport.samples_drawn() <= 1 || viewport.is_complete();
}

void show_part(const eevee::FrameNode &node)
{
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  const bool is_leaf = node.children.empty();
  if (!node.is_made) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  }
  const bool is_open =
      ImGui::TreeNodeEx(node.what.c_str(), ImGuiTreeNodeFlags_SpanFullWidth | (is_leaf ? ImGuiTreeNodeFlags_Leaf : 0));
  if (ImGui::IsItemHovered() && !node.why.empty()) {
    ImGui::SetTooltip("%s", node.why.c_str());
  }
  ImGui::TableNextColumn();
  show_text(node.count ? fmt::format("{}", *node.count) : "");
  ImGui::TableNextColumn();
  show_text(node.bytes ? eevee::bytes_text(*node.bytes) : "");
  ImGui::TableNextColumn();
  show_text(node.seconds && node.is_made ? eevee::seconds_text(*node.seconds) : "");
  ImGui::TableNextColumn();
  show_text(node.why);
  if (!node.is_made) {
    ImGui::PopStyleColor();
  }
  if (is_open) {
    for (const eevee::FrameNode &child : node.children) {
      show_part(child);
    }
    ImGui::TreePop();
  }
}

/** The selected lamp in RenderScene::lamps. Empty: none, or eevee does not draw the picture of \a viewport. */
std::optional<std::size_t> selected_lamp(Document &document, WindowViewport &viewport)
{
  const auto lamps = document.render_scene().lamps();
  const auto lamp = std::ranges::find(lamps, document.selected, &scene::PlacedLamp::node);
  const bool is_drawn = document.eevee() && viewport.viewport() && viewport.engine == "eevee";
  return is_drawn && lamp != lamps.end() ? std::optional(std::size_t(lamp - lamps.begin())) : std::nullopt;
}

void show_density_box(Document &document)
{
  WindowSettings settings = document.settings();
  if (ImGui::Checkbox("Texel density over the picture", &settings.has_texel_density)) {
    document.set_settings(settings);
  }
}

void show_lines(const char *title, const std::vector<std::string> &lines)
{
  if (!lines.empty() && ImGui::CollapsingHeader(title, ImGuiTreeNodeFlags_DefaultOpen)) {
    for (const std::string &line : lines) {
      ImGui::TextWrapped("%s", line.c_str());
    }
  }
}

}  // namespace

void FramePanel::show(Document &document, WindowViewport &viewport)
{
  eevee::Engine *engine = document.eevee();
  if (!engine || !viewport.viewport() || viewport.engine != "eevee") {
    ImGui::TextDisabled("The list is of viewports that eevee draws.");
    return;
  }
  if (const PanelKey key = key_of(document, viewport);
      key != shown_ && (is_worth_showing(viewport) || shown_ == PanelKey{})) {
    report_ = eevee::Inspection(*engine, *viewport.viewport()).report();
    shown_ = key;
  }
  show_lines("Warnings", report_.warnings);
  show_lines("Limits", report_.limits);
  show_lines("The file", document.scene().warnings);
  const ImGuiTableFlags flags = ImGuiTableFlags_Resizable | ImGuiTableFlags_ScrollY | ImGuiTableFlags_ScrollX |
                                ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit;
  if (ImGui::BeginTable("frame", 5, flags)) {
    ImGui::TableSetupScrollFreeze(1, 1);
    for (const char *name : {"Part", "Count", "Bytes", "Time", "Why"}) {
      ImGui::TableSetupColumn(name);
    }
    ImGui::TableHeadersRow();
    for (const eevee::FrameNode &part : report_.tree.children) {
      show_part(part);
    }
    ImGui::EndTable();
  }
}

void ShadowPanel::show(Document &document, WindowViewport &viewport, gpu::Device &device)
{
  show_density_box(document);
  const std::optional<std::size_t> index = selected_lamp(document, viewport);
  if (!index) {
    ImGui::TextDisabled("Select a lamp, in a viewport that eevee draws.");
    return;
  }
  eevee::Engine *engine = document.eevee();
  std::vector<std::string> layers = eevee::Inspection(*engine, *viewport.viewport()).shadow_layers(*index);
  if (layers.empty()) {
    ImGui::TextDisabled("'%s' has no shadow that is seen.", document.render_scene().lamps()[*index].name.c_str());
    return;
  }
  layers.insert(layers.begin(), "all");
  layer_ = std::min(layer_, int(layers.size()) - 1);
  if (ImGui::BeginCombo("Layer", layers[std::size_t(layer_)].c_str())) {
    for (int i = 0; i < int(layers.size()); i++) {
      if (ImGui::Selectable(layers[std::size_t(i)].c_str(), i == layer_)) {
        layer_ = i;
      }
    }
    ImGui::EndCombo();
  }
  const PanelKey key = key_of(document, viewport, layer_);
  if (key != shown_ && (is_worth_showing(viewport) || key.selected != shown_.selected || layer_ != shown_.layer)) {
    read(*engine, viewport, *index, device);
    shown_ = key;
  }
  const glm::vec2 size_px(canvas_.size_px());
  const ImVec2 space = ImGui::GetContentRegionAvail();
  const glm::vec2 room(space.x, std::max(100.0F, space.y - ImGui::GetTextLineHeightWithSpacing()));
  canvas_.show(size_px * std::min(room.x / size_px.x, room.y / size_px.y));
  ImGui::TextDisabled("Near is dark, far is bright; %.0fx%.0f px", double(size_px.x), double(size_px.y));
}

void ShadowPanel::select(Document &document, WindowViewport &viewport, const std::string &text)
{
  const std::optional<std::size_t> lamp = selected_lamp(document, viewport);
  if (!lamp) {
    throw std::runtime_error("no lamp is selected in a viewport that eevee draws");
  }
  if (text == "all") {
    layer_ = 0;
    return;
  }
  const std::vector<std::string> layers =
      eevee::Inspection(*document.eevee(), *viewport.viewport()).shadow_layers(*lamp);
  const std::optional<std::size_t> layer = eevee::find_layer(layers, text);
  if (!layer) {
    throw std::runtime_error(fmt::format("the shadow of '{}' has no layer '{}'; it has: {}",
                                         document.render_scene().lamps()[*lamp].name, text,
                                         layers.empty() ? "none" : fmt::format("{}", fmt::join(layers, ", "))));
  }
  layer_ = int(*layer) + 1;
}

void ShadowPanel::close()
{
  canvas_.free();
  shown_ = {};
}

void ShadowPanel::read(eevee::Engine &engine, WindowViewport &viewport, std::size_t lamp, gpu::Device &device)
{
  const gpu::Texture &picture =
      eevee::Inspection(engine, *viewport.viewport())
          .shadow_picture(lamp, layer_ == 0 ? std::nullopt : std::optional(std::size_t(layer_ - 1)));
  const std::vector<float> values = gpu::read_as<float>(device, picture);
  std::vector<std::uint8_t> bytes(values.size());
  std::ranges::transform(values, bytes.begin(),
                         [](float value) { return std::uint8_t(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F))); });
  // The alpha channel has the distance in metres.
  for (std::size_t i = 3; i < bytes.size(); i += 4) {
    bytes[i] = 255;
  }
  canvas_.upload(device, {picture.desc().width, picture.desc().height}, bytes);
}

}  // namespace gnomon::view
