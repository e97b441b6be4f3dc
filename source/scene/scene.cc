// SPDX-License-Identifier: MIT
#include "scene.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::scene {

glm::dmat3x2 TextureSlot::uv_from_mesh() const
{
  const double sine = std::sin(double(rotation));
  const double cosine = std::cos(double(rotation));
  // v points down the image, which reverses the direction of the angle.
  return {glm::dvec2(cosine, -sine) * double(scale.x), glm::dvec2(sine, cosine) * double(scale.y), glm::dvec2(offset)};
}

float Bounds::radius() const
{
  return is_empty() ? 0.0F : glm::length(0.5F * max - 0.5F * min);
}

void Bounds::extend(const glm::vec3 &point)
{
  min = glm::min(min, point);
  max = glm::max(max, point);
}

void Bounds::extend(const Bounds &other)
{
  min = glm::min(min, other.min);
  max = glm::max(max, other.max);
}

Bounds transformed(const Bounds &bounds, const glm::mat4 &target_from_source)
{
  if (bounds.is_empty()) {
    return bounds;
  }
  // The extremes of a sum are the sums of the extremes of its terms, so each axis is transformed separately.
  Bounds result{glm::vec3(target_from_source[3]), glm::vec3(target_from_source[3])};
  for (int axis = 0; axis < 3; axis++) {
    const glm::vec3 at_min = glm::vec3(target_from_source[axis]) * bounds.min[axis];
    const glm::vec3 at_max = glm::vec3(target_from_source[axis]) * bounds.max[axis];
    result.min += glm::min(at_min, at_max);
    result.max += glm::max(at_min, at_max);
  }
  return result;
}

template <typename Visit>
void Scene::for_each_object(const Visit &visit) const
{
  for (const auto &[handle, node] : nodes_) {
    if (node.meshes.empty() || !links(handle).is_visible) {
      continue;
    }
    for (const Handle<Mesh> mesh : node.meshes) {
      if (meshes_.is_live(mesh)) {
        visit(handle, mesh, links(handle).world_from_node);
      }
    }
  }
}

std::vector<Object> Scene::objects() const
{
  std::vector<Object> objects;
  for_each_object([&](Handle<Node> node, Handle<Mesh> mesh, const glm::dmat4 &world_from_object) {
    objects.push_back({node, mesh, world_from_object});
  });
  return objects;
}

std::vector<PlacedLamp> Scene::placed_lamps() const
{
  std::vector<PlacedLamp> placed;
  for (const auto &[handle, node] : nodes_) {
    const Lamp *lamp = links(handle).is_visible ? lamps_.find(node.lamp) : nullptr;
    if (lamp) {
      const glm::dmat4 &world = links(handle).world_from_node;
      const bool is_scaled = lamp->kind == LampKind::Spot || lamp->kind == LampKind::Area;
      placed.push_back({*lamp, handle, frame_of(world), is_scaled ? scale_of(world) : glm::dvec3(1.0)});
    }
  }
  return placed;
}

std::vector<PlacedCamera> Scene::placed_cameras() const
{
  std::vector<PlacedCamera> placed;
  for (const auto &[handle, node] : nodes_) {
    if (const Camera *camera = cameras_.find(node.camera)) {
      placed.push_back({*camera, handle, frame_of(links(handle).world_from_node)});
    }
  }
  return placed;
}

const Material &Scene::material_of(const Mesh &mesh) const
{
  static const Material default_material;
  const Material *material = materials_.find(mesh.material);
  return material ? *material : default_material;
}

Bounds Scene::bounds() const
{
  Bounds result;
  for_each_object([&](Handle<Node> /*node*/, Handle<Mesh> mesh, const glm::dmat4 &world_from_object) {
    result.extend(transformed(meshes_[mesh].bounds, glm::mat4(world_from_object)));
  });
  return result;
}

std::vector<std::string> Scene::stale_references() const
{
  std::vector<std::string> lines;
  const auto check = [&](std::string_view kind, std::string_view name, const auto &pool, auto handle) {
    if (handle && !pool.is_live(handle)) {
      using T = std::decay_t<decltype(*pool.find(handle))>;
      lines.push_back(fmt::format("{} '{}': its {} was removed", kind, name, T::kind_name));
    }
  };
  for (const auto &[handle, node] : nodes_) {
    for (const Handle<Mesh> mesh : node.meshes) {
      check("node", node.name, meshes_, mesh);
    }
    check("node", node.name, lamps_, node.lamp);
    check("node", node.name, cameras_, node.camera);
  }
  for (const auto &[handle, mesh] : meshes_) {
    check("mesh", mesh.name, materials_, mesh.material);
  }
  for (const auto &[handle, material] : materials_) {
    for (const TextureInput &input : texture_inputs) {
      check("material", material.name, textures_, (material.*input.slot).texture);
    }
    check("material", material.name, surface_functions_, material.surface_function);
  }
  for (const auto &[handle, texture] : textures_) {
    check("texture", std::to_string(handle.index), images_, texture.image);
  }
  return lines;
}

const glm::dmat4 &Scene::world_from_node(Handle<Node> node) const
{
  return links(node).world_from_node;
}

bool Scene::is_visible(Handle<Node> node) const
{
  return links(node).is_visible;
}

Handle<Node> Scene::parent(Handle<Node> node) const
{
  return links(node).parent;
}

Handle<Node> Scene::first_child(Handle<Node> node) const
{
  return links(node).first_child;
}

Handle<Node> Scene::next_sibling(Handle<Node> node) const
{
  return links(node).next_sibling;
}

}  // namespace gnomon::scene
