// SPDX-License-Identifier: MIT
#include "view_panels.hh"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <memory>

namespace gnomon::view {

namespace {

const char *kind_of(const scene::Node &node)
{
  if (node.lamp) {
    return "lamp";
  }
  if (node.camera) {
    return "camera";
  }
  return node.meshes.empty() ? "" : "mesh";
}

bool contains(const std::string &text, const char *part)
{
  const std::string_view wanted(part);
  const auto is_same = [](char a, char b) { return std::tolower(a) == std::tolower(b); };
  return std::search(text.begin(), text.end(), wanted.begin(), wanted.end(), is_same) != text.end() || wanted.empty();
}

/** Show the images of a material; they cannot be edited. */
void show_textures(const scene::Scene &scene, const scene::Material &material)
{
  const std::vector<TextureLine> lines = texture_lines(scene, material);
  if (lines.empty() ||
      !ImGui::TreeNodeEx("Textures", ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_DefaultOpen)) {
    return;
  }
  if (ImGui::BeginTable("textures", 2)) {
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 8.0F * ImGui::GetFontSize());
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
    for (const TextureLine &line : lines) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(line.slot.c_str());
      ImGui::TableNextColumn();
      ImGui::TextWrapped("%s", line.image.c_str());
    }
    ImGui::EndTable();
  }
  ImGui::TreePop();
}

bool header(const std::string &text)
{
  return ImGui::CollapsingHeader(text.c_str(), ImGuiTreeNodeFlags_DefaultOpen);
}

}  // namespace

void SceneTree::show_node(Document &document, scene::Handle<scene::Node> handle)
{
  const scene::Scene &scene = document.scene();
  const scene::Node &node = scene.nodes()[handle];
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::PushID(int(handle.index));
  const bool is_leaf = !scene.first_child(handle) || *filter_ != '\0';
  const ImGuiTreeNodeFlags flags = ImGuiTreeNodeFlags_OpenOnArrow | ImGuiTreeNodeFlags_SpanAvailWidth |
                                   ImGuiTreeNodeFlags_DefaultOpen |
                                   (document.is_selected(handle) ? ImGuiTreeNodeFlags_Selected : 0) |
                                   (is_leaf ? ImGuiTreeNodeFlags_Leaf | ImGuiTreeNodeFlags_NoTreePushOnOpen : 0);
  const bool is_shown = scene.is_visible(handle);
  if (!is_shown) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  }
  const bool is_open = ImGui::TreeNodeEx("node", flags, "%s", node.name.empty() ? "(no name)" : node.name.c_str());
  if (!is_shown) {
    ImGui::PopStyleColor();
  }
  if (ImGui::IsItemClicked() && !ImGui::IsItemToggledOpen()) {
    document.select(handle, ImGui::GetIO().KeyShift);
  }
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", kind_of(node));
  ImGui::TableNextColumn();
  bool is_visible = node.is_visible;
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0.0F, 0.0F});
  if (ImGui::Checkbox("##visible", &is_visible)) {
    document.edit(handle, [&](scene::Node &edited) { edited.is_visible = is_visible; });
  }
  ImGui::PopStyleVar();
  if (is_open && !is_leaf) {
    for (scene::Handle<scene::Node> child = scene.first_child(handle); child; child = scene.next_sibling(child)) {
      show_node(document, child);
    }
    ImGui::TreePop();
  }
  ImGui::PopID();
}

void SceneTree::show(Document &document)
{
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::InputTextWithHint("##filter", "Filter", filter_, sizeof(filter_));
  if (!ImGui::BeginTable("tree", 3, ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg)) {
    return;
  }
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed);
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed);
  const scene::Scene &scene = document.scene();
  for (const auto &[handle, node] : scene.nodes()) {
    const bool is_row = *filter_ != '\0' ? contains(node.name, filter_) : !scene.parent(handle);
    if (is_row) {
      show_node(document, handle);
    }
  }
  ImGui::EndTable();
}

/** The rows of the node \a handle, which is selected. */
void show_node(Document &document, scene::Handle<scene::Node> handle)
{
  scene::Node node = document.scene().nodes()[handle];
  if (!header(fmt::format("Node: {}###node", node.name))) {
    return;
  }
  ImGui::PushID("placement");
  const Placement before = placement_of(node.parent_from_node);
  Placement placement = before;
  if (show_properties(placement)) {
    document.edit(handle,
                  [&](scene::Node &edited) { edited.parent_from_node = placed(edited.parent_from_node, placement); });
  }
  ImGui::PopID();
  node = document.scene().nodes()[handle];
  if (show_properties(node)) {
    document.edit(handle, [&](scene::Node &edited) { edited = node; });
  }
}

void show_lamp(Document &document, scene::Handle<scene::Lamp> handle)
{
  const scene::Lamp *lamp = document.scene().lamps().find(handle);
  if (!lamp || !header(fmt::format("Lamp: {}###lamp", lamp->name))) {
    return;
  }
  ImGui::PushID("lamp");
  scene::Lamp edited = *lamp;
  if (show_properties(edited)) {
    document.edit(handle, [&](scene::Lamp &one) { one = edited; });
  }
  ImGui::PushID("shadow");
  ShadowOfLamp shadow = document.shadow_of(edited);
  if (edited.kind != scene::LampKind::Hemi && show_properties(shadow)) {
    document.edit(handle, [&](scene::Lamp &one) { one.shadow = shadow.shadow; });
  }
  ImGui::PopID();
  ImGui::PopID();
}

void show_camera(Document &document, scene::Handle<scene::Camera> handle)
{
  const scene::Camera *camera = document.scene().cameras().find(handle);
  if (!camera || !header(fmt::format("Camera: {}###camera", camera->name))) {
    return;
  }
  ImGui::PushID("camera");
  scene::Camera edited = *camera;
  if (show_properties(edited)) {
    document.edit(handle, [&](scene::Camera &one) { one = edited; });
  }
  ImGui::PopID();
}

/** The materials of \a meshes, each once. */
void show_materials(Document &document, const std::vector<scene::Handle<scene::Mesh>> &meshes)
{
  const scene::Scene &scene = document.scene();
  std::vector<scene::Handle<scene::Material>> shown;
  for (const scene::Handle<scene::Mesh> mesh : meshes) {
    const scene::Mesh *value = scene.meshes().find(mesh);
    const scene::Material *material = value ? scene.materials().find(value->material) : nullptr;
    if (!material || std::ranges::find(shown, value->material) != shown.end()) {
      continue;
    }
    shown.push_back(value->material);
    ImGui::PushID(int(value->material.index));
    if (header(fmt::format("Material: {}###material", material->name))) {
      scene::Material edited = *material;
      if (show_properties(edited)) {
        document.edit(value->material, [&](scene::Material &one) { one = edited; });
      }
      show_textures(scene, edited);
    }
    ImGui::PopID();
  }
}

/** Where the last click met the selected node. */
void show_clicked(const Document &document)
{
  const overlay::Hit *hit = document.clicked();
  if (!hit || !header("Clicked point###clicked")) {
    return;
  }
  const glm::dvec3 &at = hit->position_ws;
  ImGui::TextUnformatted(fmt::format("Position {:.4f}, {:.4f}, {:.4f} m", at.x, at.y, at.z).c_str());
  if (!hit->triangle) {
    return;
  }
  const overlay::TrianglePoint &point = *hit->triangle;
  ImGui::TextWrapped("%s",
                     fmt::format("Triangle {} of {}", point.index, document.scene().meshes()[hit->mesh].name).c_str());
  ImGui::TextUnformatted(
      fmt::format("Weights {:.3f}, {:.3f}, {:.3f}", point.barycentric.x, point.barycentric.y, point.barycentric.z)
          .c_str());
  ImGui::TextUnformatted(fmt::format("UV {:.4f}, {:.4f}", point.uv.x, point.uv.y).c_str());
  ImGui::TextUnformatted(
      fmt::format("Normal {:.3f}, {:.3f}, {:.3f}", point.normal_ws.x, point.normal_ws.y, point.normal_ws.z).c_str());
}

void show_selection(Document &document)
{
  const scene::Handle<scene::Node> selected = document.selected;
  if (!document.scene().nodes().is_live(selected)) {
    ImGui::TextDisabled("Nothing is selected.");
    return;
  }
  show_node(document, selected);
  const scene::Node node = document.scene().nodes()[selected];
  show_lamp(document, node.lamp);
  show_camera(document, node.camera);
  show_materials(document, node.meshes);
  show_clicked(document);
}

bool show_world(Document &document)
{
  const bool has_world = document.scene().world().has_value();
  bool is_on = has_world;
  if (ImGui::Checkbox("Light from everywhere", &is_on) && is_on != has_world) {
    document.set_world(is_on ? std::optional(scene::World{}) : std::nullopt);
    return false;
  }
  const bool is_asked = ImGui::Button("Picture...");
  if (!has_world) {
    return is_asked;
  }
  scene::World world = *document.scene().world();
  if (const std::shared_ptr<const scene::WorldPicture> picture = world.picture) {
    ImGui::SameLine();
    if (ImGui::Button("No picture")) {
      document.set_world_picture(nullptr);
      return false;
    }
    ImGui::TextWrapped("%s",
                       fmt::format("{}, {}x{}", picture->path.empty() ? "A picture without a file" : picture->path,
                                   picture->width, picture->height)
                           .c_str());
  }
  else {
    ImGui::TextDisabled("The same from everywhere");
  }
  // The product of color, strength and picture may be too large where each of them is not.
  if (show_properties(world) && fault_of(world).empty()) {
    document.set_world(world);
  }
  return is_asked;
}

void show_settings(Document &document)
{
  WindowSettings settings = document.settings();
  if (show_properties(settings)) {
    document.set_settings(settings);
  }
}

}  // namespace gnomon::view
