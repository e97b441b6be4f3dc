// SPDX-License-Identifier: MIT
#include "render_scene.hh"

#include "render_materials.hh"
#include "render_world.hh"

#include "memory_pages.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gnomon::render_scene {

glm::dvec3 origin_near(const glm::dvec3 &position_ws, const glm::dvec3 &current, const scene::Bounds &bounds_ws)
{
  // Within 1.5 steps of the origin, floats are spaced by at most 0.12 mm, or a 40000th of the scene's radius. Multiples
  // of a power of two are exact.
  constexpr double step_max_m = 1024.0;
  constexpr double step_min_m = 1e-6;
  const double wanted_m = bounds_ws.is_empty() ? step_max_m : 256.0 * double(bounds_ws.radius());
  const double step_m = std::exp2(std::floor(std::log2(std::clamp(wanted_m, step_min_m, step_max_m))));
  const glm::dvec3 offset = glm::abs(position_ws - current);
  return std::max({offset.x, offset.y, offset.z}) <= step_m ? current : step_m * glm::round(position_ws / step_m);
}

static glm::mat4 relative_to(const glm::dmat4 &world, const glm::dvec3 &origin_ws)
{
  glm::dmat4 relative = world;
  relative[3] -= glm::dvec4(origin_ws, 0.0);
  return glm::mat4(relative);
}

scene::PlacedCamera RenderScene::relative(scene::PlacedCamera camera) const
{
  camera.world_from_camera[3] -= glm::dvec4(origin_ws_, 0.0);
  return camera;
}

std::vector<glm::vec4> RenderScene::relative(std::span<const glm::dvec4> planes_ws) const
{
  std::vector<glm::vec4> planes;
  for (const glm::dvec4 &plane : planes_ws) {
    planes.emplace_back(plane + glm::dvec4(0.0, 0.0, 0.0, glm::dot(glm::dvec3(plane), origin_ws_)));
  }
  return planes;
}

RenderScene::RenderScene(gpu::Device &device, const scene::Scene &scene)
    : device_(device), scene_(scene), materials_(std::make_unique<MaterialTable>())
{
}

RenderScene::~RenderScene() = default;

void RenderScene::update()
{
  if (is_up_to_date()) {
    return;
  }
  host_batch_changes_ = meshes_.update(scene_.meshes());
  host_texture_changes_ = images_.update(scene_);
  materials_->update(scene_);
  update_objects();
  update_lamps();
  update_revisions();
  seen_ = scene_.revision();
  is_origin_changed_ = false;
  has_host_calls_ = false;
}

void RenderScene::set_host_batch(scene::Handle<scene::Mesh> handle, const std::optional<gpu::HostBatch> &batch)
{
  const scene::Mesh &mesh = scene_.meshes()[handle];
  if (batch && !mesh.host_shape) {
    throw gpu::Error("mesh '{}': it has no shape in buffers of a host (Mesh::host_shape)", mesh.name);
  }
  meshes_.host_batches().set(handle, batch);
  has_host_calls_ = true;
}

void RenderScene::set_host_texture(scene::Handle<scene::Image> handle, const std::optional<gpu::HostTexture> &texture)
{
  [[maybe_unused]] const scene::Image &image = scene_.images()[handle];
  images_.host_textures().set(handle, texture);
  has_host_calls_ = true;
}

std::vector<std::uint8_t> RenderScene::flags_of(std::span<const scene::Handle<scene::Node>> nodes) const
{
  std::vector<std::uint8_t> flags(objects_.index_end());
  std::vector<scene::Handle<scene::Node>> left(nodes.begin(), nodes.end());
  while (!left.empty()) {
    const scene::Handle<scene::Node> node = left.back();
    left.pop_back();
    if (!scene_.nodes().is_live(node)) {
      continue;
    }
    if (node.index < node_objects_.size() && node_objects_[node.index].node == node) {
      for (draw::ObjectIndex index = node_objects_[node.index].first; index != draw::object_identity;
           index = next_of_node_[index]) {
        flags[index] = 1;
      }
    }
    for (scene::Handle<scene::Node> child = scene_.first_child(node); child; child = scene_.next_sibling(child)) {
      left.push_back(child);
    }
  }
  return flags;
}

draw::ObjectSet RenderScene::hidden_objects(std::span<const scene::Handle<scene::Node>> hidden,
                                            std::span<const scene::Handle<scene::Node>> isolated) const
{
  std::vector<std::uint8_t> flags = flags_of(hidden);
  if (!isolated.empty()) {
    const std::vector<std::uint8_t> shown = flags_of(isolated);
    for (draw::ObjectIndex index = draw::object_identity + 1; index < flags.size(); index++) {
      flags[index] |= std::uint8_t(1 - shown[index]);
    }
  }
  return draw::ObjectSet(std::move(flags));
}

void RenderScene::remove_objects(NodeObjects &entry)
{
  while (entry.first != draw::object_identity) {
    objects_.remove(entry.first);
    entry.first = next_of_node_[entry.first];
  }
}

bool RenderScene::is_shadow_receiver(draw::ObjectIndex index) const
{
  const RenderObject &one = object(index);
  return one.receives_shadow && !scene().material_of(scene().meshes()[one.mesh]).is_unlit;
}

void RenderScene::update_objects()
{
  using enum scene::Node::Aspect;
  const scene::Pool<scene::Node> &nodes = scene_.nodes();
  const scene::Revision meshes = std::max(scene_.meshes().latest(scene::Mesh::Aspect::Shape),
                                          scene_.meshes().latest(scene::Mesh::Aspect::Material));
  const scene::Revision materials =
      std::max(scene_.materials().latest(scene::Material::Aspect::Coverage), scene_.surface_functions().latest());
  const scene::Revision latest = std::max({nodes.latest(Transform), nodes.latest(Content), nodes.latest(Visibility),
                                           nodes.latest(Shadow), meshes, materials});
  if (latest <= seen_ && !is_origin_changed_ && !host_batch_changes_.resources) {
    return;
  }
  for (NodeObjects &entry : node_objects_) {
    if (entry.first != draw::object_identity && !nodes.is_live(entry.node)) {
      remove_objects(entry);
    }
  }
  if (node_objects_.empty()) {
    // Only at first: later, memory must grow by a factor and not with each edit.
    objects_.reserve(nodes.size() + 1);
    render_objects_.reserve(nodes.size() + 1);
    next_of_node_.reserve(nodes.size() + 1);
    memory::prefer_large_pages(render_objects_.data(), render_objects_.capacity() * sizeof(RenderObject));
  }
  node_objects_.resize(nodes.index_end());
  // Update every node if a material was edited, because any node may use it. Such edits are rare.
  const bool is_anew = is_origin_changed_ || host_batch_changes_.resources || materials > seen_;
  const scene::Pool<scene::Mesh> &pool = scene_.meshes();
  const auto is_edited = [&](scene::Handle<scene::Mesh> mesh) {
    return !pool.is_live(mesh) || pool.revision(mesh, scene::Mesh::Aspect::Shape) > seen_ ||
           pool.revision(mesh, scene::Mesh::Aspect::Material) > seen_;
  };
  for (const auto &[handle, node] : nodes) {
    const bool is_node_anew = is_anew || (meshes > seen_ && std::ranges::any_of(node.meshes, is_edited));
    if (is_node_anew || nodes.revision(handle, Transform) > seen_ || nodes.revision(handle, Content) > seen_ ||
        nodes.revision(handle, Visibility) > seen_ || nodes.revision(handle, Shadow) > seen_) {
      update_node(handle, node, is_node_anew);
    }
  }
  bounds_ = {};
  for (draw::ObjectIndex index = draw::object_identity + 1; index < objects_.index_end(); index++) {
    if (objects_.is_live(index)) {
      bounds_.extend(render_objects_[index].bounds);
    }
  }
}

void RenderScene::update_node(scene::Handle<scene::Node> handle, const scene::Node &node, bool is_anew)
{
  NodeObjects &entry = node_objects_[handle.index];
  std::vector<scene::Handle<scene::Mesh>> &shown = shown_;
  shown.clear();
  if (!node.meshes.empty() && scene_.is_visible(handle)) {
    for (const scene::Handle<scene::Mesh> mesh : node.meshes) {
      const scene::Mesh *value = scene_.meshes().find(mesh);
      if (value && meshes_.has_shape(mesh, *value) && is_drawable(scene_, scene_.material_of(*value))) {
        shown.push_back(mesh);
      }
    }
  }
  if (!has_shown(entry, handle)) {
    remove_objects(entry);
    entry.node = handle;
    draw::ObjectIndex last = draw::object_identity;
    for (const scene::Handle<scene::Mesh> mesh : shown) {
      const draw::ObjectIndex index = write_object(draw::object_identity, handle, node, mesh);
      (last == draw::object_identity ? entry.first : next_of_node_[last]) = index;
      last = index;
    }
  }
  else if (is_anew || scene_.nodes().revision(handle, scene::Node::Aspect::Transform) > seen_ ||
           scene_.nodes().revision(handle, scene::Node::Aspect::Shadow) > seen_) {
    for (draw::ObjectIndex index = entry.first; index != draw::object_identity; index = next_of_node_[index]) {
      write_object(index, handle, node, render_objects_[index].mesh);
    }
  }
}

bool RenderScene::has_shown(const NodeObjects &entry, scene::Handle<scene::Node> node) const
{
  draw::ObjectIndex index = entry.first;
  for (const scene::Handle<scene::Mesh> mesh : shown_) {
    if (index == draw::object_identity || render_objects_[index].mesh != mesh) {
      return false;
    }
    index = next_of_node_[index];
  }
  return entry.node == node && index == draw::object_identity;
}

draw::ObjectIndex RenderScene::write_object(draw::ObjectIndex index, scene::Handle<scene::Node> handle,
                                            const scene::Node &node, scene::Handle<scene::Mesh> mesh)
{
  const scene::Mesh &value = scene_.meshes()[mesh];
  const glm::mat4 world_from_object = relative_to(scene_.world_from_node(handle), origin_ws_);
  const scene::Bounds bounds = scene::transformed(value.bounds, world_from_object);
  const draw::CullingVolume volume{bounds.center(), bounds.radius()};
  const std::uint32_t material = MaterialTable::place_of(scene_, value.material);
  if (index == draw::object_identity) {
    index = objects_.add(world_from_object, material, volume);
    render_objects_.resize(objects_.index_end());
    next_of_node_.resize(objects_.index_end());
    next_of_node_[index] = draw::object_identity;
  }
  else {
    objects_.set(index, world_from_object, material, volume);
  }
  const RenderObject before =
      std::exchange(render_objects_[index], {handle, mesh, bounds, node.casts_shadow, node.receives_shadow});
  are_flags_changed_ |= before.casts_shadow != node.casts_shadow || before.receives_shadow != node.receives_shadow;
  return index;
}

void RenderScene::update_lamps()
{
  using enum scene::Node::Aspect;
  const scene::Pool<scene::Node> &nodes = scene_.nodes();
  const scene::Revision latest = std::max({scene_.lamps().latest(), nodes.latest(Transform), nodes.latest(Content),
                                           nodes.latest(Visibility), scene_.world_revision()});
  if (latest <= seen_ && !is_origin_changed_) {
    return;
  }
  std::vector<scene::PlacedLamp> lamps = scene_.placed_lamps();
  for (scene::PlacedLamp &lamp : lamps) {
    lamp.world_from_lamp[3] -= glm::dvec4(origin_ws_, 0.0);
  }
  const bool is_world_new = scene_.world_revision() > seen_;
  if (is_world_new) {
    world_revision_++;
    world_ = scene_.world() ? std::make_shared<const WorldLight>(world_light(*scene_.world())) : nullptr;
    if (world_ && world_->is_black()) {
      world_.reset();
    }
  }
  if (lamps != lamps_ || is_world_new) {
    lamps_ = std::move(lamps);
    lamps_revision_++;
  }
}

void RenderScene::update_revisions()
{
  using Material = scene::Material::Aspect;
  const scene::Pool<scene::Material> &materials = scene_.materials();
  const scene::Revision passes = std::max(
      {scene_.meshes().latest(scene::Mesh::Aspect::Layout), scene_.meshes().latest(scene::Mesh::Aspect::Material),
       materials.latest(Material::Coverage), materials.latest(Material::Textures), scene_.textures().latest(),
       scene_.images().latest(scene::Image::Aspect::Content),
       scene_.surface_functions().latest(scene::SurfaceFunction::Aspect::Text)});
  const bool are_resources_new =
      meshes_.free_outgrown() || host_batch_changes_.resources || host_texture_changes_.resources;
  const bool are_flags_changed = std::exchange(are_flags_changed_, false);
  passes_revision_ += passes > seen_ || are_resources_new || are_flags_changed ? 1 : 0;
  const bool is_content_new = host_batch_changes_.content || host_texture_changes_.content ||
                              scene_.meshes().latest(scene::Mesh::Aspect::Shape) > seen_;
  content_revision_ += is_content_new ? 1 : 0;
  materials_revision_ += materials.latest(Material::Surface) > seen_ ? 1 : 0;
}

void RenderScene::upload(MaterialClass widest)
{
  objects_.upload(device_);
  meshes_.upload(device_, scene_);
  materials_->upload(device_, widest);
}

}  // namespace gnomon::render_scene
