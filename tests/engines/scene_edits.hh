// SPDX-License-Identifier: MIT
#pragma once

#include "engines/eevee/eevee_test_scene.hh"

#include <algorithm>
#include <array>
#include <concepts>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

/**
 * Every edit of a scene: each property of each kind of thing, and each addition, removal, move and replacement. A
 * renderer that follows each of them, alone and in any order, shows the picture of a renderer that is made after them.
 */
namespace gnomon::test {

/** An edit, and the edit that takes it back. */
struct SceneEdit {
  std::string name;
  std::function<void(scene::Scene &)> apply;
  std::function<void(scene::Scene &)> undo;
  /** After `undo` all is as before, and not in another order or with other handles. */
  bool is_restored = true;
};

/** A scene and all edits of it. Edits refer to its things, and may follow each other in any order after an undo. */
struct EditedScene {
  std::string name;
  scene::Scene scene;
  std::vector<SceneEdit> edits;
  /** Edits that the scene refuses, as their values have no sense with others. */
  int refused_count = 0;
};

/** The least and the greatest number that edits set. */
struct EditLimits {
  double min = 0.0;
  double max = 100.0;
};

/** The limits of a row, without numbers so large or small that the picture would show nothing. */
inline EditLimits edit_limits(const scene::Description &row)
{
  // Ends of shadows are beyond their starts.
  if (row.name == "shadow_clip_start") {
    return {0.5, 3.0};
  }
  if (row.name == "shadow_clip_end") {
    return {3.5, 5.0};
  }
  if (row.unit == "px") {
    return {16.0, 100.0};
  }
  // Less than the layers of a small picture need.
  if (row.unit == "bytes") {
    return {5e4, 1e5};
  }
  const double least = row.min > 0.0 ? std::max(row.min, 0.01) : std::max(row.min, -3.0);
  return {std::min(least, row.max), std::min(row.max, 100.0)};
}

/** Calls \a visit with the name of each property of a T, a function that accesses it, and the limits for edits. */
template <typename T, typename Visit>
void for_each_edited(Visit &&visit)
{
  T::for_each_property([&](const auto &row) {
    const auto access = [row](auto &thing) -> auto &
    {
      return row.access(thing);
    };
    visit(row.name, access, edit_limits(row));
  });
}

template <std::same_as<scene::Texture> T, typename Visit>
void for_each_edited(Visit &&visit)
{
  const auto add = [&](std::string_view name, auto member, int last) {
    visit(
        name, [member](auto &texture) -> auto & { return texture.*member; }, EditLimits{0.0, double(last)});
  };
  add("wrap_u", &T::wrap_u, 2);
  add("wrap_v", &T::wrap_v, 2);
  add("magnified", &T::magnified, 1);
  add("minified", &T::minified, 1);
  add("mip", &T::mip, 2);
}

/** Some values beside \a value within the limits; at least one. */
template <typename Value>
std::vector<Value> other_values(const Value &value, double min, double max)
{
  std::vector<Value> others;
  const auto add = [&](const Value &other) {
    if (other != value && std::ranges::find(others, other) == others.end()) {
      others.push_back(other);
    }
  };
  if constexpr (requires { value.has_value(); }) {
    add(std::nullopt);
    using Content = typename Value::value_type;
    for (const Content &content : other_values<Content>(value.value_or(Content{}), min, max)) {
      add(content);
    }
  }
  else if constexpr (std::is_same_v<Value, bool>) {
    add(!value);
  }
  else if constexpr (std::is_enum_v<Value>) {
    constexpr auto word_count = int(scene::words<Value>.size());
    for (int i = 0; i < (word_count > 0 ? word_count : int(max) + 1); i++) {
      add(Value(i));
    }
  }
  else if constexpr (std::is_same_v<Value, std::string>) {
    add(value + " again");
  }
  else if constexpr (std::is_arithmetic_v<Value>) {
    add(Value(min));
    add(std::is_integral_v<Value> ? Value(max) : Value(std::clamp(0.4 * double(value) + 0.3, min, max)));
  }
  else {
    // Vectors: all components 0, and one component.
    add(Value(float(min)));
    Value moved = value;
    moved.x = float(std::clamp(0.4 * double(value.x) + 0.3, min, max));
    add(moved);
  }
  return others;
}

/** Adds edits of all properties of \a part of the thing \a handle. \a part returns the part of a thing. */
template <typename Thing, typename Part>
void add_property_edits(EditedScene &edited, scene::Handle<Thing> handle, const std::string &name, Part &&part)
{
  const auto original = std::make_shared<const Thing>(edited.scene.pool<Thing>()[handle]);
  Thing changed = *original;
  using Edited = std::remove_cvref_t<decltype(part(changed))>;
  for_each_edited<Edited>([&](std::string_view property, auto access, EditLimits limits) {
    auto &value = access(part(changed));
    const auto before = value;
    auto others = other_values(before, limits.min, limits.max);
    if constexpr (std::is_same_v<Edited, scene::TextureSlot>) {
      // There are fifteen slots.
      others.erase(others.begin(), others.end() - 1);
    }
    for (const auto &other : others) {
      value = other;
      const auto after = std::make_shared<const Thing>(changed);
      try {
        scene::Scene(edited.scene).replace(handle, changed);
        edited.edits.push_back({name + ": " + std::string(property),
                                [handle, after](scene::Scene &scene) { scene.replace(handle, *after); },
                                [handle, original](scene::Scene &scene) { scene.replace(handle, *original); }});
      }
      catch (const scene::InvalidEdit &) {
        edited.refused_count++;
      }
    }
    value = before;
  });
}

template <typename Thing>
void add_property_edits(EditedScene &edited, scene::Handle<Thing> handle, const std::string &name)
{
  add_property_edits(edited, handle, name, [](Thing &thing) -> Thing & { return thing; });
}

/** Adds edits that replace \a handle by \a change of it. */
template <typename Thing, std::invocable<Thing &> Change>
void add_edit(EditedScene &edited, scene::Handle<Thing> handle, const std::string &name, Change &&change)
{
  const auto original = std::make_shared<const Thing>(edited.scene.pool<Thing>()[handle]);
  Thing changed = *original;
  change(changed);
  edited.edits.push_back({name,
                          [handle, after = std::make_shared<const Thing>(std::move(changed))](scene::Scene &scene) {
                            scene.replace(handle, *after);
                          },
                          [handle, original](scene::Scene &scene) { scene.replace(handle, *original); }});
}

/** Ground, and boxes that cast shadows on it. */
struct Ground {
  explicit Ground(scene::Scene &scene)
      : material(add_material(scene, glm::vec3(0.5F))),
        mesh(add_square_mesh(scene, material)),
        box_mesh(add_box_mesh(scene, material)),
        ground(add_object(scene, mesh, glm::scale(glm::dmat4(1.0), glm::dvec3(4.0)))),
        box(add_object(scene, box_mesh, glm::scale(glm::translate(glm::dmat4(1.0), {0.3, 0, 0.7}), glm::dvec3(0.4))))
  {
  }
  scene::Handle<scene::Material> material;
  scene::Handle<scene::Mesh> mesh;
  scene::Handle<scene::Mesh> box_mesh;
  scene::Handle<scene::Node> ground;
  scene::Handle<scene::Node> box;
};

inline scene::Handle<scene::Lamp> add_lamp_of(scene::Scene &scene, scene::LampKind kind, const glm::vec3 &from)
{
  const bool is_far = kind == scene::LampKind::Sun || kind == scene::LampKind::Hemi;
  const auto lamp = add_lamp(scene, kind, from, -from, is_far ? 1.0F : 20.0F);
  scene.edit(lamp, [](scene::Lamp &one) {
    one.radius = 0.2F;
    one.angle = 0.1F;
    one.spot_outer_angle = 0.6F;
    one.spot_blend = 0.1F;
    one.range = 20.0F;
  });
  return lamp;
}

/** Gives the shadow of \a lamp a near plane that does not follow casters: it may keep one that was made before. */
inline void keep_near_plane(scene::Scene &scene, scene::Handle<scene::Lamp> lamp)
{
  scene.edit(lamp, [](scene::Lamp &one) { one.shadow.clip_start = 0.1F; });
}

/** A scene with one lamp of \a kind, all properties of which are edited, as are those of its shadow. */
inline EditedScene lamp_scene(scene::LampKind kind, const std::string &name)
{
  EditedScene edited{name, {}, {}};
  const Ground ground(edited.scene);
  const auto lamp = add_lamp_of(edited.scene, kind, {-1.5F, -1, 3});
  add_property_edits(edited, lamp, name);
  add_property_edits(edited, lamp, name, [](scene::Lamp &one) -> scene::LampShadow & { return one.shadow; });
  const auto node = edited.scene.placed_lamps().front().node;
  add_property_edits(edited, node, name + "'s node");
  add_edit(edited, node, name + " moves", [](scene::Node &one) { one.parent_from_node[3].x += 0.5; });
  add_edit(edited, node, name + " turns", [](scene::Node &one) {
    one.parent_from_node = glm::rotate(one.parent_from_node, 0.3, glm::dvec3(0.6, 0.8, 0));
  });
  add_edit(edited, node, name + " is stretched",
           [](scene::Node &one) { one.parent_from_node = glm::scale(one.parent_from_node, glm::dvec3(2, 0.5, 1)); });
  add_edit(edited, node, name + " leaves its node", [](scene::Node &one) { one.lamp = {}; });
  return edited;
}

inline std::vector<std::uint8_t> some_texels(std::uint32_t size, std::uint32_t seed)
{
  std::vector<std::uint8_t> texels(std::size_t(4) * size * size);
  for (std::size_t i = 0; i < texels.size(); i++) {
    texels[i] = std::uint8_t((i * 37 + seed * 101 + i * i * 7) % 256);
  }
  return texels;
}

/** \a mesh with all streams. */
inline void fill_streams(scene::Mesh &mesh)
{
  if (mesh.uvs.empty()) {
    mesh.uvs.assign(mesh.positions.size(), glm::vec2(0.3F));
  }
  mesh.second_uvs = mesh.uvs;
  for (glm::vec2 &uv : mesh.second_uvs) {
    uv = glm::vec2(uv.y, 1.0F - uv.x);
  }
  mesh.tangents.clear();
  mesh.colors.clear();
  for (const glm::vec3 &normal : mesh.normals) {
    const glm::vec3 across = std::abs(normal.x) < 0.9F ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    mesh.tangents.emplace_back(glm::normalize(glm::cross(normal, across)), 1.0F);
    mesh.colors.emplace_back(0.9F, 0.8F, 1.0F, 0.7F);
  }
}

/** Textures in the slots of a material before edits. */
enum class SlotTextures { None, Texel, Image };

/** Adds a spot whose shadow keeps nothing of pictures before: neither a near plane that follows casters nor an extent.
 */
inline void add_spot(scene::Scene &scene)
{
  keep_near_plane(scene, add_lamp(scene, scene::LampKind::Spot, {-1.5F, -1, 3}, {1.5F, 1, -3}, 20.0F));
}

/** A scene with a square that shows a texture several times, all properties of which are edited, and its image. */
inline EditedScene texture_scene(const std::string &name)
{
  EditedScene edited{name, {}, {}};
  scene::Scene &scene = edited.scene;
  const Ground ground(scene);
  add_spot(scene);
  const auto texture = add_texture(scene, 4, some_texels(4, 1));
  const auto other = add_texture(scene, 2, some_texels(2, 2));
  const auto material = add_material(scene, glm::vec3(1.0F));
  scene.edit(material, [&](scene::Material &one) { one.base_color_texture = texture; });
  const auto mesh = add_square_mesh(scene, material);
  scene.edit(mesh, [](scene::Mesh &one) { one.uvs = {{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}; });
  add_object(scene, mesh, glm::scale(glm::translate(glm::dmat4(1.0), {0.2, -1.1, 0.02}), glm::dvec3(0.7)));
  add_property_edits(edited, texture, "texture");
  add_edit(edited, texture, "texture: image", [&](scene::Texture &one) { one.image = scene.textures()[other].image; });
  const auto image = scene.textures()[texture].image;
  add_edit(edited, image, "image: a texel", [](scene::Image &one) { one.texels[5] ^= 0x80; });
  add_edit(edited, image, "image: size", [](scene::Image &one) {
    one.width = one.height = 3;
    one.texels = some_texels(3, 7);
  });
  add_edit(edited, image, "image: name", [](scene::Image &one) { one.name = "other"; });
  return edited;
}

/**
 * A scene of an object with one material, all properties of which are edited; with \a before it also has a coat and
 * emission. Mesa compiles a program again for each sampler, and where a texture has one level and no longer several.
 * Slots are therefore switched on and off with textures of one texel, as that of an empty slot is, and samplers are
 * edited in texture_scene().
 */
inline EditedScene material_scene(SlotTextures before, const std::string &name)
{
  EditedScene edited{name, {}, {}};
  scene::Scene &scene = edited.scene;
  const Ground ground(scene);
  add_spot(scene);
  const auto texture = add_texture(scene, 4, some_texels(4, 1));
  const auto other = add_texture(scene, 2, some_texels(2, 2));
  const auto texel = add_texture(scene, 1, {150, 170, 200, 220});
  const auto material = add_material(scene, {0.7F, 0.5F, 0.3F});
  const auto function = scene.add(scene::SurfaceFunction{
      "dim", "void surface(SurfaceInputs inputs, inout StandardSurface result)\n{\n  result.base_color *= 0.5;\n}\n"});
  scene.edit(material, [&](scene::Material &one) {
    one.specular_color = glm::vec3(1.0F);
    one.roughness = 0.4F;
    if (before != SlotTextures::None) {
      for (const scene::TextureInput &input : scene::texture_inputs) {
        one.*input.slot = before == SlotTextures::Image ? texture : texel;
      }
      one.coat = 0.5F;
      one.emissive = glm::vec3(0.1F);
      one.alpha_mode = scene::AlphaMode::Mask;
    }
  });
  const auto mesh = add_box_mesh(scene, material);
  scene.edit(mesh, [](scene::Mesh &one) { fill_streams(one); });
  const auto node =
      add_object(scene, mesh, glm::scale(glm::translate(glm::dmat4(1.0), {-1.2, 0.3, 1.0}), glm::dvec3(0.6, 0.5, 0.4)));
  for (const scene::TextureInput &input : scene::texture_inputs) {
    const std::string slot = name + ": " + std::string(input.name);
    if (before == SlotTextures::Image) {
      add_edit(edited, material, slot + ".texture", [&](scene::Material &one) { (one.*input.slot).texture = other; });
      add_property_edits(edited, material, slot,
                         [&](scene::Material &one) -> scene::TextureSlot & { return one.*input.slot; });
    }
    else {
      add_edit(edited, material, slot + " on or off", [&](scene::Material &one) {
        one.*input.slot = before == SlotTextures::Texel ? scene::TextureSlot() : scene::TextureSlot(texel);
      });
    }
  }
  if (before == SlotTextures::Texel) {
    return edited;
  }
  add_property_edits(edited, material, name);
  add_edit(edited, material, name + ": surface_function",
           [&](scene::Material &one) { one.surface_function = function; });
  add_edit(edited, mesh, "mesh: material", [&](scene::Mesh &one) { one.material = ground.material; });
  add_edit(edited, mesh, "mesh: no material", [](scene::Mesh &one) { one.material = {}; });
  add_edit(edited, mesh, "mesh: a position", [](scene::Mesh &one) { one.positions[3].z += 0.5F; });
  add_edit(edited, mesh, "mesh: normals",
           [](scene::Mesh &one) { std::rotate(one.normals.begin(), one.normals.begin() + 4, one.normals.end()); });
  edited.edits.push_back(
      {"mesh: positions and colours of two vertices",
       [mesh](scene::Scene &to) {
         to.set_vertices(mesh, {.vertices = std::array{9U, 3U},
                                .positions = std::array{glm::vec3(-1.4F, 0.9F, 1.2F), glm::vec3(0.8F)},
                                .colors = std::array{glm::vec4(0.3F), glm::vec4(1.0F)}});
       },
       [mesh, original = scene.meshes()[mesh]](scene::Scene &to) {
         to.set_vertices(mesh, {.vertices = std::array{9U, 3U},
                                .positions = std::array{original.positions[9], original.positions[3]},
                                .colors = std::array{original.colors[9], original.colors[3]}});
       }});
  add_edit(edited, mesh, "mesh: fewer triangles", [](scene::Mesh &one) { one.indices.resize(18); });
  add_edit(edited, mesh, "mesh: more vertices", [](scene::Mesh &one) {
    scene::for_each_stream(one, [](auto &stream) { stream.push_back(stream.back()); });
    one.positions.back().z += 1.0F;
    one.indices.insert(one.indices.end(), {0, 1, std::uint32_t(one.positions.size()) - 1});
  });
  add_edit(edited, mesh, "mesh: lines", [](scene::Mesh &one) { one.topology = scene::Topology::Lines; });
  add_edit(edited, mesh, "mesh: points", [](scene::Mesh &one) { one.topology = scene::Topology::Points; });
  add_edit(edited, mesh, "mesh: empty", [](scene::Mesh &one) {
    scene::for_each_stream(one, [](auto &stream) { stream.clear(); });
    one.indices.clear();
  });
  for (const auto &[stream, clear] :
       {std::pair<const char *, void (*)(scene::Mesh &)>("uvs", [](scene::Mesh &one) { one.uvs.clear(); }),
        {"second_uvs", [](scene::Mesh &one) { one.second_uvs.clear(); }},
        {"tangents", [](scene::Mesh &one) { one.tangents.clear(); }},
        {"colors", [](scene::Mesh &one) { one.colors.clear(); }}}) {
    add_edit(edited, mesh, std::string("mesh: no ") + stream, clear);
  }
  add_edit(edited, mesh, "mesh: name", [](scene::Mesh &one) { one.name = "other"; });
  add_property_edits(edited, node, "object");
  return edited;
}

/** Adds an edit that adds a thing, with the node or handle that it needs, and removes it again. */
template <typename Add>
void add_addition(EditedScene &edited, const std::string &name, Add &&add)
{
  using Added = std::invoke_result_t<Add, scene::Scene &>;
  const auto added = std::make_shared<Added>();
  edited.edits.push_back({"add " + name, [added, add](scene::Scene &scene) { *added = add(scene); },
                          [added](scene::Scene &scene) { scene.remove(*added); }, false});
}

/** Adds an edit that removes the thing \a handle, and adds it again; \a use gives the new handle to its users. */
template <typename Thing, typename Use>
void add_removal(EditedScene &edited, const std::string &name, scene::Handle<Thing> handle, Use &&use)
{
  const auto now = std::make_shared<scene::Handle<Thing>>(handle);
  const auto value = std::make_shared<const Thing>(edited.scene.pool<Thing>()[handle]);
  edited.edits.push_back({"remove " + name, [now](scene::Scene &scene) { scene.remove(*now); },
                          [now, value, use](scene::Scene &scene) {
                            *now = scene.add(*value);
                            use(scene, *now);
                          },
                          false});
}

/** Adds additions of each kind of thing, and of objects of \a mesh. */
inline void add_additions(EditedScene &edited, scene::Handle<scene::Mesh> mesh)
{
  add_addition(edited, "an object", [mesh](scene::Scene &to) {
    return to.add(
        scene::Node{.parent_from_node = glm::scale(glm::translate(glm::dmat4(1.0), {0.4, -1, 0.4}), glm::dvec3(0.2)),
                    .meshes = {mesh}});
  });
  add_addition(edited, "an object that casts no shadow", [mesh](scene::Scene &to) {
    return to.add(
        scene::Node{.parent_from_node = glm::scale(glm::translate(glm::dmat4(1.0), {0.4, -1, 0.4}), glm::dvec3(0.2)),
                    .meshes = {mesh},
                    .casts_shadow = false,
                    .receives_shadow = false});
  });
  add_addition(edited, "an object of a mesh that is removed", [mesh](scene::Scene &to) {
    const auto made = to.add(scene::Mesh(to.meshes()[mesh]));
    const auto at = to.add(scene::Node{.meshes = {made}});
    to.remove(made);
    return at;
  });
  for (const auto &[kind, text] : {std::pair(scene::LampKind::Point, "a point"),
                                   {scene::LampKind::Sun, "a sun"},
                                   {scene::LampKind::Spot, "a spot"},
                                   {scene::LampKind::Hemi, "a hemi lamp"},
                                   {scene::LampKind::Area, "an area lamp"}}) {
    add_addition(edited, text, [kind = kind](scene::Scene &to) {
      keep_near_plane(to, add_lamp_of(to, kind, {1, 1.5F, 2.5F}));
      return to.placed_lamps().back().node;
    });
  }
  add_addition(edited, "a mesh", [mesh](scene::Scene &to) { return to.add(scene::Mesh(to.meshes()[mesh])); });
  add_addition(edited, "a material", [](scene::Scene &to) { return to.add(scene::Material{}); });
  add_addition(edited, "an image", [](scene::Scene &to) {
    return to.add(scene::Image{"more", 2, 2, some_texels(2, 9)});
  });
  add_addition(edited, "a texture", [](scene::Scene &to) { return to.add(scene::Texture{}); });
  add_addition(edited, "a lamp without a node", [](scene::Scene &to) { return to.add(scene::Lamp{}); });
  add_addition(edited, "a camera", [](scene::Scene &to) { return to.add(scene::Camera{}); });
  add_addition(edited, "a function", [](scene::Scene &to) {
    return to.add(
        scene::SurfaceFunction{"more", "void surface(SurfaceInputs inputs, inout StandardSurface result)\n{\n}\n"});
  });
}

/** A scene of each kind of thing, which are added, removed, moved to other nodes and replaced. */
inline EditedScene structure_scene(const std::string &name)
{
  EditedScene edited{name, {}, {}};
  scene::Scene &scene = edited.scene;
  const Ground ground(scene);
  const auto sun = add_lamp_of(scene, scene::LampKind::Sun, {-1.5F, -1, 3});
  const auto sun_node = scene.placed_lamps().back().node;
  const auto area = add_lamp_of(scene, scene::LampKind::Area, {1, -1, 2});
  const auto area_node = scene.placed_lamps().back().node;
  keep_near_plane(scene, area);
  const auto texture = add_texture(scene, 4, some_texels(4, 3));
  const auto material = add_material(scene, glm::vec3(0.8F));
  const auto function = scene.add(scene::SurfaceFunction{
      "dim", "void surface(SurfaceInputs inputs, inout StandardSurface result)\n{\n  result.base_color *= 0.5;\n}\n"});
  scene.edit(material, [&](scene::Material &one) {
    one.base_color_texture = texture;
    one.emissive = glm::vec3(0.5F);
  });
  const auto mesh = add_box_mesh(scene, material);
  const auto node =
      add_object(scene, mesh, glm::scale(glm::translate(glm::dmat4(1.0), {-1.2, 0.3, 1.0}), glm::dvec3(0.3)));
  const auto group = scene.add(scene::Node{.name = "group"});
  const auto child = scene.add(
      scene::Node{.name = "child",
                  .parent_from_node = glm::scale(glm::translate(glm::dmat4(1.0), {1.4, 0.8, 0.5}), glm::dvec3(0.3)),
                  .meshes = {ground.box_mesh}},
      group);
  const auto camera = scene.add(scene::Camera{.name = "camera"});
  const auto camera_node = scene.add(scene::Node{.name = "camera", .camera = camera});

  add_additions(edited, ground.box_mesh);

  edited.edits.push_back({"re-parent the object's group to the ground",
                          [=](scene::Scene &to) { to.set_parent(group, ground.ground); },
                          [=](scene::Scene &to) { to.set_parent(group, {}); }});
  edited.edits.push_back({"re-parent the child to the ground",
                          [=](scene::Scene &to) { to.set_parent(child, ground.ground); },
                          [=](scene::Scene &to) { to.set_parent(child, group); }});
  add_edit(edited, group, "the group moves", [](scene::Node &one) { one.parent_from_node[3].x = -0.5; });
  add_edit(edited, group, "the group is mirrored",
           [](scene::Node &one) { one.parent_from_node = glm::scale(one.parent_from_node, glm::dvec3(-1, 1, 1)); });
  add_edit(edited, group, "the group is flat",
           [](scene::Node &one) { one.parent_from_node = glm::scale(one.parent_from_node, glm::dvec3(1, 1, 0)); });
  add_edit(edited, group, "the group is 10 km away", [](scene::Node &one) { one.parent_from_node[3].x = 1e4; });
  edited.edits.push_back(
      {"the child's transform",
       [=](scene::Scene &to) {
         to.set_transform(child, glm::scale(glm::translate(glm::dmat4(1.0), {1.0, -0.8, 0.6}), glm::dvec3(0.3)));
       },
       [=, value = scene.nodes()[child].parent_from_node](scene::Scene &to) { to.set_transform(child, value); }});
  add_property_edits(edited, group, "group");
  add_property_edits(edited, child, "child");
  add_property_edits(edited, ground.ground, "ground");
  add_edit(edited, child, "the child has two meshes", [=](scene::Node &one) {
    one.meshes = {ground.box_mesh, ground.mesh};
  });
  add_edit(edited, child, "the child has another mesh", [=](scene::Node &one) { one.meshes = {ground.mesh}; });
  add_edit(edited, child, "the child has no mesh", [](scene::Node &one) { one.meshes.clear(); });
  add_edit(edited, child, "the child has a lamp", [=](scene::Node &one) { one.lamp = area; });
  add_edit(edited, ground.box, "the box has a camera", [=](scene::Node &one) { one.camera = camera; });
  add_property_edits(edited, camera, "camera");
  edited.edits.push_back(
      {"a world", [](scene::Scene &to) { to.set_world(scene::World{}); }, [](scene::Scene &to) { to.set_world({}); }});

  // The last ones: other edits refer to these things.
  const auto no_use = [](scene::Scene &, auto) {};
  add_removal(edited, "the object", node, no_use);
  add_removal(edited, "the sun's node", sun_node, no_use);
  add_removal(edited, "the area lamp's node", area_node, no_use);
  add_removal(edited, "the camera's node", camera_node, no_use);
  add_removal(edited, "the camera", camera, [camera_node](scene::Scene &to, auto handle) {
    if (to.nodes().is_live(camera_node)) {
      to.edit(camera_node, [&](scene::Node &one) { one.camera = handle; });
    }
  });
  // Nodes of things that other edits removed and added again have other handles.
  const auto use_lamp = [](scene::Scene &to, scene::Handle<scene::Lamp> handle) {
    for (const auto &[at, one] : to.nodes()) {
      if (one.lamp && !to.lamps().is_live(one.lamp)) {
        to.edit(at, [&](scene::Node &user) { user.lamp = handle; });
        return;
      }
    }
  };
  add_removal(edited, "the sun", sun, use_lamp);
  add_removal(edited, "the area lamp", area, use_lamp);
  add_removal(edited, "the mesh", mesh, [](scene::Scene &to, scene::Handle<scene::Mesh> handle) {
    for (const auto &[at, one] : to.nodes()) {
      if (!one.meshes.empty() && !to.meshes().is_live(one.meshes.front())) {
        to.edit(at, [&](scene::Node &user) { user.meshes = {handle}; });
        return;
      }
    }
  });
  add_removal(edited, "the material", material, [](scene::Scene &to, scene::Handle<scene::Material> handle) {
    for (const auto &[at, one] : to.meshes()) {
      if (one.material && !to.materials().is_live(one.material)) {
        to.edit(at, [&](scene::Mesh &user) { user.material = handle; });
        return;
      }
    }
  });
  add_removal(edited, "the texture", texture, [](scene::Scene &to, scene::Handle<scene::Texture> handle) {
    for (const auto &[at, one] : to.materials()) {
      if (one.base_color_texture && !to.textures().is_live(one.base_color_texture.texture)) {
        to.edit(at, [&](scene::Material &user) { user.base_color_texture.texture = handle; });
        return;
      }
    }
  });
  add_removal(edited, "the image", scene.textures()[texture].image,
              [](scene::Scene &to, scene::Handle<scene::Image> handle) {
                for (const auto &[at, one] : to.textures()) {
                  if (!to.images().is_live(one.image)) {
                    to.edit(at, [&](scene::Texture &user) { user.image = handle; });
                    return;
                  }
                }
              });
  add_removal(edited, "the unused function", function, no_use);
  return edited;
}

/** A scene that a world alone lights, all properties of which are edited. \a has_picture: it has a picture with a sun.
 */
inline EditedScene world_scene(bool has_picture, const std::string &name)
{
  EditedScene edited{name, {}, {}};
  const Ground ground(edited.scene);
  const auto picture_of = [](float sun) {
    scene::WorldPicture picture{16, 8, std::vector<glm::vec3>(128, glm::vec3(0.2F, 0.3F, 0.4F))};
    picture.texels[35] = glm::vec3(sun);
    return std::make_shared<const scene::WorldPicture>(std::move(picture));
  };
  scene::World world{.picture = has_picture ? picture_of(200.0F) : nullptr};
  edited.scene.set_world(world);
  const auto add = [&](const std::string &what, const std::optional<scene::World> &other) {
    edited.edits.push_back({name + ": " + what, [other](scene::Scene &to) { to.set_world(other); },
                            [world](scene::Scene &to) { to.set_world(world); }});
  };
  for_each_edited<scene::World>([&](std::string_view property, auto access, EditLimits limits) {
    for (const auto &value : other_values(access(world), limits.min, limits.max)) {
      scene::World other = world;
      access(other) = value;
      add(std::string(property), other);
    }
  });
  scene::World other = world;
  other.picture = has_picture ? nullptr : picture_of(100.0F);
  add("a picture or none", other);
  other.picture = picture_of(0.1F);
  add("another picture", other);
  add("no world", std::nullopt);
  return edited;
}

/**
 * \a scene with additions, and edits of all properties of its lamps, cameras, textures and nodes, of one material, and
 * of the nodes' places.
 */
inline EditedScene edited_scene_of(const scene::Scene &scene)
{
  EditedScene edited{"scene", scene, {}};
  add_additions(edited, scene.objects().front().mesh);
  for (const auto &[lamp, one] : scene.lamps()) {
    add_property_edits(edited, lamp, one.name);
    add_property_edits(edited, lamp, one.name,
                       [](scene::Lamp &lamp_of) -> scene::LampShadow & { return lamp_of.shadow; });
  }
  for (const auto &[camera, one] : scene.cameras()) {
    add_property_edits(edited, camera, one.name);
  }
  for (const auto &[texture, one] : scene.textures()) {
    add_property_edits(edited, texture, "texture");
  }
  for (const auto &[node, one] : scene.nodes()) {
    add_property_edits(edited, node, one.name);
    add_edit(edited, node, one.name + " moves", [](scene::Node &moved) { moved.parent_from_node[3].x += 0.5; });
  }
  const scene::Handle<scene::Material> material = scene.meshes()[scene.objects().front().mesh].material;
  add_property_edits(edited, material, "material");
  return edited;
}

/** All scenes with all edits. */
inline std::vector<EditedScene> edited_scenes()
{
  std::vector<EditedScene> scenes;
  scenes.push_back(lamp_scene(scene::LampKind::Point, "point"));
  scenes.push_back(lamp_scene(scene::LampKind::Sun, "sun"));
  scenes.push_back(lamp_scene(scene::LampKind::Spot, "spot"));
  scenes.push_back(lamp_scene(scene::LampKind::Hemi, "hemi"));
  scenes.push_back(lamp_scene(scene::LampKind::Area, "area"));
  scenes.push_back(material_scene(SlotTextures::None, "plain material"));
  scenes.push_back(material_scene(SlotTextures::Texel, "material of texels"));
  scenes.push_back(material_scene(SlotTextures::Image, "rich material"));
  scenes.push_back(texture_scene("texture"));
  scenes.push_back(structure_scene("structure"));
  scenes.push_back(world_scene(false, "even world"));
  scenes.push_back(world_scene(true, "world with a picture"));
  return scenes;
}

/** Pixels that differ in at least one bit, and the root of the mean square of the differences. */
struct PictureDifference {
  std::size_t pixel_count = 0;
  double rms = 0.0;
};

inline PictureDifference difference_of(const std::vector<glm::vec4> &a, const std::vector<glm::vec4> &b)
{
  PictureDifference difference;
  for (std::size_t i = 0; i < a.size(); i++) {
    difference.pixel_count += a[i] == b[i] ? 0 : 1;
    const glm::dvec4 delta = glm::dvec4(a[i]) - glm::dvec4(b[i]);
    difference.rms += glm::dot(delta, delta);
  }
  difference.rms = std::sqrt(difference.rms / (4.0 * double(a.size())));
  return difference;
}

}  // namespace gnomon::test
