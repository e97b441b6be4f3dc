// SPDX-License-Identifier: MIT
#include "scene.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <random>
#include <set>

namespace gnomon::scene {
namespace {

/** A simple model of the expected content of a scene. */
struct Model {
  struct ModelNode {
    Node value;
    Handle<Node> parent;
  };
  std::map<Handle<Node>, ModelNode> nodes;
  std::map<Handle<Lamp>, Lamp> lamps;
  std::map<Handle<Mesh>, Mesh> meshes;
  /** All removed handles. */
  std::vector<Handle<Node>> removed_nodes;
  std::vector<Handle<Lamp>> removed_lamps;
  std::vector<Handle<Mesh>> removed_meshes;

  [[nodiscard]] glm::dmat4 world_from_node(Handle<Node> node) const
  {
    const ModelNode &own = nodes.at(node);
    return own.parent ? world_from_node(own.parent) * own.value.parent_from_node : own.value.parent_from_node;
  }
  [[nodiscard]] bool is_visible(Handle<Node> node) const
  {
    const ModelNode &own = nodes.at(node);
    return own.value.is_visible && (!own.parent || is_visible(own.parent));
  }
  [[nodiscard]] bool is_below(Handle<Node> node, Handle<Node> root) const
  {
    return node == root || (nodes.at(node).parent && is_below(nodes.at(node).parent, root));
  }
};

/** Random edits of a scene and of its model. */
class Editor {
 public:
  void edit()
  {
    switch (below(16)) {
      case 0:
      case 1: add_node(); break;
      case 2: add_lamp(); break;
      case 3: add_mesh(); break;
      case 4: remove_node(); break;
      case 5: remove(model.lamps, model.removed_lamps); break;
      case 6: remove(model.meshes, model.removed_meshes); break;
      case 7: set_parent(); break;
      case 8: change_node([&](Node &node) { node.is_visible = below(3) != 0; }); break;
      case 9: change_node([&](Node &node) { node.lamp = any(model.lamps); }); break;
      case 10: change_node([&](Node &node) { node.meshes.assign(below(3), any(model.meshes)); }); break;
      case 11: change_lamp(); break;
      case 12: restore_node(); break;
      case 13: restore_lamp(); break;
      default: set_transform(); break;
    }
  }
  void check() const
  {
    check_pool(model.lamps, model.removed_lamps);
    check_pool(model.meshes, model.removed_meshes);
    check_pool(model.nodes, model.removed_nodes);
    std::size_t object_count = 0;
    std::size_t lamp_count = 0;
    for (const auto &[handle, node] : model.nodes) {
      ASSERT_EQ(scene.parent(handle), node.parent);
      ASSERT_EQ(scene.world_from_node(handle), model.world_from_node(handle));
      ASSERT_EQ(scene.is_visible(handle), model.is_visible(handle));
      for (Handle<Node> child = scene.first_child(handle); child; child = scene.next_sibling(child)) {
        ASSERT_EQ(model.nodes.at(child).parent, handle);
      }
      if (model.is_visible(handle)) {
        lamp_count += model.lamps.count(node.value.lamp);
        for (const Handle<Mesh> mesh : node.value.meshes) {
          object_count += model.meshes.count(mesh);
        }
      }
    }
    for (const auto &[handle, lamp] : model.lamps) {
      ASSERT_EQ(scene.lamps()[handle], lamp);
    }
    for (const Object &object : scene.objects()) {
      ASSERT_EQ(object.world_from_object, model.world_from_node(object.node));
      ASSERT_TRUE(model.meshes.count(object.mesh) == 1);
    }
    ASSERT_EQ(scene.objects().size(), object_count);
    ASSERT_EQ(scene.placed_lamps().size(), lamp_count);
  }

  Scene scene;
  Model model;

 private:
  std::size_t below(std::size_t count)
  {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }
  /** A random handle of a map; seldom an invalid one. */
  template <typename T, typename Value>
  Handle<T> any(const std::map<Handle<T>, Value> &things)
  {
    return things.empty() || below(16) == 0 ? Handle<T>()
                                            : std::next(things.begin(), std::ptrdiff_t(below(things.size())))->first;
  }
  glm::dmat4 matrix()
  {
    const auto number = [&] { return std::uniform_real_distribution<double>(-2.0, 2.0)(random_); };
    return glm::rotate(glm::translate(glm::dmat4(1.0), {number(), number(), number()}), number(), glm::dvec3(0, 0, 1));
  }
  void add_node()
  {
    Node node;
    node.name = "node";
    node.parent_from_node = matrix();
    node.is_visible = below(4) != 0;
    node.lamp = any(model.lamps);
    node.meshes = {any(model.meshes)};
    const Handle<Node> parent = any(model.nodes);
    expect_new(scene.add(node, parent), model.nodes, model.removed_nodes, {node, parent});
  }
  void add_lamp()
  {
    Lamp lamp;
    lamp.intensity = float(below(1000));
    expect_new(scene.add(lamp), model.lamps, model.removed_lamps, lamp);
  }
  void add_mesh()
  {
    Mesh mesh;
    mesh.positions.assign(below(4), glm::vec3(1.0F));
    mesh.normals.assign(mesh.positions.size(), glm::vec3(0, 0, 1));
    expect_new(scene.add(mesh), model.meshes, model.removed_meshes, mesh);
  }
  /** No handle is given twice. */
  template <typename T, typename Value>
  void expect_new(Handle<T> handle, std::map<Handle<T>, Value> &things, const std::vector<Handle<T>> &removed,
                  const Value &value)
  {
    EXPECT_TRUE(things.emplace(handle, value).second);
    EXPECT_EQ(std::count(removed.begin(), removed.end(), handle), 0);
  }
  template <typename T, typename Value>
  void remove(std::map<Handle<T>, Value> &things, std::vector<Handle<T>> &removed)
  {
    if (const Handle<T> handle = any(things)) {
      scene.remove(handle);
      things.erase(handle);
      removed.push_back(handle);
    }
  }
  void remove_node()
  {
    const Handle<Node> root = any(model.nodes);
    // Seldom, because removing a root also removes its descendants.
    if (!root || below(2) == 0) {
      return;
    }
    std::vector<Handle<Node>> subtree;
    for (const auto &[handle, node] : model.nodes) {
      if (model.is_below(handle, root)) {
        subtree.push_back(handle);
      }
    }
    scene.remove(root);
    for (const Handle<Node> handle : subtree) {
      model.nodes.erase(handle);
      model.removed_nodes.push_back(handle);
    }
  }
  /** A handle that was removed and whose index is free; seldom, one that cannot be restored. */
  template <typename T>
  Handle<T> take_removed(std::vector<Handle<T>> &removed, const T &value)
  {
    if (removed.empty()) {
      return {};
    }
    const auto taken = removed.begin() + std::ptrdiff_t(below(removed.size()));
    const Handle<T> handle = *taken;
    if (!scene.pool<T>().is_restorable(handle)) {
      EXPECT_THROW(scene.restore(handle, value), InvalidEdit);
      return {};
    }
    removed.erase(taken);
    return handle;
  }
  void restore_lamp()
  {
    Lamp lamp;
    lamp.intensity = float(below(1000));
    if (const Handle<Lamp> handle = take_removed(model.removed_lamps, lamp)) {
      scene.restore(handle, lamp);
      EXPECT_TRUE(model.lamps.emplace(handle, lamp).second);
    }
  }
  /** At a random place among the children of a random parent. */
  void restore_node()
  {
    Node node;
    node.name = "restored";
    node.parent_from_node = matrix();
    node.lamp = any(model.lamps);
    const Handle<Node> handle = take_removed(model.removed_nodes, node);
    if (!handle) {
      return;
    }
    const Handle<Node> parent = any(model.nodes);
    Handle<Node> next;
    for (Handle<Node> child = parent ? scene.first_child(parent) : parent; child && !next;
         child = scene.next_sibling(child)) {
      next = below(3) == 0 ? child : next;
    }
    scene.restore(handle, node, parent, next);
    EXPECT_TRUE(model.nodes.emplace(handle, Model::ModelNode{node, parent}).second);
    EXPECT_EQ(scene.next_sibling(handle), next);
  }
  void set_parent()
  {
    const Handle<Node> node = any(model.nodes);
    const Handle<Node> parent = any(model.nodes);
    if (!node) {
      return;
    }
    if (parent && model.is_below(parent, node)) {
      EXPECT_THROW(scene.set_parent(node, parent), InvalidEdit);
      return;
    }
    scene.set_parent(node, parent);
    model.nodes.at(node).parent = parent;
  }
  void set_transform()
  {
    if (const Handle<Node> node = any(model.nodes)) {
      model.nodes.at(node).value.parent_from_node = matrix();
      scene.set_transform(node, model.nodes.at(node).value.parent_from_node);
    }
  }
  template <typename Change>
  void change_node(Change change)
  {
    if (const Handle<Node> node = any(model.nodes)) {
      change(model.nodes.at(node).value);
      scene.replace(node, model.nodes.at(node).value);
    }
  }
  void change_lamp()
  {
    if (const Handle<Lamp> lamp = any(model.lamps)) {
      model.lamps.at(lamp).intensity = float(below(1000));
      scene.edit(lamp, [&](Lamp &changed) { changed.intensity = model.lamps.at(lamp).intensity; });
    }
  }
  template <typename T, typename Value>
  void check_pool(const std::map<Handle<T>, Value> &things, const std::vector<Handle<T>> &removed) const
  {
    std::set<Handle<T>> found;
    for (const auto &thing : scene.pool<T>()) {
      ASSERT_TRUE(found.insert(thing.handle).second);
      ASSERT_TRUE(things.count(thing.handle) == 1);
      ASSERT_EQ(&thing.value, scene.pool<T>().find(thing.handle));
    }
    ASSERT_EQ(found.size(), things.size());
    ASSERT_EQ(scene.pool<T>().size(), things.size());
    for (const Handle<T> handle : removed) {
      ASSERT_EQ(scene.pool<T>().find(handle), nullptr);
    }
  }

  std::mt19937 random_{20261122};
};

TEST(SceneRandom, TenThousandEditsAgreeWithASimpleModel)
{
  Editor editor;
  Revision revision = 0;
  for (int i = 0; i < 10000; i++) {
    editor.edit();
    ASSERT_GE(editor.scene.revision(), revision) << i;
    revision = editor.scene.revision();
    if (i % 50 == 0) {
      editor.check();
      ASSERT_FALSE(HasFailure()) << i;
    }
  }
  editor.check();
  // The random edits must have reached a scene of some size.
  EXPECT_GT(editor.model.nodes.size(), 20U);
  EXPECT_GT(editor.model.removed_nodes.size(), 1000U);
  EXPECT_GT(editor.model.removed_lamps.size(), 300U);
}

/** Comparing revisions after each edit finds exactly the changes of world matrices. */
TEST(SceneRandom, RevisionsShowEachChangeOfAWorldMatrix)
{
  Editor editor;
  std::map<Handle<Node>, std::pair<Revision, glm::dmat4>> seen;
  for (int i = 0; i < 2000; i++) {
    editor.edit();
    std::map<Handle<Node>, std::pair<Revision, glm::dmat4>> now;
    for (const auto &[handle, node] : editor.scene.nodes()) {
      now[handle] = {editor.scene.nodes().revision(handle, Node::Aspect::Transform),
                     editor.scene.world_from_node(handle)};
      const auto before = seen.find(handle);
      if (before != seen.end()) {
        ASSERT_EQ(before->second.first != now[handle].first, before->second.second != now[handle].second) << i;
      }
    }
    seen = std::move(now);
  }
}

}  // namespace
}  // namespace gnomon::scene
