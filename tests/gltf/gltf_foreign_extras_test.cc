// SPDX-License-Identifier: MIT
#include "gltf/gltf_check.hh"
#include "gltf_export.hh"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

namespace gnomon::test {
namespace {

using scene::Node;
using scene::Scene;

// Numbers that no float or 64-bit integer has, nested values, and text that is not ASCII, plain and escaped.
const std::string rich =
    R"({"big":123456789012345678901234567890,"far":1e300,"fine":0.10000000000000000001,"max":18446744073709551615,)"
    R"("näme\n\"é":"Ünïcode 漢字 \u00e9\ud83d\ude00","nested":{"list":[1,[2,{"a":null}],true,""],"gnomon_deep":-0.0}})";

/** A file with a thing of each kind that keeps extras; each has \a extras. */
json file_with(const json &extras)
{
  GltfBuilder builder;
  const int positions = builder.positions(triangle_positions);
  const json primitive = {{"attributes", {{"POSITION", positions}}}, {"material", 0}};
  json document = json::parse(builder.gltf());
  document["extras"] = extras;
  document["scene"] = 0;
  document["scenes"] = json::array({{{"nodes", {0, 1, 2}}, {"extras", extras}}});
  document["materials"] = json::array({{{"name", "paint"}, {"extras", extras}}});
  document["meshes"] = json::array({{{"name", "body"}, {"primitives", {primitive, primitive}}, {"extras", extras}}});
  document["cameras"] = json::array({{{"name", "eye"}, {"type", "perspective"}, {"extras", extras}}});
  document["cameras"][0]["perspective"] = {{"yfov", 1}, {"znear", 0.1}};
  json light = {{"name", "sun"}, {"type", "directional"}, {"extras", extras}};
  document["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light});
  document["nodes"] = {{{"name", "box"}, {"mesh", 0}, {"extras", extras}},
                       {{"name", "stand"}, {"camera", 0}, {"extras", extras}},
                       {{"name", "lamp"}, {"extras", extras}}};
  document["nodes"][2]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  return document;
}

/** The same with the text \a extras, which nlohmann's numbers could not hold. */
std::string text_with(const std::string &extras)
{
  const std::string mark = "\"<extras>\"";
  std::string text = file_with("<extras>").dump();
  for (std::size_t at = text.find(mark); at != text.npos; at = text.find(mark, at + extras.size())) {
    text.replace(at, mark.size(), extras);
  }
  return text;
}

/** The extras of all things, each with its kind. */
std::vector<std::pair<std::string, std::string>> all_extras(const Scene &scene)
{
  std::vector<std::pair<std::string, std::string>> all = {{"file", scene.file_extras}, {"scene", scene.extras}};
  const auto add = [&](const auto &pool) {
    for (const auto &[handle, thing] : pool) {
      all.emplace_back(fmt::format("{} {}", thing.kind_name, thing.name), thing.extras);
    }
  };
  add(scene.nodes());
  add(scene.meshes());
  add(scene.materials());
  add(scene.cameras());
  add(scene.lamps());
  return all;
}

std::string file_text(const std::filesystem::path &path)
{
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/** The file that \a scene is written to. */
std::string written(const Scene &scene)
{
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "written.gltf";
  gltf::export_gltf(scene, path);
  EXPECT_EQ(gltf::left_out_of_export(path), "");
  return file_text(path);
}

std::size_t count_of(const std::string &text, const std::string &part)
{
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + part.size())) {
    count++;
  }
  return count;
}

TEST(GltfForeignExtras, OfEachThingAreKeptAsTheyAreWritten)
{
  const TemporaryFolder folder;
  const std::string spaced = " { \"big\" : " + rich.substr(7, rich.size() - 8) + "\n\t} ";
  for (const std::string &extras : {rich, spaced}) {
    const std::filesystem::path path = folder.write("rich.gltf", text_with(extras));
    EXPECT_EQ(gltf::left_out_of_export(path), "");
    const Scene scene = gltf::import_gltf(path);
    expect_valid(scene);
    EXPECT_EQ(all_extras(scene).size(), 2U + 3 + 2 + 1 + 1 + 1);
    for (const auto &[kind, kept] : all_extras(scene)) {
      EXPECT_EQ(kept, rich) << kind;
    }
    // The primitives have those of their mesh.
    EXPECT_EQ(count_of(written(scene), rich), 9U);
    for (const char *name : {"copy.gltf", "copy.glb"}) {
      gltf::export_gltf(scene, folder.path() / name);
      EXPECT_EQ(all_extras(gltf::import_gltf(folder.path() / name)), all_extras(scene)) << name;
    }
  }
}

TEST(GltfForeignExtras, StandBesideThoseOfGnomonWhichFollowEdits)
{
  json document = file_with({{"gnomon_visible", false}, {"price", 3}, {"gnomon_unknown", 1}});
  document["nodes"][1]["extras"] = {{"gnomon_shift_x", 0.25}, {"price", 3}};
  document["nodes"][2]["extras"] = {{"gnomon_angle", 0.5}, {"price", 3}};
  document["materials"][0]["extras"] = {{"gnomon_thickness", 0.5}, {"price", 3}};
  document["scenes"][0]["extras"] = {{"gnomon_world", {0.5, 1, 1}}, {"price", 3}};
  Scene scene = import_text(document.dump());
  for (const auto &[kind, kept] : all_extras(scene)) {
    EXPECT_EQ(kept, R"({"price":3})") << kind;
  }
  json again = json::parse(written(scene));
  EXPECT_EQ(again["nodes"][0]["extras"], (json{{"gnomon_visible", false}, {"price", 3}}));
  EXPECT_EQ(again["nodes"][1]["extras"], (json{{"gnomon_shift_x", 0.25}, {"price", 3}}));
  EXPECT_EQ(again["nodes"][2]["extras"], (json{{"gnomon_angle", 0.5}, {"price", 3}}));
  EXPECT_TRUE(again["scenes"][0]["extras"].contains("gnomon_world")) << again["scenes"];
  EXPECT_EQ(again["scenes"][0]["extras"]["price"], 3);
  const auto box = (*scene.nodes().begin()).handle;
  scene.edit(box, [](Node &node) {
    node.is_visible = true;
    node.extras = R"({"gnomon_visible": false, "price": 4})";
  });
  EXPECT_EQ(json::parse(written(scene))["nodes"][0]["extras"], (json{{"price", 4}}));
}

TEST(GltfForeignExtras, FollowCopiesAndComeBackWithWhatWasRemoved)
{
  Scene scene = import_text(text_with(rich));
  const auto box = (*scene.nodes().begin()).handle;
  const Node node = scene.nodes()[box];
  const std::string before = written(scene);
  scene.add(Node(node));
  EXPECT_EQ(count_of(written(scene), rich), 10U);
  scene.remove(box);
  // The copy has the mesh and its material.
  EXPECT_EQ(count_of(written(scene), rich), 9U);
  Scene other = import_text(text_with(rich));
  const auto first = (*other.nodes().begin()).handle;
  other.remove(first);
  EXPECT_EQ(count_of(written(other), rich), 6U);
  other.restore(first, node, {}, {});
  EXPECT_EQ(all_extras(other), all_extras(import_text(text_with(rich))));
}

TEST(GltfForeignExtras, OfALampThatBecomesAnAreaAreWrittenToItsNode)
{
  json document = file_with(json::object());
  document["nodes"][2]["extras"] = {{"id", 1}};
  document["extensions"]["KHR_lights_punctual"]["lights"][0]["extras"] = {{"id", 2}, {"maker", "m"}};
  Scene scene = import_text(document.dump());
  scene.edit((*scene.lamps().begin()).handle, [](scene::Lamp &lamp) { lamp.kind = scene::LampKind::Area; });
  const json extras = json::parse(written(scene))["nodes"][2]["extras"];
  EXPECT_EQ(extras["id"], 1);
  EXPECT_EQ(extras["maker"], "m");
  EXPECT_EQ(extras["gnomon_lamp"], "area");
}

TEST(GltfForeignExtras, OfMeshesWithTheSameTrianglesStayApart)
{
  json document = file_with(json::object());
  document["meshes"].push_back(document["meshes"][0]);
  document["meshes"][0]["extras"] = {{"part", 1}};
  document["meshes"][1]["extras"] = {{"part", 2}};
  document["nodes"][1]["mesh"] = 1;
  const json again = json::parse(written(import_text(document.dump())));
  EXPECT_EQ(again["meshes"][0]["extras"], (json{{"part", 1}}));
  EXPECT_EQ(again["meshes"][1]["extras"], (json{{"part", 2}}));
}

TEST(GltfForeignExtras, ThatAreNotKeptAreNamed)
{
  const TemporaryFolder folder;
  const auto left_out = [&](const json &document) {
    return gltf::left_out_of_export(folder.write("some.gltf", document.dump()));
  };
  const json foreign = {{"by", "hand"}};
  json document = file_with(foreign);
  document["scenes"].push_back({{"extras", foreign}});
  EXPECT_EQ(left_out(document), "extra 'by' of scene 1");
  document["scene"] = 1;
  EXPECT_EQ(left_out(document), "extra 'by' of scene 0");
  document = file_with(foreign);
  document["meshes"][0]["primitives"][0]["extras"] = foreign;
  document["accessors"][0]["extras"] = foreign;
  document["asset"]["extras"] = foreign;
  document["materials"][0]["pbrMetallicRoughness"]["extras"] = foreign;
  document["cameras"][0]["perspective"]["extras"] = foreign;
  EXPECT_EQ(left_out(document), "extra 'by' of asset and 4 others");
  document = file_with(json::array({1}));
  EXPECT_EQ(left_out(document), "extra of extensions.KHR_lights_punctual.lights[0] and 8 others");
  EXPECT_EQ(all_extras(import_text(document.dump())).front().second, "");
}

TEST(GltfForeignExtras, AreAtMost64MiBAlsoWhereThingsShareThem)
{
  json document = file_with(json::object());
  document["extensions"]["KHR_lights_punctual"]["lights"][0]["extras"] = {{"text", std::string(1U << 20U, 'x')}};
  document["nodes"][0]["extras"] = {{"a", 1}};
  for (int i = 3; i < 103; i++) {
    document["nodes"].push_back(document["nodes"][2]);
    document["scenes"][0]["nodes"].push_back(i);
  }
  const Scene scene = import_text(document.dump());
  EXPECT_EQ(scene.lamps().size(), 101U);
  std::size_t kept = 0;
  for (const auto &[handle, lamp] : scene.lamps()) {
    kept += lamp.extras.empty() ? 0U : 1U;
  }
  EXPECT_EQ(kept, 63U) << "each has some bytes more than a MiB";
  EXPECT_WARNING(scene, "left out: those of all things have more than 64 MiB (38 times)");
  // A file whose own text has more.
  const TemporaryFolder folder;
  const std::string large = R"({"text":")" + std::string(65U << 20U, 'x') + R"("})";
  const std::filesystem::path path =
      folder.write("large.gltf", R"({"asset":{"version":"2.0"},"materials":[{"extras":)" + large + "}]}");
  EXPECT_EQ(gltf::left_out_of_export(path), "extra 'text' of material 0");
}

TEST(GltfForeignExtras, OfAHostAreWrittenIfTheyAreAnObject)
{
  Scene scene;
  const auto node = scene.add(Node{.name = "chair"});
  const TemporaryFolder folder;
  for (const std::string text : {"{", "[1]", "3", "{\"a\": }", "{\"a\": 1} 2", "{\"a\": \"\xFF\"}", " "}) {
    scene.edit(node, [&](Node &value) { value.extras = text; });
    try {
      gltf::export_gltf(scene, folder.path() / "bad.gltf");
      ADD_FAILURE() << text;
    }
    catch (const gltf::ExportError &error) {
      EXPECT_HAS(std::string(error.what()), "node 'chair': its extras are not a JSON object");
    }
  }
  const std::string deep = "{\"a\":" + std::string(5000, '[') + std::string(5000, ']') + '}';
  scene.edit(node, [&](Node &value) { value.extras = deep; });
  EXPECT_EQ(count_of(written(scene), deep), 1U);
  scene.edit(node, [&](Node &value) { value.extras = " {} "; });
  EXPECT_EQ(count_of(written(scene), "extras"), 0U);
}

TEST(GltfForeignExtras, OfAHostKeepTheCameraAndTheLampThatTheImporterAdded)
{
  GltfBuilder builder;
  const Scene scene = import_text(builder.gltf());
  ASSERT_TRUE(scene.is_camera_default && scene.is_lamp_default);
  EXPECT_EQ(count_of(written(scene), "extras"), 0U);
  const std::string extras = R"({"by":"host"})";
  for (const auto &[handle, node] : scene.nodes()) {
    Scene edited = scene;
    edited.edit(handle, [&](Node &value) { value.extras = extras; });
    EXPECT_EQ(count_of(written(edited), extras), 1U) << (node.camera ? "node of the camera" : "node of the lamp");
  }
  Scene edited = scene;
  edited.edit((*scene.cameras().begin()).handle, [&](scene::Camera &camera) { camera.extras = extras; });
  edited.edit((*scene.lamps().begin()).handle, [&](scene::Lamp &lamp) { lamp.extras = extras; });
  EXPECT_EQ(count_of(written(edited), extras), 2U);
}

TEST(GltfForeignExtras, OfMembersThatStandBeforeOnesOfAnotherTypeDoNotCount)
{
  const std::string text = file_with({{"last", 4}}).dump();
  for (const std::string first :
       {R"("nodes":5)", R"("nodes":[5])", R"("meshes":{})", R"("extras":[])", R"("extensions":[1])",
        R"("extensions":{"KHR_lights_punctual":null})", R"("extensions":{"KHR_lights_punctual":{"lights":{}}})",
        R"("nodes":[{"extras":{"first":1}}],"nodes":"")"}) {
    const Scene scene = import_text('{' + first + ',' + text.substr(1));
    for (const auto &[kind, kept] : all_extras(scene)) {
      EXPECT_EQ(kept, R"({"last":4})") << first << ": " << kind;
    }
  }
}

TEST(GltfForeignExtras, OfMembersThatDoNotCountTakeNoRoom)
{
  const std::string large = fmt::format(R"({{"text":"{}"}})", std::string(40U << 20U, 'x'));
  const std::string materials = R"("materials":[{"extras":)" + large + "}]";
  const TemporaryFolder folder;
  const std::filesystem::path path =
      folder.write("twice.gltf", R"({"asset":{"version":"2.0"},)" + materials + ',' + materials + '}');
  EXPECT_EQ(gltf::left_out_of_export(path), "");
}

TEST(GltfForeignExtras, OfMaterialsForLinesCountAgain)
{
  json document = file_with(json::object());
  document["materials"][0]["extras"] = {{"text", std::string(40U << 20U, 'x')}};
  document["meshes"][0]["primitives"][1]["mode"] = 0;
  const Scene scene = import_text(document.dump());
  ASSERT_EQ(scene.materials().size(), 2U);
  std::size_t kept = 0;
  for (const auto &[handle, material] : scene.materials()) {
    kept += material.extras.empty() ? 0U : 1U;
  }
  EXPECT_EQ(kept, 1U);
  EXPECT_WARNING(scene, "left out: those of all things have more than 64 MiB");
}

TEST(GltfForeignExtras, OfTheLastOfTwoMembersCount)
{
  std::string text = file_with("<extras>").dump();
  text = R"({"nodes": [{"extras": {"first": 1}}, {"extras": {"first": 2}}],)" + text.substr(1);
  const std::string mark = R"("extras":"<extras>")";
  for (std::size_t at = text.find(mark); at != text.npos; at = text.find(mark)) {
    text.replace(at, mark.size(), R"("extras":{"first":3},"extras":{"last":4})");
  }
  const Scene scene = import_text(text);
  for (const auto &[kind, kept] : all_extras(scene)) {
    EXPECT_EQ(kept, R"({"last":4})") << kind;
  }
}

}  // namespace
}  // namespace gnomon::test
