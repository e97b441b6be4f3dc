// SPDX-License-Identifier: MIT
#include "scene.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <random>
#include <ranges>
#include <set>

namespace gnomon::scene {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Mesh triangle()
{
  Mesh mesh;
  mesh.name = "triangle";
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.indices = {0, 1, 2};
  return mesh;
}

Image texel()
{
  return {"texel", 1, 1, {1, 2, 3, 4}};
}

Node named(const std::string &name)
{
  Node node;
  node.name = name;
  return node;
}

Node at(const glm::dvec3 &position, const std::string &name = "node")
{
  Node node = named(name);
  node.parent_from_node = glm::translate(glm::dmat4(1.0), position);
  return node;
}

/** The message of the exception that \a act throws; empty if it throws none. */
template <typename Exception>
std::string message_of(const std::function<void()> &act)
{
  try {
    act();
  }
  catch (const Exception &error) {
    return error.what();
  }
  return {};
}

#define EXPECT_STALE(statement, kind)                                                          \
  EXPECT_NE(message_of<StaleHandle>([&] { (void)(statement); }).find(kind), std::string::npos) \
      << message_of<StaleHandle>([&] { (void)(statement); })

// ---- Handles ----

/** Tests the properties of handles for one type of thing. */
template <typename T>
void expect_handles_of(const T &value)
{
  const std::string kind(T::kind_name);
  Scene scene;
  const Pool<T> &pool = scene.pool<T>();
  EXPECT_FALSE(pool.first());
  const Handle<T> a = scene.add(value);
  const Handle<T> b = scene.add(value);
  EXPECT_TRUE(a && b && a != b && a.key() != b.key());
  EXPECT_EQ(pool.size(), 2U);
  EXPECT_EQ(pool.first(), a);
  const T *kept = &pool[b];
  scene.remove(a);
  EXPECT_EQ(&pool[b], kept) << kind << ": references of others stay valid";
  EXPECT_EQ(pool.size(), 1U);
  EXPECT_EQ(pool.first(), b);
  EXPECT_FALSE(pool.is_live(a));
  EXPECT_EQ(pool.find(a), nullptr);
  EXPECT_STALE(pool[a], kind);
  EXPECT_STALE(pool.revision(a, typename T::Aspect(0)), kind);
  EXPECT_STALE(scene.replace(a, value), kind);
  EXPECT_STALE(scene.remove(a), kind);
  EXPECT_STALE(scene.edit(a, [](T & /*thing*/) { ADD_FAILURE() << "of a removed thing"; }), kind);
  EXPECT_STALE(pool[Handle<T>()], kind);
  EXPECT_EQ(pool.find(Handle<T>()), nullptr);
  EXPECT_STALE(pool[Handle<T>({99, 1})], kind);

  const Handle<T> again = scene.add(value);
  EXPECT_EQ(again.index, a.index) << kind << ": the place is used again";
  EXPECT_NE(again.generation, a.generation);
  EXPECT_NE(again.key(), a.key());
  EXPECT_EQ(pool.find(a), nullptr) << kind << ": the old handle does not name the new thing";
  EXPECT_EQ(pool.index_end(), 2U);
  // Copies of a scene have the same handles and are edited independently.
  Scene copy = scene;
  copy.remove(again);
  EXPECT_TRUE(pool.is_live(again));
}

TEST(SceneHandle, RemovedThingsAreDetected)
{
  expect_handles_of(triangle());
  expect_handles_of(texel());
  expect_handles_of(Texture());
  expect_handles_of(Material());
  expect_handles_of(Lamp());
  expect_handles_of(Camera());
  expect_handles_of(Node());
}

/** Tests the restoring of removed things for one type of thing. */
template <typename T>
void expect_restored(const T &value)
{
  const std::string kind(T::kind_name);
  const auto refusal = [&](Scene &scene, Handle<T> handle) {
    return message_of<InvalidEdit>([&] { scene.restore(handle, value); });
  };
  Scene scene;
  const Pool<T> &pool = scene.pool<T>();
  const Handle<T> a = scene.add(value);
  const Handle<T> b = scene.add(value);
  EXPECT_NE(refusal(scene, a).find("it is in the scene"), std::string::npos) << kind;
  scene.remove(a);
  EXPECT_NE(refusal(scene, {a.index, a.generation + 1}).find("never had it"), std::string::npos) << kind;
  EXPECT_NE(refusal(scene, {}).find("never had it"), std::string::npos) << kind;
  EXPECT_NE(refusal(scene, {7, 1}).find("never had it"), std::string::npos) << kind;

  // A thing that took its place must be removed first.
  const Handle<T> c = scene.add(value);
  EXPECT_EQ(c.index, a.index) << kind;
  EXPECT_NE(refusal(scene, a).find("another one has its index"), std::string::npos) << kind;
  scene.remove(c);
  const Revision before = scene.revision();
  scene.restore(a, value);
  EXPECT_TRUE(pool.is_live(a) && pool.is_live(b) && !pool.is_live(c)) << kind;
  EXPECT_EQ(pool.size(), 2U) << kind;
  EXPECT_EQ(pool.first(), a) << kind << ": at its old place";
  for (std::size_t aspect = 0; aspect < std::size_t(T::Aspect::Count); aspect++) {
    EXPECT_GT(pool.revision(a, typename T::Aspect(aspect)), before) << kind;
    EXPECT_LE(pool.revision(b, typename T::Aspect(aspect)), before) << kind;
    EXPECT_EQ(pool.latest(typename T::Aspect(aspect)), scene.revision()) << kind;
  }
  // The handle that another thing has had is given to no third one.
  scene.remove(a);
  const Handle<T> d = scene.add(value);
  EXPECT_EQ(d.index, a.index) << kind;
  EXPECT_TRUE(d != a && d != c) << kind;
  scene.remove(d);
  scene.restore(c, value);
  EXPECT_TRUE(pool.is_live(c) && !pool.is_live(a) && !pool.is_live(d)) << kind;
}

TEST(SceneHandle, RemovedThingsAreRestoredUnderTheirHandles)
{
  expect_restored(triangle());
  expect_restored(texel());
  expect_restored(Texture());
  expect_restored(SurfaceFunction());
  expect_restored(Material());
  expect_restored(Lamp());
  expect_restored(Camera());
  expect_restored(Node());
}

TEST(SceneHandle, ARestoredNodeHasItsPlaceInTheTree)
{
  Scene scene;
  const auto parent = scene.add(at({1, 0, 0}, "parent"));
  const auto first = scene.add(named("first"), parent);
  const auto middle = scene.add(at({0, 2, 0}, "middle"), parent);
  const auto last = scene.add(named("last"), parent);
  const auto other = scene.add(named("other"));
  const Node value = scene.nodes()[middle];
  const auto children = [&] {
    std::string names;
    for (Handle<Node> child = scene.first_child(parent); child; child = scene.next_sibling(child)) {
      names += scene.nodes()[child].name + ' ';
    }
    return names;
  };
  scene.remove(middle);
  for (const auto next : {first, last, Handle<Node>()}) {
    scene.restore(middle, value, parent, next);
    EXPECT_EQ(children(), next == first  ? "middle first last "
                          : next == last ? "first middle last "
                                         : "first last middle ");
    EXPECT_EQ(scene.world_from_node(middle)[3], glm::dvec4(1, 2, 0, 1));
    scene.remove(middle);
    EXPECT_EQ(children(), "first last ");
  }
  const Revision before = scene.revision();
  EXPECT_THROW(scene.restore(middle, value, {}, first), InvalidEdit);
  EXPECT_THROW(scene.restore(middle, value, parent, other), InvalidEdit);
  EXPECT_THROW(scene.restore(middle, value, parent, middle), StaleHandle);
  EXPECT_THROW(scene.restore(middle, value, middle), StaleHandle);
  Node invalid = value;
  invalid.parent_from_node[0][0] = nan;
  EXPECT_THROW(scene.restore(middle, invalid, parent), InvalidEdit);
  EXPECT_EQ(scene.revision(), before);
  EXPECT_EQ(children(), "first last ");
}

// Iterators of pools are those of the standard library.
static_assert(std::forward_iterator<Pool<Node>::Iterator>);
static_assert(std::ranges::forward_range<const Pool<Mesh>>);
static_assert(std::ranges::common_range<Pool<Lamp>>);

TEST(SceneHandle, AlgorithmsOfTheStandardLibraryTakePools)
{
  Scene scene;
  std::vector<Handle<Node>> handles;
  for (const char *name : {"a", "b", "c", "d"}) {
    handles.push_back(scene.add(named(name)));
  }
  scene.remove(handles[1]);
  const Pool<Node> &nodes = scene.nodes();
  EXPECT_EQ(std::next(nodes.begin())->handle, handles[2]) << "removed things are skipped";
  EXPECT_EQ(std::next(nodes.begin(), 3), nodes.end());
  EXPECT_EQ(std::distance(nodes.begin(), nodes.end()), 3);
  const auto is_d = [](const Pool<Node>::Item &item) { return item.value.name == "d"; };
  EXPECT_EQ((*std::find_if(nodes.begin(), nodes.end(), is_d)).handle, handles[3]);
  EXPECT_EQ(std::ranges::find(nodes, handles[2], &Pool<Node>::Item::handle)->value.name, "c");
  EXPECT_EQ(std::count_if(nodes.begin(), nodes.end(), is_d), 1);
// clang before version 16 does not compile the views of libstdc++.
#if !defined(__clang__) || __clang_major__ >= 16
  std::string names;
  for (const Pool<Node>::Item item : nodes | std::views::filter(std::not_fn(is_d)) | std::views::take(5)) {
    names += item.value.name;
  }
  EXPECT_EQ(names, "ac");
#endif
  Pool<Node>::Iterator at = nodes.begin();
  EXPECT_EQ((at++)->value.name, "a");
  EXPECT_EQ(at->value.name, "c");
  std::vector<Pool<Node>::Item> items(nodes.begin(), nodes.end());
  EXPECT_EQ(items.size(), 3U);
  EXPECT_EQ(Pool<Node>::Iterator(), Pool<Node>::Iterator());
}

TEST(SceneHandle, NodeFunctionsThrowForStaleHandles)
{
  Scene scene;
  const Handle<Node> node = scene.add(Node());
  const Handle<Node> removed = scene.add(Node());
  scene.remove(removed);
  for (const Handle<Node> stale : {removed, Handle<Node>()}) {
    EXPECT_STALE(scene.world_from_node(stale), "node");
    EXPECT_STALE(scene.is_visible(stale), "node");
    EXPECT_STALE(scene.parent(stale), "node");
    EXPECT_STALE(scene.first_child(stale), "node");
    EXPECT_STALE(scene.next_sibling(stale), "node");
    EXPECT_STALE(scene.set_transform(stale, glm::dmat4(1.0)), "node");
    EXPECT_STALE(scene.set_parent(stale, node), "node");
  }
  EXPECT_STALE(scene.set_parent(node, removed), "node");
  EXPECT_STALE(scene.add(Node(), removed), "node");
  EXPECT_EQ(scene.nodes().size(), 1U);
}

TEST(SceneHandle, StaleReferencesAreListedAndIgnored)
{
  Scene scene;
  const auto image = scene.add(texel());
  const auto texture = scene.add(Texture{.image = image});
  Material material;
  material.name = "paint";
  material.base_color = glm::vec3(0.5F);
  material.base_color_texture = texture;
  const auto paint = scene.add(material);
  Mesh mesh = triangle();
  mesh.material = paint;
  const auto shape = scene.add(mesh);
  const auto lamp = scene.add(Lamp());
  const auto camera = scene.add(Camera());
  Node node = named("all");
  node.meshes = {shape};
  node.lamp = lamp;
  node.camera = camera;
  scene.add(node);
  EXPECT_TRUE(scene.stale_references().empty());
  EXPECT_EQ(scene.material_of(mesh).base_color, glm::vec3(0.5F));

  scene.remove(paint);
  EXPECT_EQ(scene.stale_references(), std::vector<std::string>{"mesh 'triangle': its material was removed"});
  EXPECT_EQ(scene.material_of(mesh).base_color, Material().base_color) << "the default material";
  EXPECT_EQ(scene.objects().size(), 1U);
  scene.remove(shape);
  scene.remove(lamp);
  scene.remove(camera);
  scene.remove(image);
  EXPECT_EQ(scene.stale_references(),
            (std::vector<std::string>{"node 'all': its mesh was removed", "node 'all': its lamp was removed",
                                      "node 'all': its camera was removed", "texture '0': its image was removed"}));
  EXPECT_TRUE(scene.objects().empty() && scene.placed_lamps().empty() && scene.placed_cameras().empty());
  EXPECT_TRUE(scene.bounds().is_empty());
  // Old handles do not identify new things at the same index.
  scene.add(triangle());
  scene.add(Lamp());
  EXPECT_TRUE(scene.objects().empty() && scene.placed_lamps().empty());
  EXPECT_EQ(scene.stale_references().size(), 4U);
}

// ---- Hierarchy ----

TEST(SceneNodes, WorldMatricesAreComposedInDouble)
{
  // 16777217 is not a float: in single precision the child would be at 0 or 2.
  Scene scene;
  const auto root = scene.add(at({16777217, 0, 0}));
  const auto child = scene.add(at({-16777216, 0, 0}), root);
  EXPECT_EQ(scene.world_from_node(child)[3].x, 1.0);
  Node node = at({0, 0, 0});
  node.parent_from_node = glm::rotate(glm::dmat4(1.0), 0.5, glm::dvec3(0.6, 0.0, 0.8));
  const auto grandchild = scene.add(node, child);
  EXPECT_EQ(scene.world_from_node(grandchild), scene.world_from_node(child) * node.parent_from_node);
}

TEST(SceneNodes, SetTransformMovesTheSubtreeAlone)
{
  Scene scene;
  const auto root = scene.add(at({1, 0, 0}));
  const auto child = scene.add(at({0, 2, 0}), root);
  const auto leaf = scene.add(at({0, 0, 3}), child);
  const auto sibling = scene.add(at({0, 5, 0}), root);
  const auto other = scene.add(at({9, 9, 9}));
  scene.set_transform(child, glm::translate(glm::dmat4(1.0), {0, -2, 0}));
  EXPECT_EQ(scene.world_from_node(leaf)[3], glm::dvec4(1, -2, 3, 1));
  EXPECT_EQ(scene.nodes()[child].parent_from_node[3], glm::dvec4(0, -2, 0, 1));
  scene.set_transform(root, glm::translate(glm::dmat4(1.0), {-1, 0, 0}));
  EXPECT_EQ(scene.world_from_node(leaf)[3], glm::dvec4(-1, -2, 3, 1));
  EXPECT_EQ(scene.world_from_node(sibling)[3], glm::dvec4(-1, 5, 0, 1));
  EXPECT_EQ(scene.world_from_node(other)[3], glm::dvec4(9, 9, 9, 1));
}

/** Children in order. */
std::vector<Handle<Node>> children_of(const Scene &scene, Handle<Node> node)
{
  std::vector<Handle<Node>> children;
  for (Handle<Node> child = scene.first_child(node); child; child = scene.next_sibling(child)) {
    children.push_back(child);
  }
  return children;
}

TEST(SceneNodes, SetParentMovesTheSubtreeToTheEndOfTheChildren)
{
  using Handles = std::vector<Handle<Node>>;
  Scene scene;
  const auto left = scene.add(at({-10, 0, 0}));
  const auto right = scene.add(at({10, 0, 0}));
  const auto a = scene.add(at({1, 0, 0}), left);
  const auto b = scene.add(at({2, 0, 0}), left);
  const auto c = scene.add(at({3, 0, 0}), left);
  const auto leaf = scene.add(at({0, 1, 0}), b);
  EXPECT_EQ(children_of(scene, left), (Handles{a, b, c}));
  scene.set_parent(b, right);
  EXPECT_EQ(children_of(scene, left), (Handles{a, c}));
  EXPECT_EQ(children_of(scene, right), Handles{b});
  EXPECT_EQ(scene.parent(b), right);
  EXPECT_EQ(scene.world_from_node(leaf)[3], glm::dvec4(12, 1, 0, 1));
  scene.set_parent(a, right);
  scene.set_parent(c, right);
  EXPECT_EQ(children_of(scene, right), (Handles{b, a, c}));
  EXPECT_FALSE(scene.first_child(left));
  scene.set_parent(a, {});
  EXPECT_FALSE(scene.parent(a));
  EXPECT_FALSE(scene.next_sibling(a));
  EXPECT_EQ(scene.world_from_node(a)[3], glm::dvec4(1, 0, 0, 1));
  EXPECT_EQ(children_of(scene, right), (Handles{b, c}));
}

TEST(SceneNodes, ACycleIsRefused)
{
  Scene scene;
  const auto root = scene.add(named("root"));
  const auto child = scene.add(named("child"), root);
  const auto leaf = scene.add(named("leaf"), child);
  const Revision before = scene.revision();
  for (const Handle<Node> parent : {root, child, leaf}) {
    const std::string message = message_of<InvalidEdit>([&] { scene.set_parent(root, parent); });
    EXPECT_NE(message.find("node 'root'"), std::string::npos) << message;
    EXPECT_NE(message.find("'" + scene.nodes()[parent].name + "'"), std::string::npos) << message;
  }
  EXPECT_EQ(scene.parent(child), root);
  EXPECT_EQ(scene.parent(leaf), child);
  EXPECT_FALSE(scene.parent(root));
  EXPECT_EQ(scene.revision(), before);
}

TEST(SceneNodes, RemovalTakesTheSubtreeAndLeavesTheRest)
{
  Scene scene;
  const auto root = scene.add(named("root"));
  const auto first = scene.add(named("first"), root);
  const auto middle = scene.add(named("middle"), root);
  const auto last = scene.add(named("last"), root);
  const auto child = scene.add(named("child"), middle);
  const auto leaf = scene.add(named("leaf"), child);
  const auto lamp = scene.add(Lamp());
  scene.edit(leaf, [&](Node &node) { node.lamp = lamp; });
  scene.remove(middle);
  for (const Handle<Node> removed : {middle, child, leaf}) {
    EXPECT_FALSE(scene.nodes().is_live(removed));
  }
  EXPECT_EQ(children_of(scene, root), (std::vector<Handle<Node>>{first, last}));
  EXPECT_TRUE(scene.lamps().is_live(lamp)) << "things at nodes stay";
  EXPECT_TRUE(scene.placed_lamps().empty());
  EXPECT_EQ(scene.nodes().size(), 3U);
  const auto added = scene.add(named("added"), root);
  EXPECT_EQ(children_of(scene, root), (std::vector<Handle<Node>>{first, last, added}));
  EXPECT_FALSE(scene.first_child(added)) << "links of the place's former node are gone";
}

TEST(SceneNodes, DepthOfAHundredThousandIsSupported)
{
  Scene scene;
  const auto root = scene.add(at({0, 1, 0}));
  Handle<Node> leaf = root;
  for (int i = 1; i < 100000; i++) {
    leaf = scene.add(at({0, 1, 0}), leaf);
  }
  EXPECT_EQ(scene.world_from_node(leaf)[3].y, 100000.0);
  scene.set_transform(root, glm::dmat4(1.0));
  EXPECT_EQ(scene.world_from_node(leaf)[3].y, 99999.0);
  scene.remove(root);
  EXPECT_TRUE(scene.nodes().empty());
}

TEST(SceneNodes, VisibilityIsInherited)
{
  Scene scene;
  const auto mesh = scene.add(triangle());
  const auto root = scene.add(Node());
  Node value = named("child");
  value.meshes = {mesh};
  value.lamp = scene.add(Lamp());
  value.camera = scene.add(Camera());
  const auto child = scene.add(value, root);
  const auto grandchild = scene.add(value, child);
  EXPECT_EQ(scene.objects().size(), 2U);
  EXPECT_EQ(scene.placed_lamps().size(), 2U) << "a lamp at two nodes shines twice";

  scene.edit(root, [](Node &node) { node.is_visible = false; });
  EXPECT_FALSE(scene.is_visible(root) || scene.is_visible(child) || scene.is_visible(grandchild));
  EXPECT_TRUE(scene.nodes()[child].is_visible) << "the node's own flag stays";
  EXPECT_TRUE(scene.objects().empty() && scene.placed_lamps().empty() && scene.bounds().is_empty());
  EXPECT_EQ(scene.placed_cameras().size(), 2U) << "one may look through a hidden camera";
  const auto added = scene.add(value, grandchild);
  EXPECT_FALSE(scene.is_visible(added));

  scene.edit(child, [](Node &node) { node.is_visible = false; });
  scene.edit(root, [](Node &node) { node.is_visible = true; });
  EXPECT_TRUE(scene.is_visible(root));
  EXPECT_FALSE(scene.is_visible(child) || scene.is_visible(grandchild) || scene.is_visible(added));
  scene.set_parent(grandchild, root);
  EXPECT_TRUE(scene.is_visible(grandchild) && scene.is_visible(added));
  EXPECT_EQ(scene.objects().size(), 2U);
}

TEST(SceneNodes, LampsAndCamerasArePlacedWithoutScaleShearAndMirroring)
{
  Scene scene;
  Node root = at({1, 2, 3});
  root.parent_from_node = glm::scale(root.parent_from_node, {-2.0, 3.0, 0.5});
  Node node = named("spot");
  node.parent_from_node = glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(0.0, 0.6, 0.8));
  Lamp lamp;
  lamp.intensity = 5.0F;
  node.lamp = scene.add(lamp);
  node.camera = scene.add(Camera());
  const auto handle = scene.add(node, scene.add(root));
  const PlacedLamp placed = scene.placed_lamps().at(0);
  EXPECT_EQ(placed.intensity, 5.0F);
  EXPECT_EQ(placed.node, handle);
  EXPECT_EQ(placed.world_from_lamp, frame_of(scene.world_from_node(handle)));
  EXPECT_EQ(scene.placed_cameras().at(0).world_from_camera, placed.world_from_lamp);
  EXPECT_EQ(placed.world_from_lamp[3], scene.world_from_node(handle)[3]);
  const glm::dmat3 frame(placed.world_from_lamp);
  EXPECT_NEAR(glm::determinant(frame), 1.0, 1e-15);
  EXPECT_LT(glm::length(frame[2] - glm::normalize(glm::dvec3(scene.world_from_node(handle)[2]))), 1e-15);
}

// ---- Revisions ----

/** The aspects of a thing whose revision differs and is the scene's last. */
template <typename T>
class Changes {
 public:
  Changes(const Scene &scene, Handle<T> handle) : scene_(scene), handle_(handle)
  {
    start();
  }
  /** The aspects that have changed since the last call. */
  std::vector<typename T::Aspect> take()
  {
    std::vector<typename T::Aspect> changed;
    for (std::size_t i = 0; i < before_.size(); i++) {
      const auto aspect = typename T::Aspect(i);
      const Revision revision = scene_.pool<T>().revision(handle_, aspect);
      if (revision != before_[i]) {
        EXPECT_EQ(revision, scene_.revision()) << i;
        EXPECT_EQ(scene_.pool<T>().latest(aspect), revision) << i;
        changed.push_back(aspect);
      }
    }
    start();
    return changed;
  }

 private:
  void start()
  {
    for (std::size_t i = 0; i < before_.size(); i++) {
      before_[i] = scene_.pool<T>().revision(handle_, typename T::Aspect(i));
    }
  }
  const Scene &scene_;
  Handle<T> handle_;
  std::array<Revision, std::size_t(T::Aspect::Count)> before_{};
};

/** Each change changes one aspect, and setting the same value again changes none. */
template <typename T>
void expect_aspects(const T &value, const std::vector<std::pair<typename T::Aspect, std::function<void(T &)>>> &edits)
{
  Scene scene;
  const Handle<T> other = scene.add(value);
  const Handle<T> handle = scene.add(value);
  Changes<T> changes(scene, handle);
  Changes<T> others(scene, other);
  for (std::size_t i = 0; i < edits.size(); i++) {
    const Revision before = scene.revision();
    scene.edit(handle, edits[i].second);
    EXPECT_EQ(changes.take(), std::vector{edits[i].first}) << T::kind_name << ' ' << i;
    EXPECT_EQ(scene.revision(), before + 1) << T::kind_name << ' ' << i;
    scene.replace(handle, scene.pool<T>()[handle]);
    EXPECT_TRUE(changes.take().empty()) << T::kind_name << ' ' << i;
    EXPECT_EQ(scene.revision(), before + 1) << T::kind_name << ' ' << i;
    EXPECT_EQ(scene.pool<T>().latest(), scene.revision());
  }
  EXPECT_TRUE(others.take().empty()) << T::kind_name;
}

template <typename T>
using AspectEdits = std::vector<std::pair<typename T::Aspect, std::function<void(T &)>>>;

/** Sets another value that \a row allows. */
template <typename Value>
void change(Value &value, const Description &row)
{
  const double low = std::max(row.min, -1.0);
  const double other = low + 0.75 * (std::min(row.max, low + 4.0) - low);
  if constexpr (requires { value.has_value(); }) {
    change(value.emplace(), row);
  }
  else if constexpr (std::is_same_v<Value, std::string>) {
    value += " again";
  }
  else if constexpr (std::is_same_v<Value, bool>) {
    value = !value;
  }
  else if constexpr (std::is_enum_v<Value>) {
    value = Value((std::size_t(value) + 1) % words<Value>.size());
  }
  else if constexpr (std::is_same_v<Value, int>) {
    value = int(std::ceil(other));
  }
  else {
    // The end of a shadow is beyond its start.
    value = Value(float(row.name == "shadow_clip_end" ? 2.0 * other : other));
  }
}

/** Adds an edit of each property of a part of a T to \a edits, with the aspect of its row. */
template <typename Part, typename T, typename Access>
void add_edits(AspectEdits<T> &edits, Access part)
{
  Part::for_each_property([&](const auto &row) {
    edits.emplace_back(typename T::Aspect(row.aspect), [=](T &thing) { change(part(thing).*row.member, row); });
  });
}

template <typename T>
AspectEdits<T> property_edits()
{
  AspectEdits<T> edits;
  add_edits<T>(edits, [](T &thing) -> T & { return thing; });
  return edits;
}

TEST(SceneRevision, EachEditChangesItsAspectAlone)
{
  AspectEdits<Lamp> lamp_edits = property_edits<Lamp>();
  add_edits<LampShadow>(lamp_edits, [](Lamp &lamp) -> LampShadow & { return lamp.shadow; });
  expect_aspects<Lamp>({}, lamp_edits);
  expect_aspects<Camera>({}, property_edits<Camera>());
  AspectEdits<Material> material_edits = property_edits<Material>();
  for (const TextureInput &input : texture_inputs) {
    const std::size_t first = material_edits.size();
    add_edits<TextureSlot>(material_edits, [=](Material &material) -> TextureSlot & { return material.*input.slot; });
    for (std::size_t i = first; i < material_edits.size(); i++) {
      material_edits[i].first = Material::Aspect::Textures;
    }
    material_edits.emplace_back(Material::Aspect::Textures, [=](Material &material) {
      (material.*input.slot).texture = {7, 1};
    });
  }
  // The textures that are read depend on whether there is a layer, and what is let through on whether light is.
  Material layered;
  layered.coat = layered.anisotropy = 1.0F;
  layered.sheen_color = glm::vec3(1.0F);
  std::erase_if(material_edits, [&](const auto &edit) {
    Material changed = layered;
    edit.second(changed);
    return changed.has_transmission();
  });
  expect_aspects<Material>(layered, material_edits);
  // A surface function may compute alpha from all factors, so that they change what is cut out.
  const auto edits_of = [](AlphaMode mode) {
    Scene scene;
    const auto function = scene.add(SurfaceFunction{.name = "f"});
    const auto material = scene.add(Material{.alpha_mode = mode, .surface_function = function});
    const Revision before = scene.materials().latest(Material::Aspect::Coverage);
    scene.edit(material, [](Material &value) { value.roughness = 0.5F; });
    return scene.materials().latest(Material::Aspect::Coverage) > before;
  };
  EXPECT_FALSE(edits_of(AlphaMode::Opaque));
  EXPECT_TRUE(edits_of(AlphaMode::Mask) && edits_of(AlphaMode::Blend));
  using FunctionAspect = SurfaceFunction::Aspect;
  expect_aspects<SurfaceFunction>(
      {}, {{FunctionAspect::Name, [](SurfaceFunction &function) { function.name = "renamed"; }},
           {FunctionAspect::Text, [](SurfaceFunction &function) { function.text = "void"; }},
           {FunctionAspect::Text, [](SurfaceFunction &function) { function.path = "a.glsl"; }}});
  expect_aspects<Texture>({}, {{Texture::Aspect::Image,
                                [](Texture &texture) {
                                  texture.image = {7, 1};
                                }},
                               {Texture::Aspect::Sampler, [](Texture &t) { t.wrap_u = TextureWrap::ClampToEdge; }},
                               {Texture::Aspect::Sampler, [](Texture &t) { t.wrap_v = TextureWrap::ClampToEdge; }},
                               {Texture::Aspect::Sampler, [](Texture &t) { t.magnified = TextureFilter::Nearest; }},
                               {Texture::Aspect::Sampler, [](Texture &t) { t.minified = TextureFilter::Nearest; }},
                               {Texture::Aspect::Sampler, [](Texture &texture) { texture.mip = MipFilter::None; }}});
  expect_aspects<Image>(texel(), {{Image::Aspect::Name, [](Image &image) { image.name = "renamed"; }},
                                  {Image::Aspect::Content, [](Image &image) { image.texels[2] = 77; }},
                                  {Image::Aspect::Content, [](Image &image) {
                                     image.width = 2;
                                     image.texels.resize(8);
                                   }}});
  expect_aspects<Mesh>(triangle(), {{Mesh::Aspect::Name, [](Mesh &mesh) { mesh.name = "renamed"; }},
                                    {Mesh::Aspect::Shape, [](Mesh &mesh) { mesh.positions[0].x = -1.0F; }},
                                    {Mesh::Aspect::Shape,
                                     [](Mesh &mesh) {
                                       mesh.normals[0] = {1, 0, 0};
                                     }},
                                    {Mesh::Aspect::Material, [](Mesh &mesh) {
                                       mesh.material = {7, 1};
                                     }}});
  for (void (*change)(Mesh &) :
       {+[](Mesh &mesh) { mesh.uvs.resize(3); }, +[](Mesh &mesh) { mesh.second_uvs.resize(3); },
        +[](Mesh &mesh) { mesh.tangents.resize(3); }, +[](Mesh &mesh) { mesh.colors.resize(3); },
        +[](Mesh &mesh) { std::swap(mesh.indices[1], mesh.indices[2]); }}) {
    Scene scene;
    const auto mesh = scene.add(triangle());
    Changes<Mesh> changes(scene, mesh);
    scene.edit(mesh, change);
    EXPECT_EQ(changes.take(), (std::vector{Mesh::Aspect::Shape, Mesh::Aspect::Layout}));
  }
  AspectEdits<Node> node_edits = property_edits<Node>();
  node_edits.insert(node_edits.end(), {{Node::Aspect::Transform, [](Node &node) { node.parent_from_node[3].x = 1.0; }},
                                       {Node::Aspect::Content,
                                        [](Node &node) {
                                          node.meshes = {{7, 1}};
                                        }},
                                       {Node::Aspect::Content,
                                        [](Node &node) {
                                          node.lamp = {7, 1};
                                        }},
                                       {Node::Aspect::Content, [](Node &node) {
                                          node.camera = {7, 1};
                                        }}});
  expect_aspects<Node>({}, node_edits);
}

/** A mesh of 1000 vertices, edited by few at a time. */
class SceneVertices : public testing::Test {
 protected:
  SceneVertices()
  {
    Mesh made;
    for (int i = 0; i < count; i++) {
      made.positions.push_back(somewhere());
    }
    made.normals.assign(std::size_t(count), {0, 0, 1});
    made.colors.assign(std::size_t(count), glm::vec4(1.0F));
    made.indices = {0, 1, 2};
    mesh = scene.add(made);
  }
  glm::vec3 somewhere()
  {
    std::uniform_real_distribution<float> place(-1.0F, 1.0F);
    return {place(random), place(random), place(random)};
  }
  void move(std::vector<std::uint32_t> vertices)
  {
    std::vector<glm::vec3> positions;
    std::ranges::generate_n(std::back_inserter(positions), std::ptrdiff_t(vertices.size()),
                            [&] { return somewhere(); });
    scene.set_vertices(mesh, {.vertices = vertices, .positions = positions});
  }
  [[nodiscard]] Revision shape() const
  {
    return scene.meshes().revision(mesh, Mesh::Aspect::Shape);
  }

  static constexpr int count = 1000;
  const std::vector<VertexRange> whole = {{0, count}};
  std::mt19937 random{5};
  Scene scene;
  Handle<Mesh> mesh;
};

TEST_F(SceneVertices, HaveTheBoundsOfAMeshThatWasAddedSo)
{
  Changes<Mesh> changes(scene, mesh);
  for (std::uint32_t i = 0; i < 300; i++) {
    const Bounds &bounds = scene.meshes()[mesh].bounds;
    const std::vector<glm::vec3> &positions = scene.meshes()[mesh].positions;
    // Often the vertex on a face of the box, which then moves inwards.
    const auto extreme = std::ranges::find(positions, bounds.max.x, &glm::vec3::x);
    move({std::uint32_t(extreme - positions.begin()), 7 * i % count, 999});
    Scene other;
    const Handle<Mesh> added = other.add(scene.meshes()[mesh]);
    EXPECT_EQ(other.meshes()[added].bounds, scene.meshes()[mesh].bounds) << i;
  }
  EXPECT_EQ(changes.take(), std::vector{Mesh::Aspect::Shape});
}

TEST_F(SceneVertices, AreNamedToEachThatAsksForChanges)
{
  const Revision first = shape();
  EXPECT_EQ(scene.changed_vertices(mesh, 0), whole);
  move({70});
  const Revision second = shape();
  EXPECT_GT(second, first);
  EXPECT_EQ(scene.changed_vertices(mesh, first), (std::vector<VertexRange>{{64, 64}}));
  EXPECT_TRUE(scene.changed_vertices(mesh, second).empty());
  move({999, 128, 5});
  EXPECT_EQ(scene.changed_vertices(mesh, second), (std::vector<VertexRange>{{0, 64}, {128, 64}, {960, 40}}));
  EXPECT_EQ(scene.changed_vertices(mesh, first), (std::vector<VertexRange>{{0, 192}, {960, 40}}));
  const Revision third = shape();
  const std::uint32_t vertex = 5;
  scene.set_vertices(mesh, {.vertices = {&vertex, 1}, .positions = {&scene.meshes()[mesh].positions[5], 1}});
  EXPECT_EQ(shape(), third) << "the same value";
  scene.edit(mesh, [](Mesh &edited) { edited.normals[3] = {1, 0, 0}; });
  const Revision fourth = shape();
  move({70});
  EXPECT_EQ(scene.changed_vertices(mesh, third), whole) << "an edit of all was between them";
  EXPECT_EQ(scene.changed_vertices(mesh, fourth), (std::vector<VertexRange>{{64, 64}}));
  const Scene copy = scene;
  EXPECT_EQ(copy.changed_vertices(mesh, shape()), whole) << "another content";
  Mesh removed = scene.meshes()[mesh];
  scene.remove(mesh);
  scene.restore(mesh, std::move(removed));
  EXPECT_EQ(scene.changed_vertices(mesh, shape() - 1), whole);
}

TEST_F(SceneVertices, ThatDoNotFitAreRefused)
{
  const Mesh before = scene.meshes()[mesh];
  const Revision revision = scene.revision();
  const std::array<std::uint32_t, 2> vertices = {3, 4};
  const std::array<glm::vec3, 2> positions = {glm::vec3(1), glm::vec3(2)};
  const auto refused = [&](const VertexValues &values) -> std::string {
    try {
      scene.set_vertices(mesh, values);
    }
    catch (const InvalidEdit &error) {
      return error.what();
    }
    return "nothing";
  };
  const std::array<std::uint32_t, 2> beyond = {3, 1000};
  const std::array<glm::vec3, 2> infinite = {glm::vec3(1), glm::vec3(0, INFINITY, 0)};
  EXPECT_EQ(refused({.vertices = beyond, .positions = positions}), "mesh '': vertex 1000 is beyond its 1000 positions");
  EXPECT_EQ(refused({.vertices = vertices, .normals = std::span(positions).first(1)}),
            "mesh '': 1 normals for 2 vertices");
  EXPECT_EQ(refused({.vertices = vertices, .uvs = std::array{glm::vec2(0), glm::vec2(0)}}), "mesh '': it has no uvs");
  EXPECT_EQ(refused({.vertices = vertices, .positions = infinite}), "mesh '': position 4 is not finite");
  const std::vector<glm::vec4> bright(vertices.size(), glm::vec4(1.0F, 1.5F, 1.0F, 1.0F));
  EXPECT_EQ(refused({.vertices = vertices, .colors = bright}),
            fmt::format("mesh '': colour {} is not from 0 to 1", vertices[0]));
  EXPECT_EQ(refused({.vertices = vertices}), "nothing");
  EXPECT_EQ(scene.revision(), revision);
  EXPECT_EQ(scene.meshes()[mesh].positions, before.positions);
  scene.remove(mesh);
  EXPECT_THROW(scene.set_vertices(mesh, {}), StaleHandle);
}

TEST(SceneEdit, EachStreamOfVerticesIsNamedByItsErrors)
{
  std::size_t count = 0;
  for_each_stream_member([&](auto stream, auto new_values, std::string_view name) {
    count++;
    Scene scene;
    Mesh mesh = triangle();
    (mesh.*stream).resize(4);
    // More positions are too many for the first of the others.
    const std::string counts =
        name == "position" ? "3 normals for 4 positions" : fmt::format("4 {}s for 3 positions", name);
    EXPECT_EQ(message_of<InvalidEdit>([&] { scene.add(mesh); }), fmt::format("mesh '{}': {}", mesh.name, counts));
    mesh = triangle();
    (mesh.*stream).resize(3);
    const Handle<Mesh> handle = scene.add(mesh);
    auto values = mesh.*stream;
    values[1].y = float(nan);
    mesh.*stream = values;
    EXPECT_EQ(message_of<InvalidEdit>([&] { scene.replace(handle, mesh); }),
              fmt::format("mesh '{}': {} 1 is not finite", mesh.name, name));
    const std::vector<std::uint32_t> vertices = {0, 2, 1};
    VertexValues set{.vertices = vertices};
    set.*new_values = values;
    EXPECT_EQ(message_of<InvalidEdit>([&] { scene.set_vertices(handle, set); }),
              fmt::format("mesh '{}': {} 2 is not finite", mesh.name, name));
    set.*new_values = std::span(values).first(1);
    EXPECT_EQ(message_of<InvalidEdit>([&] { scene.set_vertices(handle, set); }),
              fmt::format("mesh '{}': 1 {}s for 3 vertices", mesh.name, name));
  });
  EXPECT_EQ(sizeof(VertexValues), (count + 1) * sizeof(VertexValues::vertices)) << "a stream is not in the list";
}

TEST(SceneRevision, MovingAParentChangesTheTransformsBelowAlone)
{
  Scene scene;
  const auto root = scene.add(named("root"));
  const auto child = scene.add(named("child"), root);
  const auto leaf = scene.add(named("leaf"), child);
  const auto other = scene.add(named("other"));
  Changes<Node> of_child(scene, child);
  Changes<Node> of_leaf(scene, leaf);
  Changes<Node> of_other(scene, other);
  using Aspects = std::vector<Node::Aspect>;
  scene.set_transform(root, glm::translate(glm::dmat4(1.0), {1, 0, 0}));
  EXPECT_EQ(of_child.take(), Aspects{Node::Aspect::Transform});
  EXPECT_EQ(of_leaf.take(), Aspects{Node::Aspect::Transform});
  scene.edit(root, [](Node &node) { node.is_visible = false; });
  EXPECT_EQ(of_child.take(), Aspects{Node::Aspect::Visibility});
  EXPECT_EQ(of_leaf.take(), Aspects{Node::Aspect::Visibility});
  // A child that is hidden itself does not change with its hidden parent.
  scene.edit(child, [](Node &node) { node.is_visible = false; });
  EXPECT_TRUE(of_child.take().empty() && of_leaf.take().empty());
  scene.edit(root, [](Node &node) { node.is_visible = true; });
  EXPECT_TRUE(of_child.take().empty() && of_leaf.take().empty());
  // A new parent with the same matrix and visibility changes neither aspect.
  const auto twin = scene.add(scene.nodes()[root]);
  scene.set_parent(child, twin);
  EXPECT_TRUE(of_child.take().empty() && of_leaf.take().empty());
  scene.edit(root, [](Node &node) { node.name = "renamed"; });
  scene.set_transform(root, scene.nodes()[root].parent_from_node);
  EXPECT_TRUE(of_child.take().empty() && of_leaf.take().empty() && of_other.take().empty());
}

TEST(SceneRevision, AddingAndRemovingChangesThePoolAndNotTheOthers)
{
  Scene scene;
  const Revision constructed = scene.revision();
  EXPECT_GT(constructed, 0U);
  EXPECT_LE(scene.lamps().latest(), constructed);
  const auto lamp = scene.add(Lamp());
  const Revision added = scene.revision();
  EXPECT_EQ(scene.lamps().latest(), added);
  EXPECT_EQ(scene.lamps().revision(lamp, Lamp::Aspect::Shape), added);
  const auto second = scene.add(Lamp());
  EXPECT_GT(scene.revision(), added);
  EXPECT_EQ(scene.lamps().revision(lamp, Lamp::Aspect::Shape), added);
  const Revision before = scene.revision();
  scene.remove(second);
  EXPECT_GT(scene.revision(), before);
  for (const auto aspect : {Lamp::Aspect::Name, Lamp::Aspect::Light, Lamp::Aspect::Shape, Lamp::Aspect::Shadow}) {
    EXPECT_EQ(scene.lamps().latest(aspect), scene.revision());
    EXPECT_EQ(scene.lamps().revision(lamp, aspect), added);
  }
  EXPECT_LE(scene.materials().latest(), constructed) << "another kind of thing";
  const auto third = scene.add(Lamp());
  EXPECT_EQ(third.index, second.index);
  EXPECT_EQ(scene.lamps().revision(third, Lamp::Aspect::Name), scene.revision());
}

/** Expects that all that \a scene holds has changed after \a seen, and nothing after its own last revision. */
void expect_all_changed(const Scene &scene, Revision seen, const char *how)
{
  EXPECT_GT(scene.revision(), seen) << how;
  EXPECT_GT(scene.world_revision(), seen) << how;
  EXPECT_LE(scene.world_revision(), scene.revision()) << how;
  const auto check = [&](const auto &pool) {
    using Aspect = typename std::decay_t<decltype(pool)>::Aspect;
    for (std::size_t aspect = 0; aspect < std::size_t(Aspect::Count); aspect++) {
      EXPECT_GT(pool.latest(Aspect(aspect)), seen) << how;
      EXPECT_LE(pool.latest(Aspect(aspect)), scene.revision()) << how;
      for (const auto &item : pool) {
        EXPECT_GT(pool.revision(item.handle, Aspect(aspect)), seen) << how;
        EXPECT_LE(pool.revision(item.handle, Aspect(aspect)), pool.latest(Aspect(aspect))) << how;
      }
    }
  };
  check(scene.nodes());
  check(scene.meshes());
  check(scene.images());
  check(scene.textures());
  check(scene.surface_functions());
  check(scene.materials());
  check(scene.lamps());
  check(scene.cameras());
}

TEST(SceneRevision, AnotherContentUnderAReferenceHasLaterRevisions)
{
  const auto filled = [](float intensity) {
    Scene scene;
    scene.add(at({1, 2, 3}));
    scene.add(triangle());
    scene.add(Lamp{.intensity = intensity});
    scene.set_world(World());
    return scene;
  };
  Scene other = filled(2.0F);
  Scene scene = filled(1.0F);
  // A consumer that keeps a reference to the scene has seen all until here.
  Revision seen = scene.revision();
  const auto expect_seen = [&](const char *how) {
    expect_all_changed(scene, seen, how);
    seen = scene.revision();
    EXPECT_EQ(scene.revision(), seen);
    scene.add(Material());
    EXPECT_GT(scene.revision(), seen) << how;
    EXPECT_LE(scene.lamps().latest(), seen) << how << ": only materials have changed";
    seen = scene.revision();
  };
  // The other was edited before, so that it had lower revisions.
  scene = other;
  expect_seen("copied");
  const Scene snapshot = scene;
  scene.edit(scene.lamps().first(), [](Lamp &lamp) { lamp.intensity = 3.0F; });
  seen = scene.revision();
  scene = snapshot;
  expect_seen("undone by a copy");
  std::swap(scene, other);
  expect_seen("swapped");
  expect_all_changed(other, snapshot.revision(), "the other of the swap");
  scene = std::move(other);
  expect_seen("moved");
  scene = filled(4.0F);
  expect_seen("made anew");
  scene = Scene();
  expect_seen("emptied");
  const Scene moved = std::move(scene);
  expect_all_changed(scene, seen, "moved from");
  expect_all_changed(moved, seen, "constructed by a move");
  // NOLINTNEXTLINE(bugprone-use-after-move)
  EXPECT_TRUE(scene.nodes().empty() && scene.nodes().begin() == scene.nodes().end());
  const Scene &self = moved;
  scene = self;
  EXPECT_EQ(scene.materials().size(), 1U);
  // In the same place, as std::optional::emplace makes one.
  std::optional<Scene> place(snapshot);
  seen = place->revision();
  expect_all_changed(place.emplace(), seen, "constructed in place");
}

TEST(SceneRevision, EditsOfDifferentScenesHaveDifferentRevisions)
{
  Scene a;
  Scene b = a;
  a.add(triangle());
  b.add(triangle());
  EXPECT_NE(a.revision(), b.revision());
  EXPECT_NE(a.meshes().latest(), b.meshes().latest());
}

TEST(SceneRevision, MeshBoundsFollowThePositions)
{
  Scene scene;
  Mesh mesh = triangle();
  mesh.bounds = {{-9, -9, -9}, {9, 9, 9}};
  const auto handle = scene.add(mesh);
  EXPECT_EQ(scene.meshes()[handle].bounds.max, glm::vec3(1, 1, 0));
  scene.edit(handle, [](Mesh &changed) { changed.positions[1].x = 5.0F; });
  EXPECT_EQ(scene.meshes()[handle].bounds.max, glm::vec3(5, 1, 0));
}

// ---- Refused edits ----

/**
 * Each change is refused by add, replace and edit, with a message that contains its word, and the scene is unchanged.
 */
template <typename T>
void expect_refused(const T &value, const std::vector<std::pair<std::string, std::function<void(T &)>>> &changes)
{
  Scene scene;
  const Handle<T> handle = scene.add(value);
  const Revision before = scene.revision();
  for (const auto &[word, change] : changes) {
    T changed = value;
    change(changed);
    for (const std::string &message : {message_of<InvalidEdit>([&] { scene.add(changed); }),
                                       message_of<InvalidEdit>([&] { scene.replace(handle, changed); }),
                                       message_of<InvalidEdit>([&, &edit = change] { scene.edit(handle, edit); })}) {
      EXPECT_NE(message.find(word), std::string::npos) << word << ": " << message;
      EXPECT_EQ(message.find(fmt::format("{} '{}': ", T::kind_name, value.name)), 0U) << message;
    }
  }
  EXPECT_EQ(scene.revision(), before);
  EXPECT_EQ(scene.pool<T>().size(), 1U);
  scene.replace(handle, value);
  EXPECT_EQ(scene.revision(), before) << "the value is the old one";
}

TEST(SceneEdit, InvalidValuesAreRefused)
{
  expect_refused<Mesh>(triangle(), {{"2 normals for 3 positions", [](Mesh &mesh) { mesh.normals.pop_back(); }},
                                    {"1 uvs for 3 positions", [](Mesh &mesh) { mesh.uvs.resize(1); }},
                                    {"2 second uvs for 3", [](Mesh &mesh) { mesh.second_uvs.resize(2); }},
                                    {"4 tangents for 3", [](Mesh &mesh) { mesh.tangents.resize(4); }},
                                    {"1 colours for 3", [](Mesh &mesh) { mesh.colors.resize(1); }},
                                    {"2 indices", [](Mesh &mesh) { mesh.indices.pop_back(); }},
                                    {"index 3 is beyond", [](Mesh &mesh) { mesh.indices[1] = 3; }},
                                    {"index 4294967295", [](Mesh &mesh) { mesh.indices[2] = 0xFFFFFFFFU; }},
                                    {"normal 0 is not finite", [](Mesh &mesh) { mesh.normals[0].z = float(infinity); }},
                                    {"uv 1 is not finite",
                                     [](Mesh &mesh) {
                                       mesh.uvs.assign(3, {});
                                       mesh.uvs[1].y = float(nan);
                                     }},
                                    {"colour 2 is not from 0 to 1",
                                     [](Mesh &mesh) {
                                       mesh.colors.assign(3, glm::vec4(1.0F));
                                       mesh.colors[2].a = 1.5F;
                                     }},
                                    {"position 1 is not finite", [](Mesh &mesh) { mesh.positions[1].y = float(nan); }},
                                    {"position 2", [](Mesh &mesh) { mesh.positions[2].z = float(-infinity); }}});
  const auto of_host = [](const Bounds &bounds) { return HostShape{.bounds = bounds}; };
  const Mesh host_mesh{.name = "host", .host_shape = of_host({{-1, 0, 0}, {1, 0, 2}})};
  expect_refused<Mesh>(host_mesh, {{"bounds", [](Mesh &mesh) { mesh.host_shape->bounds = {}; }},
                                   {"bounds", [](Mesh &mesh) { mesh.host_shape->bounds.max.x = float(infinity); }},
                                   {"bounds", [](Mesh &mesh) { mesh.host_shape->bounds.min.y = float(nan); }},
                                   {"3 positions and 3 indices beside a shape in the host's buffers", [&](Mesh &mesh) {
                                      mesh.positions = triangle().positions;
                                      mesh.normals = triangle().normals;
                                      mesh.indices = triangle().indices;
                                    }}});
  expect_refused<Image>(texel(), {{"4 bytes for 2x1", [](Image &image) { image.width = 2; }},
                                  {"3 bytes", [](Image &image) { image.texels.pop_back(); }},
                                  {"0 bytes for 0x0",
                                   [](Image &image) {
                                     image = {"texel", 0, 0, {}};
                                   }},
                                  // 4 · 2³⁰ · 2³⁰ is 0 in 32 bits.
                                  {"bytes for", [](Image &image) {
                                     image = {"texel", 1U << 30U, 1U << 30U, {}};
                                   }}});
  expect_refused<SurfaceFunction>(
      {.name = "f"},
      {{"surface function 'f': 65537 bytes", [](SurfaceFunction &function) { function.text.assign(65537, ' '); }},
       {"NUL", [](SurfaceFunction &function) { function.text.assign(1, '\0'); }}});
  expect_refused<Node>(
      named("n"), {{"its matrix has nan in row 1 and column 1", [](Node &node) { node.parent_from_node[1][1] = nan; }},
                   {"its matrix has inf in row 0 and column 3, which is not from -1e+12 to 1e+12",
                    [](Node &node) { node.parent_from_node[3][0] = infinity; }},
                   {"its matrix has -1e+300 in row 2", [](Node &node) { node.parent_from_node[3][2] = -1e300; }},
                   {"not affine", [](Node &node) { node.parent_from_node[0][3] = 0.5; }},
                   {"not affine", [](Node &node) { node.parent_from_node[3][3] = 2.0; }},
                   {"not affine", [](Node &node) { node.parent_from_node = glm::dmat4(0.0); }}});
  expect_refused<Lamp>({.name = "l"},
                       {{"intensity is not finite", [](Lamp &lamp) { lamp.intensity = float(nan); }},
                        {"intensity -30 is not from 0 to 1e+30", [](Lamp &lamp) { lamp.intensity = -30.0F; }},
                        {"color is not finite", [](Lamp &lamp) { lamp.color.g = float(infinity); }},
                        {"color -1 is not from 0 to 1e+12", [](Lamp &lamp) { lamp.color.b = -1.0F; }},
                        {"radius -1", [](Lamp &lamp) { lamp.radius = -1.0F; }},
                        {"spot_outer_angle is not finite", [](Lamp &lamp) { lamp.spot_outer_angle = float(nan); }},
                        {"shadow_bias is not finite", [](Lamp &lamp) { lamp.shadow.bias = float(nan); }}});
  expect_refused<Material>(
      {.name = "m"}, {{"base_color is not finite", [](Material &material) { material.base_color.b = float(nan); }},
                      {"base_color -1 is not from 0 to 1", [](Material &material) { material.base_color.r = -1.0F; }},
                      {"roughness -5", [](Material &material) { material.roughness = -5.0F; }},
                      {"emissive is not finite", [](Material &material) { material.emissive.r = float(infinity); }},
                      {"normal_scale is not", [](Material &material) { material.normal_scale = float(nan); }}});
  Material turned;
  turned.normal_scale = turned.anisotropy_rotation = -3.0F;
  Scene().add(turned);
  expect_refused<Camera>(
      {.name = "c"},
      {{"vertical_angle 0 is not from", [](Camera &camera) { camera.vertical_angle = 0.0F; }},
       {"vertical_angle 9 is not from", [](Camera &camera) { camera.vertical_angle = 9.0F; }},
       {"near 0 is not above 0", [](Camera &camera) { camera.near = 0.0F; }},
       {"far is not finite", [](Camera &camera) { camera.far = float(nan); }},
       {"half_height 0 is not from 1e-12 to 1e+12, or the negative of such a number", [](Camera &camera) {
          camera.kind = CameraKind::Orthographic;
          camera.half_height = 0.0F;
        }}});
}

TEST(SceneEdit, ARefusedTransformChangesNothing)
{
  Scene scene;
  const auto root = scene.add(at({1, 2, 3}, "root"));
  const auto child = scene.add(Node(), root);
  const Revision before = scene.revision();
  glm::dmat4 matrix(1.0);
  matrix[2][2] = nan;
  const std::string message = message_of<InvalidEdit>([&] { scene.set_transform(root, matrix); });
  EXPECT_NE(message.find("node 'root': "), std::string::npos) << message;
  EXPECT_EQ(scene.world_from_node(child)[3], glm::dvec4(1, 2, 3, 1));
  EXPECT_EQ(scene.nodes()[root].parent_from_node[2][2], 1.0);
  EXPECT_EQ(scene.revision(), before);
  // Singular and mirrored matrices are valid.
  scene.set_transform(root, glm::scale(glm::dmat4(1.0), {-1.0, 0.0, 1.0}));
  EXPECT_EQ(scene.world_from_node(child)[0][0], -1.0);
}

TEST(SceneEdit, EmptyMeshIsValid)
{
  Scene scene;
  const auto mesh = scene.add(Mesh());
  EXPECT_TRUE(scene.meshes()[mesh].bounds.is_empty());
  Node node;
  node.meshes = {mesh, mesh};
  scene.add(node);
  EXPECT_EQ(scene.objects().size(), 2U);
  EXPECT_TRUE(scene.bounds().is_empty());
}

TEST(SceneWorld, PictureWithATexelThatIsNoRadianceIsRefused)
{
  Scene scene;
  for (const float texel : {-1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    World world;
    world.picture = std::make_shared<const WorldPicture>(WorldPicture{2, 1, {glm::vec3(1.0F), glm::vec3(1, texel, 1)}});
    try {
      scene.set_world(world);
      FAIL() << texel;
    }
    catch (const InvalidEdit &error) {
      EXPECT_NE(std::string(error.what()).find("world: its picture: texel 1, 0 from the top left is"),
                std::string::npos)
          << error.what();
    }
  }
  EXPECT_FALSE(scene.world());
}

TEST(SceneWorld, RadianceAboveTheLimitIsRefusedAndCanBeClamped)
{
  const auto largest = float(light_max);
  const auto picture_of = [](float texel) {
    return std::make_shared<const WorldPicture>(WorldPicture{2, 1, {glm::vec3(1, 0, 1), glm::vec3(1, texel, 1)}});
  };
  const auto error_of = [](const World &world) {
    try {
      Scene().set_world(world);
    }
    catch (const InvalidEdit &error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(error_of({.picture = picture_of(largest)}), "");
  EXPECT_EQ(error_of({.color = glm::vec3(largest)}), "");
  EXPECT_EQ(error_of({.color = {1, 0, 1}, .strength = largest, .picture = picture_of(largest)}), "");
  // The texels of the first two are above the limit alone. The light of the last is beyond float.
  for (const World &world :
       {World{.picture = picture_of(2e30F)}, World{.strength = 10.0F, .picture = picture_of(1e38F)},
        World{.color = {3, 1e10F, 3}, .strength = 7e15F, .picture = picture_of(1e10F)},
        World{.color = {1, 1e30F, 1}, .strength = 1e30F, .picture = picture_of(1e30F)}}) {
    EXPECT_NE(error_of(world), "");
    WorldPicture picture = *world.picture;
    const bool is_texel_beyond = picture.texels[1].g > largest;
    EXPECT_EQ(clamp_radiances(picture),
              is_texel_beyond ? "1 of 2 texels above 1e+30 (the first at 1, 0 from the top left): clamped to 0 and the "
                                "largest finite value, at most 1e+30"
                              : "");
    World limited = world;
    limited.picture = std::make_shared<const WorldPicture>(picture);
    const bool is_beyond = limited.strength != 1.0F;
    EXPECT_EQ(limit_radiances(limited),
              is_beyond
                  ? "its picture: 1 of 2 texels above 1e+30 by its color and strength (the first at 1, 0 from the "
                    "top left): clamped to 1e+30"
                  : "");
    EXPECT_EQ(error_of(limited), "");
    EXPECT_EQ(limited.picture->texels[0], glm::vec3(1, 0, 1)) << "as it was";
    EXPECT_NEAR(double(limited.picture->texels[1].g) * limited.color.g * limited.strength, light_max, 1e-6 * light_max);
  }
  World even{.color = {1e30F, 1, 0}, .strength = 1e30F};
  EXPECT_NE(error_of(even).find("world: its color times its strength is 1e+60, 1e+30, 0, which is above 1e+30"),
            std::string::npos)
      << error_of(even);
  EXPECT_NE(limit_radiances(even), "");
  EXPECT_EQ(even.color, glm::vec3(1, 1, 0));
  EXPECT_EQ(error_of(even), "");
}

}  // namespace
}  // namespace gnomon::scene
