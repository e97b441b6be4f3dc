// SPDX-License-Identifier: MIT
#include "gltf/gltf_check.hh"

#include <cctype>
#include <functional>

/**
 * Files that write the same scene in another way than most: each gives the same scene, with a warning where glTF
 * forbids the spelling, or a message that names the place and the reason.
 */
namespace gnomon::test {
namespace {

using scene::Scene;

void expect_triangle(const Scene &scene)
{
  ASSERT_EQ(scene.meshes().size(), 1U);
  EXPECT_EQ(nth(scene.meshes(), 0).positions,
            (std::vector<glm::vec3>{{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}}));
}

std::string replaced(std::string text, const std::string &from, const std::string &to)
{
  std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  for (; at != text.npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// ---- JSON ----

TEST(GltfSpelling, FaultsOfJsonAreNamedWithLineAndByte)
{
  const std::string start = "{\"asset\": {\"version\": \"2.0\"},\n ";
  const std::string at_line = "JSON: parse error: line 2, column 2 (byte " + std::to_string(start.size()) + "): found ";
  EXPECT_HAS(import_error(start + "// text\n \"nodes\": []}"), at_line + "a comment");
  EXPECT_HAS(import_error(start + "/* text */ \"nodes\": []}"), at_line + "a comment");
  EXPECT_HAS(import_error(start + "# text\n \"nodes\": []}"), at_line + "a comment");
  EXPECT_HAS(import_error(start + "nodes: []}"), at_line + "'nodes', where a name in double quotes must stand");
  EXPECT_HAS(import_error(start + "'nodes': []}"), at_line + "a single quote");
  EXPECT_HAS(import_error(start + "\xE9: []}"), at_line + "the byte 0xE9, which is not UTF-8");
  EXPECT_HAS(import_error(start + ", \"nodes\": []}"), at_line + "',', where a name in double quotes must stand");
  EXPECT_HAS(import_error(start + "\"nodes: []}"), at_line + "a string without an end");

  const auto value = [&](const std::string &text) { return import_error(start + "\"a\": [1,\n" + text + "]}"); };
  const std::string at_value =
      "JSON: parse error: line 3, column 1 (byte " + std::to_string(start.size() + 9) + "): found ";
  for (const char *word :
       {"NaN", "-NaN", "Infinity", "-Infinity", "nan", "inf", "01", "+1", ".5", "1.", "0x10", "1e", "-"}) {
    EXPECT_HAS(value(word), at_value + "'" + word + "', which is no number of JSON");
  }
  EXPECT_HAS(value("None"), at_value + "'None', where a value must stand");
  EXPECT_HAS(value("True"), at_value + "'True', where a value must stand");
  EXPECT_HAS(value("1e999"), at_value + "'1e999', a number too large for a double");
  const std::string in_string = replaced(at_value, "column 1 (byte " + std::to_string(start.size() + 9),
                                         "column 3 (byte " + std::to_string(start.size() + 11));
  EXPECT_HAS(value("\"a\xE9 b\""), in_string + "the byte 0xE9 in a string that is not UTF-8");
  EXPECT_HAS(value("\"a\xC3\x28\""), in_string + "the byte 0xC3 in a string that is not UTF-8");
  EXPECT_HAS(value("\"a\xED\xA0\x80\""), in_string + "the byte 0xED in a string that is not UTF-8");
  EXPECT_HAS(value("\"a\t\""), in_string + "the control character 0x09 in a string");
  EXPECT_HAS(value("\"a\n\""), in_string + "the control character 0x0A in a string");
  EXPECT_HAS(value("\"a\\x41\""), in_string + "'\\x', which is no escape of JSON");
  EXPECT_HAS(value("\"a\\u12G4\""), in_string + "'\\u12G4', which is no escape of JSON");
  EXPECT_HAS(value("\"a\\uD800\""), in_string + "'\\uD800', half of a surrogate pair");
}

TEST(GltfSpelling, LinesOfFaultsEndAsTheFilesDo)
{
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const std::string start = "{\"asset\":" + end + "{\"version\": \"2.0\"}," + end + end + "  \"a\": ";
    EXPECT_HAS(import_error(start + "NaN" + end + "}"),
               "line 4, column 8 (byte " + std::to_string(start.size()) + "): found 'NaN'");
  }
}

TEST(GltfSpelling, CommasAndEndsAreNamed)
{
  EXPECT_HAS(import_error("{\"a\": [1, 2,\n]}"), "line 1, column 12 (byte 11): found a comma before ']'");
  EXPECT_HAS(import_error("{\"a\": 1 ,\r\n }"), "line 1, column 9 (byte 8): found a comma before '}'");
  EXPECT_HAS(import_error("{\"a\": 1 \"b\": 2}"), "(byte 8): found '\"', where ',' or '}' must stand");
  EXPECT_HAS(import_error("{\"a\" 1}"), "(byte 5): found '1', where ':' must stand");
  EXPECT_HAS(import_error("{\"a\": [1, 2}"), "(byte 11): found '}', where ',' or ']' must stand");
  EXPECT_HAS(import_error("{\"a\": [1, 2]"), "(byte 12): found the end of the text, where ',' or '}' must stand");
  EXPECT_HAS(import_error("{\"a\": 1} x"), "(byte 9): found 'x', where the end must stand");
  EXPECT_HAS(import_error(""), "line 1, column 1 (byte 0): found the end of the text, where a value must stand");
  EXPECT_HAS(import_error(std::string("\xFF\xFE{\0}\0", 6)), "(byte 0): found the byte-order mark of UTF-16");
  // Longer than the depth of any stack.
  EXPECT_HAS(import_error(std::string(300000, '[') + "x"), "(byte 300000): found 'x'");
}

TEST(GltfSpelling, ByteOrderMarksAndZeroBytesAreReadWithAWarning)
{
  const std::string text = triangle_scene().gltf();
  const Scene marked = import_text("\xEF\xBB\xBF" + text);
  expect_triangle(marked);
  EXPECT_WARNING(marked, "JSON: begins with a byte-order mark");
  const Scene padded = import_text(text + std::string(3, '\0'));
  expect_triangle(padded);
  EXPECT_WARNING(padded, "JSON: zero bytes at its end are dropped: 3");
  EXPECT_HAS(import_error(std::string(8, '\0')), "(byte 0): found the control character 0x00");
}

TEST(GltfSpelling, WholeNumbersAreReadFromFloatsWithAWarning)
{
  const std::string plain = triangle_scene().gltf();
  std::string text;
  bool is_in_string = false;
  // Each whole number n becomes n.0.
  for (std::size_t i = 0; i < plain.size(); i++) {
    is_in_string = is_in_string != (plain[i] == '"');
    text += plain[i];
    const bool is_digit = std::isdigit(plain[i]) != 0;
    text += !is_in_string && is_digit && std::isdigit(plain[i + 1]) == 0 ? ".0" : "";
  }
  const Scene scene = import_text(text);
  expect_triangle(scene);
  EXPECT_WARNING(scene, "a whole number is written as a float");
  EXPECT_WARNING(import_text(replaced(plain, "5126", "5126.0")),
                 "accessors[0].componentType: a whole number is written as a float");
  expect_triangle(import_text(replaced(plain, "5126", "5.126e3")));
  expect_triangle(import_text(replaced(plain, "\"mesh\":0", "\"mesh\":-0.0")));
  EXPECT_HAS(import_error(replaced(plain, "5126", "5126.5")), "accessors[0].componentType: is 5126.5");
  EXPECT_HAS(import_error(replaced(plain, "5126", "-5126.0")), "accessors[0].componentType: is -5126");
  EXPECT_HAS(import_error(replaced(plain, "\"mesh\":0", "\"mesh\":1.0")), "index 1 is out of range");
  EXPECT_HAS(import_error(replaced(plain, "5126", "1e300")), "accessors[0].componentType: is 1e+300");
}

TEST(GltfSpelling, MembersThatStandTwiceAreNamedAndTheLastCounts)
{
  const std::string plain = triangle_scene().gltf();
  const Scene scene = import_text(replaced(plain, "\"name\":\"thing\"", "\"name\":\"first\",\"name\":\"thing\""));
  expect_triangle(scene);
  EXPECT_EQ(object_name(scene, 0), "thing");
  EXPECT_WARNING(scene, "nodes[0].name: stands twice in the object; the last counts");
  const Scene twice = import_text(replaced(plain, "\"scene\":0", "\"scene\":0,\"scene\":0"));
  EXPECT_WARNING(twice, "scene: stands twice in the document; the last counts");
}

// ---- Data URIs ----

Scene import_with_uri(const std::function<std::string(const std::string &base64)> &uri)
{
  GltfBuilder builder = triangle_scene();
  builder.document["buffers"] = {{{"byteLength", builder.bytes.size()}, {"uri", uri(base64(builder.bytes))}}};
  return import(builder);
}

TEST(GltfSpelling, DataUrisOfEachSpellingAreRead)
{
  for (const char *start :
       {"data:application/octet-stream;base64,", "DATA:application/octet-stream;BASE64,", "Data:;Base64,",
        "data:;base64,", "data:text/plain;charset=utf-8;base64,", "data:application/gltf-buffer; base64 ,",
        "data:a/b;base64;x=y,", "data:application%2Foctet-stream;base64,"}) {
    expect_triangle(import_with_uri([&](const std::string &data) { return start + data; }));
  }
  const std::string start = "data:;base64,";
  using Change = std::function<std::string(std::string)>;
  const auto escaped = [](const std::string &text, const char *format) {
    std::string result;
    for (const char character : text) {
      std::array<char, 8> buffer{};
      std::snprintf(buffer.data(), buffer.size(), format, unsigned(static_cast<unsigned char>(character)));
      result += buffer.data();
    }
    return result;
  };
  const std::vector<Change> changes{
      [&](const std::string &data) { return escaped(data, "%%%02X"); },
      [&](const std::string &data) { return escaped(data, "%%%02x"); },
      // The alphabet for URLs.
      [](std::string data) {
        std::ranges::replace(data, '+', '-');
        std::ranges::replace(data, '/', '_');
        return data;
      },
      // Mail breaks lines like this.
      [](const std::string &data) { return data.substr(0, 16) + "\r\n " + data.substr(16) + "\n"; },
      [](const std::string &data) { return data.substr(0, data.find('=')); },
      [](const std::string &data) { return data + "===="; }, [](const std::string &data) { return data + "%3D%3d"; }};
  for (const Change &change : changes) {
    expect_triangle(import_with_uri([&](const std::string &data) { return start + change(data); }));
  }
  // All digits of the alphabet.
  std::vector<unsigned char> all;
  for (int i = 0; i < 64; i++) {
    all.push_back(static_cast<unsigned char>(4 * i));
    all.push_back(static_cast<unsigned char>(i));
    all.push_back(static_cast<unsigned char>(255 - i));
  }
  EXPECT_HAS(base64(all), "+");
  EXPECT_HAS(base64(all), "/");
  // Bytes without base64: those of the triangle as escapes.
  expect_triangle(import_with_uri([&](const std::string &) {
    const GltfBuilder builder = triangle_scene();
    return "data:application/octet-stream," +
           escaped(std::string(builder.bytes.begin(), builder.bytes.end()), "%%%02X");
  }));
}

TEST(GltfSpelling, DataUrisThatAreDamagedAreNamed)
{
  const auto error_with = [](const std::string &uri) {
    GltfBuilder builder = triangle_scene();
    builder.document["buffers"] = {{{"byteLength", 36}, {"uri", uri}}};
    return import_error(builder);
  };
  EXPECT_HAS(error_with("data:a/b;base64"), "buffer 0: its data URI has no comma before the data");
  EXPECT_HAS(error_with("data:a/b;base64,AAAA*"), "buffer 0: its data URI is not base64");
  EXPECT_HAS(error_with("data:a/b;base64,AAAAA"), "buffer 0: its data URI is not base64");
  EXPECT_HAS(error_with("data:a/b,hello"), "buffer 0: is cut off: it says 36 bytes, but has 5");
}

// ---- GLB ----

std::string u32(std::size_t value)
{
  std::string text(4, '\0');
  for (std::size_t i = 0; i < 4; i++) {
    text[i] = char(value >> 8U * i & 0xFFU);
  }
  return text;
}

struct Chunk {
  std::string type;
  std::string content;
};

std::string glb_of(const std::vector<Chunk> &chunks, const std::string &rest = "")
{
  std::string body;
  for (const Chunk &chunk : chunks) {
    body += u32(chunk.content.size()) + chunk.type + chunk.content;
  }
  body += rest;
  return "glTF" + u32(2) + u32(12 + body.size()) + body;
}

TEST(GltfSpelling, ContainersOfEachWriterAreRead)
{
  GltfBuilder builder = triangle_scene();
  builder.document["buffers"] = {{{"byteLength", builder.bytes.size()}}};
  std::string text = builder.document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const Chunk json_chunk{"JSON", text};
  const Chunk binary{std::string("BIN\0", 4), std::string(builder.bytes.begin(), builder.bytes.end())};
  const Chunk other{"OTHR", "12345678"};
  const auto import_glb = [](const std::string &content) {
    Scene scene = import_text(content, "scene.glb");
    expect_triangle(scene);
    return scene;
  };
  EXPECT_NO_WARNING(import_glb(glb_of({json_chunk, binary})), "GLB");
  EXPECT_NO_WARNING(import_glb(glb_of({json_chunk, binary, other})), "GLB");
  EXPECT_WARNING(import_glb(glb_of({binary, json_chunk})), "is the JSON chunk, which must be the first");
  EXPECT_WARNING(import_glb(glb_of({other, json_chunk, binary})), "is the JSON chunk, which must be the first");
  EXPECT_WARNING(import_glb(glb_of({json_chunk, binary, json_chunk})), "is a second JSON chunk, which is not read");
  EXPECT_WARNING(import_glb(glb_of({json_chunk, binary, binary})), "is a second BIN chunk, which is not read");
  EXPECT_WARNING(import_glb(glb_of({json_chunk, binary}, "1234")), "bytes after the last chunk are not read: 4");
  EXPECT_WARNING(import_glb(glb_of({json_chunk, binary}) + "abc"), "bytes after the last chunk are not read: 3");
  EXPECT_WARNING(import_glb(glb_of({{"JSON", text + " "}, binary})), "is not a multiple of 4");
  for (const std::size_t count : {1, 2, 3, 4, 64}) {
    EXPECT_WARNING(import_glb(glb_of({{"JSON", text + std::string(count, '\0')}, binary})),
                   "JSON: zero bytes at its end are dropped: " + std::to_string(count));
  }
  EXPECT_WARNING(import_glb(glb_of({{"JSON", text + std::string(1, '\0') + "   "}, binary})),
                 "JSON: zero bytes at its end are dropped: 1");
  // The header's length ends before the chunks, within one, or is 0.
  const std::string whole = glb_of({json_chunk, binary});
  for (const std::size_t length : {std::size_t(0), std::size_t(24), 20 + text.size()}) {
    EXPECT_WARNING(import_glb(whole.substr(0, 8) + u32(length) + whole.substr(12)),
                   "GLB header: it says " + std::to_string(length) + " bytes");
  }
}

// ---- Extensions ----

TEST(GltfSpelling, ExtensionsThatAreNotReadAreNamedWhereverTheyStand)
{
  GltfBuilder builder = triangle_scene();
  json &d = builder.document;
  d["buffers"] = {
      {{"byteLength", builder.bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(builder.bytes)}}};
  d["materials"] = {{{"name", "paint"}, {"normalTexture", {{"index", 0}}}, {"pbrMetallicRoughness", json::object()}}};
  d["meshes"][0]["primitives"][0]["material"] = 0;
  d["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
  d["textures"] = {{{"source", 0}, {"sampler", 0}}};
  d["samplers"] = json::array({json::object()});
  d["images"] = {{{"uri", "a.png"}}};
  d["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  d["skins"] = {{{"joints", {0}}}};
  const int times = builder.accessor<float>({0, 1}, Float32, "SCALAR");
  const int values = builder.accessor<float>({0, 0, 0, 1, 1, 1}, Float32, "VEC3");
  d["buffers"][0] = {{"byteLength", builder.bytes.size()},
                     {"uri", "data:application/octet-stream;base64," + base64(builder.bytes)}};
  d["animations"] = {{{"samplers", {{{"input", times}, {"output", values}}}},
                      {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  builder.light({{"type", "point"}});
  const std::vector<std::pair<std::string, std::string>> places{
      {"", "extensions"},
      {"/asset", "asset"},
      {"/scenes/0", "scene 0"},
      {"/nodes/0", "node 'thing'"},
      {"/meshes/0", "mesh 'mesh'"},
      {"/meshes/0/primitives/0", "meshes[0].primitives[0]"},
      {"/materials/0", "material 'paint'"},
      {"/materials/0/normalTexture", "materials[0].normalTexture"},
      {"/materials/0/pbrMetallicRoughness", "materials[0].pbrMetallicRoughness"},
      {"/textures/0", "texture 0"},
      {"/samplers/0", "sampler 0"},
      {"/images/0", "image 0"},
      {"/cameras/0", "camera 0"},
      {"/cameras/0/perspective", "cameras[0].perspective"},
      {"/skins/0", "skin 0"},
      {"/accessors/0", "accessor 0"},
      {"/bufferViews/0", "bufferView 0"},
      {"/buffers/0", "buffer 0"},
      {"/animations/0", "animation 0"},
      {"/animations/0/samplers/0", "animations[0].samplers[0]"},
      {"/animations/0/channels/0", "animations[0].channels[0]"},
      {"/animations/0/channels/0/target", "animations[0].channels[0].target"},
      {"/extensions/KHR_lights_punctual/lights/0", "extensions.KHR_lights_punctual.lights[0]"},
      {"/materials/0/extensions/KHR_materials_unlit", "materials[0].extensions.KHR_materials_unlit"}};
  for (std::size_t i = 0; i < places.size(); i++) {
    GltfBuilder changed = builder;
    const auto &[pointer, name] = places[i];
    const std::string extension = "EXT_number_" + std::to_string(i);
    changed.document[json::json_pointer(pointer + "/extensions/" + extension)] = {{"a", 1}};
    EXPECT_WARNING(import(changed), name + ": " + extension + " is not read");
  }
  EXPECT_NO_WARNING(import(builder), "is not read");
  // Equal ones are counted.
  builder.node({{"mesh", 0}, {"extensions", {{"EXT_a", json::object()}}}});
  builder.node({{"mesh", 0}, {"extensions", {{"EXT_a", json::object()}}}});
  EXPECT_WARNING(import(builder), "node 2 and 1 other: EXT_a is not read (2 times)");
}

TEST(GltfVisibility, NodesAndTheirDescendantsAreHidden)
{
  GltfBuilder builder = triangle_scene();
  builder.document["nodes"][0]["extensions"]["KHR_node_visibility"] = {{"visible", false}};
  builder.document["extensionsRequired"] = {"KHR_node_visibility"};
  const Scene hidden = import(builder);
  EXPECT_TRUE(hidden.objects().empty());
  EXPECT_NO_WARNING(hidden, "KHR_node_visibility");
  builder.document["nodes"][0]["extensions"]["KHR_node_visibility"] = {{"visible", true}};
  EXPECT_EQ(import(builder).objects().size(), 1U);
  builder.document["nodes"][0]["extensions"]["KHR_node_visibility"] = json::object();
  EXPECT_EQ(import(builder).objects().size(), 1U) << "visible by default";
  // An ancestor hides it, whatever it says itself.
  builder.node({{"children", {0}}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
  builder.document["scenes"][0]["nodes"] = {1};
  EXPECT_TRUE(import(builder).objects().empty());
  builder.document["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = "no";
  EXPECT_HAS(import_error(builder), "KHR_node_visibility.visible: is \"no\", and must be true or false");
}

}  // namespace
}  // namespace gnomon::test
