// SPDX-License-Identifier: MIT
#include "gltf/gltf_check.hh"
#include "image_file.hh"

#include <glm/gtc/quaternion.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace gnomon::test {
namespace {

using scene::Mesh;
using scene::Scene;

const Mesh &only_mesh(const Scene &scene)
{
  EXPECT_EQ(scene.meshes().size(), 1U);
  return (*scene.meshes().begin()).value;
}

/** A triangle with COLOR_0. */
template <typename T>
GltfBuilder colored_triangle(const std::vector<T> &colors, Component component, const std::string &type,
                             const json &more = json::object())
{
  GltfBuilder builder;
  const int positions = builder.positions(triangle_positions);
  json accessor = {{"bufferView", builder.view(colors)},
                   {"componentType", int(component)},
                   {"count", colors.size() / (type == "VEC4" ? 4 : 3)},
                   {"type", type}};
  accessor.update(more);
  const int color = builder.append("accessors", accessor);
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}, {"COLOR_0", color}}}})}});
  return builder;
}

TEST(GltfColor, FloatsAreLinearAndKept)
{
  const std::vector<float> values{0, 0.25F, 1, 0.5F, 1, 0, 0.125F, 1, 0.1F, 0.2F, 0.3F, 0};
  const Scene scene = import(colored_triangle(values, Float32, "VEC4"));
  EXPECT_EQ(only_mesh(scene).colors,
            (std::vector<glm::vec4>{{0, 0.25F, 1, 0.5F}, {1, 0, 0.125F, 1}, {0.1F, 0.2F, 0.3F, 0}}));
  EXPECT_NO_WARNING(scene, "colour");
}

TEST(GltfColor, Vec3IsOpaque)
{
  const Scene scene = import(colored_triangle(std::vector<float>{0, 0, 1, 0, 1, 0, 1, 0, 0}, Float32, "VEC3"));
  EXPECT_EQ(only_mesh(scene).colors, (std::vector<glm::vec4>{{0, 0, 1, 1}, {0, 1, 0, 1}, {1, 0, 0, 1}}));
}

TEST(GltfColor, BlackAtAllVerticesIsNamed)
{
  const auto blacks_with = [](float last) {
    return import(colored_triangle(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, last, 1}, Float32, "VEC4"));
  };
  EXPECT_WARNING(blacks_with(0.0F), "mesh 'mesh': its vertex colours are all black, which makes its base colour black");
  EXPECT_NO_WARNING(blacks_with(0.25F), "colour");
}

TEST(GltfColor, NormalizedIntegersAreFractions)
{
  const json normalized = {{"normalized", true}};
  const std::vector<std::uint8_t> bytes{255, 51, 0, 255, 0, 0, 0, 102, 0, 0, 0, 0};
  const Scene of_bytes = import(colored_triangle(bytes, Uint8, "VEC4", normalized));
  EXPECT_EQ(only_mesh(of_bytes).colors[0], glm::vec4(1, 0.2F, 0, 1));
  EXPECT_EQ(only_mesh(of_bytes).colors[1], glm::vec4(0, 0, 0, 0.4F));
  const std::vector<std::uint16_t> shorts{65535, 13107, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(only_mesh(import(colored_triangle(shorts, Uint16, "VEC3", normalized))).colors[0],
            glm::vec4(1, 0.2F, 0, 1));
}

TEST(GltfColor, InvalidTypesAreNamed)
{
  const std::vector<std::uint8_t> bytes(12, 255);
  const Scene plain = import(colored_triangle(bytes, Uint8, "VEC4"));
  EXPECT_TRUE(only_mesh(plain).colors.empty());
  EXPECT_WARNING(plain, "mesh 'mesh': its vertex colours are left out: COLOR_0: holds neither floats nor normalized");
  const Scene few = import(colored_triangle(std::vector<float>{1, 1, 1}, Float32, "VEC3"));
  EXPECT_TRUE(only_mesh(few).colors.empty());
  EXPECT_WARNING(few, "its vertex colours are left out: COLOR_0: count differs from that of POSITION");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Scene odd = import(colored_triangle(std::vector<float>{nan, -1, 2, 0, 1, 0.5F, 0, 0, 0}, Float32, "VEC3"));
  EXPECT_EQ(only_mesh(odd).colors[0], glm::vec4(0, 0, 1, 1));
  EXPECT_WARNING(odd, "mesh 'mesh': vertex colour limited to 0 to 1: it was not finite or outside");
}

TEST(GltfColor, StaysWithItsVertex)
{
  // Vertices 1 and 3 have the same position and different colours; vertex 0 is used by no triangle.
  const std::vector<float> positions{9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<float> colors{0.9F, 0, 0, 0.1F, 0, 0, 0.2F, 0, 0, 0.3F, 0, 0, 0.4F, 0, 0, 0.5F, 0, 0};
  const std::array<float, 6> expected{0.1F, 0.2F, 0.4F, 0.3F, 0.4F, 0.5F};
  for (const bool has_normals : {false, true}) {
    GltfBuilder builder;
    json attributes = {{"POSITION", builder.positions(positions)},
                       {"COLOR_0", builder.accessor(colors, Float32, "VEC3")}};
    if (has_normals) {
      attributes["NORMAL"] = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0, 0});
    }
    const int indices = builder.accessor(std::vector<std::uint16_t>{1, 2, 4, 3, 4, 5}, Uint16, "SCALAR");
    builder.node({{"mesh", builder.mesh({{"attributes", attributes}, {"indices", indices}})}});
    const Scene scene = import(builder);
    const Mesh &mesh = only_mesh(scene);
    ASSERT_EQ(mesh.indices.size(), 6U);
    for (std::size_t i = 0; i < 6; i++) {
      EXPECT_EQ(mesh.colors[mesh.indices[i]].x, expected[i]) << i;
    }
  }
}

TEST(GltfColor, FollowsATriangleThatGetsItsOwnNormal)
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.3F});
  const glm::vec3 n = glm::normalize(glm::cross(glm::vec3(1, 1, 0), glm::vec3(-1, 1, 0.3F)));
  const int normals = builder.positions({n.x, n.y, n.z, n.x, n.y, n.z, n.x, n.y, n.z, n.x, n.y, n.z});
  const int colors =
      builder.accessor(std::vector<float>{0.1F, 0, 0, 0.2F, 0, 0, 0.3F, 0, 0, 0.4F, 0, 0}, Float32, "VEC3");
  const int indices = builder.accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, Uint16, "SCALAR");
  builder.node(
      {{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"COLOR_0", colors}}},
                              {"indices", indices}})}});
  const Scene scene = import(builder);
  const Mesh &mesh = only_mesh(scene);
  const std::array<float, 6> expected{0.1F, 0.2F, 0.3F, 0.1F, 0.3F, 0.4F};
  for (std::size_t i = 0; i < 6; i++) {
    EXPECT_EQ(mesh.colors[mesh.indices[i]].x, expected[i]) << i;
  }
}

// ---- Extras ----

TEST(GltfNodes, FlagsAreExtras)
{
  GltfBuilder builder = triangle_scene();
  const Scene plain = import(builder);
  const scene::Node &node = plain.nodes()[plain.nodes().first()];
  EXPECT_TRUE(node.is_visible && node.casts_shadow && node.receives_shadow);
  builder.document["nodes"][0]["extras"] = {
      {"gnomon_visible", false}, {"gnomon_casts_shadow", false}, {"gnomon_receives_shadow", false}};
  const Scene scene = import(builder);
  const scene::Node &flagged = scene.nodes()[scene.nodes().first()];
  EXPECT_FALSE(flagged.is_visible || flagged.casts_shadow || flagged.receives_shadow);
  EXPECT_NO_WARNING(scene, "gnomon_");
  builder.document["nodes"][0]["extras"] = {{"gnomon_visible", 0}};
  EXPECT_HAS(import_error(builder), "node 'thing': gnomon_visible is 0, and must be true or false");
}

TEST(GltfNodes, NamesOfLampsAndCamerasAreExtras)
{
  GltfBuilder builder = triangle_scene();
  builder.light({{"type", "point"}}, {{"gnomon_lamp_name", "bulb"}});
  builder.append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}});
  builder.node({{"name", "stand"}, {"camera", 0}, {"extras", {{"gnomon_camera_name", "eye"}}}});
  const Scene scene = import(builder);
  EXPECT_EQ((*scene.lamps().begin()).value.name, "bulb");
  EXPECT_EQ((*scene.cameras().begin()).value.name, "eye");
  EXPECT_NO_WARNING(scene, "gnomon_");
}

TEST(GltfCamera, ShiftAndApertureAreExtras)
{
  GltfBuilder builder = triangle_scene();
  builder.append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}});
  builder.append("cameras",
                 {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 1}, {"znear", 0}, {"zfar", 10}}}});
  const json extras = {{"gnomon_shift_x", 0.25},     {"gnomon_shift_y", -0.5},        {"gnomon_aperture_radius", 0.02},
                       {"gnomon_focus_distance", 3}, {"gnomon_aperture_blades", 6.0}, {"gnomon_aperture_rotation", 0.1},
                       {"gnomon_aperture_ratio", 2}};
  builder.node({{"name", "eye"}, {"camera", 0}, {"extras", extras}});
  builder.node({{"name", "plan"}, {"camera", 1}, {"extras", extras}});
  const Scene scene = import(builder);
  const std::vector<scene::PlacedCamera> cameras = scene.placed_cameras();
  ASSERT_EQ(cameras.size(), 2U);
  for (const scene::PlacedCamera &camera : cameras) {
    EXPECT_EQ(camera.shift_x, 0.25F);
    EXPECT_EQ(camera.shift_y, -0.5F);
  }
  EXPECT_EQ(cameras[0].aperture_radius, 0.02F);
  EXPECT_EQ(cameras[0].focus_distance, 3.0F);
  EXPECT_EQ(cameras[0].aperture_blades, 6);
  EXPECT_EQ(cameras[0].aperture_rotation, 0.1F);
  EXPECT_EQ(cameras[0].aperture_ratio, 2.0F);
  EXPECT_EQ(cameras[1].aperture_radius, 0.0F);
  EXPECT_NO_WARNING(scene, "camera 'eye': extra");
  EXPECT_WARNING(scene, "camera 'plan': extra 'gnomon_aperture_radius' does not apply to this kind of camera");

  builder.document["nodes"][1]["extras"] = {{"gnomon_focus_distance", 0}};
  EXPECT_EQ(import(builder).placed_cameras().front().focus_distance, 0.0F) << "infinite";
  for (const auto &[wrong, message] : std::vector<std::pair<json, std::string>>{
           {{{"gnomon_aperture_blades", 2}},
            "camera 'eye': gnomon_aperture_blades is 2, and must be from 3 to 64, or 0"},
           {{{"gnomon_aperture_radius", -1}}, "camera 'eye': gnomon_aperture_radius is -1, and must be from 0"},
           {{{"gnomon_shift_x", "far"}}, "camera 'eye': gnomon_shift_x is 'far', and must be a number"}}) {
    builder.document["nodes"][1]["extras"] = wrong;
    EXPECT_HAS(import_error(builder), message);
  }
}

// ---- Worlds ----

/** A triangle in a scene with these extras. */
GltfBuilder scene_with(const json &extras)
{
  GltfBuilder builder = triangle_scene();
  builder.document["scenes"][0]["extras"] = extras;
  return builder;
}

std::string error_with(const json &extras)
{
  return import_error(scene_with(extras));
}

/** Imports a scene with these extras from \a folder. The picture of its world has one texel, of red \a red. */
Scene import_with_picture(const TemporaryFolder &folder, const json &extras, float red = 1.0F)
{
  const auto read_picture = [red](const std::filesystem::path &) { return scene::WorldPicture{1, 1, {{red, 2, 3}}}; };
  return gltf::import_gltf(folder.write("scene.gltf", scene_with(extras).gltf()), {.read_picture = read_picture});
}

TEST(GltfWorld, ColourStrengthAndRotationAreExtrasOfTheScene)
{
  const Scene scene = import(scene_with({{"gnomon_world", {0.25, 0.5, 1}},
                                         {"gnomon_world_color", {1, 2, 0}},
                                         {"gnomon_world_strength", 3},
                                         {"gnomon_world_rotation", -0.5}}));
  const scene::World expected{.color = {0.25F, 1, 0}, .strength = 3, .rotation = -0.5F};
  EXPECT_EQ(scene.world(), expected);
  // No lamp is added.
  EXPECT_TRUE(scene.lamps().empty());
  EXPECT_FALSE(scene.is_lamp_default);
  EXPECT_NO_WARNING(scene, "has no lamp");
  EXPECT_FALSE(import(triangle_scene()).world());
}

TEST(GltfWorld, IsOfTheSceneOrOfTheFirstVisibleNodeThatHasOne)
{
  GltfBuilder builder = triangle_scene();
  builder.node({{"name", "hidden"}, {"extras", {{"gnomon_world", {9, 9, 9}}, {"gnomon_visible", false}}}});
  builder.node({{"name", "sky"}, {"extras", {{"gnomon_world", {1, 1, 1}}}}});
  builder.node({{"name", "other"}, {"extras", {{"gnomon_world", {2, 2, 2}}}}});
  const Scene of_node = import(builder);
  EXPECT_EQ(of_node.world(), scene::World());
  EXPECT_WARNING(of_node, "node 'other': its world has no effect, because node 'sky' has one");
  EXPECT_NO_WARNING(of_node, "not a lamp");
  builder.document["scenes"][0]["extras"] = {{"gnomon_world", {3, 3, 3}}};
  const Scene of_scene = import(builder);
  EXPECT_EQ(of_scene.world(), scene::World{.color = glm::vec3(3.0F)});
  EXPECT_WARNING(of_scene, "node 'sky': its world has no effect, because scene has one");
}

TEST(GltfWorld, ExtrasOfTheWrongTypeOrOutOfRangeAreErrors)
{
  EXPECT_HAS(error_with({{"gnomon_world", true}}),
             "scene: gnomon_world is true, and must be three numbers or the name of a file");
  EXPECT_HAS(error_with({{"gnomon_world", {1, 2}}}), "scene: gnomon_world is an array, and must be three numbers");
  EXPECT_HAS(error_with({{"gnomon_world", {1, -1, 2}}}), "scene: gnomon_world is -1, and must be from 0 to 1e+30");
  EXPECT_HAS(error_with({{"gnomon_world", json::object()}}), "extra gnomon_world is an object, and must be");
  EXPECT_HAS(error_with({{"gnomon_world", {1, 1, 1}}, {"gnomon_world_strength", "a"}}),
             "scene: gnomon_world_strength is 'a', and must be a number");
  EXPECT_HAS(error_with({{"gnomon_world", {1, 1, 1}}, {"gnomon_world_strength", 1e31}}), "gnomon_world_strength is");
  EXPECT_HAS(error_with({{"gnomon_world", {1, 1, 1}}, {"gnomon_world_rotation", 1e39}}), "gnomon_world_rotation is");
  EXPECT_WARNING(import(scene_with({{"gnomon_world", {1e30, 1, 1}}, {"gnomon_world_color", {1e30, 1, 1}}})),
                 "world: its color times its strength is inf, 1, 1, which is above 1e+30: clamped to 1e+30");
  EXPECT_HAS(error_with({{"gnomon_world_accessor", 0}}),
             "gnomon_world_width is absent, and must be present where gnomon_world_accessor is");
  EXPECT_HAS(error_with({{"gnomon_world_accessor", 0.5}, {"gnomon_world_width", 1}}), "must be a whole number");
  EXPECT_HAS(error_with({{"gnomon_world_accessor", 0}, {"gnomon_world_width", 0}}), "gnomon_world_width is 0");
  EXPECT_HAS(error_with({{"gnomon_world", "a"}, {"gnomon_world_accessor", 0}, {"gnomon_world_width", 1}}),
             "gnomon_world_accessor is 0, and must be absent beside gnomon_world");
  const Scene idle = import(scene_with({{"gnomon_world_strength", 2}, {"gnomon_wolrd", 1}}));
  EXPECT_WARNING(idle, "scene: its extras of a world have no effect without gnomon_world");
  EXPECT_WARNING(idle, "scene: extra 'gnomon_wolrd' is unknown");
  EXPECT_FALSE(idle.world());
}

TEST(GltfWorld, APictureIsAFileBesideTheScene)
{
  const TemporaryFolder folder;
  static_cast<void>(folder.write("blue sky.hdr", "any"));
  const Scene scene = import_with_picture(folder, {{"gnomon_world", "blue%20sky.hdr"}, {"gnomon_world_strength", 2}});
  ASSERT_TRUE(scene.world() && scene.world()->picture) << all_warnings(scene);
  EXPECT_EQ(scene.world()->strength, 2.0F);
  EXPECT_EQ(scene.world()->picture->texels, (std::vector<glm::vec3>{{1, 2, 3}}));
  EXPECT_EQ(scene.world()->picture->path, (folder.path() / "blue sky.hdr").string());
}

// ---- Units of lamps ----

/** The triangle, and a lamp at 3 m from it, or a sun. */
GltfBuilder lit_triangle(const std::string &type, double intensity)
{
  GltfBuilder builder = triangle_scene();
  json light = {{"type", type}, {"intensity", intensity}};
  if (type == "spot") {
    light["spot"] = json::object();
  }
  builder.light(light, nullptr, {{"translation", {0, 0, 3}}});
  return builder;
}

float imported_intensity(const GltfBuilder &builder, gltf::LampUnits units)
{
  const TemporaryFolder folder;
  const Scene scene = gltf::import_gltf(folder.write("scene.gltf", builder.gltf()), {.lamp_units = units});
  return scene.placed_lamps().at(0).intensity;
}

TEST(GltfLampUnits, FilesThatWereExportedUnitlessAreNamedAndConverted)
{
  // 100 W of Blender are 8 W/sr, and 0.28 W/(sr m²) of a white surface at 3 m. 700 W/sr at 3 m are as bright as 1 kW at
  // 1 m.
  for (const auto &[type, raw] :
       {std::pair("point", 100.0 / (4.0 * 3.14159265)), {"spot", 8.0}, {"directional", 3.0}}) {
    const GltfBuilder unitless = lit_triangle(type, raw);
    const std::string message = "the file was probably exported unitless";
    EXPECT_WARNING(import(unitless), message);
    EXPECT_NEAR(imported_intensity(unitless, gltf::LampUnits::Lumen), raw / 683.0, 1e-6 * raw);
    EXPECT_NEAR(imported_intensity(unitless, gltf::LampUnits::Raw), raw, 1e-6 * raw);
    EXPECT_NEAR(imported_intensity(unitless, gltf::LampUnits::Auto), raw, 1e-6 * raw);
    const GltfBuilder standard = lit_triangle(type, 683.0 * raw);
    EXPECT_NO_WARNING(import(standard), message);
    EXPECT_NEAR(imported_intensity(standard, gltf::LampUnits::Auto), raw, 1e-6 * raw);
    EXPECT_NEAR(imported_intensity(standard, gltf::LampUnits::Raw), 683.0 * raw, 1e-3 * raw);
    // One lamp that can be seen, another light, or none at all.
    GltfBuilder mixed = unitless;
    mixed.light({{"type", "point"}, {"intensity", 5000.0}});
    EXPECT_NO_WARNING(import(mixed), message);
    GltfBuilder with_world = unitless;
    with_world.document["scenes"][0]["extras"] = {{"gnomon_world", {1, 1, 1}}};
    EXPECT_NO_WARNING(import(with_world), message);
    EXPECT_NO_WARNING(import(lit_triangle(type, 0.0)), message);
  }
}

TEST(GltfLampUnits, DarkFilesMayHaveEitherUnit)
{
  // 700 cd at 3 m are as bright as 1 kW of Blender, exported unitless, or as a right bulb of 800 lm, at about 1 m.
  const GltfBuilder dark = lit_triangle("point", 700.0);
  EXPECT_WARNING(import(dark), "may have been exported unitless; --lamp-units raw reads");
  EXPECT_NEAR(imported_intensity(dark, gltf::LampUnits::Auto), 700.0 / 683.0, 1e-3);
  EXPECT_NEAR(imported_intensity(dark, gltf::LampUnits::Raw), 700.0, 1e-3);
  EXPECT_NO_WARNING(import(lit_triangle("point", 2000.0)), "exported unitless");
}

TEST(GltfWorld, TexelsOfItsPictureThatAreNoRadiancesAreClamped)
{
  constexpr float infinite = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto &[red, kind] : {std::pair(-1.0F, "negative"), {infinite, "infinite"}, {nan, "not a number"}}) {
    const TemporaryFolder folder;
    static_cast<void>(folder.write("sky.hdr", "any"));
    const Scene scene = import_with_picture(folder, {{"gnomon_world", "sky.hdr"}}, red);
    ASSERT_TRUE(scene.world() && scene.world()->picture) << all_warnings(scene);
    EXPECT_EQ(scene.world()->picture->texels, (std::vector<glm::vec3>{{0, 2, 3}}));
    EXPECT_WARNING(scene, std::string("1 of 1 texels ") + kind + " (the first at 0, 0 from the top left)");
  }
}

TEST(GltfWorld, RadianceAboveTheLimitIsClamped)
{
  const TemporaryFolder folder;
  static_cast<void>(folder.write("sky.hdr", "any"));
  const std::string place = " (the first at 0, 0 from the top left)";
  const json weak = {{"gnomon_world", "sky.hdr"}};
  const json strong = {{"gnomon_world", "sky.hdr"}, {"gnomon_world_strength", 1e10}, {"gnomon_world_color", {1, 1, 2}}};
  const Scene bright = import_with_picture(folder, weak, 2e38F);
  EXPECT_WARNING(bright, "world: its picture: 1 of 1 texels above 1e+30" + place);
  ASSERT_TRUE(bright.world());
  EXPECT_EQ(bright.world()->picture->texels, (std::vector<glm::vec3>{{1e30F, 2, 3}}));
  const Scene scene = import_with_picture(folder, strong, 1e25F);
  EXPECT_WARNING(scene, "world: its picture: 1 of 1 texels above 1e+30 by its color and strength" + place);
  ASSERT_TRUE(scene.world());
  EXPECT_NEAR(scene.world()->picture->texels[0].r, 1e20, 1e14);
  EXPECT_EQ(scene.world()->strength, 1e10F);
}

TEST(GltfWorld, IsLeftOutWhereItsPictureCannotBeUsed)
{
  const TemporaryFolder folder;
  const std::string file = folder.write("sky.hdr", "any");
  const auto expect_left_out = [](const Scene &scene, const std::string &reason) {
    expect_valid(scene);
    EXPECT_FALSE(scene.world());
    EXPECT_WARNING(scene, "scene: its world is left out: " + reason);
    // The scene is lit as one without a world.
    EXPECT_TRUE(scene.is_lamp_default);
  };
  const auto expect_refused = [&](const char *name, const std::string &reason) {
    expect_left_out(import_with_picture(folder, {{"gnomon_world", name}}), reason);
  };
  expect_refused("nowhere.hdr", "picture 'nowhere.hdr': there is no such file");
  expect_refused(".", "picture '.': is not a file");
  expect_refused("../../../../../../../dev/zero", "picture");
  expect_refused("/etc/passwd", "picture '/etc/passwd': is not a file beside the scene");
  expect_refused("http://a/b.hdr", "picture 'http://a/b.hdr': is not a file beside the scene");
  expect_refused("data:image/vnd.radiance;base64,AAAA", "picture: is a data URI");
  expect_refused("", "picture ''");
  const json extras = {{"gnomon_world", "sky.hdr"}};
  const std::filesystem::path scene = folder.write("scene.gltf", scene_with(extras).gltf());
  expect_left_out(gltf::import_gltf(scene), "picture 'sky.hdr': this program reads no pictures of worlds");
  expect_left_out(gltf::import_gltf(scene, {.read_picture = [](const auto &) -> scene::WorldPicture {
                                      throw std::runtime_error("has no channels");
                                    }}),
                  "has no channels");
  expect_left_out(
      gltf::import_gltf(scene, {.read_picture = [](const auto &) -> scene::WorldPicture { throw std::bad_alloc(); }}),
      "there is not enough memory");
  expect_left_out(gltf::import_gltf(scene, {.read_picture =
                                                [](const auto &) {
                                                  return scene::WorldPicture{3, 2, {}};
                                                }}),
                  "its picture '" + file + "': has no texels, or not as many as its size says");
}

TEST(GltfWorld, APictureMayBeAnAccessor)
{
  const auto import_with = [](const std::vector<float> &texels, int width, const json &more = json::object()) {
    GltfBuilder builder = triangle_scene();
    const int accessor = builder.accessor(texels, Float32, "VEC3", more);
    builder.document["scenes"][0]["extras"] = {{"gnomon_world_accessor", accessor}, {"gnomon_world_width", width}};
    return import(builder);
  };
  const std::vector<float> four{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const Scene scene = import_with(four, 2);
  ASSERT_TRUE(scene.world() && scene.world()->picture) << all_warnings(scene);
  EXPECT_EQ(scene.world()->picture->width, 2);
  EXPECT_EQ(scene.world()->picture->height, 2);
  EXPECT_EQ(scene.world()->picture->at(1, 0), glm::vec3(4, 5, 6));
  EXPECT_EQ(scene.world()->picture->at(0, 1), glm::vec3(7, 8, 9));
  const auto expect_left_out = [](const Scene &damaged, const std::string &reason) {
    EXPECT_FALSE(damaged.world());
    EXPECT_WARNING(damaged, "scene: its world is left out: " + reason);
  };
  expect_left_out(import_with(four, 3), "accessor 1: its 4 elements are not rows of 3 texels");
  expect_left_out(import_with(four, 5), "accessor 1: its 4 elements are not rows of 5 texels");
  expect_left_out(import_with({}, 1), "accessor 1");
  expect_left_out(import_with(four, 2, {{"count", 1 << 30}}), "accessor 1: runs past the end");
  expect_left_out(import(scene_with({{"gnomon_world_accessor", 7}, {"gnomon_world_width", 1}})),
                  "gnomon_world_accessor: index 7 is out of range: the file has 1");
  GltfBuilder scalars = triangle_scene();
  const int accessor = scalars.accessor(four, Float32, "SCALAR");
  scalars.document["scenes"][0]["extras"] = {{"gnomon_world_accessor", accessor}, {"gnomon_world_width", 1}};
  expect_left_out(import(scalars), "accessor 1: must be a VEC3");
}

/** The texel of the picture that is nearest to a direction. */
glm::vec3 texel_in(const scene::WorldPicture &picture, const glm::vec3 &direction)
{
  const glm::vec3 unit = glm::normalize(direction);
  constexpr float pi = std::numbers::pi_v<float>;
  const float u = 0.5F + std::atan2(unit.z, unit.x) / (2.0F * pi);
  const float v = 0.5F + std::asin(unit.y) / pi;
  return picture.at(std::min(int(u * float(picture.width)), picture.width - 1),
                    std::min(int((1.0F - v) * float(picture.height)), picture.height - 1));
}

constexpr int face_edge = 8;

/** Faces of one grey each, 10, 20 ... 60 of 255, with 255 in the quarter at the upper left corner. */
std::vector<unsigned char> face_png(int face)
{
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < face_edge * face_edge; i++) {
    const bool is_marked = i % face_edge < face_edge / 2 && i / face_edge < face_edge / 2;
    texels.insert(texels.end(), 3, std::uint8_t(is_marked ? 255 : 10 * (face + 1)));
  }
  return image_file("png", face_edge, face_edge, 3, texels);
}

/** A triangle in an image-based light. */
GltfBuilder image_lit_scene()
{
  GltfBuilder builder = triangle_scene();
  json faces = json::array();
  for (int face = 0; face < 6; face++) {
    faces.push_back(builder.append("images", {{"uri", "data:image/png;base64," + base64(face_png(face))}}));
  }
  builder.document["extensions"]["EXT_lights_image_based"]["lights"] = {
      {{"name", "sky"}, {"intensity", 3}, {"specularImageSize", face_edge}, {"specularImages", {faces, {7, 7}}}}};
  builder.document["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 0;
  builder.document["extensionsRequired"] = {"EXT_lights_image_based"};
  return builder;
}

json &image_light(GltfBuilder &builder)
{
  return builder.document["extensions"]["EXT_lights_image_based"]["lights"][0];
}

float linear_of(int encoded)
{
  const double value = encoded / 255.0;
  return float(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
}

/** OpenGL 4.6, table 8.19: the direction to the place (s, t) of a face, both from -1 to 1. */
glm::vec3 face_direction(int face, float s, float t)
{
  const std::array<glm::vec3, 6> directions = {glm::vec3(1, -t, -s), {-1, -t, s}, {s, 1, t},
                                               {s, -1, -t},          {s, -t, 1},  {-s, -t, -1}};
  return directions[std::size_t(face)];
}

TEST(GltfWorld, AnImageBasedLightIsItsCubeMap)
{
  const Scene scene = import(image_lit_scene());
  EXPECT_NO_WARNING(scene, "EXT_lights_image_based");
  EXPECT_NO_WARNING(scene, "has no lamp");
  ASSERT_TRUE(scene.world() && scene.world()->picture) << all_warnings(scene);
  EXPECT_EQ(scene.world()->strength, 3.0F);
  const scene::WorldPicture &picture = *scene.world()->picture;
  EXPECT_EQ(picture.width, 4 * face_edge);
  EXPECT_EQ(picture.height, 2 * face_edge);
  for (int face = 0; face < 6; face++) {
    for (const auto &[s, t] : {std::pair(-0.5F, -0.5F), {0.5F, -0.5F}, {-0.5F, 0.5F}, {0.5F, 0.5F}}) {
      const float expected = linear_of(s < 0.0F && t < 0.0F ? 255 : 10 * (face + 1));
      EXPECT_NEAR(texel_in(picture, face_direction(face, s, t)).g, expected, 1e-6F) << face << ": " << s << ", " << t;
    }
  }
}

/** The mean over the sphere is that of the faces, so that no light is lost or gained. */
TEST(GltfWorld, AnImageBasedLightKeepsItsLight)
{
  const Scene scene = import(image_lit_scene());
  const scene::WorldPicture &picture = *scene.world()->picture;
  double light = 0.0;
  double weights = 0.0;
  for (int y = 0; y < picture.height; y++) {
    const double weight = std::sin((y + 0.5) / picture.height * std::numbers::pi);
    for (int x = 0; x < picture.width; x++) {
      light += weight * double(picture.at(x, y).r);
      weights += weight;
    }
  }
  double expected = 0.25;
  for (int face = 0; face < 6; face++) {
    expected += 0.75 / 6.0 * double(linear_of(10 * (face + 1)));
  }
  // The marked quarters are blurred at their inner edges, which differ in distance.
  EXPECT_NEAR(light / weights, expected, 0.01 * expected);
}

TEST(GltfWorld, TheRotationTurnsAnImageBasedLight)
{
  GltfBuilder builder = image_lit_scene();
  const glm::quat turn = glm::normalize(glm::quat(0.9F, 0.1F, -0.3F, 0.2F));
  image_light(builder)["rotation"] = {turn.x, turn.y, turn.z, turn.w};
  const Scene turned = import(builder);
  for (int face = 0; face < 6; face++) {
    const glm::vec3 direction = turn * face_direction(face, 0.5F, 0.5F);
    EXPECT_NEAR(texel_in(*turned.world()->picture, direction).g, linear_of(10 * (face + 1)), 1e-6F) << face;
  }
  // The content at +X is at -Z after a quarter turn around +Y, as for the rotation of any world.
  const double half = std::sqrt(0.5);
  image_light(builder)["rotation"] = {0, half, 0, half};
  EXPECT_NEAR(texel_in(*import(builder).world()->picture, {0.5F, -0.5F, -1}).g, linear_of(10), 1e-6F);
  image_light(builder)["rotation"] = {0, 0, 0, 0};
  const Scene unturned = import(builder);
  EXPECT_WARNING(unturned, "image-based light 'sky': its rotation has no length and is not used");
  EXPECT_NEAR(texel_in(*unturned.world()->picture, {1, -0.5F, -0.5F}).g, linear_of(10), 1e-6F);
}

TEST(GltfWorld, AlphaDividesTheColoursOfAnImageBasedLight)
{
  GltfBuilder builder = image_lit_scene();
  const auto set_alpha = [&builder](std::uint8_t alpha) {
    const std::vector<std::uint8_t> texels{200, 100, 0, alpha};
    const std::string uri = "data:image/png;base64," + base64(image_file("png", 1, 1, 4, texels));
    for (json &image : builder.document["images"]) {
      image["uri"] = uri;
    }
    const Scene scene = import(builder);
    return scene.world()->picture->at(0, 0);
  };
  const glm::vec3 color(linear_of(200), linear_of(100), 0.0F);
  for (const int alpha : {255, 51, 1, 0}) {
    const float factor = 255.0F / float(std::max(alpha, 1));
    EXPECT_LE(glm::distance(set_alpha(std::uint8_t(alpha)), color * factor), 1e-6F * factor) << alpha;
  }
}

TEST(GltfWorld, ADamagedImageBasedLightIsNamed)
{
  const auto expect_left_out = [](const GltfBuilder &builder, const std::string &reason) {
    const Scene scene = import(builder);
    EXPECT_FALSE(scene.world());
    EXPECT_TRUE(scene.is_lamp_default);
    EXPECT_WARNING(scene, "image-based light 'sky': its world is left out: " + reason);
  };
  GltfBuilder builder = image_lit_scene();
  builder.document["images"][3]["uri"] = "nowhere.png";
  expect_left_out(builder, "image 3 'nowhere.png': there is no such file");
  builder = image_lit_scene();
  builder.document["images"][3]["uri"] =
      "data:image/png;base64," + base64(image_file<std::uint8_t>("png", 1, 2, 3, {1, 2, 3, 4, 5, 6}));
  expect_left_out(builder, "image-based light 'sky': its faces are not squares of one size: one has 1x2 texels");
  builder = image_lit_scene();
  image_light(builder)["specularImages"][0] = {0, 1, 2, 3, 4, 9};
  expect_left_out(builder, "image-based light 'sky': image of a face: index 9 is out of range: the file has 6");
  image_light(builder)["specularImages"][0] = {0, 1, 2, 3, 4};
  expect_left_out(builder, "image-based light 'sky': its specularImages begin with 5 images, and must with 6");
  image_light(builder).erase("specularImages");
  expect_left_out(builder, "image-based light 'sky': its specularImages begin with 0 images");
  builder = image_lit_scene();
  image_light(builder)["intensity"] = -1;
  expect_left_out(builder, "its intensity is -1, and must be from 0 to 1e+30");
  image_light(builder)["intensity"] = "a";
  EXPECT_HAS(import_error(builder), "extensions.EXT_lights_image_based.lights[0].intensity: is \"a\"");
  builder = image_lit_scene();
  image_light(builder)["specularImages"] = {{0, "a"}};
  EXPECT_HAS(import_error(builder), "specularImages[0]: is \"a\", and must be an index");
}

TEST(GltfWorld, ExtrasPrecedeAnImageBasedLight)
{
  GltfBuilder builder = image_lit_scene();
  builder.document["scenes"][0]["extras"] = {{"gnomon_world", {1, 1, 1}}};
  const Scene scene = import(builder);
  EXPECT_EQ(scene.world(), scene::World());
  EXPECT_WARNING(scene, "image-based light 'sky': has no effect, because scene has a world");
  builder = image_lit_scene();
  builder.light({{"type", "point"}});
  EXPECT_WARNING(import(builder), "image-based light 'sky': its values are radiances in W/(sr m2)");
  builder.document["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 1;
  EXPECT_HAS(import_error(builder), "light: index 1 is out of range: the file has 1 image-based lights");
}

TEST(GltfImport, OnePrimitiveOfTwoMeshesIsOneMesh)
{
  GltfBuilder builder = triangle_scene();
  const json primitive = {{"attributes", {{"POSITION", 0}}}, {"extras", {{"gnomon_name", "shared"}}}};
  builder.document["meshes"] = {{{"primitives", {primitive}}},
                                {{"primitives", {primitive, {{"attributes", {{"POSITION", 0}}}, {"mode", 5}}}}}};
  builder.node({{"name", "both"}, {"mesh", 1}});
  const Scene scene = import(builder);
  EXPECT_EQ(scene.meshes().size(), 2U);
  EXPECT_EQ(scene.objects().size(), 3U);
  EXPECT_EQ(scene.meshes()[scene.meshes().first()].name, "shared");
}

// ---- JSON ----

TEST(GltfFile, ByteOrderMarkIsSkipped)
{
  EXPECT_EQ(import_error("\xEF\xBB\xBF" + triangle_scene().gltf()), "");
}

TEST(GltfFile, WholeNumbersMayBeOfAnyLength)
{
  std::string text = triangle_scene().gltf();
  text.insert(1, R"("extras":[123456789012345678901234567890,-99999999999999999999,"\\\"99999999999999999999"],)");
  EXPECT_EQ(import_error(text), "");
  EXPECT_HAS(import_error("{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"mesh\": 99999999999999999999}]}"),
             "nodes[0].mesh: is ");
}

TEST(GltfFile, OfPropertiesOfOneNameTheLastCounts)
{
  std::string text = triangle_scene().gltf();
  text.insert(1, "\"nodes\":7,\"asset\":{\"version\":\"1.0\"},");
  EXPECT_EQ(import_error(text), "");
}

}  // namespace
}  // namespace gnomon::test
