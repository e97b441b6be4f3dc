// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <concepts>
#include <string>

/** Small scenes built in code. */
namespace gnomon::test {

/** A double-sided Lambertian material. */
inline scene::Handle<scene::Material> add_material(scene::Scene &scene, const glm::vec3 &albedo)
{
  scene::Material material;
  material.base_color = albedo;
  material.metallic = 0.0F;
  material.specular_color = glm::vec3(0.0F);
  material.is_double_sided = true;
  return scene.add(std::move(material));
}

/** Changes the material that was added first. */
template <std::invocable<scene::Material &> Change>
void edit_material(scene::Scene &scene, Change change)
{
  scene.edit(scene.materials().first(), change);
}

/** Changes the mesh that was added first. */
template <std::invocable<scene::Mesh &> Change>
void edit_mesh(scene::Scene &scene, Change change)
{
  scene.edit(scene.meshes().first(), change);
}

/** Triangles of the first material, three positions each, at a node of that matrix. */
inline scene::Handle<scene::Mesh> add_triangles(scene::Scene &scene, const std::vector<glm::vec3> &corners,
                                                const glm::mat4 &world_from_object = glm::mat4(1.0F))
{
  if (scene.materials().empty()) {
    add_material(scene, glm::vec3(1.0F));
  }
  scene::Mesh mesh;
  mesh.positions = corners;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const glm::vec3 normal = glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]);
    const float length = glm::length(normal);
    for (std::size_t k = 0; k < 3; k++) {
      mesh.normals.push_back(length > 0.0F ? normal / length : glm::vec3(0.0F, 0.0F, 1.0F));
      mesh.indices.push_back(std::uint32_t(i + k));
    }
  }
  mesh.material = scene.materials().first();
  const scene::Handle<scene::Mesh> handle = scene.add(std::move(mesh));
  scene::Node node;
  node.name = "object" + std::to_string(scene.nodes().size());
  node.parent_from_node = world_from_object;
  node.meshes = {handle};
  scene.add(std::move(node));
  return handle;
}

/** Adds a rectangle in the plane z = 0, facing +Z. */
inline scene::Handle<scene::Mesh> add_rectangle(scene::Scene &scene, const glm::vec2 &low, const glm::vec2 &high,
                                                const glm::mat4 &world_from_object = glm::mat4(1.0F))
{
  const glm::vec3 a(low, 0.0F);
  const glm::vec3 b(high.x, low.y, 0.0F);
  const glm::vec3 c(high, 0.0F);
  const glm::vec3 d(low.x, high.y, 0.0F);
  return add_triangles(scene, {a, b, c, a, c, d}, world_from_object);
}

inline glm::mat4 placed(const glm::vec3 &position)
{
  return glm::translate(glm::mat4(1.0F), position);
}

/** A lamp of intensity 1 at \a position that emits along \a forward. */
inline scene::PlacedLamp lamp_at(scene::LampKind kind, const glm::vec3 &position,
                                 const glm::vec3 &forward = {0.0F, 0.0F, -1.0F})
{
  scene::PlacedLamp lamp;
  lamp.name = "lamp";
  lamp.kind = kind;
  const glm::vec3 up = std::abs(glm::normalize(forward).y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  lamp.world_from_lamp = glm::inverse(glm::lookAt(glm::vec3(0.0F), forward, up));
  lamp.world_from_lamp[3] = glm::dvec4(position, 1.0);
  return lamp;
}

inline void add_lamp(scene::Scene &scene, const scene::PlacedLamp &lamp)
{
  scene::Node node;
  node.name = lamp.name;
  node.parent_from_node = lamp.world_from_lamp;
  node.lamp = scene.add(scene::Lamp(lamp));
  scene.add(std::move(node));
}

inline void add_camera(scene::Scene &scene, const scene::PlacedCamera &camera)
{
  scene::Node node;
  node.name = camera.name;
  node.parent_from_node = camera.world_from_camera;
  node.camera = scene.add(scene::Camera(camera));
  scene.add(std::move(node));
}

/** A camera that belongs to no scene. */
inline scene::PlacedCamera camera_at(const glm::vec3 &position, const glm::vec3 &target, float vertical_angle = 0.8F)
{
  scene::PlacedCamera camera;
  const glm::vec3 up = std::abs(glm::normalize(target - position).y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
  camera.world_from_camera = glm::inverse(glm::lookAt(position, target, up));
  camera.vertical_angle = vertical_angle;
  return camera;
}

}  // namespace gnomon::test
