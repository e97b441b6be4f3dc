// SPDX-License-Identifier: MIT
// The extra gnomon_surface of a material: a file beside the scene, a data URI, and what is refused.
#include "gltf/gltf_check.hh"
#include "gltf_export.hh"

#include <filesystem>

namespace gnomon::test {
namespace {

using scene::Scene;

const std::string surface_text = "void surface(SurfaceInputs inputs, inout StandardSurface result) {}\n";

/** A triangle with a material named "paint" whose extra is \a uri. */
std::string painted_with(const json &uri)
{
  GltfBuilder builder;
  const int material = builder.append("materials", {{"name", "paint"}, {"extras", {{"gnomon_surface", uri}}}});
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", builder.positions(triangle_positions)}}},
                                       {"material", material}})}});
  return builder.gltf();
}

const scene::SurfaceFunction &only_function(const Scene &scene)
{
  EXPECT_EQ(scene.surface_functions().size(), 1U) << all_warnings(scene);
  EXPECT_EQ(nth(scene.materials(), 0).surface_function, scene.surface_functions().first());
  return nth(scene.surface_functions(), 0);
}

TEST(GltfSurfaceFunction, IsReadFromAFileBesideTheSceneAndWrittenBack)
{
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "copies");
  const std::filesystem::path file = folder.write("a surface.glsl", surface_text);
  const Scene scene = gltf::import_gltf(folder.write("scene.gltf", painted_with("a%20surface.glsl")));
  EXPECT_NO_WARNING(scene, "surface");
  EXPECT_EQ(only_function(scene).text, surface_text);
  EXPECT_TRUE(std::filesystem::equivalent(only_function(scene).path, file));
  for (const char *name : {"copies/copy.gltf", "copy.glb"}) {
    gltf::export_gltf(scene, folder.path() / name);
    const Scene copy = gltf::import_gltf(folder.path() / name);
    EXPECT_EQ(only_function(copy).text, surface_text);
    EXPECT_TRUE(std::filesystem::equivalent(only_function(copy).path, file));
  }
}

TEST(GltfSurfaceFunction, WithoutAFileItsTextIsInTheScene)
{
  const TemporaryFolder folder;
  Scene scene = gltf::import_gltf(folder.write("scene.gltf", painted_with("data:text/plain;base64,dm9pZA==")));
  EXPECT_EQ(only_function(scene).text, "void");
  EXPECT_EQ(only_function(scene).path, "");
  const std::string long_text = surface_text + "// \"quoted\" \\ ü\n";
  scene.edit(scene.surface_functions().first(), [&](scene::SurfaceFunction &function) {
    function.text = long_text;
    function.path = (folder.path() / "gone.glsl").string();
  });
  gltf::export_gltf(scene, folder.path() / "copy.gltf");
  const Scene copy = gltf::import_gltf(folder.path() / "copy.gltf");
  EXPECT_EQ(only_function(copy).text, long_text);
  EXPECT_EQ(only_function(copy).path, "");
}

TEST(GltfSurfaceFunction, BothSetsOfUvsAreKeptWithoutATextureThatReadsThem)
{
  for (const bool has_second : {false, true}) {
    GltfBuilder builder;
    const int material =
        builder.append("materials", {{"extras", {{"gnomon_surface", "data:text/plain;base64,dm9pZA=="}}}});
    json attributes = {{"POSITION", builder.positions(triangle_positions)},
                       {"TEXCOORD_0", builder.accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, Float32, "VEC2")}};
    if (has_second) {
      attributes["TEXCOORD_1"] = builder.accessor(std::vector<float>{0, 0, 0.5F, 0, 0, 0.5F}, Float32, "VEC2");
    }
    builder.node({{"mesh", builder.mesh({{"attributes", attributes}, {"material", material}})}});
    const Scene scene = import(builder);
    EXPECT_NO_WARNING(scene, "texture");
    EXPECT_EQ(nth(scene.meshes(), 0).uvs, (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}}));
    EXPECT_EQ(nth(scene.meshes(), 0).second_uvs,
              has_second ? (std::vector<glm::vec2>{{0, 0}, {0.5F, 0}, {0, 0.5F}}) : std::vector<glm::vec2>());
  }
}

TEST(GltfSurfaceFunction, MaterialsWithOneFileShareIt)
{
  const TemporaryFolder folder;
  static_cast<void>(folder.write("a.glsl", surface_text));
  GltfBuilder builder;
  for (int i = 0; i < 3; i++) {
    const int material = builder.append("materials", {{"extras", {{"gnomon_surface", "a.glsl"}}}});
    builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", builder.positions(triangle_positions)}}},
                                         {"material", material}})}});
  }
  const Scene scene = gltf::import_gltf(folder.write("scene.gltf", builder.gltf()));
  EXPECT_EQ(scene.materials().size(), 3U);
  EXPECT_EQ(scene.surface_functions().size(), 1U);
}

/** The warning about a URI. The scene is valid, and its function has no text. */
std::string warning_about(const json &uri, const TemporaryFolder &folder)
{
  const Scene scene = gltf::import_gltf(folder.write("scene.gltf", painted_with(uri)));
  expect_valid(scene);
  EXPECT_EQ(only_function(scene).text, "");
  EXPECT_EQ(only_function(scene).path, "");
  EXPECT_WARNING(scene, "material 'paint': surface function");
  EXPECT_WARNING(scene, "; magenta is drawn instead");
  return all_warnings(scene);
}

TEST(GltfSurfaceFunction, PathsThatAreNotBesideTheSceneAndWhatIsNoTextAreRefused)
{
  const TemporaryFolder folder;
  static_cast<void>(folder.write("large.glsl", std::string(scene::SurfaceFunction::text_bytes_max + 1, ' ')));
  static_cast<void>(folder.write("nul.glsl", std::string("a\0b", 3)));
  const std::string outside = "is not a file beside the scene";
  for (const auto &[uri, reason] :
       std::vector<std::pair<std::string, std::string>>{{"/etc/passwd", outside},
                                                        {"file:///etc/passwd", outside},
                                                        {"https://example.org/a.glsl", outside},
                                                        {"a%00.glsl", outside},
                                                        {"missing.glsl", "there is no such file"},
                                                        {".", "is not a file"},
                                                        {"large.glsl", "is larger than 65536 bytes"},
                                                        {"nul.glsl", "its text contains a NUL"},
                                                        {"data:text/plain;base64,v*", "its data URI is not base64"}}) {
    SCOPED_TRACE(uri);
    const std::string warning = warning_about(uri, folder);
    EXPECT_NE(warning.find(reason), std::string::npos) << warning;
  }
  EXPECT_NE(import_error(painted_with(5)).find("gnomon_surface"), std::string::npos);
}

}  // namespace
}  // namespace gnomon::test
