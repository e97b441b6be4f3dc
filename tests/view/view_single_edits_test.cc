// SPDX-License-Identifier: MIT
// Every edit that the window offers, alone: undone, redone, saved and loaded. The edits come from the tables of
// properties, so that a new property is among them.
#include "view_document.hh"

#include "gltf_export.hh"
#include "gltf_import.hh"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <unistd.h>

namespace gnomon::view {
namespace {

using scene::Handle;
using scene::Lamp;
using scene::Material;
using scene::Mesh;
using scene::Node;
using scene::Scene;

/** One step for undo. */
struct Edit {
  std::string name;
  std::function<void(Document &)> apply;
};

/** Another value of a row of a table, and its name. */
template <typename T>
struct Changed {
  std::string name;
  T value;
};

/** All values of \a thing that one choice or number of its table changes. */
template <typename T>
std::vector<Changed<T>> row_changes(const T &thing, const std::string &prefix)
{
  std::vector<Changed<T>> changes;
  const Properties<T> &rows = properties<T>();
  for (const ChoiceProperty<T> &row : rows.choices) {
    for (int option = 0; option < int(row.options.size()); option++) {
      if ((!row.applies || row.applies(thing)) && row.get(thing) != option) {
        changes.push_back({fmt::format("{}{}={}", prefix, row.name, row.options[std::size_t(option)]), thing});
        row.set(changes.back().value, option);
      }
    }
  }
  for (const NumberProperty<T> &row : rows.numbers) {
    if (row.applies && !row.applies(thing)) {
      continue;
    }
    const Limits limits = row.limits(thing);
    for (int i = 0; i < row.width; i++) {
      for (const double part : {0.0, 0.77}) {
        // One limit of three is enough.
        if (part == 0.0 && i > 0) {
          continue;
        }
        const double high = std::min(limits.max, std::max(limits.min + 1.0, 10.0));
        const double value = std::max(limits.min, -10.0) * (1.0 - part) + high * part;
        changes.push_back({fmt::format("{}{}[{}]={:g}", prefix, row.name, i, value), thing});
        row.set(changes.back().value, i, value);
      }
    }
    if (row.absent) {
      changes.push_back({fmt::format("{}{}={}", prefix, row.name, row.absent), thing});
      row.remove(changes.back().value);
    }
  }
  return changes;
}

/** The name of a row in the name of a change. */
std::string row_of(const std::string &name)
{
  return name.substr(0, name.find_first_of("[="));
}

/** row_changes, and the changes of further rows that apply after one of them. */
template <typename T>
std::vector<Changed<T>> all_changes(const T &thing, const std::string &prefix)
{
  std::vector<Changed<T>> changes = row_changes(thing, prefix);
  std::set<std::string> rows;
  for (const Changed<T> &change : changes) {
    rows.insert(row_of(change.name));
  }
  const std::size_t direct = changes.size();
  for (std::size_t i = 0; i < direct; i++) {
    std::set<std::string> further;
    for (Changed<T> &change : row_changes(changes[i].value, prefix)) {
      if (!rows.contains(row_of(change.name))) {
        further.insert(row_of(change.name));
        changes.push_back({change.name + " after " + changes[i].name, std::move(change.value)});
      }
    }
    rows.merge(further);
  }
  return changes;
}

template <typename T>
void add_edits(std::vector<Edit> &edits, Handle<T> handle, const T &thing, const std::string &name)
{
  for (Changed<T> &change : all_changes(thing, std::string(T::kind_name) + '.')) {
    edits.push_back({name + ' ' + change.name, [handle, value = std::move(change.value)](Document &document) {
                       document.edit(handle, [&](T &edited) { edited = value; });
                     }});
  }
}

/** The edits of a node and of what it has, that the panels of the window and scripts make. */
void add_edits_of_node(std::vector<Edit> &edits, const Document &document, Handle<Node> handle)
{
  const Scene &scene = document.scene();
  const Node &node = scene.nodes()[handle];
  for (const Changed<Placement> &change : all_changes(placement_of(node.parent_from_node), "placement.")) {
    edits.push_back({node.name + ' ' + change.name, [handle, value = change.value](Document &edited_document) {
                       edited_document.edit(handle, [&](Node &edited) {
                         edited.parent_from_node = placed(edited.parent_from_node, value);
                       });
                     }});
  }
  add_edits(edits, handle, node, node.name);
  if (const Lamp *lamp = scene.lamps().find(node.lamp)) {
    add_edits(edits, node.lamp, *lamp, node.name);
    for (const Changed<ShadowOfLamp> &change : all_changes(document.shadow_of(*lamp), "shadow.")) {
      edits.push_back(
          {node.name + ' ' + change.name, [lamp = node.lamp, value = change.value](Document &edited_document) {
             edited_document.edit(lamp, [&](Lamp &edited) { edited.shadow = value.shadow; });
           }});
    }
  }
  if (const scene::Camera *camera = scene.cameras().find(node.camera)) {
    add_edits(edits, node.camera, *camera, node.name);
  }
  for (const Handle<Mesh> mesh : node.meshes) {
    if (const Material *material = scene.materials().find(scene.meshes()[mesh].material)) {
      add_edits(edits, scene.meshes()[mesh].material, *material, node.name);
    }
  }
  edits.push_back({"remove " + node.name, [handle](Document &edited_document) {
                     edited_document.selected = handle;
                     EXPECT_TRUE(edited_document.remove_selected());
                   }});
  edits.push_back({"duplicate " + node.name, [handle](Document &edited_document) {
                     edited_document.selected = handle;
                     EXPECT_TRUE(edited_document.duplicate_selected());
                   }});
}

std::vector<Edit> single_edits(const Document &document)
{
  std::vector<Edit> edits;
  for (const auto &[handle, node] : document.scene().nodes()) {
    add_edits_of_node(edits, document, handle);
  }
  for (const Addition &addition : additions()) {
    edits.push_back({std::string("add ") + addition.name, [&addition](Document &edited) {
                       edited.add(addition, {1, 2, 3}, glm::translate(glm::dmat4(1.0), {3, 2, 1}));
                     }});
  }
  for (const Changed<scene::World> &change : all_changes(scene::World(), "world.")) {
    edits.push_back({change.name, [value = change.value](Document &edited) { edited.set_world(value); }});
  }
  edits.push_back({"no world", [](Document &edited) { edited.set_world(std::nullopt); }});
  edits.push_back({"a world", [](Document &edited) { edited.set_world(scene::World{.strength = 0.25F}); }});
  edits.push_back(
      {"a picture", [](Document &edited) {
         const std::vector<glm::vec3> texels(8, {0.25F, 0.5F, 1.0F});
         edited.set_world_picture(std::make_shared<const scene::WorldPicture>(scene::WorldPicture{4, 2, texels}));
       }});
  edits.push_back({"no picture", [](Document &edited) { edited.set_world_picture(nullptr); }});
  return edits;
}

/** The content of a scene by names: values of properties, and positions of vertices in world space. */
using Content = std::map<std::string, double>;

template <typename T>
void add_rows(Content &content, const T &thing, const std::string &name)
{
  const Properties<T> &rows = properties<T>();
  for (const ChoiceProperty<T> &row : rows.choices) {
    if (!row.applies || row.applies(thing)) {
      content[name + row.name] = row.get(thing);
    }
  }
  for (const NumberProperty<T> &row : rows.numbers) {
    const bool is_there = (!row.applies || row.applies(thing)) && !(row.is_absent && row.is_absent(thing));
    for (int i = 0; is_there && i < row.width; i++) {
      content[fmt::format("{}{}[{}]", name, row.name, i)] = row.get(thing, i);
    }
  }
}

Content content_of(const Scene &scene)
{
  Content content;
  // By name and, in the order of the nodes, by number.
  std::map<std::string, int> numbers;
  for (const auto &[handle, node] : scene.nodes()) {
    const Handle<Node> parent = scene.parent(handle);
    std::string name = fmt::format("{}/{}", parent ? scene.nodes()[parent].name : "", node.name);
    name += fmt::format("#{} ", numbers[name]++);
    const glm::dmat4 &world = scene.world_from_node(handle);
    for (int i = 0; i < 16; i++) {
      content[fmt::format("{}matrix[{}]", name, i)] = node.parent_from_node[i / 4][i % 4];
    }
    add_rows(content, node, name);
    std::string extras = node.extras;
    if (const Lamp *lamp = scene.lamps().find(node.lamp)) {
      add_rows(content, *lamp, name);
      add_rows(content, ShadowOfLamp{lamp->kind, scene::ShadowKind::Evsm, lamp->shadow}, name);
      extras += lamp->extras;
    }
    if (const scene::Camera *camera = scene.cameras().find(node.camera)) {
      add_rows(content, *camera, name);
      extras += camera->extras;
    }
    for (std::size_t m = 0; m < node.meshes.size(); m++) {
      const Mesh *mesh = scene.meshes().find(node.meshes[m]);
      if (!mesh) {
        continue;
      }
      add_rows(content, scene.material_of(*mesh), fmt::format("{}material {} ", name, m));
      extras += mesh->extras + scene.material_of(*mesh).extras;
      for (std::size_t i = 0; i < mesh->positions.size(); i++) {
        const glm::dvec3 position(world * glm::dvec4(mesh->positions[i], 1.0));
        for (int axis = 0; axis < 3; axis++) {
          content[fmt::format("{}vertex {}.{}[{}]", name, m, i, axis)] = position[axis];
        }
      }
    }
    // Those of an area lamp are read as those of its node.
    content[name + "extras"] = double(std::ranges::count(extras, ':'));
  }
  if (scene.world()) {
    add_rows(content, *scene.world(), "world ");
    content["world picture"] = scene.world()->picture ? 1.0 : 0.0;
  }
  return content;
}

/** The content at rest, and at some times of each animation. */
Content moving_content_of(Scene scene)
{
  Content content = content_of(scene);
  for (const scene::Animation &animation : std::vector<scene::Animation>(scene.animations)) {
    for (const double seconds : {0.4, 1.0}) {
      scene::pose(scene, animation, seconds);
      for (const auto &[name, value] : content_of(scene)) {
        content[fmt::format("{} at {}: {}", animation.name, seconds, name)] = value;
      }
    }
  }
  return content;
}

/** A body with two joints and a morph target, animated, with an animated lamp and material. */
Scene animated_scene()
{
  Scene scene;
  const auto material = scene.add(Material{.name = "skin", .emissive = {0.5F, 0.25F, 0.125F}});
  Mesh shape{.name = "body", .material = material};
  for (int i = 0; i < 8; i++) {
    shape.positions.emplace_back(float(i % 2), float(i / 2 % 2), float(i / 4));
    shape.normals.emplace_back(0, 0, 1);
  }
  shape.indices = {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6};
  const auto mesh = scene.add(shape);
  const auto armature = scene.add(Node{.name = "armature"});
  const auto body = scene.add(
      Node{.name = "body", .parent_from_node = glm::translate(glm::dmat4(1.0), {1, 0, 0}), .meshes = {mesh}}, armature);
  const auto hip = scene.add(Node{.name = "hip"}, armature);
  const auto knee =
      scene.add(Node{.name = "knee", .parent_from_node = glm::translate(glm::dmat4(1.0), {0, 1, 0})}, hip);
  const auto lamp = scene.add(Lamp{.name = "torch", .kind = scene::LampKind::Spot, .intensity = 20.0F});
  scene.add(Node{.name = "torch", .lamp = lamp}, knee);
  const auto camera = scene.add(scene::Camera{.name = "camera"});
  scene.add(Node{.name = "camera", .camera = camera});
  scene.skins.push_back({"skin", {hip, knee}, {glm::dmat4(1.0), glm::translate(glm::dmat4(1.0), {0, -1, 0})}});
  scene::DeformedMesh deformed;
  deformed.mesh = mesh;
  deformed.node = body;
  deformed.positions = shape.positions;
  deformed.normals = shape.normals;
  deformed.targets = {{std::vector<glm::vec3>(8, {0, 0, 0.5F}), {}, {}}};
  deformed.weights = {0.25};
  deformed.skin = 0;
  deformed.joint_sets = 1;
  for (int i = 0; i < 8; i++) {
    const float weight = i < 4 ? 0.25F : 1.0F;
    deformed.joint_weights.push_back({{0, 1, 0, 0}, {1.0F - weight, weight, 0, 0}});
  }
  scene.deformed_meshes.push_back(std::move(deformed));
  const auto track = [](std::size_t width, std::vector<float> values) {
    return std::make_shared<const scene::Track>(
        scene::Track{scene::Interpolation::Linear, width, {0, 1}, std::move(values)});
  };
  scene::AnimatedNode moved;
  moved.node = knee;
  moved.translation_track = track(3, {0, 1, 0, 1, 2, 3});
  moved.rotation_track = track(4, {0, 0, 0, 1, 0.6F, 0, 0, 0.8F});
  scene::AnimatedNode morphed;
  morphed.node = body;
  morphed.weights_track = track(1, {0.25F, 1});
  scene::AnimatedNode walking;
  walking.node = armature;
  walking.translation_track = track(3, {0, 0, 0, 4, 0, 0});
  scene.animations.push_back({"walk",
                              {moved, morphed, walking},
                              {{.target = lamp, .property = "intensity", .track = track(1, {20, 40})},
                               {.target = material, .property = "roughness", .track = track(1, {1, 0.5F})}}});
  scene::deform_meshes(scene);
  return scene;
}

class ViewSingleEditsTest : public testing::Test {
 protected:
  ViewSingleEditsTest()
      : folder_(std::filesystem::path(testing::TempDir()) /
                fmt::format("single_edits_{}", testing::UnitTest::GetInstance()->random_seed() + ::getpid()))
  {
    std::filesystem::create_directories(folder_);
  }
  ~ViewSingleEditsTest() override
  {
    std::filesystem::remove_all(folder_);
  }
  /** The bytes of the scene as it is saved. */
  std::string saved(const Scene &scene)
  {
    gltf::export_gltf(scene, folder_ / "scene.glb");
    std::ifstream stream(folder_ / "scene.glb", std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  /** The scene that saved() wrote last. */
  Scene loaded()
  {
    return gltf::import_gltf(folder_ / "scene.glb");
  }
  /** Expects that \a scene, which was saved, is loaded as it was, and that it moves as before if \a is_moved. */
  void expect_loaded(const Scene &scene, const std::string &name, bool is_moved)
  {
    const Scene read = loaded();
    const Content before = is_moved ? moving_content_of(scene) : content_of(scene);
    const Content after = is_moved ? moving_content_of(read) : content_of(read);
    std::string differences;
    int count = 0;
    for (const auto &[key, value] : before) {
      const auto found = after.find(key);
      // glTF has photometric units, matrices of animated nodes as translation, rotation and scale, and spots with an
      // inner angle.
      const bool is_same =
          found != after.end() && std::abs(found->second - value) <= 2e-5 * std::max(1.0, std::abs(value));
      if (!is_same && count++ < 4) {
        differences += fmt::format("\n  {}: {} was saved, and {} is loaded", key, value,
                                   found == after.end() ? "nothing" : fmt::format("{}", found->second));
      }
    }
    EXPECT_EQ(count, 0) << name << differences;
  }
  /** Makes each edit alone, undoes and redoes it, and saves and loads it. \return the names of the edits */
  std::vector<std::string> expect_edits(Scene original)
  {
    Document document(*device_, std::move(original), default_settings());
    const std::string before = saved(document.scene());
    expect_loaded(document.scene(), "the scene before", true);
    std::vector<std::string> names;
    for (const Edit &edit : single_edits(document)) {
      names.push_back(edit.name);
      const scene::Revision revision = document.scene().revision();
      edit.apply(document);
      document.history().end_gesture();
      const std::string edited = saved(document.scene());
      if (document.scene().revision() == revision) {
        EXPECT_EQ(edited, before) << edit.name;
        continue;
      }
      // A pose sets the transforms of its nodes, also to what an edit has changed. No animation is left of a removed
      // armature, and none of the power of an area lamp, for which glTF has no word.
      const bool is_moved = edit.name.find("placement.") == std::string::npos &&
                            edit.name.find("kind=area") == std::string::npos && edit.name != "remove armature";
      // An index of refraction that reflects nothing is not written beside a specular colour that reflects.
      if (edit.name.find("material.ior[0]=1") == std::string::npos) {
        expect_loaded(document.scene(), edit.name, is_moved);
      }
      EXPECT_TRUE(document.undo()) << edit.name;
      EXPECT_TRUE(saved(document.scene()) == before) << "undo of " << edit.name;
      EXPECT_TRUE(document.redo()) << edit.name;
      EXPECT_TRUE(saved(document.scene()) == edited) << "redo of " << edit.name;
      EXPECT_TRUE(document.undo()) << edit.name;
    }
    // All of them in turn, and back.
    std::size_t step_count = 0;
    for (const Edit &edit : single_edits(document)) {
      if (!edit.name.starts_with("remove") && step_count < 300) {
        edit.apply(document);
        document.history().end_gesture();
        step_count++;
      }
    }
    while (document.undo()) {
    }
    EXPECT_TRUE(saved(document.scene()) == before) << "all undone";
    return names;
  }

  std::unique_ptr<gpu::Device> device_ = gpu::create_null_device();
  std::filesystem::path folder_;
};

/** The names of all rows of the table of \a T that \a edits lack. */
template <typename T>
std::vector<std::string> missing_rows(const std::vector<std::string> &edits, const std::string &prefix)
{
  std::vector<std::string> missing;
  const auto check = [&](const char *row) {
    const bool is_there = std::ranges::any_of(edits, [&](const std::string &edit) {
      return edit.find(prefix + row + '[') != std::string::npos || edit.find(prefix + row + '=') != std::string::npos;
    });
    if (!is_there) {
      missing.push_back(prefix + row);
    }
  };
  for (const auto &row : properties<T>().choices) {
    check(row.name);
  }
  for (const auto &row : properties<T>().numbers) {
    check(row.name);
  }
  return missing;
}

TEST_F(ViewSingleEditsTest, EachIsUndoneRedoneSavedAndLoaded)
{
  Scene full = gltf::import_gltf(std::string(GNOMON_SOURCE) + "/examples/scenes/full.gltf");
  full.set_world(scene::World{.color = {0.5F, 0.25F, 1.0F}});
  const auto give_extras = [&](const auto &pool) {
    for (const auto &item : pool) {
      full.edit(item.handle, [](auto &thing) { thing.extras = fmt::format(R"({{"{}":1}})", thing.kind_name); });
    }
  };
  give_extras(full.nodes());
  give_extras(full.meshes());
  give_extras(full.materials());
  give_extras(full.lamps());
  give_extras(full.cameras());
  const std::vector<std::string> edits = expect_edits(std::move(full));
  const std::vector<std::string> none;
  EXPECT_EQ(missing_rows<Placement>(edits, "placement."), none);
  EXPECT_EQ(missing_rows<Node>(edits, "node."), none);
  EXPECT_EQ(missing_rows<Lamp>(edits, "lamp."), none);
  EXPECT_EQ(missing_rows<ShadowOfLamp>(edits, "shadow."), none);
  EXPECT_EQ(missing_rows<scene::Camera>(edits, "camera."), none);
  EXPECT_EQ(missing_rows<scene::World>(edits, "world."), none);
  // Rows that need a texture are not offered for this scene.
  EXPECT_EQ(
      missing_rows<Material>(edits, "material."),
      (std::vector<std::string>{"material.normal_scale", "material.occlusion_strength", "material.coat_normal_scale"}));
}

TEST_F(ViewSingleEditsTest, EachOfAnAnimatedSkinnedSceneIsUndoneRedoneSavedAndLoaded)
{
  expect_edits(animated_scene());
}

}  // namespace
}  // namespace gnomon::view
