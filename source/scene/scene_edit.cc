// SPDX-License-Identifier: MIT
#include "scene.hh"

#include "internal/scene_changes.hh"
#include "internal/scene_rest_shape.hh"
#include "internal/scene_values.hh"
#include "memory_pages.hh"

#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

namespace gnomon::scene {

namespace {

template <typename... Args>
[[noreturn]] void refuse(std::string_view kind, const std::string &name, fmt::format_string<Args...> reason,
                         Args &&...args)
{
  throw InvalidEdit(fmt::format("{} '{}': {}", kind, name, fmt::format(reason, std::forward<Args>(args)...)));
}

/** \throws InvalidEdit that names a vector of vertices with a value that is not finite */
void check_finite(const Mesh &mesh, std::string_view name, const auto &stream)
{
  if (const auto index = first_infinite(stream)) {
    refuse("mesh", mesh.name, "{} {} is not finite", name, *index);
  }
}

void check(const Mesh &mesh)
{
  if (mesh.host_shape) {
    const Bounds &bounds = mesh.host_shape->bounds;
    if (first_infinite(std::array{bounds.min, bounds.max}) || !glm::all(glm::lessThanEqual(bounds.min, bounds.max))) {
      refuse("mesh", mesh.name, "the bounds of its shape in the host's buffers are empty or not finite");
    }
    if (!mesh.positions.empty() || !mesh.indices.empty()) {
      refuse("mesh", mesh.name, "{} positions and {} indices beside a shape in the host's buffers",
             mesh.positions.size(), mesh.indices.size());
    }
  }
  const std::size_t count = mesh.positions.size();
  if (mesh.normals.size() != count) {
    refuse("mesh", mesh.name, "{} normals for {} positions", mesh.normals.size(), count);
  }
  for_each_stream_member([&](auto stream, auto /*values*/, std::string_view name) {
    if (!(mesh.*stream).empty() && (mesh.*stream).size() != count) {
      refuse("mesh", mesh.name, "{} {}s for {} positions", (mesh.*stream).size(), name, count);
    }
    check_finite(mesh, name, mesh.*stream);
  });
  if (const auto index = first_beyond_one(mesh.colors)) {
    refuse("mesh", mesh.name, "colour {} is not from 0 to 1", *index);
  }
  if (mesh.indices.size() % index_count_of(mesh.topology) != 0) {
    refuse("mesh", mesh.name, "{} indices are not {}", mesh.indices.size(),
           mesh.topology == Topology::Triangles ? "three for each triangle" : "two for each line");
  }
  const auto beyond = std::ranges::find_if(mesh.indices, [&](std::uint32_t index) { return index >= count; });
  if (beyond != mesh.indices.end()) {
    refuse("mesh", mesh.name, "index {} is beyond its {} positions", *beyond, count);
  }
}

void check(const Image &image)
{
  const std::uint64_t bytes = std::uint64_t(4) * image.width * image.height;
  if (bytes == 0 || bytes != image.texels.size()) {
    refuse("image", image.name, "{} bytes for {}x{} texels of 4 bytes", image.texels.size(), image.width, image.height);
  }
}

void check(const SurfaceFunction &function)
{
  if (function.text.size() > SurfaceFunction::text_bytes_max) {
    refuse("surface function", function.name, "{} bytes of text are more than {}", function.text.size(),
           SurfaceFunction::text_bytes_max);
  }
  if (function.text.find('\0') != std::string::npos) {
    refuse("surface function", function.name, "its text contains a NUL");
  }
}

void check_transform(const std::string &name, const glm::dmat4 &matrix)
{
  for (int column = 0; column < 4; column++) {
    for (int row = 0; row < 4; row++) {
      // False for NaN too.
      if (const double value = matrix[column][row]; !(std::abs(value) <= number_max)) {
        refuse("node", name, "its matrix has {} in row {} and column {}, which is not {}", value, row, column,
               range_text({.name = "matrix", .min = -number_max}));
      }
      if (row == 3 && matrix[column][3] != (column == 3 ? 1.0 : 0.0)) {
        refuse("node", name, "its matrix is not affine: the last row is not 0 0 0 1");
      }
    }
  }
}

void check(const Node &node)
{
  check_transform(node.name, node.parent_from_node);
}

/**
 * Checks the properties of \a part, which is \a thing or a part of it. Those that its kind does not have must be
 * finite.
 */
template <typename Thing, typename Part>
void check_properties(const Thing &thing, const Part &part)
{
  Part::for_each_property([&](const auto &row) {
    for_each_number(part.*row.member, [&](double value) {
      if (!std::isfinite(value)) {
        refuse(Thing::kind_name, thing.name, "{} is not finite", row.name);
      }
      if (row.has_kind(kind_of(thing)) && !row.allows(value)) {
        refuse(Thing::kind_name, thing.name, "{} {:g} is not {}", row.name, value, range_text(row));
      }
    });
  });
}

void check(const Texture & /*texture*/) {}

void check(const Material &material)
{
  check_properties(material, material);
}

void check(const Lamp &lamp)
{
  check_properties(lamp, lamp);
  check_properties(lamp, lamp.shadow);
  const LampShadow &shadow = lamp.shadow;
  if (shadow.clip_start && shadow.clip_end && *shadow.clip_end <= *shadow.clip_start) {
    refuse(Lamp::kind_name, lamp.name, "shadow_clip_end {:g} is not above shadow_clip_start {:g}", *shadow.clip_end,
           *shadow.clip_start);
  }
}

void check(const Camera &camera)
{
  check_properties(camera, camera);
  if (camera.kind == CameraKind::Perspective && !(camera.near > 0.0F)) {
    refuse(Camera::kind_name, camera.name, "near {:g} is not above 0", camera.near);
  }
}

bool is_opaque(const Image &image)
{
  for (std::size_t alpha = 3; alpha < image.texels.size(); alpha += 4) {
    if (image.texels[alpha] != 255) {
      return false;
    }
  }
  return true;
}

Bounds bounds_of(const Mesh &mesh)
{
  if (mesh.host_shape) {
    return mesh.host_shape->bounds;
  }
  Bounds bounds;
  for (const glm::vec3 &position : mesh.positions) {
    bounds.extend(position);
  }
  return bounds;
}

/** Checks \a value and computes its derived members. \throws InvalidEdit */
template <typename T>
void prepare(T &value)
{
  check(value);
  if constexpr (std::same_as<T, Mesh>) {
    value.bounds = bounds_of(value);
  }
  if constexpr (std::same_as<T, Image>) {
    value.is_opaque = is_opaque(value);
  }
}

}  // namespace

Revision next_revision()
{
  static std::atomic<Revision> last{0};
  return ++last;
}

template <typename T>
Handle<T> Scene::add_value(T value)
{
  prepare(value);
  return writable_pool<T>().add(std::move(value), edited());
}

template <typename T>
void Scene::replace_value(Handle<T> handle, T value)
{
  Pool<T> &things = writable_pool<T>();
  const Changes changed = changes(things[handle], value);
  prepare(value);
  things.writable(handle) = std::move(value);
  if (changed == 0) {
    return;
  }
  edited();
  if constexpr (std::same_as<T, Mesh>) {
    if ((changed >> unsigned(Mesh::Aspect::Shape) & 1U) != 0) {
      vertex_blocks_.erase(handle);
    }
  }
  for (unsigned aspect = 0; aspect < unsigned(T::Aspect::Count); aspect++) {
    if ((changed >> aspect & 1U) != 0) {
      things.touch(handle, typename T::Aspect(aspect), revision_);
    }
  }
}

template <typename T>
void Scene::restore_value(Handle<T> handle, T value)
{
  Pool<T> &things = writable_pool<T>();
  prepare(value);
  if (!things.is_restorable(handle)) {
    throw InvalidEdit(fmt::format("the {} of handle {}.{} cannot be restored: {}", T::kind_name, handle.index,
                                  handle.generation,
                                  things.is_live(handle)     ? "it is in the scene"
                                  : things.was_added(handle) ? "another one has its index"
                                                             : "the scene never had it"));
  }
  things.restore(handle, std::move(value), edited());
}

Handle<Mesh> Scene::add(Mesh mesh)
{
  return add_value(std::move(mesh));
}

Handle<Image> Scene::add(Image image)
{
  return add_value(std::move(image));
}

Handle<Texture> Scene::add(const Texture &texture)
{
  return add_value(texture);
}

Handle<SurfaceFunction> Scene::add(SurfaceFunction function)
{
  return add_value(std::move(function));
}

Handle<Material> Scene::add(Material material)
{
  return add_value(std::move(material));
}

Handle<Lamp> Scene::add(Lamp lamp)
{
  return add_value(std::move(lamp));
}

Handle<Camera> Scene::add(Camera camera)
{
  return add_value(std::move(camera));
}

void Scene::reserve_nodes(std::size_t count)
{
  links_.reserve(links_.size() + count);
  memory::prefer_large_pages(links_.data(), links_.capacity() * sizeof(NodeLinks));
}

Handle<Node> Scene::add(Node node, Handle<Node> parent)
{
  if (parent) {
    nodes_[parent];
  }
  // Before the node, because it may throw. Unlike reserve, resize grows geometrically.
  links_.resize(std::max(links_.size(), nodes_.index_end() + 1));
  const Handle<Node> handle = add_value(std::move(node));
  links(handle) = {};
  link(handle, parent);
  update_subtree(handle, revision_);
  return handle;
}

template <typename T>
requires(!std::same_as<T, Node>) void Scene::restore(Handle<T> handle, T value)
{
  restore_value(handle, std::move(value));
}
template void Scene::restore(Handle<Mesh> handle, Mesh value);
template void Scene::restore(Handle<Image> handle, Image value);
template void Scene::restore(Handle<Texture> handle, Texture value);
template void Scene::restore(Handle<SurfaceFunction> handle, SurfaceFunction value);
template void Scene::restore(Handle<Material> handle, Material value);
template void Scene::restore(Handle<Lamp> handle, Lamp value);
template void Scene::restore(Handle<Camera> handle, Camera value);

void Scene::restore(Handle<Node> handle, Node node, Handle<Node> parent, Handle<Node> next)
{
  if (parent) {
    nodes_[parent];
  }
  if (next && (!parent || std::as_const(*this).links(next).parent != parent)) {
    refuse("node", node.name, "node '{}' cannot follow it, because it is not a child of the same parent",
           nodes_[next].name);
  }
  restore_value(handle, std::move(node));
  links(handle) = {};
  link(handle, parent, next);
  update_subtree(handle, revision_);
}

void Scene::replace(Handle<Mesh> handle, Mesh mesh)
{
  const auto deformed = std::ranges::find(deformed_meshes, handle, &DeformedMesh::mesh);
  if (deformed == deformed_meshes.end()) {
    replace_value(handle, std::move(mesh));
    return;
  }
  check(mesh);
  std::optional<RestShape> rest = edited_rest_shape(*this, *deformed, meshes_[handle], mesh);
  replace_value(handle, std::move(mesh));
  if (rest) {
    deformed->positions = std::move(rest->positions);
    deformed->normals = std::move(rest->normals);
    deformed->tangents = std::move(rest->tangents);
    deformed->has_flat_normals = rest->has_flat_normals;
  }
}

void Scene::set_posed(Handle<Mesh> handle, PosedVertices posed)
{
  Mesh &mesh = meshes_.writable(handle);
  const VertexValues values{.positions = posed.positions, .normals = posed.normals, .tangents = posed.tangents};
  for_each_stream_member(
      [&](auto /*stream*/, auto new_values, std::string_view name) { check_finite(mesh, name, values.*new_values); });
  const bool is_new_layout = posed.indices || posed.tangents.size() != mesh.tangents.size();
  mesh.positions = std::move(posed.positions);
  mesh.normals = std::move(posed.normals);
  mesh.tangents = std::move(posed.tangents);
  if (posed.indices) {
    mesh.indices = std::move(*posed.indices);
  }
  mesh.bounds = bounds_of(mesh);
  vertex_blocks_.erase(handle);
  const Revision revision = edited();
  meshes_.touch(handle, Mesh::Aspect::Shape, revision);
  if (is_new_layout) {
    meshes_.touch(handle, Mesh::Aspect::Layout, revision);
  }
}

void Scene::replace(Handle<Image> handle, Image image)
{
  replace_value(handle, std::move(image));
}

void Scene::replace(Handle<Texture> handle, const Texture &texture)
{
  replace_value(handle, texture);
}

void Scene::replace(Handle<SurfaceFunction> handle, SurfaceFunction function)
{
  replace_value(handle, std::move(function));
}

void Scene::replace(Handle<Material> handle, Material material)
{
  replace_value(handle, std::move(material));
}

void Scene::replace(Handle<Lamp> handle, Lamp lamp)
{
  replace_value(handle, std::move(lamp));
}

void Scene::replace(Handle<Camera> handle, Camera camera)
{
  replace_value(handle, std::move(camera));
}

void Scene::replace(Handle<Node> handle, Node node)
{
  const bool is_moved = !same_bytes(nodes_[handle].parent_from_node, node.parent_from_node) ||
                        nodes_[handle].is_visible != node.is_visible;
  replace_value(handle, std::move(node));
  if (is_moved) {
    update_subtree(handle, edited());
  }
}

void Scene::set_transform(Handle<Node> node, const glm::dmat4 &parent_from_node)
{
  Node &written = nodes_.writable(node);
  check_transform(written.name, parent_from_node);
  if (!same_bytes(written.parent_from_node, parent_from_node)) {
    written.parent_from_node = parent_from_node;
    update_subtree(node, edited());
  }
}

void Scene::set_parent(Handle<Node> node, Handle<Node> parent)
{
  nodes_[node];
  if (parent) {
    nodes_[parent];
  }
  for (Handle<Node> above = parent; above; above = links(above).parent) {
    if (above == node) {
      refuse("node", nodes_[node].name, "node '{}' cannot be its parent: it is the node itself or a descendant of it",
             nodes_[parent].name);
    }
  }
  unlink(node);
  link(node, parent);
  update_subtree(node, edited());
}

void Scene::link(Handle<Node> node, Handle<Node> parent, Handle<Node> next)
{
  NodeLinks &own = links(node);
  own.parent = parent;
  if (!parent) {
    return;
  }
  NodeLinks &above = links(parent);
  Handle<Node> &previous = next ? links(next).previous_sibling : above.last_child;
  own.previous_sibling = previous;
  own.next_sibling = next;
  (previous ? links(previous).next_sibling : above.first_child) = node;
  previous = node;
}

void Scene::unlink(Handle<Node> node)
{
  NodeLinks &own = links(node);
  if (own.parent) {
    NodeLinks &above = links(own.parent);
    (own.previous_sibling ? links(own.previous_sibling).next_sibling : above.first_child) = own.next_sibling;
    (own.next_sibling ? links(own.next_sibling).previous_sibling : above.last_child) = own.previous_sibling;
  }
  own.parent = own.previous_sibling = own.next_sibling = {};
}

void Scene::remove_subtree(Handle<Node> node)
{
  unlink(node);
  edited();
  // Leaves first. No recursion: the tree may be deeper than the stack.
  Handle<Node> at = node;
  while (at) {
    if (const Handle<Node> child = links(at).first_child) {
      at = child;
      continue;
    }
    const Handle<Node> above = at == node ? Handle<Node>() : links(at).parent;
    unlink(at);
    nodes_.remove(at, revision_);
    at = above;
  }
}

void Scene::update_subtree(Handle<Node> node, Revision revision)
{
  Handle<Node> at = node;
  while (at) {
    NodeLinks &own = links(at);
    const Node &value = nodes_[at];
    const NodeLinks *above = own.parent ? &links(own.parent) : nullptr;
    const glm::dmat4 world = above ? above->world_from_node * value.parent_from_node : value.parent_from_node;
    const bool is_visible = value.is_visible && (!above || above->is_visible);
    const bool is_moved = !same_bytes(own.world_from_node, world);
    const bool is_toggled = own.is_visible != is_visible;
    if (is_moved) {
      own.world_from_node = world;
      nodes_.touch(at, Node::Aspect::Transform, revision);
    }
    if (is_toggled) {
      own.is_visible = is_visible;
      nodes_.touch(at, Node::Aspect::Visibility, revision);
    }
    // The descendants of an unchanged node are unchanged.
    Handle<Node> next = is_moved || is_toggled || at == node ? own.first_child : Handle<Node>();
    while (!next && at != node) {
      next = links(at).next_sibling;
      at = next ? at : links(at).parent;
    }
    if (at == node && !next) {
      return;
    }
    at = next;
  }
}

void Scene::set_world(std::optional<World> world)
{
  if (const std::string fault = world ? fault_of(*world) : std::string(); !fault.empty()) {
    throw InvalidEdit("world: " + fault);
  }
  if (world != world_) {
    world_ = std::move(world);
    world_revision_ = edited();
  }
}

}  // namespace gnomon::scene
