// SPDX-License-Identifier: MIT
#include "gltf_export.hh"
#include "gltf/gltf_check.hh"
#include "scene_studio.hh"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include <unistd.h>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <random>

namespace gnomon::test {
namespace {

using scene::Handle;
using scene::Scene;

/** A scene as text, exact to the bit: equal texts mean equal scenes, apart from the indices in the pools. */
class Description {
 public:
  static std::string of(const Scene &scene)
  {
    Description description(scene);
    for (const auto &[handle, node] : scene.nodes()) {
      if (!scene.parent(handle)) {
        description.add_node(handle, 0);
      }
    }
    if (const std::optional<scene::World> &world = scene.world()) {
      description.line("world{}", properties(*world));
      if (const scene::WorldPicture *picture = world->picture.get()) {
        description.line("  picture {}x{} {}", picture->width, picture->height, values(picture->texels));
      }
    }
    return fmt::format("default camera {} lamp {}\n{}", scene.is_camera_default, scene.is_lamp_default,
                       description.text_);
  }

 private:
  explicit Description(const Scene &scene) : scene_(scene) {}

  const Scene &scene_;
  std::string text_;
  std::map<Handle<scene::Mesh>, std::size_t> meshes_;
  std::map<Handle<scene::Material>, std::size_t> materials_;
  std::map<Handle<scene::Texture>, std::size_t> textures_;
  std::map<Handle<scene::Image>, std::size_t> images_;

  template <typename... Args>
  void line(fmt::format_string<Args...> format, Args &&...args)
  {
    text_ += fmt::format(format, std::forward<Args>(args)...) + '\n';
  }
  template <typename T>
  static std::string numbers(const T &value, int count)
  {
    std::string text;
    for (int i = 0; i < count; i++) {
      text += fmt::format(" {:a}", value[i]);
    }
    return text;
  }
  template <typename Value>
  static std::string text_of(const Value &value)
  {
    if constexpr (requires { value.has_value(); }) {
      return value ? text_of(*value) : " none";
    }
    else if constexpr (std::is_same_v<Value, std::string>) {
      return " '" + value + '\'';
    }
    else if constexpr (std::is_enum_v<Value> || std::is_integral_v<Value>) {
      return fmt::format(" {}", int(value));
    }
    else {
      std::string text;
      scene::for_each_number(value, [&](double number) { text += fmt::format(" {:a}", number); });
      return text;
    }
  }
  /** All properties, with their names. */
  template <typename Part>
  static std::string properties(const Part &part)
  {
    std::string text;
    Part::for_each_property(
        [&](const auto &row) { text += fmt::format(" {}{}", row.name, text_of(part.*row.member)); });
    return text;
  }
  template <typename T>
  static std::string values(const std::vector<T> &values)
  {
    const auto *bytes = reinterpret_cast<const unsigned char *>(values.data());
    std::uint64_t hash = 14695981039346656037ULL;
    for (std::size_t i = 0; i < values.size() * sizeof(T); i++) {
      hash = (hash ^ bytes[i]) * 1099511628211ULL;
    }
    return fmt::format("{}:{:x}", values.size(), hash);
  }
  /** Number of a thing in the order of first use, so that sharing is visible. */
  template <typename T, typename Add>
  std::string number(std::map<Handle<T>, std::size_t> &seen, Handle<T> handle, const Add &add)
  {
    if (!scene_.pool<T>().is_live(handle)) {
      return "none";
    }
    const auto [place, is_new] = seen.try_emplace(handle, seen.size());
    const std::string result = std::to_string(place->second);
    if (is_new) {
      add(scene_.pool<T>()[handle], result);
    }
    return result;
  }

  void add_node(Handle<scene::Node> handle, int depth)
  {
    const scene::Node &node = scene_.nodes()[handle];
    std::string matrix;
    for (int column = 0; column < 4; column++) {
      matrix += numbers(node.parent_from_node[column], 4);
    }
    std::string meshes;
    for (const Handle<scene::Mesh> mesh : node.meshes) {
      meshes += ' ' + number(meshes_, mesh,
                             [this](const scene::Mesh &value, const std::string &name) { add_mesh(value, name); });
    }
    line("{} node{} meshes{} matrix{}", depth, properties(node), meshes, matrix);
    if (const scene::Lamp *lamp = scene_.lamps().find(node.lamp)) {
      line("  lamp{} shadow{}", properties(*lamp), properties(lamp->shadow));
    }
    if (const scene::Camera *camera = scene_.cameras().find(node.camera)) {
      line("  camera{}", properties(*camera));
    }
    for (Handle<scene::Node> child = scene_.first_child(handle); child; child = scene_.next_sibling(child)) {
      add_node(child, depth + 1);
    }
  }

  void add_mesh(const scene::Mesh &mesh, const std::string &number_of)
  {
    const std::string material =
        number(materials_, mesh.material,
               [this](const scene::Material &value, const std::string &name) { add_material(value, name); });
    line("mesh {} '{}' {} material {} {} {} {} {} {} {} {}", number_of, mesh.name, int(mesh.topology), material,
         values(mesh.positions), values(mesh.normals), values(mesh.uvs), values(mesh.second_uvs), values(mesh.tangents),
         values(mesh.colors), values(mesh.indices));
  }

  void add_material(const scene::Material &m, const std::string &number_of)
  {
    std::string textures;
    for (const scene::TextureInput &input : scene::texture_inputs) {
      const scene::TextureSlot &slot = m.*input.slot;
      textures += fmt::format(" {}{}", texture_number(slot), properties(slot));
    }
    line("material {}{} textures{}", number_of, properties(m), textures);
  }

  std::string texture_number(const scene::TextureSlot &slot)
  {
    return number(textures_, slot.texture, [this](const scene::Texture &t, const std::string &name) {
      const std::string image = number(images_, t.image, [this](const scene::Image &i, const std::string &at) {
        line("image {} '{}' {}x{} {}", at, i.name, i.width, i.height, values(i.texels));
      });
      line("texture {} image {} {} {} {} {} {}", name, image, int(t.wrap_u), int(t.wrap_v), int(t.magnified),
           int(t.minified), int(t.mip));
    });
  }
};

std::string content_of(const std::filesystem::path &path)
{
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/** Both file formats read back as \a scene, and the same scene gives the same bytes. */
void expect_round_trip(const Scene &scene)
{
  const TemporaryFolder folder;
  const std::string expected = Description::of(scene);
  for (const char *name : {"copy.gltf", "copy.glb"}) {
    SCOPED_TRACE(name);
    const std::filesystem::path path = folder.path() / name;
    gltf::export_gltf(scene, path);
    const Scene copy = gltf::import_gltf(path);
    expect_valid(copy);
    EXPECT_EQ(Description::of(copy), expected);
    const std::filesystem::path again = folder.path() / (std::string("again_") + name);
    gltf::export_gltf(copy, again);
    EXPECT_EQ(content_of(again), content_of(path));
  }
}

TEST(GltfExport, PublicScenesReadBackAsTheyAre)
{
  std::size_t count = 0;
  for (const auto &entry : std::filesystem::directory_iterator(GNOMON_SOURCE "/examples/scenes")) {
    if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") {
      SCOPED_TRACE(entry.path());
      expect_round_trip(gltf::import_gltf(entry.path()));
      count++;
    }
  }
  EXPECT_GE(count, 5U);
}

/** Seeded values that are not round in any unit. */
class Values {
 public:
  float operator()(float low, float high)
  {
    return std::uniform_real_distribution<float>(low, high)(random_);
  }
  glm::vec3 color(float high = 1.0F)
  {
    return {(*this)(0, high), (*this)(0, high), (*this)(0, high)};
  }
  /** Sets all properties that things of \a kind have in files. */
  template <typename Part>
  void set_all(Part &part, unsigned kind)
  {
    Part::for_each_property([&](const auto &row) {
      if (row.has_kind(kind) && (!row.path.empty() || row.has_extra(kind))) {
        set(part.*row.member, row);
      }
    });
  }

 private:
  std::mt19937 random_{9};

  template <typename Value>
  void set(Value &value, const scene::Description &row)
  {
    const auto low = float(row.min > 0.0 ? std::max(row.min, 0.01) : std::max(row.min, -3.0));
    const auto high = float(std::min(row.max, 100.0));
    if constexpr (requires { value.has_value(); }) {
      set(value.emplace(), row);
    }
    else if constexpr (std::is_same_v<Value, bool>) {
      value = !value;
    }
    else if constexpr (std::is_enum_v<Value>) {
      value = Value(scene::words<Value>.size() - 1);
    }
    else if constexpr (std::is_arithmetic_v<Value>) {
      value = Value((*this)(low, high));
    }
    else if constexpr (!std::is_same_v<Value, std::string>) {
      for (int i = 0; i < value.length(); i++) {
        value[i] = (*this)(low, high);
      }
    }
  }
};

scene::Mesh triangle(const std::string &name, Values &value)
{
  scene::Mesh mesh;
  mesh.name = name;
  mesh.positions = {{0, 0, 0}, {1.1F, 0, value(0, 0.1F)}, {0, 1.3F, 0.7F}};
  for (int i = 0; i < 3; i++) {
    mesh.normals.push_back(glm::normalize(glm::vec3(value(-1, 1), value(-1, 1), 1)));
    mesh.colors.emplace_back(value.color(), value(0, 1));
  }
  mesh.indices = {0, 1, 2};
  return mesh;
}

/** A lamp with a value for each property of its kind. */
scene::Lamp lamp_of(scene::LampKind kind, Values &value)
{
  using scene::LampKind;
  scene::Lamp lamp;
  lamp.name = fmt::format("lamp of kind {} \"\\ü", int(kind));
  lamp.kind = kind;
  value.set_all(lamp, unsigned(kind));
  value.set_all(lamp.shadow, unsigned(kind));
  if (lamp.shadow.clip_start) {
    lamp.shadow.clip_end = 2.0F * *lamp.shadow.clip_start;
  }
  // Angles at their limits, which file and scene may round differently.
  if (kind == LampKind::Sun) {
    lamp.angle = float(std::numbers::pi);
    lamp.shadow.filter_angle = float(std::numbers::pi / 4);
  }
  if (kind == LampKind::Spot) {
    lamp.spot_outer_angle = float(std::numbers::pi / 2);
  }
  return lamp;
}

Handle<scene::Material> add_material(Scene &scene, Values &value)
{
  scene::Image image{"leaf", 3, 2, {}};
  for (int i = 0; i < 24; i++) {
    image.texels.push_back(std::uint8_t(value(0, 255)));
  }
  scene::Texture texture;
  texture.image = scene.add(std::move(image));
  texture.wrap_u = scene::TextureWrap::MirroredRepeat;
  texture.wrap_v = scene::TextureWrap::ClampToEdge;
  texture.magnified = scene::TextureFilter::Nearest;
  texture.mip = scene::MipFilter::Nearest;
  scene::Material material;
  material.name = "paint";
  value.set_all(material, 0);
  material.alpha = value(0, 1);
  // A test of its own has the index, by which the specular colour is rounded.
  material.ior = scene::Material().ior;
  material.alpha_mode = scene::AlphaMode::Mask;
  const auto handle = scene.add(texture);
  int set = 0;
  for (const scene::TextureInput &input : scene::texture_inputs) {
    scene::TextureSlot &slot = material.*input.slot;
    slot = handle;
    value.set_all(slot, 0);
    slot.uv_set = set;
    set = 1 - set;
  }
  return scene.add(material);
}

/** A scene with every type of content. */
Scene full_scene()
{
  Values value;
  Scene scene;
  scene::Mesh textured = triangle("pair[0]", value);
  textured.material = add_material(scene, value);
  textured.uvs = {{0.1F, 0.2F}, {3, 0.3F}, {0.5F, -1}};
  textured.second_uvs = {{0.7F, 0.2F}, {0.1F, 0.9F}, {-0.5F, 1}};
  textured.tangents = {{1, 0, 0, 1}, {0, -1, 0, -1}, {0.6F, 0.8F, 0, 1}};
  const Handle<scene::Mesh> first = scene.add(textured);
  scene::Mesh plain = triangle("any \t name", value);
  scene::Material emissive;
  emissive.name = "dim";
  emissive.emissive = value.color();
  emissive.alpha_mode = scene::AlphaMode::Blend;
  plain.material = scene.add(emissive);
  const Handle<scene::Mesh> second = scene.add(plain);

  scene::Node root;
  root.name = "root";
  root.parent_from_node = glm::translate(glm::dmat4(1.0), {1048576.1, 0.3, -524288.7});
  const Handle<scene::Node> parent = scene.add(root);
  scene::Node pair;
  pair.name = "both";
  pair.meshes = {first, second};
  pair.parent_from_node = glm::rotate(glm::dmat4(1.0), 0.3, {1, 2, 3});
  pair.casts_shadow = false;
  scene.add(pair, parent);
  scene::Node alone;
  alone.name = "alone";
  alone.meshes = {second};
  alone.receives_shadow = false;
  alone.parent_from_node[1][0] = 0.5;
  const Handle<scene::Node> child = scene.add(alone, parent);
  scene::Node hidden;
  hidden.name = "hidden";
  hidden.is_visible = false;
  const Handle<scene::Node> grandchild = scene.add(hidden, child);
  for (int kind = 0; kind <= int(scene::LampKind::Area); kind++) {
    scene::Node node;
    node.name = kind % 2 == 0 ? fmt::format("lamp {}", kind) : lamp_of(scene::LampKind(kind), value).name;
    node.lamp = scene.add(lamp_of(scene::LampKind(kind), value));
    scene.add(node, kind == 0 ? grandchild : Handle<scene::Node>());
  }
  for (const scene::CameraKind kind : {scene::CameraKind::Perspective, scene::CameraKind::Orthographic}) {
    scene::Camera camera;
    camera.name = "eye";
    camera.kind = kind;
    value.set_all(camera, unsigned(kind));
    camera.near = value(0.01F, 0.1F);
    camera.far = kind == scene::CameraKind::Perspective ? 0.0F : value(50, 60);
    scene::Node node;
    node.name = "stand";
    node.camera = scene.add(camera);
    scene.add(node);
  }
  scene::WorldPicture sky{4, 2, {}};
  for (int i = 0; i < 8; i++) {
    sky.texels.push_back(value.color(1e5F));
  }
  scene.set_world(
      scene::World{value.color(), value(0, 3), value(-7, 7), std::make_shared<const scene::WorldPicture>(sky)});
  return scene;
}

TEST(GltfExport, AllContentsOfASceneReadBack)
{
  expect_round_trip(full_scene());
}

TEST(GltfExport, WhatIsNotWrittenIsSaid)
{
  const std::filesystem::path path = std::filesystem::temp_directory_path() / fmt::format("variants{}.gltf", getpid());
  const std::string variants =
      R"("extensions": {"KHR_materials_variants": {"variants": [{"name": "a"}, {"name": "b"}]}})";
  const std::string own = R"(, "nodes": [{"extras": {"gnomon_visible": false}}])";
  const std::string foreign =
      R"(, "nodes": [{"name": "chair", "extras": {"gnomon_visible": false, "price": {"now": 3}}},
    {"extras": [1, 2]}], "meshes": [{"primitives": [{"attributes": {}, "extras": {"price": 1, "maker": "m"}}]}])";
  for (const auto &[members, text] :
       {std::pair(", " + variants, "2 variants of materials"),
        {std::string(), ""},
        {own, ""},
        {foreign, "extra of node 1 and 2 others"},
        {R"(, "extras": "made by hand")", "extra of the document"},
        {", " + variants + foreign, "2 variants of materials and extra of node 1 and 2 others"}}) {
    std::ofstream(path) << R"({"asset": {"version": "2.0"})" << members << "}";
    EXPECT_EQ(gltf::left_out_of_export(path), text);
  }
  std::filesystem::remove(path);
  EXPECT_EQ(gltf::left_out_of_export(path), "");
}

TEST(GltfExport, AUniformWorldReadsBackAndIsTheOnlyLight)
{
  Scene scene;
  scene.set_world(scene::World{.color = {0.1F, 0.2F, 0.3F}, .strength = 1e30F, .rotation = -0.1F});
  scene::Node node;
  node.name = "eye";
  node.camera = scene.add(scene::Camera{.name = "eye"});
  scene.add(node);
  expect_round_trip(scene);
}

TEST(GltfExport, APictureOfAWorldStaysInItsFile)
{
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "all skies");
  std::filesystem::create_directories(folder.path() / "scenes");
  const std::filesystem::path sky = folder.write("all skies/50% \"blue\" ü.hdr", "sky");
  scene::WorldPicture picture{1, 1, {{1, 2, 3}}, sky.string()};
  Scene scene;
  scene.set_world(scene::World{.strength = 2.0F, .picture = std::make_shared<const scene::WorldPicture>(picture)});
  const std::filesystem::path path = folder.path() / "scenes" / "scene.gltf";
  const auto read_again = [&] {
    gltf::export_gltf(scene, path);
    return gltf::import_gltf(path, {.read_picture = [&](const std::filesystem::path &file) {
                               EXPECT_EQ(content_of(file), "sky");
                               return scene::WorldPicture{1, 1, {{4, 5, 6}}};
                             }});
  };
  Scene copy = read_again();
  ASSERT_TRUE(copy.world() && copy.world()->picture) << all_warnings(copy);
  EXPECT_EQ(copy.world()->strength, 2.0F);
  EXPECT_EQ(copy.world()->picture->texels, (std::vector<glm::vec3>{{4, 5, 6}}));
  EXPECT_TRUE(std::filesystem::equivalent(copy.world()->picture->path, sky));
  EXPECT_EQ(json::parse(content_of(path))["scenes"][0]["extras"]["gnomon_world"],
            "../all%20skies/50%25%20%22blue%22%20%C3%BC.hdr");
  // Where the file has gone, the texels are written.
  std::filesystem::remove(sky);
  copy = read_again();
  ASSERT_TRUE(copy.world() && copy.world()->picture) << all_warnings(copy);
  EXPECT_EQ(copy.world()->picture->texels, picture.texels);
}

TEST(GltfExport, AnIndexOfRefractionIsWrittenApartFromTheSpecularColour)
{
  Values value;
  for (const float ior : {1.0F, 1.33F, 2.4F}) {
    Scene scene;
    scene::Material water;
    water.name = "water";
    water.transmission = 1.0F;
    water.ior = ior;
    // The value that the importer computes for a specular colour of (1, 0.5, 0.25).
    const float root = (ior - 1.0F) / (ior + 1.0F);
    water.specular_color = glm::vec3(1.0F, 0.5F, 0.25F) * (root * root / 0.04F);
    scene::Mesh mesh = triangle("drop", value);
    mesh.material = scene.add(water);
    scene::Node node;
    node.meshes = {scene.add(mesh)};
    scene.add(node);
    const TemporaryFolder folder;
    gltf::export_gltf(scene, folder.path() / "copy.glb");
    const Scene copy = gltf::import_gltf(folder.path() / "copy.glb");
    const scene::Material &read = (*copy.materials().begin()).value;
    EXPECT_EQ(read.ior, ior);
    EXPECT_LE(glm::distance(read.specular_color, water.specular_color), 1e-6F * glm::length(water.specular_color));
  }
}

TEST(GltfExport, AnEditedSceneReadsBack)
{
  Scene scene = full_scene();
  const Handle<scene::Node> removed = scene.first_child(scene.nodes().first());
  scene.remove(removed);
  scene::Node node;
  node.name = "takes the place of a removed one";
  scene.add(node, scene.first_child(scene.nodes().first()));
  expect_round_trip(scene);
}

TEST(GltfExport, RemovedAndUnusedThingsAreNotWritten)
{
  Values value;
  Scene scene = full_scene();
  const std::string expected = Description::of(scene);
  scene::Mesh unused = triangle("unused", value);
  scene.add(unused);
  scene::Mesh gone = triangle("gone", value);
  const Handle<scene::Mesh> handle = scene.add(gone);
  scene.edit(scene.nodes().first(), [&](scene::Node &node) { node.meshes.push_back(handle); });
  scene.remove(handle);
  const TemporaryFolder folder;
  gltf::export_gltf(scene, folder.path() / "copy.glb");
  EXPECT_EQ(Description::of(gltf::import_gltf(folder.path() / "copy.glb")), expected);
}

TEST(GltfExport, AdditionsOfTheImporterAreNotWritten)
{
  const Scene scene = import(triangle_scene());
  ASSERT_TRUE(scene.is_camera_default && scene.is_lamp_default);
  const TemporaryFolder folder;
  gltf::export_gltf(scene, folder.path() / "copy.gltf");
  const json document = json::parse(content_of(folder.path() / "copy.gltf"));
  EXPECT_EQ(document["nodes"].size(), 1U);
  EXPECT_FALSE(document.contains("cameras"));
  EXPECT_FALSE(document.contains("extensions"));
  expect_round_trip(scene);
}

TEST(GltfExport, TheStudioThatAProgramSetIsNotWrittenUntilTheSceneHasMore)
{
  const TemporaryFolder folder;
  Scene scene = import(triangle_scene());
  scene.remove(scene.placed_lamps().front().node);
  scene.default_world = scene::studio_world(scene.placed_cameras().front().world_from_camera);
  scene.set_world(scene.default_world);
  const auto has_world = [&] {
    gltf::export_gltf(scene, folder.path() / "copy.gltf");
    return gltf::import_gltf(folder.path() / "copy.gltf").world().has_value();
  };
  EXPECT_FALSE(has_world());
  scene::World darker = *scene.default_world;
  darker.strength = 0.5F;
  scene.set_world(darker);
  EXPECT_TRUE(has_world());
  // An undo sets the same world again.
  scene.set_world(scene.default_world);
  EXPECT_FALSE(has_world());
  // A file with a lamp gets no studio.
  scene::Node node;
  node.lamp = scene.add(scene::Lamp());
  scene.add(node);
  EXPECT_TRUE(has_world());
}

TEST(GltfExport, EditedAdditionsOfTheImporterAreWritten)
{
  const TemporaryFolder folder;
  const auto written = [&](const Scene &scene) {
    gltf::export_gltf(scene, folder.path() / "copy.gltf");
    return gltf::import_gltf(folder.path() / "copy.gltf");
  };
  Scene brighter = import(triangle_scene());
  brighter.edit(brighter.lamps().first(), [](scene::Lamp &lamp) { lamp.intensity = 9.0F; });
  const Scene read_brighter = written(brighter);
  EXPECT_TRUE(read_brighter.is_camera_default);
  EXPECT_FALSE(read_brighter.is_lamp_default);
  EXPECT_FLOAT_EQ(read_brighter.placed_lamps().front().intensity, 9.0F);
  // The sun is not above another camera, so that it is written, too.
  Scene nearer = import(triangle_scene());
  const scene::PlacedCamera camera = nearer.placed_cameras().front();
  nearer.edit(nearer.cameras().first(), [](scene::Camera &edited) { edited.vertical_angle = 0.25F; });
  nearer.set_transform(camera.node, glm::translate(camera.world_from_camera, {1, 2, 3}));
  const scene::PlacedCamera read_camera = written(nearer).placed_cameras().front();
  EXPECT_FLOAT_EQ(read_camera.vertical_angle, 0.25F);
  EXPECT_EQ(read_camera.world_from_camera, nearer.placed_cameras().front().world_from_camera);
}

TEST(GltfExport, BentFlatQuadsReadBack)
{
  // The importer gives each triangle its own normal, and therefore its own vertices.
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.3F});
  const glm::vec3 n = glm::normalize(glm::cross(glm::vec3(1, 1, 0), glm::vec3(-1, 1, 0.3F)));
  const int normals = builder.positions({n.x, n.y, n.z, n.x, n.y, n.z, n.x, n.y, n.z, n.x, n.y, n.z});
  const int indices = builder.accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, Uint16, "SCALAR");
  builder.node(
      {{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}})}});
  const Scene scene = import(builder);
  EXPECT_EQ((*scene.meshes().begin()).value.positions.size(), 6U);
  expect_round_trip(scene);
}

TEST(GltfExport, UnitsAreThoseOfGltf)
{
  Scene scene;
  scene::Node node;
  node.name = "sun";
  scene::Lamp lamp{.name = "sun", .kind = scene::LampKind::Sun};
  lamp.intensity = 2.0F;
  node.lamp = scene.add(lamp);
  scene.add(node);
  const TemporaryFolder folder;
  gltf::export_gltf(scene, folder.path() / "sun.gltf");
  const json document = json::parse(content_of(folder.path() / "sun.gltf"));
  EXPECT_EQ(document["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"], 1366.0);
  EXPECT_EQ(document["extensionsUsed"], json({"KHR_lights_punctual"}));
}

/** Sets all numbers of \a value. \return false if it has none. */
template <typename Value>
bool set_numbers(Value &value, double number)
{
  if constexpr (requires { value.has_value(); }) {
    return set_numbers(value.emplace(), number);
  }
  else if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, float>) {
    value = Value(number);
    return true;
  }
  else if constexpr (requires {
                       value.length();
                       value.x;
                     }) {
    value = Value(float(number));
    return true;
  }
  return false;
}

/** The pointer to a property of a thing in the part \a within of a file, or to its first number. Empty: the file does
 * not have it. */
std::string pointer_to(const json &document, const scene::Description &row, const std::string &within)
{
  const std::array places{'/' + std::string(row.path), "/gnomon_" + std::string(row.key_or_name())};
  const json values = document.flatten();
  for (const auto &[pointer, value] : values.items()) {
    for (const std::string &place : places) {
      if (place != "/" && pointer.find(within) != pointer.npos &&
          (pointer.ends_with(place) || pointer.ends_with(place + "/0"))) {
        return pointer;
      }
    }
  }
  return {};
}

/** The warnings, without those about things that the scene lacks, such as a camera. */
std::string warnings_of_things(const Scene &scene)
{
  std::string text;
  for (const std::string &warning : scene.warnings) {
    text += warning.starts_with("scene: has ") ? "" : warning + '\n';
  }
  return text;
}

/**
 * Each number of a \a part of a thing of \a kind is read back at its limits, and reported beyond them. \a scene_of: a
 * scene with the part. \a part_of: the part of such a scene. \a within: a key that holds it in the file.
 */
template <typename Part>
void expect_limits(Part part, unsigned kind, const std::function<Scene(const Part &)> &scene_of,
                   const std::function<Part(const Scene &)> &part_of, const std::string &within)
{
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "limit.gltf";
  Part::for_each_property([&](const auto &row) {
    auto &member = part.*row.member;
    const auto before = member;
    const bool is_in_files = row.has_kind(kind) && (!row.path.empty() || row.has_extra(kind));
    bool is_written = false;
    for (const double limit : {row.least > 0.0 ? row.least : row.min, row.max}) {
      const bool is_max = limit == row.max;
      // The planes of a camera limit each other.
      const bool is_limited = row.name == "near" || (row.name == "far" && !is_max);
      if (!is_in_files || is_limited || !set_numbers(member, limit)) {
        is_written = true;
        continue;
      }
      SCOPED_TRACE(fmt::format("{} {}", row.name, limit));
      gltf::export_gltf(scene_of(part), path);
      const Scene copy = gltf::import_gltf(path);
      EXPECT_EQ(warnings_of_things(copy), "");
      EXPECT_EQ(part_of(copy).*row.member, member);
      json document = json::parse(content_of(path));
      const std::string pointer = pointer_to(document, row, within);
      if (pointer.empty()) {
        // The limit is glTF's default.
        continue;
      }
      is_written = true;
      json &number = document[json::json_pointer(pointer)];
      const double inside = number;
      const double step = std::max(number.is_number_float() ? 0.01 : 1.0, 0.01 * std::abs(inside));
      number = is_max ? inside + step : inside > 0.0 ? 0.5 * inside : inside - step;
      try {
        const Scene changed = gltf::import_gltf(folder.write("beyond.gltf", document.dump()));
        // Any distance beyond the limit stands for no absorption, which needs no warning.
        EXPECT_TRUE(row.name == "attenuation_distance" || !warnings_of_things(changed).empty()) << number;
        scene::for_each_number(part_of(changed).*row.member,
                               [&](double value) { EXPECT_TRUE(row.allows(value)) << value; });
      }
      catch (const gltf::ImportError &error) {
        EXPECT_HAS(std::string(error.what()), " must be ");
      }
    }
    EXPECT_TRUE(is_written) << row.name;
    member = before;
  });
}

TEST(GltfExport, NumbersReadBackAtTheirLimitsAndAreReportedBeyondThem)
{
  const auto on_node = [](Scene &scene, scene::Node node) {
    node.name = "node";
    scene.add(node);
  };
  const auto with_lamp = [&](const scene::Lamp &lamp) {
    Scene scene;
    on_node(scene, {.lamp = scene.add(lamp)});
    return scene;
  };
  const auto lamp_of_scene = [](const Scene &scene) { return scene.lamps()[scene.lamps().first()]; };
  for (std::size_t kind = 0; kind < scene::words<scene::LampKind>.size(); kind++) {
    const scene::Lamp lamp{.name = "lamp", .kind = scene::LampKind(kind)};
    expect_limits<scene::Lamp>(lamp, unsigned(kind), with_lamp, lamp_of_scene, "");
    expect_limits<scene::LampShadow>(
        {}, unsigned(kind),
        [&](const scene::LampShadow &shadow) {
          scene::Lamp shadowed = lamp;
          shadowed.shadow = shadow;
          return with_lamp(shadowed);
        },
        [&](const Scene &scene) { return lamp_of_scene(scene).shadow; }, "nodes");
  }
  for (const scene::CameraKind kind : {scene::CameraKind::Perspective, scene::CameraKind::Orthographic}) {
    scene::Camera camera{.name = "eye", .kind = kind};
    camera.far = kind == scene::CameraKind::Orthographic ? float(scene::number_max) : 0.0F;
    expect_limits<scene::Camera>(
        camera, unsigned(kind),
        [&](const scene::Camera &value) {
          Scene scene;
          on_node(scene, {.camera = scene.add(value)});
          return scene;
        },
        [](const Scene &scene) { return scene.cameras()[scene.cameras().first()]; }, "");
  }
  Values value;
  scene::Mesh mesh = triangle("leaf", value);
  mesh.uvs = mesh.second_uvs = {{0, 0}, {1, 0}, {0, 1}};
  mesh.tangents.assign(3, {1, 0, 0, 1});
  const auto with_material = [&](const scene::Material &material) {
    Scene scene;
    scene::Material textured = material;
    const auto texture = scene.add(scene::Texture{.image = scene.add(scene::Image{"texel", 1, 1, {1, 2, 3, 4}})});
    for (const scene::TextureInput &input : scene::texture_inputs) {
      (textured.*input.slot).texture = texture;
    }
    scene::Mesh drawn = mesh;
    drawn.material = scene.add(textured);
    on_node(scene, {.meshes = {scene.add(drawn)}});
    return scene;
  };
  const auto material_of_scene = [](const Scene &scene) { return scene.materials()[scene.materials().first()]; };
  scene::Material material{.name = "paint"};
  // The exporter divides the tint by the reflectance of the index: a black one has any index.
  material.specular_color = glm::vec3(0.0F);
  expect_limits<scene::Material>(material, 0, with_material, material_of_scene, "materials");
  expect_limits<scene::TextureSlot>(
      {}, 0,
      [&](const scene::TextureSlot &slot) {
        scene::Material turned = material;
        turned.base_color_texture = slot;
        return with_material(turned);
      },
      [&](const Scene &scene) { return material_of_scene(scene).base_color_texture; }, "baseColorTexture");
}

std::string export_error(const Scene &scene, const std::filesystem::path &path)
{
  try {
    gltf::export_gltf(scene, path);
  }
  catch (const gltf::ExportError &error) {
    EXPECT_HAS(std::string(error.what()), path.string() + ": ");
    return error.what();
  }
  return {};
}

TEST(GltfExport, ErrorsNameTheFileAndLeaveTheOldOne)
{
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write("old.gltf", "old");
  Scene scene;
  const Handle<scene::Node> handle = scene.add(scene::Node());
  scene.edit(handle, [](scene::Node &edited) { edited.name = "\xC3\x28"; });
  EXPECT_HAS(export_error(scene, path), "its name is not UTF-8");
  scene.edit(handle, [](scene::Node &edited) { edited.name = std::string(1025, 'x'); });
  EXPECT_HAS(export_error(scene, path), "its name is longer than 1024 bytes");
  scene.edit(handle, [](scene::Node &edited) { edited.name = "node"; });
  EXPECT_HAS(export_error(scene, folder.path() / "scene.obj"), "the name ends neither in .gltf nor in .glb");
  EXPECT_HAS(export_error(scene, folder.path() / "nowhere" / "scene.glb"),
             "scene.glb: cannot be written: No such file");
  std::filesystem::create_directory(folder.path() / "folder.glb");
  EXPECT_HAS(export_error(scene, folder.path() / "folder.glb"), "folder.glb: cannot be written: Is a directory");
  EXPECT_EQ(content_of(path), "old");
  // No temporary file is left.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

}  // namespace
}  // namespace gnomon::test
