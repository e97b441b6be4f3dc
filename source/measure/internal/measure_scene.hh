// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_camera.hh"
#include "eevee_engine.hh"
#include "gpu_read.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

/** Small scenes made in place, and the pixels they come to. Internal to source/measure, and for tests. */
namespace gnomon::measure {

/** Lambertian. \return its index. */
inline std::uint32_t add_material(scene::Scene &scene, const glm::vec3 &albedo)
{
  scene::Material material;
  material.name = "material" + std::to_string(scene.materials.size());
  material.base_color = albedo;
  material.metallic = 0.0F;
  material.specular_color = glm::vec3(0.0F);
  material.is_double_sided = true;
  scene.materials.push_back(material);
  return std::uint32_t(scene.materials.size() - 1);
}

/** Nearest texels, rows from the top, four bytes each. \return its index. */
inline std::int32_t add_texture(scene::Scene &scene, std::uint32_t width, const std::vector<std::uint8_t> &texels)
{
  scene.images.push_back({"image", width, std::uint32_t(texels.size()) / 4 / width, texels});
  scene::Texture texture;
  texture.image = std::uint32_t(scene.images.size() - 1);
  texture.magnified = texture.minified = scene::TextureFilter::Nearest;
  texture.mip = scene::MipFilter::None;
  scene.textures.push_back(texture);
  return std::int32_t(scene.textures.size() - 1);
}

/** A square of half size 1 in the plane z = 0, facing +Z. \return its mesh's index. */
inline std::uint32_t add_square_mesh(scene::Scene &scene, std::uint32_t material)
{
  scene::Mesh mesh;
  mesh.name = "square";
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  if (scene.materials[material].base_color_texture >= 0) {
    // The image upright to who faces it.
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.material = material;
  for (const glm::vec3 &position : mesh.positions) {
    mesh.bounds.extend(position);
  }
  scene.meshes.push_back(mesh);
  return std::uint32_t(scene.meshes.size() - 1);
}

/** A closed box from -1 to 1, with the whole of an image on each side. \return its mesh's index. */
inline std::uint32_t add_box_mesh(scene::Scene &scene, std::uint32_t material)
{
  scene::Mesh mesh;
  mesh.name = "box";
  for (int axis = 0; axis < 3; axis++) {
    for (const float side : {-1.0F, 1.0F}) {
      glm::vec3 normal(0.0F);
      glm::vec3 across(0.0F);
      normal[axis] = side;
      across[(axis + 1) % 3] = 1.0F;
      const glm::vec3 up = glm::cross(normal, across);
      const auto first = std::uint32_t(mesh.positions.size());
      for (const glm::vec2 &corner : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
        mesh.positions.push_back(normal + corner.x * across + corner.y * up);
        mesh.normals.push_back(normal);
        mesh.uvs.push_back(0.5F * corner + 0.5F);
        mesh.bounds.extend(mesh.positions.back());
      }
      for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) {
        mesh.indices.push_back(first + i);
      }
    }
  }
  mesh.material = material;
  scene.meshes.push_back(mesh);
  return std::uint32_t(scene.meshes.size() - 1);
}

inline void add_object(scene::Scene &scene, std::uint32_t mesh, const glm::mat4 &world_from_object)
{
  scene.objects.push_back({"object" + std::to_string(scene.objects.size()), mesh, world_from_object});
}

/** A lamp at \a position that shines along \a forward. */
inline scene::Lamp &add_lamp(scene::Scene &scene, scene::LampKind kind, const glm::vec3 &position,
                             const glm::vec3 &forward, float intensity)
{
  scene::Lamp lamp;
  lamp.name = "lamp" + std::to_string(scene.lamps.size());
  lamp.kind = kind;
  lamp.intensity = intensity;
  const glm::vec3 up = std::abs(glm::normalize(forward).y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  lamp.world_from_lamp = glm::inverse(glm::lookAt(position, position + forward, up));
  scene.lamps.push_back(lamp);
  return scene.lamps.back();
}

inline scene::Camera camera_at(const glm::vec3 &position, const glm::vec3 &target, float vertical_angle = 0.8F)
{
  scene::Camera camera;
  camera.name = "camera";
  const glm::vec3 up = std::abs(glm::normalize(target - position).y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
  camera.world_from_camera = glm::inverse(glm::lookAt(position, target, up));
  camera.vertical_angle = vertical_angle;
  return camera;
}

/** Linear radiance, rows from the bottom. */
struct Picture {
  glm::ivec2 size_px{0};
  std::vector<glm::vec4> pixels;

  [[nodiscard]] const glm::vec4 &at(int x, int y) const
  {
    return pixels.at(std::size_t(y) * std::size_t(size_px.x) + std::size_t(x));
  }
  [[nodiscard]] const glm::vec4 &middle() const
  {
    return at(size_px.x / 2, size_px.y / 2);
  }
  [[nodiscard]] std::size_t non_finite_count() const
  {
    std::size_t count = 0;
    for (const glm::vec4 &pixel : pixels) {
      for (int c = 0; c < 4; c++) {
        count += std::isfinite(pixel[c]) ? 0 : 1;
      }
    }
    return count;
  }
};

/** An engine, a viewport, and the order of calls that draws a picture with them. */
class Renderer {
 public:
  Renderer(gpu::Device &device, const scene::Scene &scene, glm::ivec2 size_px, const eevee::Settings &settings = {})
      : scene_(scene), settings_(settings), engine(scene, settings), viewport(device, size_px)
  {
    sync();
  }
  void sync()
  {
    const std::array<draw::Engine *, 1> engines = {&engine};
    viewport.sync(engines, eevee::object_refs(scene_));
  }
  void draw(const scene::Camera &camera)
  {
    const std::array<draw::Engine *, 1> engines = {&engine};
    for (int i = 0; i < settings_.sample_count; i++) {
      viewport.draw(engines, eevee::view_of(camera, viewport.size_px()));
    }
  }
  Picture picture(const scene::Camera &camera)
  {
    draw(camera);
    return {viewport.size_px(), gpu::read_as<glm::vec4>(viewport.device(), engine.radiance(viewport))};
  }

 private:
  const scene::Scene &scene_;
  eevee::Settings settings_;

 public:
  eevee::Engine engine;
  draw::Viewport viewport;
};

}  // namespace gnomon::measure
