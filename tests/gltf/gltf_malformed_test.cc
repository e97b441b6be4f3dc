// SPDX-License-Identifier: MIT
#include "gltf/gltf_check.hh"
#include "image_png.hh"

#include <cstdlib>
#include <functional>
#include <random>
#include <tuple>

namespace gnomon::test {
namespace {

using scene::Scene;

// ---- Files ----

TEST(GltfFile, MissingFileIsNamed)
{
  const TemporaryFolder folder;
  try {
    (void)gltf::import_gltf(folder.path() / "nowhere.glb");
    FAIL();
  }
  catch (const gltf::ImportError &error) {
    EXPECT_HAS(std::string(error.what()), "nowhere.glb: file: there is no such file");
  }
}

TEST(GltfFile, FolderIsNoFile)
{
  const TemporaryFolder folder;
  EXPECT_THROW((void)gltf::import_gltf(folder.path()), gltf::ImportError);
}

TEST(GltfFile, FilesOfOtherProgramsAreNamedWithAdvice)
{
  for (const auto &[name, content, format] : {std::tuple("a.blend", "BLENDER-v304RENDH", "Blender"),
                                              {"a.BLEND", "\x28\xB5\x2F\xFD packed", "Blender"},
                                              {"a.gltf", "BLENDER_v277", "Blender"},
                                              {"a.fbx", "Kaydara FBX Binary  ", "FBX"},
                                              {"a.Fbx", "; FBX 7.4.0 project file", "FBX"},
                                              {"a.glb", "Kaydara FBX Binary  ", "FBX"},
                                              {"a.obj", "# cube", "Wavefront OBJ"},
                                              {"a.usdz", "PK", "USD"},
                                              {"a.dae", "<?xml", "COLLADA"}}) {
    const std::string error = import_error(content, name);
    EXPECT_HAS(error, std::string("file: is of the format ") + format + ", and not glTF 2.0: ");
    EXPECT_HAS(error, "File > Export > glTF 2.0");
  }
  for (const std::string picture : {"v/1\x01", "\x89PNG\r\n", "\xFF\xD8\xFF", "#?RADIANCE\n"}) {
    EXPECT_HAS(import_error(picture, "a.exr"), "file: is a picture, and not glTF 2.0");
  }
  // The content decides.
  EXPECT_EQ(import_error(triangle_scene().gltf(), "a.blend"), "");
}

TEST(GltfFile, NotJson)
{
  EXPECT_HAS(import_error(""), "JSON: ");
  EXPECT_HAS(import_error("hello"), "JSON: parse error");
  EXPECT_HAS(import_error("[1, 2]"), "JSON: the document is not an object");
  EXPECT_HAS(import_error("{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [1e999]}"), "JSON: ");
  EXPECT_HAS(import_error("{\"asset\": {\"version\": \"2.0\", \"copyright\": \"\xC3\x28\"}}"), "JSON: ");
  EXPECT_HAS(import_error(std::string(1000000, '[')), "JSON: ");
}

TEST(GltfFile, DeepJsonInAForeignPlaceIsNoTrouble)
{
  const int depth = 1000000;
  const std::string deep = std::string(depth, '[') + std::string(depth, ']');
  EXPECT_EQ(import_error("{\"asset\": {\"version\": \"2.0\"}, \"extras\": " + deep + "}"), "");
  EXPECT_HAS(import_error("{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"mesh\": " + deep + "}]}"),
             "nodes[0].mesh: is an array");
}

TEST(GltfFile, OnlyVersionTwo)
{
  EXPECT_HAS(import_error("{}"), "asset: is missing");
  EXPECT_HAS(import_error("{\"asset\": {}}"), "asset.version: is ''");
  EXPECT_HAS(import_error("{\"asset\": {\"version\": \"1.0\"}}"), "asset.version: is '1.0', and only glTF 2.0 is read");
}

TEST(GltfFile, GlbHeaderIsChecked)
{
  const std::string glb = triangle_scene().glb();
  const auto changed = [&](std::size_t at, char value) {
    std::string result = glb;
    result[at] = value;
    return import_error(result, "scene.glb");
  };
  EXPECT_HAS(import_error(glb.substr(0, 10), "scene.glb"), "GLB header: the file is cut off");
  EXPECT_HAS(import_error(glb.substr(0, glb.size() - 4), "scene.glb"), "GLB header: the file is cut off");
  EXPECT_HAS(changed(4, 1), "GLB header: version 1");
  EXPECT_HAS(changed(15, 0x7F), "GLB chunk: runs past the end");
  EXPECT_HAS(changed(16, 'X'), "GLB: has no JSON chunk");
}

TEST(GltfFile, BuffersAreChecked)
{
  const auto error_with = [](const json &buffer) {
    GltfBuilder builder = triangle_scene();
    builder.document["buffers"] = json::array({buffer});
    return import_error(builder);
  };
  EXPECT_HAS(error_with({{"byteLength", 36}, {"uri", "missing.bin"}}), "buffer 0 'missing.bin': there is no such file");
  EXPECT_HAS(error_with({{"byteLength", 36}, {"uri", "."}}), "buffer 0 '.': is not a file");
  EXPECT_HAS(error_with({{"byteLength", 36}, {"uri", "../../../../../../dev/zero"}}), "buffer 0");
  EXPECT_HAS(error_with({{"byteLength", 36}, {"uri", "/etc/passwd"}}), "is not a file beside the scene");
  EXPECT_HAS(error_with({{"byteLength", 36}, {"uri", "http://a/b.bin"}}), "is not a file beside the scene");
  EXPECT_HAS(error_with({{"byteLength", 36}, {"uri", "$(touch x)`touch y`"}}), "there is no such file");
  EXPECT_HAS(error_with({{"byteLength", 36}, {"uri", "data:a/b;base64,????"}}), "buffer 0: its data URI is not base64");
  EXPECT_HAS(error_with({{"byteLength", 36}, {"uri", "data:a/b;base64,AAAA"}}),
             "buffer 0: is cut off: it says 36 bytes, but has 3");
  EXPECT_HAS(error_with({{"byteLength", -1}, {"uri", "x"}}), "buffers[0].byteLength: is -1");
  EXPECT_HAS(error_with({{"byteLength", 36}}), "buffer 0 holds no data");
}

// ---- Indices and types ----

/** The error for a small scene after \a change. */
std::string error_after(const std::function<void(json &)> &change)
{
  GltfBuilder builder = triangle_scene();
  builder.document["materials"] = {{{"name", "paint"}}};
  builder.document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  change(builder.document);
  return import_error(builder);
}

TEST(GltfFile, EveryIndexIsChecked)
{
  EXPECT_EQ(error_after([](json &) {}), "");
  EXPECT_HAS(error_after([](json &d) { d["scene"] = 7; }), "scene: index 7 is out of range: the file has 1 scenes");
  EXPECT_HAS(error_after([](json &d) { d["scenes"][0]["nodes"] = {9}; }), "scenes[0].nodes[0]: index 9");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["children"] = {4}; }), "nodes[0].children[0]: index 4");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["mesh"] = 1; }),
             "nodes[0].mesh: index 1 is out of range: the file has 1 meshes");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["camera"] = 1; }), "nodes[0].camera: index 1");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["skin"] = 0; }), "nodes[0].skin: index 0");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; }),
             "KHR_lights_punctual.light: index 0");
  EXPECT_HAS(error_after([](json &d) { d["meshes"][0]["primitives"][0]["material"] = 1; }),
             "meshes[0].primitives[0].material: index 1");
  EXPECT_HAS(error_after([](json &d) { d["meshes"][0]["primitives"][0]["indices"] = 1; }),
             "meshes[0].primitives[0].indices: index 1");
  EXPECT_HAS(error_after([](json &d) { d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 1; }),
             "attributes.POSITION: index 1");
  EXPECT_HAS(error_after([](json &d) { d["accessors"][0]["bufferView"] = 1; }), "accessors[0].bufferView: index 1");
  EXPECT_HAS(error_after([](json &d) {
               d["bufferViews"][0]["buffer"] = 1;
               d["buffers"] = json::array();
             }),
             "bufferViews[0].buffer: index 1");
  // Its lower 32 bits are 0.
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["mesh"] = 4294967296; }),
             "nodes[0].mesh: is 4294967296, and must be an index");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["mesh"] = -1; }), "nodes[0].mesh: is -1, and must be an index");
}

TEST(GltfFile, EveryTypeIsChecked)
{
  EXPECT_HAS(error_after([](json &d) { d["nodes"] = 3; }), "nodes: is 3, and must be an array");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0] = 3; }), "nodes[0]: is 3, and must be an object");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["mesh"] = "a"; }),
             "nodes[0].mesh: is \"a\", and must be an index");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["name"] = 1; }), "nodes[0].name: is 1, and must be a string");
  EXPECT_HAS(error_after([](json &d) {
               d["nodes"][0]["matrix"] = {1, 2};
             }),
             "nodes[0].matrix: is an array, and must be an array of 16 numbers");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["translation"] = {1, "x", 2}; }), "nodes[0].translation");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["children"] = 1; }),
             "nodes[0].children: is 1, and must be an array of indices");
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["extensions"] = 1; }), "nodes[0].extensions: is 1");
  EXPECT_HAS(error_after([](json &d) { d["meshes"][0]["primitives"][0].erase("attributes"); }),
             "meshes[0].primitives[0]: has no attributes");
  EXPECT_HAS(error_after([](json &d) { d["accessors"][0]["count"] = -3; }), "accessors[0].count: is -3");
  EXPECT_HAS(error_after([](json &d) { d["accessors"][0]["sparse"] = json::object(); }),
             "accessors[0].sparse: has no indices");
  EXPECT_HAS(error_after([](json &d) { d["materials"][0]["doubleSided"] = 1; }),
             "materials[0].doubleSided: is 1, and must be true or false");
  EXPECT_HAS(error_after([](json &d) {
               d["materials"][0]["pbrMetallicRoughness"] = {{"metallicFactor", "x"}};
             }),
             "metallicFactor: is \"x\", and must be a number");
  EXPECT_HAS(error_after([](json &d) { d["cameras"][0]["perspective"]["yfov"] = "x"; }), "cameras[0].perspective.yfov");
  EXPECT_HAS(error_after([](json &d) { d["extensionsRequired"] = {1}; }), "extensionsRequired[0]: is 1");
  EXPECT_HAS(error_after([](json &d) { d["extensionsRequired"] = {{"a", 1}}; }), "extensionsRequired: is an object");
}

TEST(GltfFile, PropertiesThatGltfRequiresAreChecked)
{
  EXPECT_HAS(error_after([](json &d) { d["accessors"][0].erase("type"); }), "glTF: ");
  EXPECT_HAS(error_after([](json &d) { d["cameras"][0]["type"] = "fisheye"; }), "glTF: Invalid camera type");
  EXPECT_HAS(error_after([](json &d) { d["bufferViews"][0]["byteStride"] = 3; }), "glTF: Invalid `byteStride'");
}

TEST(GltfNodes, CyclesAndSecondParentsAreErrors)
{
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["children"] = {0}; }), "node 'thing': is its own ancestor");
  EXPECT_HAS(error_after([](json &d) {
               d["nodes"].push_back({{"children", {2}}});
               d["nodes"].push_back({{"children", {1}}});
             }),
             "node 1: is its own ancestor");
  EXPECT_HAS(error_after([](json &d) {
               d["nodes"].push_back({{"name", "a"}, {"children", {0}}});
               d["nodes"].push_back({{"name", "b"}, {"children", {0}}});
             }),
             "node 'thing': has two parents, node 'a' and node 'b'");
}

TEST(GltfNodes, OfASceneAreDrawnOnceWhereItListsThemTwiceOrWithTheirParents)
{
  const auto nodes_after = [](const std::function<void(json &)> &change, const std::string &warning) {
    GltfBuilder builder = triangle_scene();
    builder.document["nodes"].push_back({{"name", "a"}, {"children", {0}}, {"translation", {1, 2, 3}}});
    builder.document["nodes"].push_back({{"name", "b"}, {"children", {1}}});
    change(builder.document);
    const Scene scene = import(builder);
    EXPECT_WARNING(scene, "node 'thing': is " + warning);
    EXPECT_EQ(scene.objects().size(), 1);
    return std::pair(scene.nodes().size(), glm::vec3(scene.objects().begin()->world_from_object[3]));
  };
  using Result = std::pair<std::size_t, glm::vec3>;
  // With the camera and the lamp that are added.
  const Scene plain = import(triangle_scene());
  const std::size_t count = plain.nodes().size();
  const glm::vec3 place(plain.objects().begin()->world_from_object[3]);
  EXPECT_EQ(nodes_after([](json &d) { d["scenes"][0]["nodes"] = {0}; },
                        "a root of the scene, but also a child of node 'a': it is drawn without that node"),
            Result(count, place));
  for (const json &listed : {json{0, 2}, json{2, 0}}) {
    EXPECT_EQ(nodes_after([&](json &d) { d["scenes"][0]["nodes"] = listed; },
                          "a root of the scene, but also a child of node 'a': it is drawn below that node alone"),
              Result(count + 2, place + glm::vec3(1, 2, 3)));
  }
  EXPECT_EQ(nodes_after(
                [](json &d) {
                  d["scenes"][0]["nodes"] = {0, 0};
                },
                "twice a root of the scene"),
            Result(count, place));
}

// ---- Accessors ----

/** Imports a valid triangle and a second one that \a change has damaged. Its accessors: positions 1, indices 2. */
Scene import_beside(const std::function<void(json &)> &change)
{
  GltfBuilder builder = triangle_scene();
  const int positions = builder.positions(triangle_positions);
  const int indices = builder.accessor(std::vector<std::uint8_t>{0, 1, 2}, Uint8, "SCALAR");
  const int mesh = builder.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}}, "bad");
  builder.node({{"mesh", mesh}});
  change(builder.document);
  return import(builder);
}

void expect_left_out(const std::function<void(json &)> &change, const std::string &reason)
{
  const Scene scene = import_beside(change);
  EXPECT_EQ(scene.objects().size(), 1U);
  EXPECT_WARNING(scene, "mesh 'bad': primitive left out: " + reason);
}

TEST(GltfAccessor, IncompleteElementsAreErrors)
{
  EXPECT_EQ(import_beside([](json &) {}).objects().size(), 2U);
  expect_left_out([](json &d) { d["accessors"][1]["count"] = 4; },
                  "accessor 1: runs past the end of bufferView 1: count is 4");
  expect_left_out([](json &d) { d["accessors"][1]["count"] = 18446744073709551615ULL; }, "accessor 1: runs past");
  expect_left_out([](json &d) { d["accessors"][1]["count"] = 1537228672809129302ULL; }, "accessor 1: runs past");
  expect_left_out([](json &d) { d["accessors"][1]["byteOffset"] = 4; }, "accessor 1: runs past");
  expect_left_out([](json &d) { d["accessors"][1]["byteOffset"] = 18446744073709551612ULL; },
                  "accessor 1: begins past");
  expect_left_out([](json &d) { d["bufferViews"][1]["byteLength"] = 1000; },
                  "accessor 1: bufferView 1 runs past the end of buffer 0");
  expect_left_out([](json &d) { d["bufferViews"][1]["byteOffset"] = 18446744073709551612ULL; },
                  "accessor 1: bufferView 1 runs past");
  expect_left_out([](json &d) { d["bufferViews"][1]["byteStride"] = 4; },
                  "accessor 1: byteStride 4 is below the size of an element");
  expect_left_out([](json &d) { d["bufferViews"][1]["byteStride"] = 16; }, "accessor 1: runs past");
  expect_left_out([](json &d) { d["accessors"][1]["componentType"] = 5130; },
                  "accessor 1: componentType 5130 is not one of glTF 2.0");
  expect_left_out([](json &d) { d["accessors"][1]["type"] = "VEC2"; }, "accessor 1: must be a VEC3");
  expect_left_out([](json &d) { d["accessors"][2]["type"] = "VEC2"; }, "accessor 2: must be a SCALAR");
  expect_left_out([](json &d) { d["accessors"][2]["componentType"] = 5120; }, "indices: are not unsigned integers");
  expect_left_out(
      [](json &d) {
        d["accessors"][1].erase("bufferView");
        d["accessors"][1]["count"] = 1000000000;
      },
      "accessor 1: count 1000000000 is too large for an accessor without bufferView");
  expect_left_out([](json &d) { d["meshes"][1]["primitives"][0]["attributes"].erase("POSITION"); },
                  "POSITION: is missing");
}

TEST(GltfAccessor, NoElementsMakeNoTriangles)
{
  // Zeros (glTF 2.0, 3.6.2.1).
  EXPECT_WARNING(import_beside([](json &d) { d["accessors"][1].erase("bufferView"); }),
                 "mesh 'bad': triangle left out: it has no area");
  const Scene scene = import_beside([](json &d) { d["accessors"][1]["count"] = 0; });
  EXPECT_EQ(scene.objects().size(), 1U);
  EXPECT_WARNING(scene, "mesh 'bad': triangle left out: a vertex index is out of range");
  expect_left_out([](json &d) { d["accessors"][2]["count"] = 0; }, "POSITION: makes no triangle");
}

TEST(GltfAccessor, SparseIsChecked)
{
  const auto with_sparse = [](int count, const json &indices, const json &values) {
    return [=](json &d) { d["accessors"][1]["sparse"] = {{"count", count}, {"indices", indices}, {"values", values}}; };
  };
  const json values = {{"bufferView", 0}};
  const json indices = {{"bufferView", 2}, {"componentType", 5121}};
  EXPECT_EQ(import_beside(with_sparse(3, indices, values)).objects().size(), 2U);
  expect_left_out(with_sparse(4, indices, values), "accessor 1: sparse.count 4 is above count");
  expect_left_out(with_sparse(3, {{"bufferView", 2}, {"componentType", 5125}}, values),
                  "accessor 1: its sparse indices run past");
  expect_left_out(with_sparse(3, indices, {{"bufferView", 2}}), "accessor 1: its sparse values run past");
  // The bytes of 1.0F are not ascending, so they are invalid sparse indices.
  expect_left_out(with_sparse(3, {{"bufferView", 0}, {"componentType", 5121}}, values),
                  "accessor 1: its sparse indices do not ascend");
}

TEST(GltfImport, VertexIndexOutOfRangeLosesItsTriangle)
{
  GltfBuilder builder;
  const int positions = builder.positions(triangle_positions);
  const int indices =
      builder.accessor(std::vector<std::uint32_t>{0, 1, 2, 0, 1, 3, 0xFFFFFFFFU, 1, 2}, Uint32, "SCALAR");
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
  const Scene scene = import(builder);
  EXPECT_EQ(nth(scene.meshes(), 0).indices.size(), 3U);
  EXPECT_WARNING(scene, "mesh 'mesh': triangle left out: a vertex index is out of range (2 times)");
}

TEST(GltfImport, NonFiniteVertexLosesItsTriangle)
{
  GltfBuilder builder;
  const float inf = INFINITY;
  const int positions = builder.positions({0, 0, 0, 1,   0, 0, 0, 1, 0, 0, 0, 0, NAN,   0, 0, 0, 1, 0,
                                           0, 0, 0, inf, 0, 0, 0, 1, 0, 0, 0, 0, 1e30F, 0, 0, 0, 1, 0});
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}})}});
  const Scene scene = import(builder);
  EXPECT_EQ(nth(scene.meshes(), 0).indices.size(), 3U);
  EXPECT_WARNING(scene, "mesh 'mesh': triangle left out: a position is not finite or beyond 1e12 m (3 times)");
}

TEST(GltfImport, TriangleWithoutAreaIsLeftOut)
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 1, 2, 2, 2});
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}})}});
  const Scene scene = import(builder);
  EXPECT_EQ(nth(scene.meshes(), 0).indices.size(), 3U);
  EXPECT_WARNING(scene, "mesh 'mesh': triangle left out: it has no area");
}

TEST(GltfImport, FileWithoutUsableContentIsAnErrorWithTheReason)
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, NAN, 0, 0, 0, 1, 0});
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}})}});
  EXPECT_HAS(import_error(builder),
             "scene: nothing in it can be drawn: mesh 'mesh': triangle left out: a position is not finite");
  // Messages about other elements follow.
  builder.document["animations"] = {{{"samplers", {{{"input", positions}, {"output", positions}}}},
                                     {"channels", {{{"sampler", 0}, {"target", {{"path", "translation"}}}}}}}};
  builder.document["nodes"][0]["extras"] = {{"gnomon_energy", 1}};
  EXPECT_HAS(import_error(builder),
             "scene: nothing in it can be drawn: mesh 'mesh': triangle left out: a position is not finite");
  // A node is lost without its mesh being read.
  builder.document["nodes"][0]["translation"] = {1e30, 0, 0};
  EXPECT_HAS(import_error(builder), "scene: nothing in it can be drawn: node 0: left out: its own matrix or that");
}

TEST(GltfImport, PrimitivesOfAnUnknownCompressionAreLeftOutIfTheRestCanBeDrawn)
{
  const auto compress = [](json &document, int mesh, int positions, int indices) {
    document["extensionsRequired"] = {"EXT_other_compression"};
    document["meshes"][mesh]["primitives"][0]["extensions"]["EXT_other_compression"] = {{"bufferView", 0}};
    document["accessors"][positions].erase("bufferView");
    document["accessors"][indices].erase("bufferView");
  };
  const Scene scene = import_beside([&](json &document) { compress(document, 1, 1, 2); });
  EXPECT_EQ(scene.objects().size(), 1U);
  EXPECT_WARNING(scene, "extensionsRequired: EXT_other_compression is not supported");
  EXPECT_WARNING(scene, "mesh 'bad': primitive left out: POSITION: is compressed by EXT_other_compression");

  GltfBuilder alone;
  const int positions = alone.positions(triangle_positions);
  const int indices = alone.accessor(std::vector<std::uint8_t>{0, 1, 2}, Uint8, "SCALAR");
  alone.node({{"mesh", alone.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
  compress(alone.document, 0, positions, indices);
  EXPECT_HAS(import_error(alone), "nothing in it can be drawn, and it requires EXT_other_compression");
}

TEST(GltfImport, BufferOfAnUnknownExtensionHasNoData)
{
  GltfBuilder builder = triangle_scene();
  builder.document["buffers"] = {{{"byteLength", builder.bytes.size()}}};
  builder.document["extensionsRequired"] = {"EXT_other"};
  EXPECT_HAS(import_error(builder),
             "it requires EXT_other: mesh 'mesh': primitive left out: accessor 0: buffer 0 holds no data");
}

TEST(SlowGltfImport, WorkIsLimitedForSmallFiles)
{
  // A thousand primitives share one long index accessor: a small file, but a scene of 10^9 triangles.
  GltfBuilder builder;
  const int positions = builder.positions(triangle_positions);
  std::vector<std::uint8_t> long_list(1000000, 7);
  const int indices = builder.accessor(long_list, Uint8, "SCALAR");
  json primitives = json::array();
  for (int i = 0; i < 1000; i++) {
    primitives.push_back({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  }
  builder.append("meshes", {{"primitives", primitives}});
  builder.node({{"mesh", 0}});
  EXPECT_HAS(import_error(builder.glb(), "scene.glb"), "scene: has more than 268435456 vertices and indices");
}

TEST(GltfImport, TheLimitOfVerticesIsAnOption)
{
  const std::string triangle = triangle_scene().gltf();
  EXPECT_HAS(import_error(triangle, "scene.gltf", {.element_count_max = 2}),
             "scene: has more than 2 vertices and indices");
  EXPECT_EQ(import_error(triangle, "scene.gltf", {.element_count_max = 6}), "");
}

TEST(SlowGltfImport, ObjectsAreLimited)
{
  GltfBuilder builder;
  const json primitive = {{"attributes", {{"POSITION", builder.positions(triangle_positions)}}}};
  builder.append("meshes", {{"primitives", json(2200, primitive)}});
  for (int i = 0; i < 2000; i++) {
    builder.node({{"mesh", 0}});
  }
  EXPECT_HAS(import_error(builder), "scene: has more than 4194304 objects");
}

TEST(GltfImport, NamesCannotBreakAMessage)
{
  GltfBuilder builder = triangle_scene();
  // GCC 14 would warn of bounds in "a\nb" + std::string(...).
  builder.light({{"type", "point"}}, {{"gnomon_radius", -1}}, {{"name", std::string("a\nb").append(999, 'x')}});
  const std::string error = import_error(builder);
  EXPECT_HAS(error, "lamp 'a?bxxx");
  EXPECT_LT(error.size(), 200U);
  EXPECT_HAS(error_after([](json &d) { d["nodes"][0]["name"] = std::string(1025, 'x'); }),
             "nodes[0].name: is longer than 1024 bytes");
}

// ---- Random damage ----

/** A scene with all kinds of content. */
GltfBuilder rich_scene()
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  const int normals = builder.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, Float32, "VEC3");
  const int indices = builder.accessor(std::vector<std::uint16_t>{0, 1, 2, 2, 1, 3}, Uint16, "SCALAR");
  const int places = builder.view(std::vector<std::uint8_t>{0, 2});
  const int values = builder.view(std::vector<float>{0, 0, 1, 0, 1, 1});
  const int sparse = builder.accessor(triangle_positions, Float32, "VEC3",
                                      {{"sparse",
                                        {{"count", 2},
                                         {"indices", {{"bufferView", places}, {"componentType", 5121}}},
                                         {"values", {{"bufferView", values}}}}}});
  builder.append("materials",
                 {{"name", "paint"},
                  {"alphaMode", "MASK"},
                  {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"metallicFactor", 0}}},
                  {"extensions", {{"KHR_materials_specular", {{"specularColorFactor", {0, 0, 0}}}}}}});
  builder.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}, {"material", 0}});
  builder.mesh({{"attributes", {{"POSITION", sparse}}}, {"mode", 5}});
  builder.node({{"name", "a"}, {"mesh", 0}, {"rotation", {0, 0, 0.6, 0.8}}, {"scale", {1, 2, 3}}});
  builder.node({{"name", "b"}, {"mesh", 1}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 4, 5, 1}}});
  builder.document["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}, {"zfar", 10}}}}};
  builder.node({{"name", "eye"}, {"camera", 0}, {"translation", {0, 0, 9}}});
  builder.light({{"type", "spot"}, {"intensity", 100}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}},
                {{"gnomon_radius", 0.1}, {"gnomon_spot_blend", 0.5}});
  builder.light({{"type", "directional"}, {"color", {1, 1, 0.5}}}, {{"gnomon_angle", 0.1}});
  builder.node(
      {{"name", "panel"},
       {"extras", {{"gnomon_lamp", "area"}, {"gnomon_shape", "disk"}, {"gnomon_size_x", 2}, {"gnomon_power", 9}}}});
  const int sky = builder.accessor(std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 1, 2}, Float32, "VEC3");
  json &scene = builder.document["scenes"][0];
  scene["extras"] = {{"gnomon_world_accessor", sky},
                     {"gnomon_world_width", 2},
                     {"gnomon_world_color", {1, 2, 3}},
                     {"gnomon_world_strength", 2},
                     {"gnomon_world_rotation", 1}};
  // Used if the extras are not.
  const std::vector<std::uint8_t> texel{1, 2, 3, 4};
  builder.append("images", {{"bufferView", builder.view(image::png_file(1, 1, 4, texel))}});
  builder.document["extensions"]["EXT_lights_image_based"]["lights"] = {
      {{"rotation", {0, 0.6, 0, 0.8}}, {"intensity", 2}, {"specularImages", {{0, 0, 0, 0, 0, 0}}}}};
  scene["extensions"]["EXT_lights_image_based"]["light"] = 0;
  return builder;
}

/** Changes a few bytes, or cuts off the end. */
std::string mutated(const std::string &original, std::mt19937 &random)
{
  std::string result = original;
  const auto below = [&random](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  if (below(16) == 0) {
    result.resize(below(result.size()));
    return result;
  }
  const std::size_t change_count = 1 + below(4);
  for (std::size_t i = 0; i < change_count; i++) {
    const std::size_t at = below(result.size());
    switch (below(4)) {
      case 0: result[at] = static_cast<char>(below(256)); break;
      case 1: result[at] = static_cast<char>(result[at] ^ static_cast<char>(1U << below(8))); break;
      case 2: {
        // Digits become other digits, so that the JSON stays valid more often.
        constexpr std::string_view characters = "0123456789-.e\"[]{},:";
        result[at] = characters[below(characters.size())];
        break;
      }
      default: result.erase(at, 1 + below(8));
    }
    if (result.empty()) {
      break;
    }
  }
  return result;
}

void expect_survives(const std::string &original, const std::string &name, int count)
{
  const TemporaryFolder folder;
  std::mt19937 random(20261121);
  int kept = 0;
  for (int i = 0; i < count; i++) {
    const std::filesystem::path path = folder.write(name, mutated(original, random));
    try {
      expect_valid(gltf::import_gltf(path));
      kept++;
    }
    catch (const gltf::ImportError &) {
    }
    if (::testing::Test::HasFailure()) {
      // Keep the file for analysis.
      std::filesystem::copy_file(path, std::filesystem::temp_directory_path() / ("gnomon_fuzz_" + name),
                                 std::filesystem::copy_options::overwrite_existing);
      FAIL() << "mutation " << i << ", kept in " << std::filesystem::temp_directory_path();
    }
  }
  // Otherwise the mutations would test only the JSON parser.
  EXPECT_GT(kept, count / 50);
}

TEST(GltfFuzz, MutatedGltfImportsOrFailsCleanly)
{
  expect_survives(rich_scene().gltf(), "scene.gltf", 4000);
}

TEST(GltfFuzz, MutatedGlbImportsOrFailsCleanly)
{
  expect_survives(rich_scene().glb(), "scene.glb", 4000);
}

/** Replaces one value in the document by an unusual one. The JSON stays valid, so that deeper layers are tested. */
void replace_some_value(json &value, std::mt19937 &random)
{
  const json odd = {nullptr,
                    true,
                    -1,
                    0,
                    1,
                    7,
                    255,
                    4294967296,
                    18446744073709551615ULL,
                    1e300,
                    -1e300,
                    1e-300,
                    0.5,
                    "",
                    "SCALAR",
                    "VEC3",
                    json::array(),
                    json::object(),
                    json{1, 2, 3},
                    json{0},
                    json{{"index", 0}},
                    5121,
                    5126,
                    5130};
  const auto below = [&random](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  json *place = &value;
  while (place->is_structured() && !place->empty() && (place == &value || below(6) != 0)) {
    place = &*std::next(place->begin(), static_cast<json::difference_type>(below(place->size())));
  }
  *place = odd[below(odd.size())];
}

TEST(GltfFuzz, OddValuesAnywhereImportOrFailCleanly)
{
  const GltfBuilder original = rich_scene();
  const TemporaryFolder folder;
  std::mt19937 random(7);
  int kept = 0;
  for (int i = 0; i < 6000; i++) {
    GltfBuilder builder = original;
    if (i % 2 == 0) {
      builder.document["scenes"][0].erase("extras");
    }
    replace_some_value(builder.document, random);
    const std::filesystem::path path = folder.write("scene.gltf", builder.gltf());
    try {
      expect_valid(gltf::import_gltf(path));
      kept++;
    }
    catch (const gltf::ImportError &) {
    }
    ASSERT_FALSE(::testing::Test::HasFailure()) << builder.document.dump();
  }
  EXPECT_GT(kept, 300);
}

TEST(GltfModels, AssimpModelsImportOrFailWithAReason)
{
  const std::filesystem::path root = "/usr/share/assimp/models";
  if (!std::filesystem::exists(root)) {
    if (std::getenv("CI") != nullptr) {
      FAIL() << "the package assimp-testmodels is not installed";
    }
    GTEST_SKIP() << "the package assimp-testmodels is not installed";
  }
  int ok_count = 0;
  int error_count = 0;
  for (const char *folder : {"glTF", "glTF2"}) {
    for (const auto &entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      if (entry.path().extension() != ".gltf" && entry.path().extension() != ".glb") {
        continue;
      }
      SCOPED_TRACE(entry.path());
      try {
        expect_valid(gltf::import_gltf(entry.path()));
        ok_count++;
      }
      catch (const gltf::ImportError &error) {
        EXPECT_HAS(std::string(error.what()), entry.path().string() + ": ");
        error_count++;
      }
    }
  }
  // Version 5.2.5 of the package. The failing files are glTF 1.0, intentionally invalid, or contain only points and
  // lines.
  EXPECT_GE(ok_count, 25);
  EXPECT_LE(error_count, 27);
}

}  // namespace
}  // namespace gnomon::test
