// SPDX-License-Identifier: MIT
#include "scene.hh"

#include "internal/scene_changes.hh"
#include "memory_pages.hh"

#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::scene {

namespace {

template <typename... Args>
[[noreturn]] void refuse(std::string_view kind, const std::string &name, fmt::format_string<Args...> reason,
                         Args &&...args)
{
  throw InvalidEdit(fmt::format("{} '{}': {}", kind, name, fmt::format(reason, std::forward<Args>(args)...)));
}

bool is_finite(const glm::vec3 &value)
{
  return std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z);
}

void check(const Mesh &mesh)
{
  if (mesh.host_shape) {
    const Bounds &bounds = mesh.host_shape->bounds;
    if (!is_finite(bounds.min) || !is_finite(bounds.max) || !glm::all(glm::lessThanEqual(bounds.min, bounds.max))) {
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
  const auto check_count = [&](std::string_view what, std::size_t size) {
    if (size != 0 && size != count) {
      refuse("mesh", mesh.name, "{} {} for {} positions", size, what, count);
    }
  };
  check_count("uvs", mesh.uvs.size());
  check_count("second uvs", mesh.second_uvs.size());
  check_count("tangents", mesh.tangents.size());
  check_count("colours", mesh.colors.size());
  if (mesh.indices.size() % index_count_of(mesh.topology) != 0) {
    refuse("mesh", mesh.name, "{} indices are not {}", mesh.indices.size(),
           mesh.topology == Topology::Triangles ? "three for each triangle" : "two for each line");
  }
  const auto beyond = std::ranges::find_if(mesh.indices, [&](std::uint32_t index) { return index >= count; });
  if (beyond != mesh.indices.end()) {
    refuse("mesh", mesh.name, "index {} is beyond its {} positions", *beyond, count);
  }
  const auto infinite = std::ranges::find_if_not(mesh.positions, is_finite);
  if (infinite != mesh.positions.end()) {
    refuse("mesh", mesh.name, "position {} is not finite", infinite - mesh.positions.begin());
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
      if (!std::isfinite(matrix[column][row])) {
        refuse("node", name, "its matrix is not finite");
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

}  // namespace

template <typename T>
void Scene::replace_value(Handle<T> handle, T value)
{
  Pool<T> &things = writable_pool<T>();
  const Changes changed = changes(things[handle], value);
  check(value);
  if constexpr (std::same_as<T, Mesh>) {
    value.bounds = bounds_of(value);
  }
  if constexpr (std::same_as<T, Image>) {
    value.is_opaque = is_opaque(value);
  }
  things.writable(handle) = std::move(value);
  if (changed == 0) {
    return;
  }
  revision_++;
  for (unsigned aspect = 0; aspect < unsigned(T::Aspect::Count); aspect++) {
    if ((changed >> aspect & 1U) != 0) {
      things.touch(handle, typename T::Aspect(aspect), revision_);
    }
  }
}

Handle<Mesh> Scene::add(Mesh mesh)
{
  check(mesh);
  mesh.bounds = bounds_of(mesh);
  return meshes_.add(std::move(mesh), ++revision_);
}

Handle<Image> Scene::add(Image image)
{
  check(image);
  image.is_opaque = is_opaque(image);
  return images_.add(std::move(image), ++revision_);
}

Handle<Texture> Scene::add(const Texture &texture)
{
  return textures_.add(texture, ++revision_);
}

Handle<SurfaceFunction> Scene::add(SurfaceFunction function)
{
  check(function);
  return surface_functions_.add(std::move(function), ++revision_);
}

Handle<Material> Scene::add(Material material)
{
  check(material);
  return materials_.add(std::move(material), ++revision_);
}

Handle<Lamp> Scene::add(Lamp lamp)
{
  check(lamp);
  return lamps_.add(std::move(lamp), ++revision_);
}

Handle<Camera> Scene::add(Camera camera)
{
  check(camera);
  return cameras_.add(std::move(camera), ++revision_);
}

void Scene::reserve_nodes(std::size_t count)
{
  links_.reserve(links_.size() + count);
  memory::prefer_large_pages(links_.data(), links_.capacity() * sizeof(NodeLinks));
}

Handle<Node> Scene::add(Node node, Handle<Node> parent)
{
  check(node);
  if (parent) {
    nodes_[parent];
  }
  // Before the node, because it may throw. Unlike reserve, resize grows geometrically.
  links_.resize(std::max(links_.size(), nodes_.index_end() + 1));
  const Handle<Node> handle = nodes_.add(std::move(node), ++revision_);
  links(handle) = {};
  link(handle, parent);
  update_subtree(handle, revision_);
  return handle;
}

void Scene::replace(Handle<Mesh> handle, Mesh mesh)
{
  replace_value(handle, std::move(mesh));
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
    update_subtree(handle, ++revision_);
  }
}

void Scene::set_transform(Handle<Node> node, const glm::dmat4 &parent_from_node)
{
  Node &written = nodes_.writable(node);
  check_transform(written.name, parent_from_node);
  if (!same_bytes(written.parent_from_node, parent_from_node)) {
    written.parent_from_node = parent_from_node;
    update_subtree(node, ++revision_);
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
  update_subtree(node, ++revision_);
}

void Scene::link(Handle<Node> node, Handle<Node> parent)
{
  NodeLinks &own = links(node);
  own.parent = parent;
  if (!parent) {
    return;
  }
  NodeLinks &above = links(parent);
  own.previous_sibling = above.last_child;
  (above.last_child ? links(above.last_child).next_sibling : above.first_child) = node;
  above.last_child = node;
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
  revision_++;
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
    world_revision_ = ++revision_;
  }
}

}  // namespace gnomon::scene
