// SPDX-License-Identifier: MIT
#include "view_additions.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace gnomon::view {

using scene::Handle;
using scene::Lamp;
using scene::LampKind;
using scene::Mesh;
using scene::Node;
using scene::Scene;

namespace {

using std::numbers::pi;

/** A square of four vertices around \a center; \a x and \a y are half its edges, and it faces where x and y turn. */
void add_square(Mesh &mesh, const glm::vec3 &center, const glm::vec3 &x, const glm::vec3 &y)
{
  const auto first = std::uint32_t(mesh.positions.size());
  for (const glm::vec3 &corner : {-x - y, x - y, x + y, -x + y}) {
    mesh.positions.push_back(center + corner);
    mesh.normals.push_back(glm::normalize(glm::cross(x, y)));
  }
  for (const std::uint32_t index : {0U, 1U, 2U, 0U, 2U, 3U}) {
    mesh.indices.push_back(first + index);
  }
}

/** 2 m wide, as are the others. */
Mesh plane_mesh()
{
  Mesh mesh{.name = "Plane"};
  add_square(mesh, {0, 0, 0}, {1, 0, 0}, {0, 0, -1});
  return mesh;
}

Mesh cube_mesh()
{
  Mesh mesh{.name = "Cube"};
  const glm::vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int axis = 0; axis < 3; axis++) {
    const glm::vec3 x = axes[(axis + 1) % 3];
    const glm::vec3 y = axes[(axis + 2) % 3];
    add_square(mesh, axes[axis], x, y);
    add_square(mesh, -axes[axis], -x, y);
  }
  return mesh;
}

Mesh sphere_mesh()
{
  constexpr int columns = 48;
  constexpr int rows = 24;
  Mesh mesh{.name = "Sphere"};
  const auto add = [&](double height, double turn) {
    const double from_top = pi * height;
    const double around = 2.0 * pi * turn;
    const glm::vec3 normal(std::sin(from_top) * std::cos(around), std::cos(from_top),
                           -std::sin(from_top) * std::sin(around));
    mesh.positions.push_back(normal);
    mesh.normals.push_back(normal);
  };
  add(0.0, 0.0);
  for (int row = 1; row < rows; row++) {
    for (int column = 0; column < columns; column++) {
      add(double(row) / rows, double(column) / columns);
    }
  }
  add(1.0, 0.0);
  const auto at = [&](int row, int column) { return std::uint32_t(1 + (row - 1) * columns + column % columns); };
  const auto last = std::uint32_t(mesh.positions.size() - 1);
  const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.indices.insert(mesh.indices.end(), {a, b, c});
  };
  for (int column = 0; column < columns; column++) {
    triangle(0, at(1, column), at(1, column + 1));
    triangle(last, at(rows - 1, column + 1), at(rows - 1, column));
    for (int row = 1; row + 1 < rows; row++) {
      triangle(at(row, column), at(row + 1, column), at(row + 1, column + 1));
      triangle(at(row, column), at(row + 1, column + 1), at(row, column + 1));
    }
  }
  return mesh;
}

template <Mesh (*Make)()>
void fill_mesh(Scene &scene, Node &node)
{
  Mesh mesh = Make();
  mesh.material =
      scene.add(scene::Material{.name = node.name, .base_color = glm::vec3(0.8F), .metallic = 0.0F, .roughness = 0.5F});
  node.meshes = {scene.add(std::move(mesh))};
}

/** Radiant power suits a distance of a few metres between lamp and objects. */
template <LampKind Kind>
void fill_lamp(Scene &scene, Node &node)
{
  Lamp lamp{.name = node.name, .kind = Kind};
  switch (Kind) {
    case LampKind::Point:
      lamp.intensity = 10.0F;
      lamp.radius = 0.1F;
      break;
    case LampKind::Sun:
      lamp.intensity = 3.0F;
      lamp.angle = float(0.526 * pi / 180.0);
      break;
    case LampKind::Spot:
      lamp.intensity = 20.0F;
      lamp.radius = 0.1F;
      lamp.spot_outer_angle = float(22.5 * pi / 180.0);
      lamp.spot_blend = 0.15F;
      break;
    case LampKind::Hemi: lamp.intensity = 0.5F; break;
    case LampKind::Area: lamp.intensity = 100.0F; break;
  }
  node.lamp = scene.add(std::move(lamp));
}

void fill_camera(Scene &scene, Node &node)
{
  node.camera = scene.add(scene::Camera{.name = node.name, .vertical_angle = 0.7F, .aspect = 1.5F});
}

constexpr std::array<Addition, 9> all = {{
    {"plane", "Plane", fill_mesh<plane_mesh>},
    {"cube", "Cube", fill_mesh<cube_mesh>},
    {"sphere", "Sphere", fill_mesh<sphere_mesh>},
    {"point", "Point", fill_lamp<LampKind::Point>, false, true},
    {"sun", "Sun", fill_lamp<LampKind::Sun>, false, true},
    {"spot", "Spot", fill_lamp<LampKind::Spot>, false, true},
    {"hemi", "Hemi", fill_lamp<LampKind::Hemi>, false, true},
    {"area", "Area", fill_lamp<LampKind::Area>, false, true},
    {"camera", "Camera", fill_camera, true},
}};

}  // namespace

std::span<const Addition> additions()
{
  return all;
}

NodeNames::NodeNames(const Scene &scene)
{
  for (const auto &[handle, node] : scene.nodes()) {
    last_numbers_.try_emplace(node.name, 0);
  }
}

std::string NodeNames::take(const std::string &name)
{
  const auto [found, is_free] = last_numbers_.try_emplace(name, 0);
  if (is_free) {
    return name;
  }
  // Unlike the iterator, the reference stays valid when names are added.
  int &number = found->second;
  std::string result;
  do {
    result = fmt::format("{}.{:03}", name, ++number);
  } while (!last_numbers_.try_emplace(result, 0).second);
  return result;
}

Handle<Node> add(Scene &scene, const Addition &addition, const glm::dvec3 &position_ws,
                 const glm::dmat4 &world_from_view)
{
  Node node{.name = NodeNames(scene).take(addition.label)};
  if (addition.is_placed_as_view) {
    node.parent_from_node = world_from_view;
  }
  else {
    node.parent_from_node = glm::translate(glm::dmat4(1.0), position_ws);
    if (addition.is_lamp) {
      // From -Z to -Y, exactly.
      node.parent_from_node[1] = {0.0, 0.0, -1.0, 0.0};
      node.parent_from_node[2] = {0.0, 1.0, 0.0, 0.0};
    }
  }
  addition.fill(scene, node);
  return scene.add(std::move(node));
}

Handle<Node> duplicate(Scene &scene, Handle<Node> root, NodeNames &names)
{
  const auto copy = [&](Handle<Node> original, Handle<Node> parent) {
    Node node = scene.nodes()[original];
    // "Lamp.001" becomes "Lamp.002", not "Lamp.001.001".
    const std::size_t dot = node.name.rfind('.');
    const bool is_numbered = dot != std::string::npos && node.name.size() == dot + 4 &&
                             node.name.find_first_not_of("0123456789", dot + 1) == std::string::npos;
    node.name = names.take(is_numbered ? node.name.substr(0, dot) : node.name);
    if (const Lamp *lamp = scene.lamps().find(node.lamp)) {
      Lamp own(*lamp);
      own.name = node.name;
      node.lamp = scene.add(std::move(own));
    }
    if (const scene::Camera *camera = scene.cameras().find(node.camera)) {
      scene::Camera own(*camera);
      own.name = node.name;
      node.camera = scene.add(std::move(own));
    }
    return scene.add(std::move(node), parent);
  };
  std::vector<std::pair<Handle<Node>, Handle<Node>>> copies = {{root, copy(root, scene.parent(root))}};
  for (std::size_t i = 0; i < copies.size(); i++) {
    const auto [original, parent] = copies[i];
    for (Handle<Node> child = scene.first_child(original); child; child = scene.next_sibling(child)) {
      copies.emplace_back(child, copy(child, parent));
    }
  }
  return copies.front().second;
}

}  // namespace gnomon::view
