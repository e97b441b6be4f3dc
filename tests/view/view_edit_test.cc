// SPDX-License-Identifier: MIT
#include "view_additions.hh"
#include "view_document.hh"
#include "view_fly.hh"
#include "view_gizmo.hh"
#include "view_history.hh"
#include "view_icons.hh"
#include "view_keys.hh"
#include "view_shader_watch.hh"
#include "view_time_line.hh"

#include "gltf_export.hh"
#include "gltf_import.hh"
#include "render_camera.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

namespace gnomon::view {
namespace {

using scene::Handle;
using scene::Node;

constexpr glm::ivec2 size_px{400, 300};

/** Far from the world's origin, and from a direction that is along no axis. */
const glm::dvec3 middle(2000, 30, -700);

PictureMap map_from(const glm::dvec3 &eye, scene::CameraKind kind = scene::CameraKind::Perspective)
{
  scene::PlacedCamera camera;
  camera.kind = kind;
  camera.half_width = 4.0F;
  camera.half_height = 3.0F;
  camera.far = 100.0F;
  camera.world_from_camera = glm::inverse(glm::lookAt(eye, middle, glm::dvec3(0, 1, 0)));
  const glm::dvec3 origin_ws(2048, 0, -1024);
  return {render_scene::view_of(camera, size_px, origin_ws), origin_ws, size_px};
}

const glm::dvec3 eye = middle + glm::dvec3(3, 4, 6);

glm::dmat4 placed_at(const glm::dvec3 &position)
{
  glm::dmat4 matrix = glm::translate(glm::dmat4(1), position);
  matrix = glm::rotate(matrix, 0.6, glm::normalize(glm::dvec3(1, 2, 3)));
  return glm::scale(matrix, {1, 2, 0.5});
}

double difference(const glm::dmat4 &a, const glm::dmat4 &b)
{
  double largest = 0.0;
  for (int i = 0; i < 16; i++) {
    largest = std::max(largest, std::abs(a[i / 4][i % 4] - b[i / 4][i % 4]));
  }
  return largest;
}

TEST(ViewPictureMapTest, ARayThroughThePixelOfAPointMeetsIt)
{
  for (const auto kind : {scene::CameraKind::Perspective, scene::CameraKind::Orthographic}) {
    const PictureMap map = map_from(eye, kind);
    for (const glm::dvec3 &point : {middle, middle + glm::dvec3(1, 0.5, -0.3), middle + glm::dvec3(-2, 0, 1)}) {
      const glm::dvec2 pixel = *map.pixel_of(point);
      const Ray ray = map.ray_through(pixel);
      const glm::dvec3 way = point - ray.origin_ws;
      EXPECT_LT(glm::length(glm::cross(ray.direction_ws, way)), 1e-3);
      EXPECT_GT(glm::dot(ray.direction_ws, way), 0.0);
      // To the right by ten pixels.
      const glm::dvec3 beside = point + 10.0 * map.metres_per_pixel(point) * map.axis_ws(0);
      EXPECT_LT(glm::distance(*map.pixel_of(beside), pixel + glm::dvec2(10, 0)), 1e-3);
    }
    EXPECT_LT(glm::distance(*map.pixel_of(middle), 0.5 * glm::dvec2(size_px)), 0.05);
    EXPECT_LT(glm::distance(map.towards_eye(middle), glm::normalize(eye - middle)), 1e-5);
  }
  EXPECT_FALSE(map_from(eye).pixel_of(eye + (eye - middle)));
}

class ViewTransformTest : public testing::Test {
 protected:
  ViewTransformTest()
  {
    glm::dmat4 parent_matrix = glm::rotate(glm::translate(glm::dmat4(1), middle), 1.1, glm::dvec3(0, 0, 1));
    parent_matrix = glm::scale(parent_matrix, {2, 1, 1});
    parent = scene.add(Node{.name = "parent", .parent_from_node = parent_matrix});
    node = scene.add(Node{.name = "node", .parent_from_node = placed_at({0.2, 0.1, 0.3})}, parent);
  }
  [[nodiscard]] glm::dmat4 world() const
  {
    return scene.world_from_node(node);
  }
  TransformOperation begin(const Transform &transform, const glm::dvec2 &pointer = {200, 150})
  {
    return {scene, node, transform, map, pointer};
  }
  glm::dmat4 world_after(const TransformOperation &operation)
  {
    scene.set_transform(node, operation.parent_from_node());
    return world();
  }
  static void type(TransformOperation &operation, std::string_view text)
  {
    for (const char character : text) {
      EXPECT_TRUE(operation.type(character)) << character;
    }
  }

  scene::Scene scene;
  Handle<Node> parent;
  Handle<Node> node;
  PictureMap map = map_from(eye);
};

TEST_F(ViewTransformTest, ANodeFollowsThePointerInThePicturesPlaneAndAlongAnAxis)
{
  const glm::dmat4 before = world();
  const glm::dvec2 from = *map.pixel_of(glm::dvec3(before[3]));
  const glm::dvec2 to = from + glm::dvec2(40, -25);
  TransformOperation free = begin({TransformKind::Move}, from);
  free.point(to);
  glm::dmat4 after = world_after(free);
  EXPECT_LT(glm::distance(*map.pixel_of(glm::dvec3(after[3])), to), 1e-3);
  EXPECT_LT(std::abs(glm::dot(glm::dvec3(after[3] - before[3]), map.axis_ws(2))), 1e-5) << "at the same depth";

  scene.set_transform(node, glm::inverse(scene.world_from_node(parent)) * before);
  const glm::dvec3 target = glm::dvec3(before[3]) + glm::dvec3(0, 0.7, 0);
  TransformOperation along = begin({TransformKind::Move, TransformAxis::Y}, from);
  along.point(*map.pixel_of(target));
  after = world_after(along);
  EXPECT_LT(glm::distance(glm::dvec3(after[3]), target), 1e-4);
  EXPECT_LT(difference(glm::dmat4(glm::dmat3(after)), glm::dmat4(glm::dmat3(before))), 1e-9);
}

TEST_F(ViewTransformTest, TypedNumbersReplaceThePointer)
{
  const glm::dmat4 before = world();
  TransformOperation operation = begin({TransformKind::Move, TransformAxis::Z});
  operation.point({10, 20});
  type(operation, "1.25-\b5");
  glm::dmat4 expected = before;
  expected[3][2] -= 1.25;
  EXPECT_LT(difference(world_after(operation), expected), 1e-9);
  EXPECT_FALSE(operation.type('x'));
  EXPECT_FALSE(operation.type('.')) << "a second one";
  EXPECT_NE(operation.text().find("along Z"), std::string::npos) << operation.text();
}

TEST_F(ViewTransformTest, TurnsKeepThePositionAndGoAroundTheAxisThatIsAskedFor)
{
  const glm::dmat4 before = world();
  for (const Orientation orientation : {Orientation::World, Orientation::Local}) {
    scene.set_transform(node, glm::inverse(scene.world_from_node(parent)) * before);
    TransformOperation operation = begin({TransformKind::Rotate, TransformAxis::X, orientation});
    type(operation, "90");
    const glm::dmat4 after = world_after(operation);
    EXPECT_LT(glm::distance(glm::dvec3(after[3]), glm::dvec3(before[3])), 1e-9);
    const glm::dvec3 axis = axis_ws(before, TransformAxis::X, orientation);
    for (int column = 0; column < 3; column++) {
      const glm::dvec3 was(before[column]);
      const glm::dvec3 along = glm::dot(was, axis) * axis;
      EXPECT_LT(glm::distance(glm::dvec3(after[column]), along + glm::cross(axis, was)), 1e-9);
    }
  }
}

TEST_F(ViewTransformTest, AroundTheNodeThePointerTurnsItAsItIsSeenAlsoByMoreThanATurn)
{
  // A point above the centre of the picture moves to the left.
  const glm::dvec2 center = *map.pixel_of(glm::dvec3(world()[3]));
  TransformOperation operation = begin({TransformKind::Rotate}, center + glm::dvec2(50, 0));
  const int steps = 36 + 9;
  for (int step = 1; step <= steps; step++) {
    const double angle = 2.0 * 3.14159265358979 * step / 36.0;
    operation.point(center + 50.0 * glm::dvec2(std::cos(angle), -std::sin(angle)));
  }
  EXPECT_NE(operation.text().find("450°"), std::string::npos) << operation.text();
  const glm::dmat4 before = world();
  const glm::dmat4 after = world_after(operation);
  const glm::dmat3 turn = glm::dmat3(after) * glm::inverse(glm::dmat3(before));
  EXPECT_GT(glm::dot(turn * map.axis_ws(1), -map.axis_ws(0)), 0.99);
}

TEST_F(ViewTransformTest, ScalesAreAlongAllAxesOneOfTheNodeOrOneOfTheWorld)
{
  const glm::dmat4 before = world();
  const auto after = [&](const Transform &transform) {
    scene.set_transform(node, glm::inverse(scene.world_from_node(parent)) * before);
    TransformOperation operation = begin(transform);
    type(operation, "3");
    return world_after(operation);
  };
  const glm::dmat4 all = after({TransformKind::Scale});
  const glm::dmat4 local = after({TransformKind::Scale, TransformAxis::Y, Orientation::Local});
  const glm::dmat4 global = after({TransformKind::Scale, TransformAxis::Y, Orientation::World});
  for (int column = 0; column < 3; column++) {
    EXPECT_LT(glm::distance(glm::dvec3(all[column]), 3.0 * glm::dvec3(before[column])), 1e-9);
    EXPECT_LT(glm::distance(glm::dvec3(local[column]), (column == 1 ? 3.0 : 1.0) * glm::dvec3(before[column])), 1e-9);
    EXPECT_LT(glm::distance(glm::dvec3(global[column]), glm::dvec3(1, 3, 1) * glm::dvec3(before[column])), 1e-9);
  }
  for (const glm::dmat4 &scaled : {all, local, global}) {
    EXPECT_LT(glm::distance(glm::dvec3(scaled[3]), glm::dvec3(before[3])), 1e-9);
  }
}

TEST_F(ViewTransformTest, AnAxisThatIsAskedForAgainIsTheOtherOrientationsAndThenNone)
{
  TransformOperation operation = begin({TransformKind::Move});
  operation.toggle_axis(TransformAxis::X);
  EXPECT_EQ(operation.transform(), (Transform{TransformKind::Move, TransformAxis::X, Orientation::World}));
  operation.toggle_axis(TransformAxis::X);
  EXPECT_EQ(operation.transform(), (Transform{TransformKind::Move, TransformAxis::X, Orientation::Local}));
  operation.toggle_axis(TransformAxis::Y);
  EXPECT_EQ(operation.transform(), (Transform{TransformKind::Move, TransformAxis::Y, Orientation::World}));
  operation.toggle_axis(TransformAxis::Y);
  operation.toggle_axis(TransformAxis::Y);
  EXPECT_EQ(operation.transform(), Transform{TransformKind::Move});
}

TEST_F(ViewTransformTest, AParentWithoutAnInverseIsNamed)
{
  scene.set_transform(parent, glm::dmat4(glm::dmat3(0.0)));
  EXPECT_THROW(begin({TransformKind::Move}), std::runtime_error);
  // Rounding leaves this one a determinant of about 1e-17.
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  scene.set_transform(parent, turn * glm::scale(glm::dmat4(1.0), {1, 0, 1}) * turn);
  EXPECT_THROW(begin({TransformKind::Move}), std::runtime_error);
}

TEST_F(ViewTransformTest, TheHandleAtTheEndOfEachAxisIsThatOfTheAxis)
{
  const glm::dmat4 place = placed_at(middle);
  for (const TransformKind kind : {TransformKind::Move, TransformKind::Scale}) {
    for (const Orientation orientation : {Orientation::World, Orientation::Local}) {
      const Gizmo gizmo{place, kind, orientation};
      for (const TransformAxis axis : {TransformAxis::X, TransformAxis::Y, TransformAxis::Z}) {
        const glm::dvec3 tip = middle + 70.0 * map.metres_per_pixel(middle) * axis_ws(place, axis, orientation);
        EXPECT_EQ(gizmo.handle_at(map, *map.pixel_of(tip)), axis) << int(kind) << int(orientation) << int(axis);
      }
      EXPECT_EQ(gizmo.handle_at(map, {5, 5}), std::nullopt);
    }
  }
  // The rings of a turn are seen at the side that faces the eye, and the outermost is around the line of sight.
  const Gizmo gizmo{place, TransformKind::Rotate, Orientation::World};
  const glm::dvec3 to_eye = glm::normalize(eye - middle);
  for (int i = 0; i < 3; i++) {
    glm::dvec3 axis(0.0);
    axis[i] = 1.0;
    const glm::dvec3 front = glm::normalize(to_eye - glm::dot(to_eye, axis) * axis);
    const glm::dvec3 on_ring = middle + 80.0 * map.metres_per_pixel(middle) * front;
    EXPECT_EQ(gizmo.handle_at(map, *map.pixel_of(on_ring)), TransformAxis(i + 1)) << i;
  }
  EXPECT_EQ(gizmo.handle_at(map, *map.pixel_of(middle) + glm::dvec2(92, 0)), TransformAxis::All);
}

TEST(ViewHistoryTest, WhatWasRemovedComesBackWithItsEditsWhereItWasAndCanBeEditedOn)
{
  scene::Scene scene;
  History history;
  const auto first = scene.add(Node{.name = "first"});
  const auto root = scene.add(Node{.name = "root"}, first);
  const auto child = scene.add(Node{.name = "child"}, root);
  scene.add(Node{.name = "grandchild"}, child);
  scene.add(Node{.name = "last"});
  const auto names = [&] {
    std::string text;
    for (const auto &[handle, node] : scene.nodes()) {
      text += node.name + "<" + (scene.parent(handle) ? scene.nodes()[scene.parent(handle)].name : "") + " ";
    }
    return text;
  };
  const std::string before = names();
  history.edit(scene, child, [](Node &node) { node.is_visible = false; });
  const std::string edited = names();
  history.remove(scene, root);
  EXPECT_EQ(names(), "first< last< ");

  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(names(), edited);
  ASSERT_EQ(history.restored(), std::vector{root}) << "with its old handle";
  // The edit from before the removal is undone on the node that came back.
  const auto restored_child = scene.first_child(history.restored()[0]);
  EXPECT_EQ(restored_child, child);
  EXPECT_FALSE(scene.nodes()[restored_child].is_visible);
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(names(), before);
  EXPECT_TRUE(scene.nodes()[restored_child].is_visible);
  EXPECT_TRUE(history.redo(scene));
  EXPECT_FALSE(scene.nodes()[restored_child].is_visible);
  EXPECT_TRUE(history.redo(scene));
  EXPECT_EQ(names(), "first< last< ");
  EXPECT_FALSE(history.redo(scene));
}

TEST(ViewHistoryTest, AChildComesBackBetweenItsSiblings)
{
  scene::Scene scene;
  History history;
  const auto parent = scene.add(Node{.name = "parent"});
  std::vector<scene::Handle<Node>> children;
  for (const char *name : {"1", "2", "3", "4"}) {
    children.push_back(scene.add(Node{.name = name}, parent));
  }
  const auto names = [&] {
    std::string text;
    for (auto child = scene.first_child(parent); child; child = scene.next_sibling(child)) {
      text += scene.nodes()[child].name;
    }
    return text;
  };
  history.remove(scene, children[2]);
  history.remove(scene, children[1]);
  EXPECT_EQ(names(), "14");
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(names(), "124");
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(names(), "1234");
  EXPECT_TRUE(history.redo(scene));
  EXPECT_TRUE(history.redo(scene));
  EXPECT_TRUE(history.undo(scene));
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(names(), "1234");
  EXPECT_FALSE(history.undo(scene));
  EXPECT_TRUE(history.restored().empty()) << "nothing was undone";
}

TEST(ViewHistoryTest, AnAdditionIsUndoneAndRedoneAlsoWithLaterEditsOfIt)
{
  scene::Scene scene;
  History history;
  const auto node = scene.add(Node{.name = "added"});
  history.note_added(scene, node);
  history.edit(scene, node, [](Node &edited) { edited.name = "edited"; });
  EXPECT_EQ(history.undo_count(), 2U);
  for (int round = 0; round < 3; round++) {
    EXPECT_TRUE(history.undo(scene));
    EXPECT_TRUE(history.undo(scene));
    EXPECT_TRUE(scene.nodes().empty());
    EXPECT_TRUE(history.redo(scene));
    EXPECT_EQ(scene.nodes()[history.restored().at(0)].name, "added");
    EXPECT_TRUE(history.redo(scene));
    EXPECT_EQ((*scene.nodes().begin()).value.name, "edited");
  }
}

TEST(ViewHistoryTest, JoinedChangesAreOneStepOfAnyLength)
{
  scene::Scene scene;
  History history;
  std::vector<scene::Handle<scene::Node>> nodes;
  for (const char *name : {"a", "b", "c"}) {
    nodes.push_back(scene.add(scene::Node{.name = name}));
  }
  const auto hidden = [&] {
    return std::ranges::count_if(nodes, [&](auto node) {
      const scene::Node *one = scene.nodes().find(node);
      return one && !one->is_visible;
    });
  };
  const auto hide = [](scene::Node &node) { node.is_visible = !node.is_visible; };
  history.edit(scene, nodes[2], hide);
  history.join([&] {
    history.edit(scene, nodes[0], hide);
    history.edit(scene, nodes[1], hide);
    history.remove(scene, nodes[2]);
  });
  history.edit(scene, nodes[0], hide);
  history.end_gesture();
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(hidden(), 2);
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(hidden(), 1);
  EXPECT_TRUE(scene.nodes().is_live(nodes[2]));
  EXPECT_TRUE(history.redo(scene));
  EXPECT_EQ(hidden(), 2);
  EXPECT_FALSE(scene.nodes().is_live(nodes[2]));
  EXPECT_TRUE(history.undo(scene));
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(hidden(), 0);
  EXPECT_FALSE(history.undo(scene));
  // A step that ends by an exception has the changes before it, and none of those that follow.
  EXPECT_THROW(history.join([&] {
    history.edit(scene, nodes[0], hide);
    throw std::runtime_error("no");
  }),
               std::runtime_error);
  history.edit(scene, nodes[0], hide);
  history.end_gesture();
  history.edit(scene, nodes[1], hide);
  EXPECT_EQ(history.undo_count(), 3U);
  EXPECT_TRUE(history.undo(scene));
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(hidden(), 1);
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(hidden(), 0);
  // More changes than steps are kept.
  history.join([&] {
    for (std::size_t i = 0; i < 2 * History::step_max + 1; i++) {
      history.edit(scene, nodes[i % 2], hide);
    }
  });
  EXPECT_EQ(hidden(), 1);
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(hidden(), 0);
  EXPECT_FALSE(history.undo(scene));
}

TEST(ViewAdditionsTest, WhatIsAddedIsReadBackAsItWasAndSurfacesFaceOutwards)
{
  scene::Scene scene;
  const glm::dmat4 view = placed_at({1, 2, 3});
  glm::dmat4 rigid = scene::frame_of(view);
  for (int round = 0; round < 2; round++) {
    for (const Addition &addition : additions()) {
      add(scene, addition, {0.1, -2.5, 3.7}, rigid);
    }
  }
  NodeNames taken(scene);
  const auto copied = duplicate(scene, (*scene.nodes().begin()).handle, taken);
  EXPECT_EQ(scene.nodes()[copied].name, "Plane.002");
  for (const auto &[handle, mesh] : scene.meshes()) {
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const glm::vec3 &a = mesh.positions[mesh.indices[i]];
      const glm::vec3 face =
          glm::cross(mesh.positions[mesh.indices[i + 1]] - a, mesh.positions[mesh.indices[i + 2]] - a);
      ASSERT_GT(glm::length(face), 1e-4F) << mesh.name;
      for (std::size_t corner = i; corner < i + 3; corner++) {
        const glm::vec3 &normal = mesh.normals[mesh.indices[corner]];
        EXPECT_GT(glm::dot(glm::normalize(face), normal), 0.9F) << mesh.name;
        EXPECT_TRUE(mesh.name == "Plane" || glm::dot(normal, mesh.positions[mesh.indices[corner]]) > 0.0F);
      }
    }
  }
  // The nodes are moved apart, because the importer splits triangles at vertices of others that lie on their edges.
  std::vector<scene::Handle<scene::Node>> nodes;
  for (const auto &[handle, node] : scene.nodes()) {
    nodes.push_back(handle);
  }
  for (std::size_t i = 0; i < nodes.size(); i++) {
    scene.edit(nodes[i], [i](scene::Node &node) { node.parent_from_node[3].x += 16.0 * double(i); });
  }
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "additions.glb";
  gltf::export_gltf(scene, path);
  const scene::Scene read = gltf::import_gltf(path);
  std::filesystem::remove(path);
  EXPECT_TRUE(read.warnings.empty()) << read.warnings.front();
  ASSERT_EQ(read.nodes().size(), scene.nodes().size());
  std::set<std::string> names;
  auto found = read.nodes().begin();
  for (const auto &[handle, node] : scene.nodes()) {
    const auto [other_handle, other] = *found;
    ++found;
    EXPECT_TRUE(names.insert(node.name).second) << node.name;
    EXPECT_EQ(other.name, node.name);
    EXPECT_EQ(other.parent_from_node, node.parent_from_node) << node.name;
    ASSERT_EQ(bool(other.lamp), bool(node.lamp)) << node.name;
    ASSERT_EQ(bool(other.camera), bool(node.camera)) << node.name;
    ASSERT_EQ(other.meshes.size(), node.meshes.size()) << node.name;
    if (node.lamp) {
      const scene::Lamp &lamp = scene.lamps()[node.lamp];
      const scene::Lamp &other_lamp = read.lamps()[other.lamp];
      EXPECT_EQ(other_lamp.kind, lamp.kind) << node.name;
      // glTF has photometric units, in which an intensity is rounded.
      EXPECT_NEAR(other_lamp.intensity, lamp.intensity, 1e-5F * lamp.intensity) << node.name;
      EXPECT_EQ(other_lamp.radius, lamp.radius) << node.name;
      EXPECT_EQ(other_lamp.angle, lamp.angle) << node.name;
    }
    if (!node.meshes.empty()) {
      const scene::Mesh &mesh = scene.meshes()[node.meshes.front()];
      const scene::Mesh &other_mesh = read.meshes()[other.meshes.front()];
      EXPECT_EQ(other_mesh.positions, mesh.positions) << node.name;
      EXPECT_EQ(other_mesh.normals, mesh.normals) << node.name;
      EXPECT_EQ(other_mesh.indices, mesh.indices) << node.name;
      EXPECT_EQ(read.material_of(other_mesh).base_color, scene.material_of(mesh).base_color) << node.name;
    }
  }
}

TEST(ViewAdditionsTest, ADuplicateHasItsDescendantsAndLampsOfItsOwn)
{
  scene::Scene scene;
  const auto root = scene.add(Node{.name = "Root"});
  const auto lamp = scene.add(scene::Lamp{.name = "Lamp"});
  scene.add(Node{.name = "Lamp", .lamp = lamp}, root);
  NodeNames names(scene);
  const auto copy = duplicate(scene, root, names);
  EXPECT_EQ(scene.nodes()[copy].name, "Root.001");
  const Node &child = scene.nodes()[scene.first_child(copy)];
  EXPECT_EQ(child.name, "Lamp.001");
  EXPECT_NE(child.lamp, lamp);
  scene::Lamp named = scene.lamps()[lamp];
  named.name = "Lamp.001";
  EXPECT_EQ(scene.lamps()[child.lamp], named);
  EXPECT_FALSE(scene.next_sibling(scene.first_child(copy)));
}

TEST(ViewIconsTest, ConesAreLinesAtTheAngleOfTheSpotAndSunsAlongTheirDirection)
{
  const auto all = [](scene::Handle<scene::Node> /*node*/) { return true; };
  scene::Scene scene;
  glm::dmat4 place = scene::frame_of(placed_at(middle));
  const auto spot = scene.add(
      scene::Lamp{.kind = scene::LampKind::Spot, .spot_outer_angle = 0.4F, .spot_blend = 0.3F, .range = 2.5F});
  const auto node = scene.add(Node{.parent_from_node = place, .lamp = spot});
  const PictureMap map = map_from(eye);
  const glm::dvec3 forward = -glm::dvec3(place[2]);
  double widest = 0.0;
  for (const overlay::Line &line : icon_lines(scene, map, {}, all)) {
    EXPECT_FALSE(line.is_on_top);
    const glm::dvec3 way = line.to_ws - middle;
    EXPECT_NEAR(glm::length(way), 2.5, 1e-6);
    widest = std::max(widest, std::acos(glm::dot(glm::normalize(way), forward)));
  }
  EXPECT_NEAR(widest, 0.4, 1e-6);
  for (const overlay::Line &line : icon_lines(scene, map, {&node, 1}, all)) {
    EXPECT_TRUE(line.is_on_top) << "it is selected";
  }

  scene.edit(spot, [](scene::Lamp &lamp) { lamp.kind = scene::LampKind::Sun; });
  double longest = 0.0;
  glm::dvec3 direction(0.0);
  for (const overlay::Line &line : icon_lines(scene, map, {}, all)) {
    if (glm::distance(line.from_ws, line.to_ws) > longest) {
      longest = glm::distance(line.from_ws, line.to_ws);
      direction = glm::normalize(line.to_ws - line.from_ws);
    }
  }
  EXPECT_LT(glm::distance(direction, forward), 1e-9);
  scene.edit(node, [](Node &hidden) { hidden.is_visible = false; });
  EXPECT_TRUE(icon_lines(scene, map, {}, all).empty());
}

TEST(ViewFlyTest, KeysMoveTheEyeAlongItsAxesAndThePointerTurnsItInPlace)
{
  Navigation navigation;
  navigation.frame({glm::vec3(-1.0F), glm::vec3(1.0F)});
  navigation.orbit({0.4, -0.2});
  Fly fly(navigation);
  const glm::dmat4 before = navigation.camera(1.0).world_from_camera;
  fly.step(navigation, {.looked = {0.3, 0.1}});
  const glm::dmat4 turned = navigation.camera(1.0).world_from_camera;
  EXPECT_LT(glm::distance(turned[3], before[3]), 1e-9);
  EXPECT_GT(glm::dot(-turned[2], before[0]), 0.1) << "to the right";
  EXPECT_LT(turned[2].y, 1.0);
  EXPECT_LT(glm::dot(-turned[2], before[1]), -0.05) << "and down";
  const double speed = fly.speed();
  fly.step(navigation, {.direction = {0, 0, -1}, .seconds = 0.05});
  const glm::dmat4 moved = navigation.camera(1.0).world_from_camera;
  EXPECT_LT(glm::distance(moved[3], turned[3] - 0.05 * speed * turned[2]), 1e-9);
  fly.step(navigation, {.wheel = 2.0});
  EXPECT_GT(fly.speed(), 1.3 * speed);
  EXPECT_LT(difference(fly.before().camera(1.0).world_from_camera, before), 1e-12);
}

TEST(ViewShaderWatchTest, EachWriteAdditionAndRemovalOfAFileIsSeenOnceAndFilesAreThoseOfTheirTime)
{
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / "view_shader_watch";
  fs::remove_all(folder);
  EXPECT_THROW(ShaderWatch{folder}, std::runtime_error);
  fs::create_directories(folder / "eevee");
  const auto write = [&](const char *name, const char *text, int second) {
    std::ofstream(folder / name) << text;
    fs::last_write_time(folder / name, fs::file_time_type(std::chrono::seconds(second)));
  };
  write("eevee/a.glsl", "first", 1);
  ShaderWatch watch(folder);
  EXPECT_TRUE(watch.has_changed());
  EXPECT_FALSE(watch.has_changed());
  const gpu::ShaderFiles first = watch.files();
  EXPECT_EQ(first("eevee/a.glsl"), "first");
  write("eevee/a.glsl", "other", 2);
  EXPECT_TRUE(watch.has_changed());
  EXPECT_EQ(first("eevee/a.glsl"), "first");
  EXPECT_EQ(watch.files()("eevee/a.glsl"), "other");
  write("b.glsl", "", 2);
  EXPECT_TRUE(watch.has_changed());
  fs::remove(folder / "b.glsl");
  EXPECT_TRUE(watch.has_changed());
  EXPECT_FALSE(watch.has_changed());
  EXPECT_FALSE(watch.files()("b.glsl"));
  fs::remove_all(folder);
}

TEST(ViewDocumentTest, ASurfaceFunctionIsReadAgainWhenItsFileIsWrittenWhichIsNoEdit)
{
  namespace fs = std::filesystem;
  const fs::path file = fs::path(testing::TempDir()) / "view_surface.glsl";
  const auto write = [&](const std::string &text, int second) {
    std::ofstream(file) << text;
    fs::last_write_time(file, fs::file_time_type(std::chrono::seconds(second)));
  };
  write("first", 1);
  scene::Scene scene;
  const auto function = scene.add(scene::SurfaceFunction{.name = "a", .text = "first", .path = file.string()});
  // One without a file is never read.
  const auto other = scene.add(scene::SurfaceFunction{.name = "b", .text = "other"});
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  Document document(*device, std::move(scene), default_settings());
  EXPECT_TRUE(document.reload_surface_functions().empty());
  write("second", 2);
  EXPECT_EQ(document.reload_surface_functions().size(), 1U);
  EXPECT_EQ(document.scene().surface_functions()[function].text, "second");
  EXPECT_TRUE(document.is_saved());
  EXPECT_EQ(document.history().undo_count(), 0U);
  EXPECT_TRUE(document.reload_surface_functions().empty());
  // An editor may replace a file by another one.
  fs::remove(file);
  EXPECT_TRUE(document.reload_surface_functions().empty());
  EXPECT_EQ(document.scene().surface_functions()[function].text, "second");
  write(std::string(scene::SurfaceFunction::text_bytes_max + 1, 'a'), 3);
  EXPECT_NE(document.reload_surface_functions().at(0).find("65537 bytes"), std::string::npos);
  EXPECT_EQ(document.scene().surface_functions()[function].text, "second");
  write("third", 4);
  EXPECT_EQ(document.reload_surface_functions().size(), 1U);
  EXPECT_EQ(document.scene().surface_functions()[function].text, "third");
  EXPECT_EQ(document.scene().surface_functions()[other].text, "other");
  fs::remove(file);
}

TEST(ViewDocumentTest, SeveralNodesAreSelectedTheFirstOfThemForThePanelsAndWhatIsRemovedIsNot)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  using Nodes = std::vector<scene::Handle<scene::Node>>;
  Nodes nodes;
  for (const char *name : {"a", "b", "c"}) {
    nodes.push_back(scene.add(scene::Node{.name = name}));
  }
  const auto child = scene.add(scene::Node{.name = "child"}, nodes[0]);
  Document document(*device, std::move(scene), default_settings());
  document.select(Nodes{nodes[1], nodes[0]});
  EXPECT_EQ(document.selected, nodes[1]);
  EXPECT_EQ(document.selected_nodes(), (Nodes{nodes[1], nodes[0], child}));
  document.select(nodes[2], true);
  EXPECT_EQ(document.selection(), (Nodes{nodes[2], nodes[1], nodes[0]}));
  document.select(child, true);
  EXPECT_EQ(document.selected_nodes().size(), 4U) << "a child is there once";
  document.select(Nodes(), true);
  EXPECT_EQ(document.selected, child) << "nothing is added";
  document.select(nodes[1]);
  EXPECT_EQ(document.selection(), Nodes{nodes[1]});
  EXPECT_FALSE(document.is_selected(nodes[0]));

  document.select(Nodes{child, nodes[0], nodes[1]});
  EXPECT_TRUE(document.remove_selected());
  EXPECT_EQ(document.scene().nodes().size(), 1U);
  EXPECT_TRUE(document.selection().empty());
  EXPECT_FALSE(document.remove_selected());
  EXPECT_TRUE(document.undo());
  EXPECT_EQ(document.scene().nodes().size(), 4U);
  EXPECT_EQ(document.scene().parent(child), nodes[0]);
  EXPECT_EQ(document.selected_nodes().size(), 3U) << "the nodes that were restored";
  EXPECT_FALSE(document.undo());

  document.add(additions().front(), glm::dvec3(0.0), glm::dmat4(1.0));
  document.select(nodes[1], true);
  document.select(document.selection().back(), true);
  EXPECT_TRUE(document.undo());
  EXPECT_EQ(document.selected, nodes[1]) << "the node beside the one that is gone";
}

/** Two nodes with turned parents, and a child of one. */
class ViewDocumentTransformTest : public testing::Test {
 protected:
  ViewDocumentTransformTest()
  {
    scene::Scene made;
    parent = made.add(Node{.name = "parent", .parent_from_node = placed_at({1, 2, 3})});
    a = made.add(Node{.name = "a", .parent_from_node = placed_at(middle)});
    b = made.add(Node{.name = "b", .parent_from_node = placed_at({0.5, 0, 1})}, parent);
    child = made.add(Node{.name = "child", .parent_from_node = placed_at({0, 0.5, 0})}, b);
    document.emplace(*device, std::move(made), default_settings());
  }
  [[nodiscard]] std::array<glm::dmat4, 3> worlds() const
  {
    return {document->scene().world_from_node(a), document->scene().world_from_node(b),
            document->scene().world_from_node(child)};
  }
  void set_matrix(Handle<Node> node, const glm::dmat4 &matrix)
  {
    document->edit(node, [&](Node &edited) { edited.parent_from_node = matrix; });
    document->history().end_gesture();
  }
  void begin(TransformKind kind, std::string_view typed, Orientation orientation = Orientation::World)
  {
    document->begin_transform({kind, TransformAxis::Y, orientation}, map_from(eye), {200, 150});
    for (const char character : typed) {
      document->operation()->type(character);
      document->update_transform();
    }
  }
  void transform(TransformKind kind, std::string_view typed, bool is_kept)
  {
    begin(kind, typed);
    document->end_transform(is_kept);
  }

  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  Handle<Node> parent, a, b, child;
  std::optional<Document> document;
};

TEST_F(ViewDocumentTransformTest, AllSelectedNodesMoveTurnAndScaleAroundTheOneOfTheGizmoAsOneStep)
{
  const auto before = worlds();
  // A child follows its selected parent, also the child that has the gizmo.
  for (const auto &[nodes, gizmo] : {std::pair(std::vector{a, b, child}, 0), {std::vector{child, b, a}, 2}}) {
    document->select(nodes);
    const glm::dvec3 pivot(before[std::size_t(gizmo)][3]);
    const auto around = [&](const glm::dmat4 &change) {
      return glm::translate(glm::dmat4(1), pivot) * change * glm::translate(glm::dmat4(1), -pivot);
    };
    for (const auto &[kind, typed, change] :
         {std::tuple(TransformKind::Move, "1.5", glm::translate(glm::dmat4(1), {0, 1.5, 0})),
          {TransformKind::Rotate, "90", around(glm::rotate(glm::dmat4(1), glm::radians(90.0), glm::dvec3(0, 1, 0)))},
          {TransformKind::Scale, "3", around(glm::scale(glm::dmat4(1), {1, 3, 1}))}}) {
      transform(kind, typed, true);
      const auto after = worlds();
      for (std::size_t i = 0; i < 3; i++) {
        EXPECT_LT(difference(after[i], change * before[i]), 1e-8) << typed << ' ' << i << ", gizmo at " << gizmo;
      }
      EXPECT_EQ(document->history().undo_count(), 1U);
      EXPECT_TRUE(document->undo());
      EXPECT_EQ(worlds(), before);
      EXPECT_TRUE(document->redo());
      EXPECT_EQ(worlds(), after);
      EXPECT_TRUE(document->undo());
      transform(kind, typed, false);
      EXPECT_EQ(worlds(), before) << "not kept";
      EXPECT_EQ(document->history().undo_count(), 0U);
    }
  }
}

TEST_F(ViewDocumentTransformTest, TheRoundingOfInversesMakesNoMatrixInvalid)
{
  set_matrix(a, glm::scale(glm::translate(glm::dmat4(1), middle), {7, 7, 1}));
  set_matrix(parent, glm::scale(glm::rotate(glm::dmat4(1), 0.6, glm::normalize(glm::dvec3(1, 2, 3))), {7, 7, 1}));
  const auto before = worlds();
  // 49 * (1 / 49) is not 1 in floating point.
  const glm::dmat4 inverse = glm::inverse(before[0]);
  ASSERT_NE(inverse[3][3], 1.0);
  document->select(std::vector{a, b});
  for (const TransformKind kind : {TransformKind::Move, TransformKind::Rotate, TransformKind::Scale}) {
    for (const Orientation orientation : {Orientation::World, Orientation::Local}) {
      ASSERT_NO_THROW(begin(kind, "2", orientation));
      const auto after = worlds();
      EXPECT_GT(difference(after[0], before[0]), 0.01);
      EXPECT_LT(difference(after[1], after[0] * inverse * before[1]), 1e-8) << int(kind) << ' ' << int(orientation);
      document->end_transform(false);
    }
  }
}

TEST_F(ViewDocumentTransformTest, ANodeWithoutAnInverseMovesOthersAndThoseBelowItStay)
{
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  // Rounding leaves this one a determinant of about 1e-17.
  const glm::dmat4 flat = turn * glm::scale(glm::dmat4(1), {1, 0, 1}) * turn;
  set_matrix(a, flat);
  const auto before = worlds();
  document->select(std::vector{a, b});
  for (const auto &[kind, typed, change] :
       {std::tuple(TransformKind::Move, "1.5", glm::translate(glm::dmat4(1), {0, 1.5, 0})),
        {TransformKind::Rotate, "90", glm::rotate(glm::dmat4(1), glm::radians(90.0), glm::dvec3(0, 1, 0))},
        {TransformKind::Scale, "3", glm::scale(glm::dmat4(1), {1, 3, 1})}}) {
    begin(kind, typed);
    for (std::size_t i = 0; i < 3; i++) {
      EXPECT_LT(difference(worlds()[i], change * before[i]), 1e-8) << typed << ' ' << i;
    }
    document->end_transform(false);
  }
  // Its own axes define no change for other nodes.
  begin(TransformKind::Scale, "3", Orientation::Local);
  EXPECT_GT(difference(worlds()[0], before[0]), 0.01);
  EXPECT_LT(difference(worlds()[1], before[1]), 1e-8);
  document->end_transform(false);

  set_matrix(parent, flat);
  const glm::dmat4 below = worlds()[1];
  begin(TransformKind::Move, "1.5");
  EXPECT_LT(difference(worlds()[0], glm::translate(glm::dmat4(1), {0, 1.5, 0}) * before[0]), 1e-8);
  EXPECT_EQ(worlds()[1], below);
}

TEST_F(ViewDocumentTransformTest, EachTransformIsAStepOfItsOwnWhateverEndsIt)
{
  const auto before = worlds();
  const auto is_at = [&](double height) {
    return difference(worlds()[0], glm::translate(glm::dmat4(1), {0, height, 0}) * before[0]) < 1e-8;
  };
  document->select(a);
  begin(TransformKind::Move, "1");
  begin(TransformKind::Move, "1");
  document->end_transform(true);
  EXPECT_EQ(document->history().undo_count(), 2U);
  EXPECT_TRUE(is_at(2.0));
  EXPECT_TRUE(document->undo());
  EXPECT_TRUE(is_at(1.0));

  begin(TransformKind::Move, "1");
  EXPECT_TRUE(document->undo());
  EXPECT_FALSE(document->operation());
  EXPECT_TRUE(is_at(1.0)) << "the running one is undone";
  begin(TransformKind::Move, "1");
  EXPECT_FALSE(document->redo()) << "a new step ends redo";
  EXPECT_TRUE(is_at(2.0));
  begin(TransformKind::Move, "1");
  EXPECT_TRUE(document->duplicate_selected());
  EXPECT_EQ(document->history().undo_count(), 4U);
  begin(TransformKind::Move, "1");
  EXPECT_TRUE(document->remove_selected());
  EXPECT_EQ(document->history().undo_count(), 6U);

  document->select(a);
  begin(TransformKind::Move, "1");
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "transformed.glb";
  document->save(path);
  std::filesystem::remove(path);
  document->end_transform(false);
  EXPECT_TRUE(is_at(4.0));
  EXPECT_TRUE(document->is_saved());
}

TEST_F(ViewDocumentTransformTest, AllSelectedNodesAreDuplicatedAsOneStepEachOnce)
{
  document->select(std::vector{a, b, child});
  EXPECT_TRUE(document->duplicate_selected());
  EXPECT_EQ(document->scene().nodes().size(), 7U) << "a, and b with its child";
  EXPECT_EQ(document->selection().size(), 2U);
  EXPECT_FALSE(document->is_selected(a) || document->is_selected(b));
  document->select(a, true);
  EXPECT_TRUE(document->duplicate_selected());
  std::set<std::string> names;
  for (const auto &[handle, node] : document->scene().nodes()) {
    EXPECT_TRUE(names.insert(node.name).second) << node.name;
  }
  EXPECT_TRUE(names.contains("a.002") && names.contains("a.003") && names.contains("child.002"));
  EXPECT_TRUE(document->undo());
  EXPECT_TRUE(document->undo());
  EXPECT_EQ(document->scene().nodes().size(), 4U);
  EXPECT_EQ(document->history().undo_count(), 0U);
  document->select(Handle<Node>());
  EXPECT_FALSE(document->duplicate_selected());
}

TEST(ViewTimeLineTest, PosesAreNoEditsAndPlayingBeginsAgainAfterTheEnd)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  const std::array nodes = {scene.add(Node{.name = "a"}), scene.add(Node{.name = "b"})};
  for (const Handle<Node> node : nodes) {
    scene::AnimatedNode animated;
    animated.node = node;
    animated.translation_track =
        std::make_shared<const scene::Track>(scene::Track{scene::Interpolation::Linear, 3, {0, 2}, {0, 0, 0, 4, 0, 0}});
    scene.animations.push_back({scene.nodes()[node].name, {animated}, {}});
  }
  Document document(*device, std::move(scene), default_settings());
  const auto x = [&](std::size_t node) { return document.scene().nodes()[nodes[node]].parent_from_node[3].x; };
  TimeLine line;
  line.play(true);
  EXPECT_FALSE(line.is_playing()) << "nothing is open";
  line.open(document.scene());
  line.set_time(document, 0.5);
  EXPECT_EQ(x(0), 1.0);
  EXPECT_EQ(x(1), 1.0) << "all animations";
  EXPECT_TRUE(document.is_saved());
  EXPECT_EQ(document.history().undo_count(), 0U);
  line.step(document, 1.0);
  EXPECT_EQ(line.seconds(), 0.5) << "it does not play";
  line.play(true);
  line.step(document, 1.0);
  EXPECT_EQ(x(0), 3.0);
  line.step(document, 1.0);
  EXPECT_EQ(x(0), 1.0);
  line.set_time(document, 9.0);
  EXPECT_EQ(line.seconds(), 2.0);
  document.edit(nodes[0], [](Node &node) { node.name = "edited"; });
  EXPECT_FALSE(document.is_saved());
  line.step(document, 0.25);
  EXPECT_FALSE(document.is_saved());
  // Time waits for a transform.
  document.select(nodes[0]);
  document.begin_transform({TransformKind::Move, TransformAxis::Y}, map_from(eye), {200, 150});
  line.step(document, 0.25);
  EXPECT_TRUE(document.operation());
  EXPECT_EQ(line.seconds(), 0.25);
  document.end_transform(false);
  // The edit remembers the pose of another time.
  document.history().end_gesture();
  document.edit(nodes[0], [](Node &node) { node.parent_from_node[3].x = 9.0; });
  TimeLine unused;
  unused.open(document.scene());
  unused.pose_again(document);
  EXPECT_EQ(x(0), 9.0);
  line.set_time(document, 1.5);
  EXPECT_TRUE(document.undo());
  EXPECT_EQ(x(0), 0.5);
  line.pose_again(document);
  EXPECT_EQ(x(0), 3.0);
  line.open(scene::Scene());
  EXPECT_TRUE(line.is_empty());
}

TEST(ViewTimeLineTest, APoseThatFailsHalfwayLeavesASavedSceneSaved)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  scene::Animation animation;
  for (const char *name : {"a", "b"}) {
    scene::AnimatedNode animated;
    animated.node = scene.add(Node{.name = name});
    animated.translation_track =
        std::make_shared<const scene::Track>(scene::Track{scene::Interpolation::Linear, 3, {0, 2}, {0, 0, 0, 4, 0, 0}});
    animation.nodes.push_back(animated);
  }
  const Handle<Node> first = animation.nodes[0].node;
  animation.nodes[1].scale = glm::dvec3(std::numeric_limits<double>::infinity());
  Document document(*device, std::move(scene), default_settings());
  EXPECT_THROW(document.pose(animation, 1.0), scene::InvalidEdit);
  EXPECT_EQ(document.scene().nodes()[first].parent_from_node[3].x, 2.0) << "the part before the fault is posed";
  EXPECT_TRUE(document.is_saved());
}

TEST(ViewDocumentTest, APictureOfTheWorldKeepsHowThePictureBeforeLitAndCanBeUndone)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  Document document(*device, scene::Scene(), default_settings());
  const auto picture = [](float radiance) {
    return std::make_shared<const scene::WorldPicture>(scene::WorldPicture{1, 1, {glm::vec3(radiance)}});
  };
  document.set_world(scene::World{.color = {0, 0, 1}, .strength = 0.1F});
  document.history().end_gesture();
  document.set_world_picture(picture(1.0F));
  EXPECT_EQ(document.scene().world()->color, glm::vec3(1.0F)) << "the colour was the light itself";
  EXPECT_EQ(document.scene().world()->strength, 1.0F);
  document.history().end_gesture();
  scene::World turned = *document.scene().world();
  turned.rotation = 0.5F;
  document.set_world(turned);
  document.history().end_gesture();
  document.set_world_picture(picture(2.0F));
  EXPECT_EQ(document.scene().world()->rotation, 0.5F);
  EXPECT_EQ(document.scene().world()->picture->texels[0].x, 2.0F);
  document.history().end_gesture();
  EXPECT_THROW(document.set_world_picture(picture(-1.0F)), scene::InvalidEdit);
  EXPECT_EQ(document.scene().world()->picture->texels[0].x, 2.0F);
  document.set_world_picture(nullptr);
  EXPECT_FALSE(document.scene().world()->picture);
  EXPECT_TRUE(document.undo());
  EXPECT_TRUE(document.undo());
  EXPECT_EQ(document.scene().world()->picture->texels[0].x, 1.0F);
  EXPECT_TRUE(document.undo());
  EXPECT_TRUE(document.undo());
  EXPECT_EQ(document.scene().world()->color, glm::vec3(0, 0, 1));
}

TEST(ViewPropertiesTest, AnglesAreShownWithoutTheRoundingOfMatrices)
{
  EXPECT_EQ(shown_number(1.84e-05, "°"), 0.0);
  EXPECT_FALSE(std::signbit(shown_number(-1.84e-05, "°")));
  EXPECT_EQ(shown_number(89.99999, "°"), 90.0);
  EXPECT_EQ(shown_number(0.53, "°"), 0.53);
  EXPECT_EQ(shown_number(1.84e-05, "m"), 1.84e-05);
  EXPECT_FALSE(std::signbit(shown_number(-0.0, "m")));
}

TEST(ViewKeysTest, KeysAreNamedAsMenusShowThem)
{
  EXPECT_EQ(key_of("g"), (KeyPress{'G', 0}));
  EXPECT_EQ(key_of("ctrl+shift+z")->key, 'Z');
  EXPECT_NE(key_of("ctrl+shift+z")->mods, key_of("ctrl+z")->mods);
  EXPECT_EQ(key_of("7")->key, '7');
  EXPECT_EQ(key_of("-")->key, '-');
  EXPECT_EQ(key_of("/")->key, '/');
  EXPECT_NE(key_of("alt+h")->mods, key_of("shift+h")->mods);
  for (const char *wrong : {"", "G", "ctrl+", "meta+g", "return"}) {
    EXPECT_FALSE(key_of(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace gnomon::view
