// SPDX-License-Identifier: MIT
#pragma once

#include "gltf_builder.hh"
#include "scene_gltf.hh"

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace gnomon::test {

inline bool is_finite(const glm::vec3 &v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline void expect_finite(const glm::mat4 &matrix)
{
  for (int column = 0; column < 4; column++) {
    EXPECT_TRUE(is_finite(glm::vec3(matrix[column])));
    EXPECT_EQ(matrix[column][3], column == 3 ? 1.0F : 0.0F);
  }
}

/** A rotation and a place, right-handed. */
inline void expect_frame(const glm::mat4 &matrix)
{
  expect_finite(matrix);
  const glm::vec3 x(matrix[0]);
  const glm::vec3 y(matrix[1]);
  const glm::vec3 z(matrix[2]);
  EXPECT_NEAR(glm::length(x), 1, 1e-5);
  EXPECT_NEAR(glm::length(y), 1, 1e-5);
  EXPECT_NEAR(glm::length(glm::cross(x, y) - z), 0, 1e-5);
}

inline void expect_valid(const scene::Mesh &mesh, std::size_t material_count)
{
  EXPECT_LT(mesh.material, material_count);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_FALSE(mesh.indices.empty());
  EXPECT_EQ(mesh.indices.size() % 3, 0U);
  EXPECT_LT(*std::max_element(mesh.indices.begin(), mesh.indices.end()), mesh.positions.size());
  EXPECT_FALSE(mesh.bounds.is_empty());
  EXPECT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size());
  std::size_t bad_count = 0;
  for (const glm::vec2 &uv : mesh.uvs) {
    bad_count += !std::isfinite(uv.x) || !std::isfinite(uv.y);
  }
  for (std::size_t i = 0; i < mesh.positions.size(); i++) {
    const bool is_inside = glm::min(mesh.bounds.min, mesh.positions[i]) == mesh.bounds.min &&
                           glm::max(mesh.bounds.max, mesh.positions[i]) == mesh.bounds.max;
    bad_count += !is_finite(mesh.positions[i]) || !is_inside || std::abs(glm::length(mesh.normals[i]) - 1) > 1e-5F;
  }
  EXPECT_EQ(bad_count, 0U);
}

inline void expect_valid(const scene::Lamp &lamp)
{
  expect_frame(lamp.world_from_lamp);
  EXPECT_TRUE(is_finite(lamp.color) && lamp.color.x >= 0 && lamp.color.y >= 0 && lamp.color.z >= 0);
  for (const float value : {lamp.intensity, lamp.radius, lamp.angle, lamp.range}) {
    EXPECT_TRUE(std::isfinite(value) && value >= 0);
  }
  EXPECT_TRUE(lamp.spot_outer_angle > 0 && lamp.spot_outer_angle <= 1.5707964F);
  EXPECT_TRUE(lamp.spot_blend >= 0 && lamp.spot_blend <= 1);
  EXPECT_TRUE(std::isfinite(lamp.area_size_x) && lamp.area_size_x > 0);
  EXPECT_TRUE(std::isfinite(lamp.area_size_y) && lamp.area_size_y > 0);
}

inline void expect_valid(const scene::Camera &camera)
{
  expect_frame(camera.world_from_camera);
  EXPECT_TRUE(camera.vertical_angle > 0 && camera.vertical_angle < 3.1415927F);
  EXPECT_TRUE(std::isfinite(camera.aspect) && camera.aspect >= 0);
  EXPECT_TRUE(std::isfinite(camera.half_width) && camera.half_width > 0);
  EXPECT_TRUE(std::isfinite(camera.half_height) && camera.half_height > 0);
  const bool is_perspective = camera.kind == scene::CameraKind::Perspective;
  EXPECT_TRUE(std::isfinite(camera.near) && (is_perspective ? camera.near > 0 : camera.near >= 0));
  EXPECT_TRUE(std::isfinite(camera.far) && (camera.far > camera.near || (is_perspective && camera.far == 0)));
}

inline void expect_valid(const scene::Material &material)
{
  for (const float factor : {material.base_color.x, material.base_color.y, material.base_color.z, material.alpha,
                             material.metallic, material.roughness, material.specular, material.alpha_cutoff}) {
    EXPECT_TRUE(factor >= 0 && factor <= 1);
  }
  EXPECT_TRUE(is_finite(material.specular_color) && is_finite(material.emissive));
}

/** All that scene.hh promises of an imported scene. */
inline void expect_valid(const scene::Scene &scene)
{
  for (const scene::Mesh &mesh : scene.meshes) {
    expect_valid(mesh, scene.materials.size());
    EXPECT_EQ(mesh.uvs.empty(), scene.materials[mesh.material].base_color_texture < 0);
  }
  for (const scene::Material &material : scene.materials) {
    expect_valid(material);
    EXPECT_TRUE(material.base_color_texture >= -1 && material.base_color_texture < int(scene.textures.size()));
  }
  for (const scene::Texture &texture : scene.textures) {
    EXPECT_LT(texture.image, scene.images.size());
  }
  for (const scene::Image &image : scene.images) {
    EXPECT_TRUE(image.width > 0 && image.height > 0);
    EXPECT_EQ(image.texels.size(), std::size_t(4) * image.width * image.height);
  }
  for (const scene::Object &object : scene.objects) {
    EXPECT_LT(object.mesh, scene.meshes.size());
    expect_finite(object.world_from_object);
  }
  std::for_each(scene.lamps.begin(), scene.lamps.end(), [](const auto &lamp) { expect_valid(lamp); });
  EXPECT_FALSE(scene.lamps.empty());
  std::for_each(scene.cameras.begin(), scene.cameras.end(), [](const auto &camera) { expect_valid(camera); });
  EXPECT_FALSE(scene.cameras.empty());
  if (!scene.objects.empty()) {
    EXPECT_TRUE(std::isfinite(scene.bounds().radius()));
  }
  for (const std::string &warning : scene.warnings) {
    EXPECT_EQ(warning.find('\n'), std::string::npos) << warning;
  }
}

inline scene::Scene import_text(const std::string &content, const std::string &name = "scene.gltf")
{
  const TemporaryFolder folder;
  scene::Scene result = scene::import_gltf(folder.write(name, content));
  expect_valid(result);
  return result;
}

inline scene::Scene import(const GltfBuilder &builder)
{
  return import_text(builder.gltf());
}

/** The message of the import's error; empty when there was none. */
inline std::string import_error(const std::string &content, const std::string &name = "scene.gltf")
{
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write(name, content);
  try {
    (void)scene::import_gltf(path);
  }
  catch (const scene::ImportError &error) {
    const std::string message = error.what();
    const std::string prefix = path.string() + ": ";
    EXPECT_EQ(message.rfind(prefix, 0), 0U) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message.substr(std::min(prefix.size(), message.size()));
  }
  return {};
}

inline std::string import_error(const GltfBuilder &builder)
{
  return import_error(builder.gltf());
}

inline bool has_warning(const scene::Scene &scene, const std::string &part)
{
  return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                     [&](const std::string &warning) { return warning.find(part) != warning.npos; });
}

inline std::string all_warnings(const scene::Scene &scene)
{
  std::string result;
  for (const std::string &warning : scene.warnings) {
    result += warning + '\n';
  }
  return result;
}

#define EXPECT_WARNING(scene, part) EXPECT_TRUE(has_warning(scene, part)) << all_warnings(scene)
#define EXPECT_NO_WARNING(scene, part) EXPECT_FALSE(has_warning(scene, part)) << all_warnings(scene)
#define EXPECT_HAS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

/** A triangle in the plane z = 0, facing +Z. */
inline const std::vector<float> triangle_positions{0, 0, 0, 1, 0, 0, 0, 1, 0};

/** One node with that triangle. */
inline GltfBuilder triangle_scene()
{
  GltfBuilder builder;
  const int mesh = builder.mesh({{"attributes", {{"POSITION", builder.positions(triangle_positions)}}}});
  builder.node({{"name", "thing"}, {"mesh", mesh}});
  return builder;
}

}  // namespace gnomon::test
