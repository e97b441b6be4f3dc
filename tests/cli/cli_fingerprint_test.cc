// SPDX-License-Identifier: MIT
#include "cli_fingerprint.hh"

#include "gltf_import.hh"
#include "measure_scene.hh"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace gnomon::cli {
namespace {

namespace fs = std::filesystem;

scene::Scene small_scene()
{
  scene::Scene scene;
  const auto material = measure::add_material(scene, glm::vec3(0.5F));
  const auto texture = measure::add_texture(scene, 1, {1, 2, 3, 4});
  const auto function = scene.add(scene::SurfaceFunction{.text = "a"});
  scene.edit(material, [&](scene::Material &edited) {
    edited.base_color_texture = texture;
    edited.surface_function = function;
  });
  measure::add_object(scene, measure::add_square_mesh(scene, material), glm::dmat4(1.0));
  measure::add_lamp(scene, scene::LampKind::Point, {0, 0, 2}, {0, 0, -1}, 1.0F);
  measure::add_camera(scene, measure::camera_at({0, 0, 4}, {0, 0, 0}));
  return scene;
}

TEST(SceneFingerprint, IsThatOfTheContent)
{
  const std::string fingerprint = scene_fingerprint(small_scene());
  EXPECT_EQ(scene_fingerprint(small_scene()), fingerprint);
  scene::Scene scene = small_scene();
  scene.path = "elsewhere";
  scene.edit(scene.nodes().first(), [](scene::Node &node) { node.extras = R"({"price":3})"; });
  EXPECT_EQ(scene_fingerprint(scene), fingerprint);

  const auto expect_other = [&](const auto &handle, const auto &change) {
    scene::Scene edited = small_scene();
    edited.edit(handle, change);
    EXPECT_NE(scene_fingerprint(edited), fingerprint);
  };
  expect_other(scene.images().first(), [](scene::Image &image) { image.texels[3] = 5; });
  expect_other(scene.textures().first(),
               [](scene::Texture &texture) { texture.wrap_v = scene::TextureWrap::ClampToEdge; });
  expect_other(scene.materials().first(), [](scene::Material &material) { material.roughness = 0.5F; });
  expect_other(scene.materials().first(), [](scene::Material &material) { material.surface_function = {}; });
  expect_other(scene.surface_functions().first(), [](scene::SurfaceFunction &function) { function.text = "b"; });
  expect_other(scene.meshes().first(), [](scene::Mesh &mesh) { mesh.positions[0].x = 0.5F; });
  expect_other(scene.nodes().first(), [](scene::Node &node) { node.parent_from_node[3].x = 1e-9; });
  expect_other(scene.nodes().first(), [](scene::Node &node) { node.is_visible = false; });
  // Mattes have the name.
  expect_other(scene.nodes().first(), [](scene::Node &node) { node.name = "other"; });
  expect_other(scene.lamps().first(), [](scene::Lamp &lamp) { lamp.shadow.bias = 2.0F; });
  expect_other(scene.cameras().first(), [](scene::Camera &camera) { camera.near = 0.2F; });
}

/** An animation of these moves or shows other things. */
TEST(SceneFingerprint, IsThatOfAllFramesOfAnAnimation)
{
  const auto expect_others = [](const scene::Scene &scene, const auto &change) {
    scene::Scene edited = scene;
    change(edited);
    EXPECT_NE(scene_fingerprint(edited), scene_fingerprint(scene));
  };
  scene::Scene scene = small_scene();
  const auto parent = scene.add(scene::Node{});
  expect_others(scene, [&](scene::Scene &edited) { edited.set_parent(edited.nodes().first(), parent); });
  const auto material = scene.add(scene::Material(scene.materials()[scene.materials().first()]));
  expect_others(scene, [&](scene::Scene &edited) {
    edited.edit(edited.meshes().first(), [&](scene::Mesh &mesh) { mesh.material = material; });
  });
  const auto hidden = scene.add(scene::Lamp{});
  scene.add(scene::Node{.lamp = hidden, .is_visible = false});
  expect_others(scene,
                [&](scene::Scene &edited) { edited.edit(hidden, [](scene::Lamp &lamp) { lamp.intensity = 3.0F; }); });
  const auto track = std::make_shared<const scene::Track>(scene::Track{.times = {0.0F}, .values = {1.0F}});
  scene::AnimatedNode animated;
  animated.node = parent;
  scene.animations.push_back({"a", {animated}, {}});
  expect_others(scene, [&](scene::Scene &edited) { edited.animations[0].nodes[0].weights_track = track; });
  expect_others(scene, [&](scene::Scene &edited) { edited.animations[0].nodes.push_back(animated); });
  scene::DeformedMesh deformed;
  deformed.mesh = scene.meshes().first();
  deformed.node = parent;
  deformed.weights = {0.0};
  scene.deformed_meshes.push_back(deformed);
  expect_others(scene, [](scene::Scene &edited) { edited.deformed_meshes[0].weights[0] = 1.0; });
  expect_others(scene, [](scene::Scene &edited) { edited.deformed_meshes[0].has_flat_normals = true; });
}

/** A file with an external buffer, whose name must be encoded in a URI. */
TEST(SceneFingerprint, FollowsFilesThatTheSceneNames)
{
  const fs::path folder = fs::temp_directory_path() / ("gnomon_fingerprint_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const auto write_buffer = [&](float x) {
    const float positions[9] = {0, 0, 0, x, 0, 0, 0, 1, 0};
    std::ofstream(folder / "a b.bin", std::ios::binary)
        .write(reinterpret_cast<const char *>(positions), sizeof(positions));
  };
  std::ofstream(folder / "scene.gltf") << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "buffers":[{"uri":"a%20b.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[2,1,0]}]})";
  write_buffer(1.0F);
  const std::string before = scene_fingerprint(gltf::import_gltf(folder / "scene.gltf"));
  EXPECT_EQ(scene_fingerprint(gltf::import_gltf(folder / "scene.gltf")), before);
  write_buffer(2.0F);
  EXPECT_NE(scene_fingerprint(gltf::import_gltf(folder / "scene.gltf")), before);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace gnomon::cli
