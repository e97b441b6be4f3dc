// SPDX-License-Identifier: MIT
#include "gltf/gltf_check.hh"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <numbers>
#include <random>

/** Compressed and quantised meshes, and instances, compared with their uncompressed form. */
namespace gnomon::test {
namespace {

using scene::Mesh;
using scene::Scene;

/** A wavy sheet of 17 x 17 vertices over [0, 1]², with uv = (x, y). */
struct Sheet {
  static constexpr int edge = 17;
  std::vector<float> positions;
  std::vector<float> normals;
  std::vector<float> uvs;
  std::vector<std::uint32_t> indices;

  Sheet()
  {
    for (int y = 0; y < edge; y++) {
      for (int x = 0; x < edge; x++) {
        const float u = float(x) / float(edge - 1);
        const float v = float(y) / float(edge - 1);
        const float slope = 0.2F * std::cos(6.0F * u);
        const glm::vec3 normal = glm::normalize(glm::vec3(-6.0F * slope, 0.0F, 1.0F));
        positions.insert(positions.end(), {u, v, 0.2F * std::sin(6.0F * u)});
        normals.insert(normals.end(), {normal.x, normal.y, normal.z});
        uvs.insert(uvs.end(), {u, v});
      }
    }
    for (int y = 0; y + 1 < edge; y++) {
      for (int x = 0; x + 1 < edge; x++) {
        const auto at = [&](int dx, int dy) { return std::uint32_t((y + dy) * edge + x + dx); };
        const std::array quad{at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)};
        indices.insert(indices.end(), quad.begin(), quad.end());
      }
    }
  }
  [[nodiscard]] std::size_t vertex_count() const
  {
    return positions.size() / 3;
  }
};

/** A material with a texture, because uvs are read only for one. */
int textured_material(GltfBuilder &builder)
{
  builder.append("images", {{"uri",
                             "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR4"
                             "2mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg=="}});
  builder.append("textures", {{"source", 0}});
  return builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
}

GltfBuilder plain_sheet(const Sheet &sheet)
{
  GltfBuilder builder;
  const int material = textured_material(builder);
  const json attributes = {{"POSITION", builder.positions(sheet.positions)},
                           {"NORMAL", builder.accessor(sheet.normals, Float32, "VEC3")},
                           {"TEXCOORD_0", builder.accessor(sheet.uvs, Float32, "VEC2")}};
  const int indices = builder.accessor(sheet.indices, Uint32, "SCALAR");
  builder.node({{"mesh", builder.mesh({{"attributes", attributes}, {"indices", indices}, {"material", material}})}});
  return builder;
}

double area(const Mesh &mesh)
{
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 a(mesh.positions[mesh.indices[i]]);
    const glm::dvec3 b(mesh.positions[mesh.indices[i + 1]]);
    const glm::dvec3 c(mesh.positions[mesh.indices[i + 2]]);
    sum += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return sum;
}

/** Largest distance of a vertex of \a mesh from the sheet, of its uv from (x, y), and of its normal from the sheet's.
 */
float error_of(const Mesh &mesh)
{
  float error = 0.0F;
  for (std::size_t i = 0; i < mesh.positions.size(); i++) {
    const glm::vec3 p = mesh.positions[i];
    const glm::vec3 normal = glm::normalize(glm::vec3(-1.2F * std::cos(6.0F * p.x), 0.0F, 1.0F));
    error = std::max({error, std::abs(p.z - 0.2F * std::sin(6.0F * p.x)), glm::distance(normal, mesh.normals[i]),
                      glm::distance(glm::vec2(p), mesh.uvs[i])});
  }
  return error;
}

/** Replaces a buffer view by its meshopt form. */
void compress(GltfBuilder &builder, int accessor, const std::string &mode, std::size_t stride,
              const std::string &filter = "NONE", const std::vector<unsigned char> &filtered = {})
{
  json &view = builder.document["bufferViews"][builder.document["accessors"][accessor]["bufferView"].get<int>()];
  const std::size_t count = builder.document["accessors"][accessor]["count"];
  const unsigned char *bytes =
      filtered.empty() ? builder.bytes.data() + view["byteOffset"].get<std::size_t>() : filtered.data();
  std::vector<unsigned char> encoded;
  if (mode == "ATTRIBUTES") {
    encoded.resize(meshopt_encodeVertexBufferBound(count, stride));
    encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), bytes, count, stride));
  }
  else {
    std::vector<unsigned> indices(count);
    std::memcpy(indices.data(), bytes, count * sizeof(unsigned));
    encoded.resize(meshopt_encodeIndexBufferBound(count, count) + meshopt_encodeIndexSequenceBound(count, count));
    encoded.resize(mode == "TRIANGLES"
                       ? meshopt_encodeIndexBuffer(encoded.data(), encoded.size(), indices.data(), count)
                       : meshopt_encodeIndexSequence(encoded.data(), encoded.size(), indices.data(), count));
  }
  const std::size_t offset = builder.bytes.size();
  builder.bytes.insert(builder.bytes.end(), encoded.begin(), encoded.end());
  view = {{"buffer", 1}, {"byteLength", count * stride}};
  if (mode == "ATTRIBUTES") {
    view["byteStride"] = stride;
  }
  view["extensions"]["EXT_meshopt_compression"] = {
      {"buffer", 0},  {"byteOffset", offset}, {"byteLength", encoded.size()}, {"byteStride", stride}, {"count", count},
      {"mode", mode}, {"filter", filter}};
}

/** Adds the fallback buffer, which has no bytes, after the buffer of bytes. */
std::string with_fallback(GltfBuilder builder)
{
  builder.document["extensionsRequired"] = {"EXT_meshopt_compression"};
  builder.document["buffers"] = {
      {{"byteLength", builder.bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(builder.bytes)}},
      {{"byteLength", 1U << 20U}}};
  return builder.gltf();
}

/** POSITION, NORMAL, TEXCOORD_0 and indices are accessors 0 to 3. */
GltfBuilder meshopt_sheet(const Sheet &sheet, const std::string &index_mode = "TRIANGLES")
{
  GltfBuilder builder = plain_sheet(sheet);
  compress(builder, 0, "ATTRIBUTES", 12);
  compress(builder, 1, "ATTRIBUTES", 12);
  compress(builder, 2, "ATTRIBUTES", 8);
  compress(builder, 3, index_mode, 4);
  return builder;
}

void expect_equal(const Mesh &a, const Mesh &b)
{
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.uvs, b.uvs);
}

TEST(GltfMeshopt, VerticesAreThoseOfThePlainForm)
{
  const Sheet sheet;
  const Scene plain = import(plain_sheet(sheet));
  for (const char *mode : {"TRIANGLES", "INDICES"}) {
    const Scene scene = import_text(with_fallback(meshopt_sheet(sheet, mode)));
    EXPECT_TRUE(scene.warnings.size() == plain.warnings.size()) << scene.warnings.back();
    expect_equal(nth(scene.meshes(), 0), nth(plain.meshes(), 0));
    // The triangle codec may rotate a triangle's corners.
    EXPECT_NEAR(area(nth(scene.meshes(), 0)), area(nth(plain.meshes(), 0)), 1e-9);
    EXPECT_EQ(nth(scene.meshes(), 0).indices.size(), sheet.indices.size());
  }
}

TEST(GltfMeshopt, FiltersAreDecoded)
{
  const Sheet sheet;
  GltfBuilder builder = plain_sheet(sheet);
  std::vector<float> normals4;
  for (std::size_t i = 0; i < sheet.vertex_count(); i++) {
    normals4.insert(normals4.end(), {sheet.normals[3 * i], sheet.normals[3 * i + 1], sheet.normals[3 * i + 2], 0.0F});
  }
  std::vector<unsigned char> octahedral(sheet.vertex_count() * 8);
  meshopt_encodeFilterOct(octahedral.data(), sheet.vertex_count(), 8, 16, normals4.data());
  std::vector<unsigned char> exponential(sheet.vertex_count() * 12);
#if MESHOPTIMIZER_VERSION < 190
  meshopt_encodeFilterExp(exponential.data(), sheet.vertex_count(), 12, 23, sheet.positions.data());
#else
  meshopt_encodeFilterExp(exponential.data(), sheet.vertex_count(), 12, 23, sheet.positions.data(),
                          meshopt_EncodeExpSharedVector);
#endif
  compress(builder, 0, "ATTRIBUTES", 12, "EXPONENTIAL", exponential);
  compress(builder, 1, "ATTRIBUTES", 8, "OCTAHEDRAL", octahedral);
  builder.document["accessors"][1].update({{"componentType", int(Int16)}, {"normalized", true}});
  const Scene scene = import_text(with_fallback(builder));
  // 16 bits for each coordinate of the octahedron, 23 for the mantissa.
  EXPECT_LT(error_of(nth(scene.meshes(), 0)), 2e-4F);
}

TEST(GltfMeshopt, DamagedDataIsNamedAndNeverRead)
{
  const Sheet sheet;
  const GltfBuilder builder = meshopt_sheet(sheet);
  const auto edited = [&](int view, const json &patch) {
    GltfBuilder other = builder;
    other.document["bufferViews"][view]["extensions"]["EXT_meshopt_compression"].update(patch);
    return import_error(with_fallback(other));
  };
  const std::size_t length = builder.document["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["byteLength"];
  for (const std::size_t cut : {std::size_t(0), std::size_t(1), length / 2, length - 1}) {
    EXPECT_HAS(edited(0, {{"byteLength", cut}}), "holds no data");
  }
  EXPECT_HAS(edited(0, {{"byteLength", 1U << 30U}}), "holds no data");
  EXPECT_HAS(edited(0, {{"count", 1U << 30U}}), "holds no data");
  EXPECT_HAS(edited(0, {{"byteStride", 13}}), "holds no data");
  EXPECT_HAS(edited(0, {{"byteStride", 0}}), "holds no data");
  EXPECT_HAS(edited(0, {{"mode", "OTHER"}}), "holds no data");
  EXPECT_HAS(edited(1, {{"filter", "QUATERNION"}}), "");
  EXPECT_HAS(edited(3, {{"count", 100}}), "");
}

/** The sheet's Draco form, with all attributes quantised to 16 bits. */
std::vector<char> draco_bytes(const Sheet &sheet, int method)
{
  draco::TriangleSoupMeshBuilder soup;
  soup.Start(int(sheet.indices.size() / 3));
  const int position = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = soup.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const int uv = soup.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  for (std::size_t i = 0; i < sheet.indices.size(); i += 3) {
    const draco::FaceIndex face(std::uint32_t(i / 3));
    const std::array corner{sheet.indices[i], sheet.indices[i + 1], sheet.indices[i + 2]};
    soup.SetAttributeValuesForFace(position, face, &sheet.positions[3 * corner[0]], &sheet.positions[3 * corner[1]],
                                   &sheet.positions[3 * corner[2]]);
    soup.SetAttributeValuesForFace(normal, face, &sheet.normals[3 * corner[0]], &sheet.normals[3 * corner[1]],
                                   &sheet.normals[3 * corner[2]]);
    soup.SetAttributeValuesForFace(uv, face, &sheet.uvs[2 * corner[0]], &sheet.uvs[2 * corner[1]],
                                   &sheet.uvs[2 * corner[2]]);
  }
  const std::unique_ptr<draco::Mesh> mesh = soup.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  for (const auto attribute :
       {draco::GeometryAttribute::POSITION, draco::GeometryAttribute::NORMAL, draco::GeometryAttribute::TEX_COORD}) {
    encoder.SetAttributeQuantization(attribute, 16);
  }
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

/** Accessors without views: the compressed mesh has the data. */
GltfBuilder draco_sheet(const Sheet &sheet, const std::vector<char> &bytes)
{
  GltfBuilder builder;
  const int material = textured_material(builder);
  const auto accessor = [&](const char *type, std::size_t count, Component component) {
    return builder.append("accessors", {{"componentType", int(component)}, {"count", count}, {"type", type}});
  };
  const json attributes = {{"POSITION", accessor("VEC3", sheet.vertex_count(), Float32)},
                           {"NORMAL", accessor("VEC3", sheet.vertex_count(), Float32)},
                           {"TEXCOORD_0", accessor("VEC2", sheet.vertex_count(), Float32)}};
  const int indices = accessor("SCALAR", sheet.indices.size(), Uint16);
  const json draco = {{"bufferView", builder.view(bytes)},
                      {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}};
  builder.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  builder.node({{"mesh", builder.mesh({{"attributes", attributes},
                                       {"indices", indices},
                                       {"material", material},
                                       {"extensions", {{"KHR_draco_mesh_compression", draco}}}})}});
  return builder;
}

TEST(GltfDraco, SurfaceIsThatOfThePlainForm)
{
  const Sheet sheet;
  const Mesh plain = nth(import(plain_sheet(sheet)).meshes(), 0);
  for (const int method : {int(draco::MESH_SEQUENTIAL_ENCODING), int(draco::MESH_EDGEBREAKER_ENCODING)}) {
    const Scene scene = import(draco_sheet(sheet, draco_bytes(sheet, method)));
    const Mesh &mesh = nth(scene.meshes(), 0);
    EXPECT_EQ(mesh.indices.size(), plain.indices.size());
    EXPECT_NEAR(area(mesh), area(plain), 1e-4);
    // 16 bits of the unit cube and of the octahedron.
    EXPECT_LT(error_of(mesh), 3e-4F);
  }
}

TEST(GltfDraco, PrimitivesThatShareTheDataAreOneMesh)
{
  const Sheet sheet;
  GltfBuilder builder = draco_sheet(sheet, draco_bytes(sheet, draco::MESH_EDGEBREAKER_ENCODING));
  json second = builder.document["meshes"][0];
  builder.node({{"mesh", builder.append("meshes", second)}});
  const Scene scene = import(builder);
  EXPECT_EQ(scene.meshes().size(), 1U);
  EXPECT_EQ(scene.objects().size(), 2U);
}

TEST(GltfDraco, PlainDataIsUsedWhereTheCompressedIsDamaged)
{
  const Sheet sheet;
  GltfBuilder builder = plain_sheet(sheet);
  builder.document["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
  const Scene scene = import(builder);
  EXPECT_WARNING(scene, "mesh 'mesh': its compressed form cannot be decoded: KHR_draco_mesh_compression: ");
  EXPECT_LT(error_of(nth(scene.meshes(), 0)), 1e-6F);
}

TEST(GltfDraco, DamagedDataIsNamedAndBounded)
{
  const Sheet sheet;
  for (const int method : {int(draco::MESH_SEQUENTIAL_ENCODING), int(draco::MESH_EDGEBREAKER_ENCODING)}) {
    const std::vector<char> whole = draco_bytes(sheet, method);
    for (std::size_t cut = 1; cut < whole.size(); cut += 1 + whole.size() / 20) {
      EXPECT_HAS(import_error(draco_sheet(sheet, {whole.begin(), whole.begin() + std::ptrdiff_t(cut)})),
                 "nothing in it can be drawn");
    }
    // Any byte may be wrong. The import must end with a valid scene or an error.
    std::mt19937 random(7);
    for (int round = 0; round < 60; round++) {
      std::vector<char> damaged = whole;
      for (int i = 0; i < 3; i++) {
        damaged[5 + random() % (round % 2 == 0 ? 40 : damaged.size() - 5)] = char(random());
      }
      (void)import_error(draco_sheet(sheet, damaged));
    }
  }
}

TEST(GltfDraco, VertexCountIsLimitedByTheDataSize)
{
  const Sheet sheet;
  const std::vector<char> whole = draco_bytes(sheet, draco::MESH_SEQUENTIAL_ENCODING);
  // Two numbers of two bytes follow the header: faces and points.
  constexpr std::ptrdiff_t header_size = 11;
  const std::vector<char> billion{'\xFF', '\xFF', '\xFF', '\xFF', '\x03'};
  for (const int number : {0, 1}) {
    std::vector<char> bomb = whole;
    const auto at = bomb.begin() + header_size + 2 * number;
    bomb.insert(bomb.erase(at, at + 2), billion.begin(), billion.end());
    EXPECT_HAS(import_error(draco_sheet(sheet, bomb)), "nothing in it can be drawn");
  }
}

TEST(GltfDraco, CountsOtherThanTheAccessorsAreRefused)
{
  const Sheet sheet;
  GltfBuilder builder = draco_sheet(sheet, draco_bytes(sheet, draco::MESH_EDGEBREAKER_ENCODING));
  builder.document["accessors"][0]["count"] = 7;
  EXPECT_HAS(import_error(builder), "nothing in it can be drawn");
  builder.document["accessors"][0]["count"] = sheet.vertex_count();
  builder.document["accessors"][0]["type"] = "VEC2";
  EXPECT_HAS(import_error(builder), "nothing in it can be drawn");
}

TEST(GltfQuantized, VerticesAreWithinTheStepOfThePlainForm)
{
  const Sheet sheet;
  GltfBuilder builder;
  const int material = textured_material(builder);
  std::vector<std::uint16_t> positions;
  std::vector<std::int8_t> normals;
  std::vector<std::uint16_t> uvs;
  for (std::size_t i = 0; i < sheet.vertex_count(); i++) {
    // z in [-0.2, 0.2] becomes [0, 0.4]. Elements are aligned to 4 bytes.
    positions.insert(positions.end(), {std::uint16_t(std::lround(65535.0F * sheet.positions[3 * i])),
                                       std::uint16_t(std::lround(65535.0F * sheet.positions[3 * i + 1])),
                                       std::uint16_t(std::lround(65535.0F * (sheet.positions[3 * i + 2] + 0.2F))), 0});
    for (std::size_t k = 0; k < 3; k++) {
      normals.push_back(std::int8_t(std::lround(127.0F * sheet.normals[3 * i + k])));
    }
    normals.push_back(0);
    uvs.insert(uvs.end(), {std::uint16_t(std::lround(65535.0F * sheet.uvs[2 * i])),
                           std::uint16_t(std::lround(65535.0F * sheet.uvs[2 * i + 1]))});
  }
  const auto accessor = [&](int view, Component component, const char *type) {
    return builder.append("accessors", {{"bufferView", view},
                                        {"componentType", int(component)},
                                        {"normalized", true},
                                        {"count", sheet.vertex_count()},
                                        {"type", type}});
  };
  const json attributes = {{"POSITION", accessor(builder.view(positions, 8), Uint16, "VEC3")},
                           {"NORMAL", accessor(builder.view(normals, 4), Int8, "VEC3")},
                           {"TEXCOORD_0", accessor(builder.view(uvs, 4), Uint16, "VEC2")}};
  const int indices = builder.accessor(sheet.indices, Uint32, "SCALAR");
  builder.document["extensionsRequired"] = {"KHR_mesh_quantization"};
  builder.node({{"mesh", builder.mesh({{"attributes", attributes}, {"indices", indices}, {"material", material}})},
                {"translation", {0, 0, -0.2}}});
  const Scene scene = import(builder);
  Mesh mesh = nth(scene.meshes(), 0);
  for (glm::vec3 &position : mesh.positions) {
    position.z -= 0.2F;
  }
  // Normals have 8 bits: half a step in each of three coordinates, plus the error of normalising.
  EXPECT_LT(error_of(mesh), 0.01F);
  EXPECT_NEAR(area(mesh), area(nth(import(plain_sheet(sheet)).meshes(), 0)), 1e-3);
}

TEST(GltfInstances, HaveTheMatricesOfEquivalentNodes)
{
  GltfBuilder builder = triangle_scene();
  const int translation = builder.accessor(std::vector<float>{1, 2, 3, -4, 5, -6}, Float32, "VEC3");
  const int scale = builder.accessor(std::vector<float>{1, 1, 1, 2, 3, 4}, Float32, "VEC3");
  const float half = std::numbers::sqrt2_v<float> / 2.0F;
  const int rotation = builder.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, half, half}, Float32, "SCALAR");
  builder.document["accessors"][rotation].update({{"type", "VEC4"}, {"count", 2}});
  builder.document["nodes"][0].update({{"translation", {10, 0, 0}}});
  const json attributes = {{"TRANSLATION", translation}, {"ROTATION", rotation}, {"SCALE", scale}};
  builder.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
  const Scene scene = import(builder);
  const auto objects = scene.objects();
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_EQ(scene.meshes().size(), 1U);
  const auto world = [&](std::size_t i) { return scene.world_from_node(objects[i].node); };
  EXPECT_EQ(glm::vec3(world(0)[3]), glm::vec3(11, 2, 3));
  EXPECT_EQ(glm::vec3(world(1)[3]), glm::vec3(6, 5, -6));
  // A quarter turn about Z maps x to y.
  EXPECT_LT(glm::distance(glm::vec3(world(1)[0]), glm::vec3(0, 2, 0)), 1e-6F);
  EXPECT_LT(glm::distance(glm::vec3(world(1)[1]), glm::vec3(-3, 0, 0)), 1e-6F);
  EXPECT_LT(glm::distance(glm::vec3(world(1)[2]), glm::vec3(0, 0, 4)), 1e-6F);
}

TEST(GltfInstances, AreMovedByMorphTargets)
{
  GltfBuilder builder = triangle_scene();
  const int scale = builder.accessor(std::vector<float>{1, 1, 1, -2, 1, 1}, Float32, "VEC3");
  json &primitive = builder.document["meshes"][0]["primitives"][0];
  const int positions = primitive["attributes"]["POSITION"];
  // From nothing at rest to the triangle.
  primitive["targets"] = {{{"POSITION", positions}}};
  const int zeros = builder.accessor(std::vector<float>(9, 0.0F), Float32, "VEC3");
  primitive["attributes"]["POSITION"] = zeros;
  builder.document["meshes"][0]["weights"] = {1.0};
  builder.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = scale;
  const int times = builder.accessor(std::vector<float>{0, 1}, Float32, "SCALAR");
  const int weights = builder.accessor(std::vector<float>{1, 3}, Float32, "SCALAR");
  builder.document["animations"] = {{{"samplers", {{{"input", times}, {"output", weights}}}},
                                     {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
  Scene scene = import(builder);
  ASSERT_EQ(scene.objects().size(), 2U);
  const Scene still = import(triangle_scene());
  const scene::Mesh &triangle = still.meshes()[still.objects()[0].mesh];
  for (const float size : {1.0F, 3.0F}) {
    for (const auto &object : scene.objects()) {
      const scene::Mesh &mesh = scene.meshes()[object.mesh];
      ASSERT_EQ(mesh.positions.size(), triangle.positions.size());
      for (std::size_t i = 0; i < mesh.positions.size(); i++) {
        EXPECT_EQ(mesh.positions[i], size * triangle.positions[i]) << size;
      }
    }
    scene::pose(scene, scene.animations.at(0), 1.0);
  }
}

TEST(GltfInstances, AreSeenWhenTheirNodeIs)
{
  GltfBuilder builder = triangle_scene();
  const int scale = builder.accessor(std::vector<float>{1, 1, 1}, Float32, "VEC3");
  builder.document["nodes"][0]["extensions"] = {{"EXT_mesh_gpu_instancing", {{"attributes", {{"SCALE", scale}}}}},
                                                {"KHR_node_visibility", {{"visible", false}}}};
  Scene scene = import(builder);
  EXPECT_TRUE(scene.objects().empty());
  const auto named = [](const auto &item) { return item.value.name == "thing"; };
  const auto &nodes = scene.nodes();
  const auto thing = std::ranges::find_if(nodes, named);
  ASSERT_NE(thing, nodes.end());
  // An animation does the same.
  scene.edit((*thing).handle, [](scene::Node &node) { node.is_visible = true; });
  EXPECT_EQ(scene.objects().size(), 1U);
}

TEST(GltfInstances, AttributesThatDisagreeAreNamed)
{
  GltfBuilder builder = triangle_scene();
  const int two = builder.accessor(std::vector<float>{1, 2, 3, -4, 5, -6}, Float32, "VEC3");
  const int one = builder.accessor(std::vector<float>{1, 1, 1}, Float32, "VEC3");
  json &extension = builder.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"];
  extension["attributes"] = {{"TRANSLATION", two}, {"SCALE", one}};
  Scene scene = import(builder);
  EXPECT_EQ(scene.objects().size(), 1U);
  EXPECT_WARNING(scene, "node 'thing': drawn once, at the node, and not as instances: SCALE: count differs");
  extension["attributes"] = json::object();
  scene = import(builder);
  EXPECT_WARNING(scene, "node 'thing': drawn once, at the node, and not as instances: EXT_mesh_gpu_instancing: has no");
  // A billion instances of no bytes are refused.
  json &accessor = builder.document["accessors"][two];
  accessor.erase("bufferView");
  accessor["count"] = 1U << 30U;
  extension["attributes"] = {{"TRANSLATION", two}};
  scene = import(builder);
  EXPECT_WARNING(scene, "is too large for an accessor without bufferView");
}

}  // namespace
}  // namespace gnomon::test
