// SPDX-License-Identifier: MIT
// Pointers of KHR_animation_pointer to visibility, transforms of textures, factors of materials, and cones of lamps.
#include "gltf/gltf_animated.hh"
#include "gltf/gltf_textured_triangle.hh"
#include "gltf_export.hh"

namespace gnomon::test {
namespace {

using scene::Scene;

json pointer_to(const std::string &path)
{
  return {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", path}}}}}};
}

/** The scene, and the scene that is read from its file. */
std::vector<Scene> scenes_of(const GltfBuilder &builder)
{
  std::vector<Scene> scenes;
  scenes.push_back(import(builder));
  const TemporaryFolder folder;
  gltf::export_gltf(scenes[0], folder.path() / "again.glb");
  scenes.push_back(gltf::import_gltf(folder.path() / "again.glb"));
  return scenes;
}

void pose_first(Scene &scene, double seconds)
{
  ASSERT_EQ(scene.animations.size(), 1U) << all_warnings(scene);
  const scene::Animation animation = scene.animations[0];
  scene::pose(scene, animation, seconds);
}

TEST(GltfPointer, VisibilityIsPlayed)
{
  GltfBuilder builder = triangle_scene();
  json &animation = builder.document["animations"][0];
  const int input = builder.accessor<float>({0, 1}, Float32, "SCALAR");
  const int output = builder.accessor(std::vector<std::uint8_t>{1, 0}, Uint8, "SCALAR");
  animation["samplers"] = {{{"input", input}, {"output", output}, {"interpolation", "STEP"}}};
  animation["channels"] = {{{"sampler", 0}, {"target", pointer_to("/nodes/0/extensions/KHR_node_visibility/visible")}}};
  for (Scene &scene : scenes_of(builder)) {
    pose_first(scene, 0.5);
    EXPECT_EQ(scene.objects().size(), 1U);
    pose_first(scene, 1.0);
    EXPECT_TRUE(scene.objects().empty());
  }
}

TEST(GltfPointer, VisibilityHasNoValuesBetweenKeys)
{
  GltfBuilder builder = triangle_scene();
  json &animation = builder.document["animations"][0];
  const int input = builder.accessor<float>({0, 1, 2}, Float32, "SCALAR");
  const int output = builder.accessor(std::vector<std::uint8_t>{0, 1, 0}, Uint8, "SCALAR");
  animation["samplers"] = {{{"input", input}, {"output", output}}};
  animation["channels"] = {{{"sampler", 0}, {"target", pointer_to("/nodes/0/extensions/KHR_node_visibility/visible")}}};
  Scene scene = import(builder);
  EXPECT_WARNING(scene, "'visible' has no values between two keys: STEP is taken for LINEAR");
  pose_first(scene, 0.5);
  EXPECT_TRUE(scene.objects().empty());
  pose_first(scene, 1.5);
  EXPECT_EQ(scene.objects().size(), 1U);
}

TEST(GltfPointer, TransformsOfTexturesArePlayed)
{
  const std::vector<std::pair<std::string, scene::TextureSlot scene::Material::*>> slots{
      {"pbrMetallicRoughness/baseColorTexture", &scene::Material::base_color_texture},
      {"emissiveTexture", &scene::Material::emissive_texture},
      {"extensions/KHR_materials_clearcoat/clearcoatNormalTexture", &scene::Material::coat_normal_texture}};
  for (const auto &[path, slot] : slots) {
    GltfBuilder builder = triangle_scene();
    builder.document["materials"] = {{{"name", "paint"}}};
    builder.document["meshes"][0]["primitives"][0]["material"] = 0;
    const std::string transform = "/materials/0/" + path + "/extensions/KHR_texture_transform/";
    add_channel(builder, pointer_to(transform + "offset"), {0, 1}, {0, 0, 0.5F, 1}, "VEC2");
    add_channel(builder, pointer_to(transform + "rotation"), {0, 1}, {0, 2}, "SCALAR");
    add_channel(builder, pointer_to(transform + "scale"), {0, 1}, {1, 1, 3, 5}, "VEC2");
    const bool has_normals = path.ends_with("NormalTexture");
    EXPECT_EQ(all_warnings(import(builder)).find("the directions of its normals do not") != std::string::npos,
              has_normals);
    for (Scene &scene : scenes_of(builder)) {
      pose_first(scene, 0.5);
      const scene::TextureSlot &posed = nth(scene.materials(), 0).*slot;
      EXPECT_EQ(posed.offset, glm::vec2(0.25F, 0.5F)) << path;
      EXPECT_EQ(posed.rotation, 1.0F) << path;
      EXPECT_EQ(posed.scale, glm::vec2(2.0F, 3.0F)) << path;
    }
  }
}

/** A triangle with texture coordinates, whose one material has a texture in each slot of the layers. All factors are 0.
 */
GltfBuilder layered_triangle()
{
  GltfBuilder builder = triangle_scene();
  builder.document["images"] = {{{"uri", data_uri(four_texel_png())}}};
  builder.document["textures"] = {{{"source", 0}}};
  builder.document["meshes"][0]["primitives"][0]["material"] = 0;
  builder.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      builder.accessor<float>({0, 0, 1, 0, 0, 1}, Float32, "VEC2");
  const json texture = {{"index", 0}};
  builder.document["materials"] = {
      {{"name", "paint"},
       {"extensions",
        {{"KHR_materials_clearcoat",
          {{"clearcoatFactor", 0}, {"clearcoatTexture", texture}, {"clearcoatNormalTexture", texture}}},
         {"KHR_materials_sheen", {{"sheenColorFactor", {0, 0, 0}}, {"sheenColorTexture", texture}}},
         {"KHR_materials_anisotropy", {{"anisotropyStrength", 0}, {"anisotropyTexture", texture}}},
         {"KHR_materials_specular", {{"specularFactor", 1}}},
         {"KHR_materials_ior", {{"ior", 2}}},
         {"KHR_materials_transmission", {{"transmissionFactor", 0}, {"transmissionTexture", texture}}},
         {"KHR_materials_volume", {{"thicknessFactor", 0}, {"thicknessTexture", texture}}}}}}};
  return builder;
}

TEST(GltfPointer, AllFactorsOfMaterialsArePlayed)
{
  // An index of refraction of 2 gives (1 / 3)² / 0.04.
  constexpr float ratio = 25.0F / 9.0F;
  int played = 0;
  scene::Material::for_each_property([&](const auto &row) {
    using Value = typename std::decay_t<decltype(row)>::Value;
    constexpr bool is_number = std::is_same_v<Value, float>;
    if constexpr (is_number || std::is_same_v<Value, glm::vec3>) {
      // The index of refraction also changes the reflection; four numbers and a product have tests of their own.
      if (row.path.empty() || row.name == "ior" || row.name == "base_color" || row.name == "emissive") {
        return;
      }
      GltfBuilder builder = layered_triangle();
      add_channel(builder, pointer_to("/materials/0/" + std::string(row.path)), {0, 1},
                  is_number ? std::vector<float>{0, 0.5F} : std::vector<float>{0, 0, 0, 0.5F, 0.25F, 1},
                  is_number ? "SCALAR" : "VEC3");
      for (Scene &scene : scenes_of(builder)) {
        pose_first(scene, 1.0);
        const Value &posed = nth(scene.materials(), 0).*row.member;
        if constexpr (is_number) {
          EXPECT_EQ(posed, 0.5F) << row.name;
        }
        else {
          const float factor = row.name == "specular_color" ? ratio : 1.0F;
          EXPECT_LT(glm::length(posed - factor * glm::vec3(0.5F, 0.25F, 1)), 1e-6F) << row.name;
        }
      }
      played++;
    }
  });
  EXPECT_GE(played, 18);
}

TEST(GltfPointer, TexturesAndTangentsOfFactorsThatBeginAtZeroAreKept)
{
  const auto posed = [](const std::string &path, bool is_color) {
    GltfBuilder builder = layered_triangle();
    add_channel(builder, pointer_to("/materials/0/extensions/" + path), {0, 1},
                is_color ? std::vector<float>{0, 0, 0, 1, 1, 1} : std::vector<float>{0, 1},
                is_color ? "VEC3" : "SCALAR");
    return scenes_of(builder);
  };
  const auto has_slots = [](const Scene &scene, auto... slots) {
    const scene::Material &material = nth(scene.materials(), 0);
    return (bool(material.*slots) && ...);
  };
  for (const Scene &scene : posed("KHR_materials_clearcoat/clearcoatFactor", false)) {
    EXPECT_TRUE(has_slots(scene, &scene::Material::coat_texture, &scene::Material::coat_normal_texture));
    EXPECT_FALSE(has_slots(scene, &scene::Material::sheen_color_texture));
  }
  for (const Scene &scene : posed("KHR_materials_sheen/sheenColorFactor", true)) {
    EXPECT_TRUE(has_slots(scene, &scene::Material::sheen_color_texture));
  }
  for (const Scene &scene : posed("KHR_materials_transmission/transmissionFactor", false)) {
    EXPECT_TRUE(has_slots(scene, &scene::Material::transmission_texture));
  }
  for (const Scene &scene : posed("KHR_materials_anisotropy/anisotropyStrength", false)) {
    EXPECT_TRUE(has_slots(scene, &scene::Material::anisotropy_texture));
    EXPECT_TRUE(nth(scene.meshes(), 0).has_tangents());
  }
  EXPECT_FALSE(nth(import(layered_triangle()).meshes(), 0).has_tangents());
}

TEST(GltfPointer, BothAnglesOfConesArePlayed)
{
  const std::string spot = "/extensions/KHR_lights_punctual/lights/0/spot/";
  const auto blend = [](double inner, double outer) {
    return (std::cos(inner) - std::cos(outer)) / (1.0 - std::cos(outer));
  };
  const auto scenes = [&](bool moves_outer, bool moves_inner) {
    GltfBuilder builder = triangle_scene();
    builder.document["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}}};
    builder.document["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    if (moves_inner) {
      add_channel(builder, pointer_to(spot + "innerConeAngle"), {0, 1}, {0, 0.5F}, "SCALAR");
    }
    if (moves_outer) {
      add_channel(builder, pointer_to(spot + "outerConeAngle"), {0, 2}, {0.5F, 1.5F}, "SCALAR");
    }
    return scenes_of(builder);
  };
  const auto expect_cones = [&](std::vector<Scene> posed, double seconds, double inner, double outer) {
    for (Scene &scene : posed) {
      pose_first(scene, seconds);
      const scene::Lamp &lamp = nth(scene.lamps(), 0);
      EXPECT_NEAR(lamp.spot_outer_angle, outer, 1e-6);
      EXPECT_NEAR(lamp.spot_blend, blend(inner, outer), 1e-6);
    }
  };
  expect_cones(scenes(true, false), 1.0, 0.25, 1.0);
  expect_cones(scenes(false, true), 0.8, 0.4, 0.5);
  expect_cones(scenes(true, true), 1.0, 0.5, 1.0);
  // The importer takes a larger inner angle for a hard edge.
  expect_cones(scenes(false, true), 1.0, 0.5, 0.5);
}

TEST(GltfPointer, WeightsOfAMeshMoveTheNodesWithoutWeightsOfTheirOwn)
{
  GltfBuilder builder = triangle_scene();
  const int up = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  builder.document["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}};
  builder.node({{"name", "second"}, {"mesh", 0}});
  builder.node({{"name", "own"}, {"mesh", 0}, {"weights", {0.25}}});
  add_channel(builder, pointer_to("/meshes/0/weights"), {0, 1}, {0, 1}, "SCALAR");
  Scene scene = import(builder);
  pose_first(scene, 0.5);
  EXPECT_EQ(nth(scene.meshes(), 0).positions[1].z, 0.5F);
  EXPECT_EQ(nth(scene.meshes(), 1).positions[1].z, 0.5F);
  EXPECT_EQ(nth(scene.meshes(), 2).positions[1].z, 0.25F);
}

TEST(GltfPointer, AnAnimationOfThingsThatTheSceneLacksMovesNothing)
{
  for (const char *path :
       {"/materials/1/alphaCutoff", "/materials/1/normalTexture/extensions/KHR_texture_transform/offset",
        "/materials/7/alphaCutoff"}) {
    GltfBuilder builder = triangle_scene();
    builder.document["materials"] = {{{"name", "used"}}, {{"name", "of another variant"}}};
    builder.document["meshes"][0]["primitives"][0]["material"] = 0;
    add_channel(builder, pointer_to(path), {0, 1}, {0, 1}, "SCALAR");
    Scene scene = import(builder);
    const bool is_in_file = std::string(path).starts_with("/materials/1");
    EXPECT_WARNING(scene, std::string("channel left out: pointer: ") +
                              (is_in_file ? "its target is not in the scene" : "the file has no material 7"));
    ASSERT_EQ(scene.animations.size(), is_in_file ? 1U : 0U) << path;
    if (is_in_file) {
      const scene::Revision before = scene.revision();
      pose_first(scene, 0.5);
      EXPECT_EQ(scene.revision(), before);
    }
  }
}

TEST(GltfPointer, AnElementThatTheFileLacksIsNamed)
{
  const std::string lights = "/extensions/KHR_lights_punctual";
  for (const auto &[path, element] :
       {std::pair<std::string, std::string>("/nodes/9/translation", "node 9"),
        {"/nodes/-1/scale", "node -1"},
        {"/nodes/9/weights", "node 9"},
        {"/nodes/9/extensions/KHR_node_visibility/visible", "node 9"},
        {"/meshes/3/weights", "mesh 3"},
        {"/materials/4/alphaCutoff", "material 4"},
        {"/materials/4/normalTexture/extensions/KHR_texture_transform/rotation", "material 4"},
        {lights + "/lights/5/intensity", "light 5"},
        {lights + "/lights/5/spot/outerConeAngle", "light 5"},
        {"/cameras/6/perspective/yfov", "camera 6"}}) {
    GltfBuilder builder = triangle_scene();
    const bool has_vectors = path.ends_with("translation") || path.ends_with("scale");
    add_channel(builder, pointer_to(path), {0, 1}, std::vector<float>(has_vectors ? 6 : 2, 1.0F),
                has_vectors ? "VEC3" : "SCALAR");
    EXPECT_WARNING(import(builder), "channel left out: pointer: the file has no " + element);
  }
}

TEST(GltfPointer, WhatIsNotPlayedIsNamed)
{
  const auto expect_left_out = [](const json &target, const std::string &why) {
    GltfBuilder builder = triangle_scene();
    builder.document["cameras"] = {
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 1}, {"zfar", 2}}}}};
    builder.document["nodes"][0]["camera"] = 0;
    builder.document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}}};
    builder.document["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    add_channel(builder, target, {0, 1}, {1, 2}, "SCALAR");
    EXPECT_WARNING(import(builder), "channel left out: " + why);
  };
  expect_left_out(pointer_to(""), "target: has no pointer");
  expect_left_out({{"path", "pointer"}}, "target: has no pointer");
  expect_left_out({{"path", "pointer"}, {"node", 0}}, "target: has no pointer");
  expect_left_out(pointer_to("/cameras/0/perspective/yfov"), "pointer: its target has no 'perspective/yfov'");
  expect_left_out(pointer_to("/extensions/KHR_lights_punctual/lights/0/range"), "pointer: its target has no 'range'");
  expect_left_out(pointer_to("/cameras/0/orthographic/znear"),
                  "pointer: '/cameras/0/orthographic/znear' is not played");
}

TEST(GltfPointer, TheFirstValueOutOfRangeIsNamedOnce)
{
  const auto warnings_of = [](const std::string &pointer, const std::vector<float> &values, const std::string &type,
                              const std::string &interpolation = "LINEAR") {
    GltfBuilder builder = triangle_scene();
    builder.document["materials"] = {{{"name", "paint"}}};
    builder.document["meshes"][0]["primitives"][0]["material"] = 0;
    builder.document["cameras"] = {
        {{"type", "perspective"}, {"name", "lens"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
    builder.document["nodes"][0]["camera"] = 0;
    builder.document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    builder.document["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    // A second node with the same lamp.
    builder.document["nodes"].push_back(builder.document["nodes"][0]);
    builder.document["scenes"][0]["nodes"].push_back(1);
    add_channel(builder, pointer_to(pointer), {0, 1, 2}, values, type, interpolation);
    return import(builder).warnings;
  };
  using Messages = std::vector<std::string>;
  const std::string roughness = "/materials/0/pbrMetallicRoughness/roughnessFactor";
  EXPECT_EQ(warnings_of(roughness, {0, 1.5F, 2}, "SCALAR"),
            Messages{"animation 0: the 'pbrMetallicRoughness/roughnessFactor' of 'paint' is 1.5 at 1 s, clamped to 1"});
  EXPECT_EQ(warnings_of(roughness, {0, 1, 0.5F}, "SCALAR"), Messages{});
  // Tangents may be any numbers.
  EXPECT_EQ(warnings_of(roughness, {9, 0, -9, 9, 1, -9, 9, 0.5F, -9}, "SCALAR", "CUBICSPLINE"), Messages{});
  EXPECT_EQ(
      warnings_of("/materials/0/pbrMetallicRoughness/baseColorFactor", {1, 1, 1, 1, 1, 1, 1, -0.5F, 1, 1, 1, 1},
                  "VEC4"),
      Messages{"animation 0: the 'pbrMetallicRoughness/baseColorFactor' of 'paint' is -0.5 at 1 s, clamped to 0"});
  EXPECT_EQ(warnings_of("/extensions/KHR_lights_punctual/lights/0/intensity", {5, 5, -2}, "SCALAR"),
            Messages{"animation 0: the 'intensity' of 'thing' is -2 at 2 s, clamped to 0"});
  EXPECT_EQ(
      warnings_of("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", {1, 1, 1}, "SCALAR"),
      Messages{});
  EXPECT_EQ(warnings_of("/cameras/0/perspective/yfov", {1, 4, 1}, "SCALAR").size(), 1U);
  EXPECT_EQ(warnings_of("/materials/0/emissiveFactor", {1, 1, 1, 1, 1, 3, 0, 0, 0}, "VEC3"),
            Messages{"animation 0: the 'emissiveFactor' of 'paint' is 3 at 1 s, clamped to 1"});
  const std::string deep =
      "/materials/0/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture/extensions/"
      "KHR_texture_transform/texCoord";
  EXPECT_EQ(warnings_of(deep, {0, 1, 0}, "SCALAR"),
            Messages{"animation 0: channel left out: pointer: '" + deep + "' is not played"});
}

TEST(GltfPointer, OfTwoChannelsWithOneTargetTheFirstIsPlayed)
{
  const json node{{"node", 0}, {"path", "translation"}};
  for (const auto &[first, second] : {std::pair(node, node),
                                      {node, pointer_to("/nodes/0/translation")},
                                      {pointer_to("/nodes/0/translation"), pointer_to("/nodes/00/translation")}}) {
    GltfBuilder builder = triangle_scene();
    add_channel(builder, first, {0, 1}, {0, 0, 0, 1, 1, 1}, "VEC3");
    add_channel(builder, second, {0, 1}, {0, 0, 0, 2, 2, 2}, "VEC3");
    Scene scene = import(builder);
    EXPECT_WARNING(scene, "channel left out: target: a channel before it has the same");
    pose_first(scene, 1.0);
    EXPECT_EQ(scene.objects()[0].world_from_object[3], glm::dvec4(1));
  }
}

TEST(GltfPointer, EmissionIsTheProductOfBothFactorsInEitherOrder)
{
  const std::string factor = "/materials/0/emissiveFactor";
  const std::string strength = "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength";
  for (const bool is_factor_first : {true, false}) {
    GltfBuilder builder = triangle_scene();
    builder.document["materials"] = {
        {{"name", "paint"},
         {"emissiveFactor", {0, 0, 0}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 0}}}}}}};
    builder.document["meshes"][0]["primitives"][0]["material"] = 0;
    for (const bool is_factor : {is_factor_first, !is_factor_first}) {
      if (is_factor) {
        add_channel(builder, pointer_to(factor), {0, 1}, {0, 0, 0, 1, 0.5F, 0.25F}, "VEC3");
      }
      else {
        add_channel(builder, pointer_to(strength), {0, 1}, {0, 5}, "SCALAR");
      }
    }
    for (Scene &scene : scenes_of(builder)) {
      pose_first(scene, 1.0);
      EXPECT_EQ(nth(scene.materials(), 0).emissive, glm::vec3(5.0F, 2.5F, 1.25F));
      pose_first(scene, 0.5);
      EXPECT_EQ(nth(scene.materials(), 0).emissive, glm::vec3(1.25F, 0.625F, 0.3125F));
    }
  }
}

TEST(GltfPointer, AnEmissiveFactorHasAtMostOneAsWithoutAnimation)
{
  for (const bool is_spline : {false, true}) {
    GltfBuilder builder = triangle_scene();
    builder.document["materials"] = {
        {{"name", "paint"}, {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}}};
    builder.document["meshes"][0]["primitives"][0]["material"] = 0;
    add_channel(builder, pointer_to("/materials/0/emissiveFactor"), {0, 1},
                is_spline ? std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, 2, 0.5F, 1, 9, 0, 0}
                          : std::vector<float>{0, 0, 0, 2, 0.5F, 1},
                "VEC3", is_spline ? "CUBICSPLINE" : "LINEAR");
    Scene scene = import(builder);
    pose_first(scene, 1.0);
    EXPECT_EQ(nth(scene.materials(), 0).emissive, glm::vec3(4.0F, 2.0F, 4.0F));
    pose_first(scene, 0.5);
    EXPECT_EQ(nth(scene.materials(), 0).emissive, glm::vec3(2.0F, 1.0F, 2.0F));
  }
}

// ---- Several animations ----

/** A file of one animation for each of the targets, whose values go from 0 to 1 in the first second. */
Scene with_animations_of(const std::vector<json> &targets)
{
  GltfBuilder builder = triangle_scene();
  builder.node({{"name", "other"}});
  builder.document["materials"] = {{{"name", "paint"}, {"emissiveFactor", {1, 1, 1}}}};
  builder.document["meshes"][0]["primitives"][0]["material"] = 0;
  json animations;
  for (const json &target : targets) {
    const bool is_strength = target.dump().find("emissiveStrength") != std::string::npos;
    builder.document["animations"] = json::array({json::object()});
    add_channel(builder, target, {0, 1},
                is_strength                    ? std::vector<float>{0, 4}
                : target["path"] == "rotation" ? std::vector<float>{0, 0, 0, 1, 0, 0, 1, 0}
                                               : std::vector<float>{0, 0, 0, 1, 1, 1},
                is_strength                    ? "SCALAR"
                : target["path"] == "rotation" ? "VEC4"
                                               : "VEC3");
    animations.push_back(builder.document["animations"][0]);
  }
  builder.document["animations"] = animations;
  return import(builder);
}

json node_path(int node, const std::string &path)
{
  return {{"node", node}, {"path", path}};
}

TEST(GltfAnimations, OfSeveralThingsArePlayedAsOne)
{
  Scene scene =
      with_animations_of({node_path(0, "translation"), node_path(0, "rotation"), node_path(1, "translation")});
  ASSERT_EQ(scene.animations.size(), 3U) << all_warnings(scene);
  scene::Animation all;
  for (const scene::Animation &one : std::vector(scene.animations)) {
    EXPECT_TRUE(scene::join(all, one));
  }
  EXPECT_EQ(all.nodes.size(), 2U);
  scene::pose(scene, all, 1.0);
  const glm::dmat4 &first = scene.nodes()[all.nodes[0].node].parent_from_node;
  EXPECT_EQ(glm::dvec3(first[3]), glm::dvec3(1.0));
  EXPECT_LT(glm::length(glm::dvec3(first[0]) - glm::dvec3(-1, 0, 0)), 1e-6) << "turned, too";
  EXPECT_EQ(glm::dvec3(scene.nodes()[all.nodes[1].node].parent_from_node[3]), glm::dvec3(1.0));
}

TEST(GltfAnimations, OfTheSameThingAreNotJoined)
{
  const std::vector<json> targets{node_path(0, "translation"), node_path(0, "scale"), node_path(1, "translation"),
                                  pointer_to("/materials/0/emissiveFactor")};
  for (const json &target : targets) {
    const Scene scene = with_animations_of({target, target});
    ASSERT_EQ(scene.animations.size(), 2U) << all_warnings(scene);
    scene::Animation all = scene.animations[0];
    EXPECT_FALSE(scene::join(all, scene.animations[1])) << target;
    EXPECT_EQ(all.nodes.size(), scene.animations[0].nodes.size());
    EXPECT_EQ(all.values.size(), scene.animations[0].values.size());
  }
}

TEST(GltfAnimations, OfBothFactorsOfEmissionAreTheirProduct)
{
  const json factor = pointer_to("/materials/0/emissiveFactor");
  const json strength = pointer_to("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength");
  for (const std::vector<json> &targets : {std::vector{factor, strength}, {strength, factor}}) {
    Scene scene = with_animations_of(targets);
    ASSERT_EQ(scene.animations.size(), 2U) << all_warnings(scene);
    scene::Animation all = scene.animations[0];
    EXPECT_TRUE(scene::join(all, scene.animations[1]));
    EXPECT_EQ(all.values.size(), 1U);
    scene::pose(scene, all, 0.5);
    EXPECT_EQ(nth(scene.materials(), 0).emissive, glm::vec3(1.0F));
  }
}

}  // namespace
}  // namespace gnomon::test
