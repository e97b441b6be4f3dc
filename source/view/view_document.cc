// SPDX-License-Identifier: MIT
#include "view_document.hh"

#include "gltf_export.hh"
#include "scene_studio.hh"
#include "shader_check_reflection.hh"
#include "unlit_engine.hh"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <unordered_set>

namespace gnomon::view {

/** Text of a surface function's file. Reads at most the allowed length. \throws std::runtime_error */
static std::string text_of(const std::string &path)
{
  // Opening a pipe might never end.
  if (!std::filesystem::is_regular_file(path)) {
    throw std::runtime_error(fmt::format("{}: is not a file", path));
  }
  std::ifstream stream(path, std::ios::binary);
  std::string text(scene::SurfaceFunction::text_bytes_max + 1, '\0');
  stream.read(text.data(), std::streamsize(text.size()));
  if (stream.bad()) {
    throw std::runtime_error(fmt::format("{}: cannot be read", path));
  }
  text.resize(std::size_t(stream.gcount()));
  return text;
}

Document::Document(gpu::Device &device, scene::Scene scene, const WindowSettings &settings)
    : scene_(std::move(scene)), settings_(settings), saved_revision_(scene_.revision())
{
  use_device(device);
}

void Document::leave_device()
{
  engines_.clear();
  registry_ = {};
  render_scene_.reset();
  has_own_shaders_ = false;
  // Panels and viewports then read data of the device again.
  settings_revision_++;
}

void Document::use_device(gpu::Device &device)
{
  render_scene_.emplace(device, scene_);
  registry_.add(eevee::engine_type(*render_scene_, settings_.eevee));
  registry_.add(unlit::engine_type(*render_scene_));
  engine_names_ = registry_.names();
}

scene::Scene Document::completed(scene::Scene scene)
{
  if (scene.is_lamp_default && !scene.world()) {
    scene.default_world = scene::studio_world(scene.placed_cameras().front().world_from_camera);
    scene.set_world(scene.default_world);
    scene.remove(scene.placed_lamps().front().node);
    scene.is_lamp_default = false;
  }
  return scene;
}

std::string Document::save(const std::filesystem::path &path)
{
  // Otherwise the end of the transform would be an unsaved edit.
  end_transform(true);
  std::string left_out = gltf::left_out_of_export(scene_.path);
  gltf::export_gltf(scene_, path);
  scene_.path = path.string();
  saved_revision_ = scene_.revision();
  return left_out;
}

draw::Engine &Document::engine(const std::string &name)
{
  std::unique_ptr<draw::Engine> &engine = engines_[name];
  if (!engine) {
    engine = registry_.create(name);
    if (auto *eevee = dynamic_cast<eevee::Engine *>(engine.get())) {
      eevee->set_settings(engine_settings(settings_));
    }
  }
  return *engine;
}

eevee::Engine *Document::eevee()
{
  const auto found = engines_.find("eevee");
  return found == engines_.end() ? nullptr : dynamic_cast<eevee::Engine *>(found->second.get());
}

std::vector<std::string> Document::reload_shaders(draw::Viewport &viewport, gpu::ShaderFiles files)
{
  auto &eevee = dynamic_cast<eevee::Engine &>(engine("eevee"));
  has_own_shaders_ = true;
  // Viewports sync again.
  settings_revision_++;
  return eevee.reload_shaders(viewport, std::move(files), shader_check::reflect);
}

std::vector<std::string> Document::reload_surface_functions()
{
  namespace fs = std::filesystem;
  std::vector<std::string> messages;
  for (const auto &[handle, function] : scene_.surface_functions()) {
    std::error_code error;
    const fs::file_time_type time =
        function.path.empty() ? fs::file_time_type() : fs::last_write_time(function.path, error);
    // The file may be missing while an editor replaces it; a later call reads it.
    if (function.path.empty() || error) {
      continue;
    }
    const auto [seen, is_new] = function_times_.try_emplace(handle, time);
    if (is_new || seen->second == time) {
      continue;
    }
    seen->second = time;
    const bool was_saved = is_saved();
    scene::SurfaceFunction changed = function;
    try {
      changed.text = text_of(function.path);
      scene_.replace(handle, std::move(changed));
      messages.push_back(fmt::format("The surface function {} is loaded", function.path));
    }
    catch (const std::exception &failure) {
      messages.push_back(failure.what());
    }
    if (was_saved) {
      saved_revision_ = scene_.revision();
    }
  }
  return messages;
}

void Document::set_settings(const WindowSettings &settings)
{
  settings_ = settings;
  settings_revision_++;
  if (eevee::Engine *engine = eevee()) {
    engine->set_settings(engine_settings(settings_));
  }
}

void Document::select(std::span<const scene::Handle<scene::Node>> nodes, bool adds)
{
  std::vector<scene::Handle<scene::Node>> all(nodes.begin(), nodes.end());
  if (adds) {
    const std::unordered_set<scene::Handle<scene::Node>> known(nodes.begin(), nodes.end());
    std::ranges::copy_if(selection(), std::back_inserter(all), [&](auto node) { return !known.contains(node); });
  }
  selected = all.empty() ? scene::Handle<scene::Node>() : all.front();
  others_.assign(all.begin() + (all.empty() ? 0 : 1), all.end());
  others_known_ = {others_.begin(), others_.end()};
}

std::vector<scene::Handle<scene::Node>> Document::selection() const
{
  std::vector<scene::Handle<scene::Node>> nodes = {selected};
  std::ranges::copy_if(others_, std::back_inserter(nodes), [&](auto node) { return node != selected; });
  std::erase_if(nodes, [&](auto node) { return !scene_.nodes().is_live(node); });
  return nodes;
}

bool Document::is_selected(scene::Handle<scene::Node> node) const
{
  return node == selected || others_known_.contains(node);
}

void Document::click(const std::optional<overlay::Hit> &hit, bool adds)
{
  select(hit ? hit->node : scene::Handle<scene::Node>(), adds);
  clicked_ = hit;
  clicked_revision_ = scene_.revision();
}

std::vector<scene::Handle<scene::Node>> Document::selected_nodes() const
{
  std::vector<scene::Handle<scene::Node>> nodes = selection();
  std::unordered_set<scene::Handle<scene::Node>> known(nodes.begin(), nodes.end());
  for (std::size_t i = 0; i < nodes.size(); i++) {
    for (scene::Handle<scene::Node> child = scene_.first_child(nodes[i]); child; child = scene_.next_sibling(child)) {
      if (known.insert(child).second) {
        nodes.push_back(child);
      }
    }
  }
  return nodes;
}

scene::Bounds Document::selected_bounds() const
{
  scene::Bounds bounds;
  for (const scene::Handle<scene::Node> handle : selected_nodes()) {
    const scene::Node &node = scene_.nodes()[handle];
    const glm::dmat4 &world = scene_.world_from_node(handle);
    for (const scene::Handle<scene::Mesh> mesh : node.meshes) {
      if (const scene::Mesh *value = scene_.meshes().find(mesh)) {
        bounds.extend(scene::transformed(value->bounds, glm::mat4(world)));
      }
    }
    if (node.lamp || node.camera) {
      bounds.extend(glm::vec3(world[3]));
    }
  }
  return bounds.is_empty() ? scene_.bounds() : bounds;
}

scene::Handle<scene::Node> Document::find(const std::string &name) const
{
  for (const auto &[handle, node] : scene_.nodes()) {
    if (node.name == name) {
      return handle;
    }
  }
  return {};
}

}  // namespace gnomon::view
