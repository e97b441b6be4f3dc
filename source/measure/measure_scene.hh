// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_camera.hh"
#include "eevee_scene_renderer.hh"
#include "gpu_read.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <concepts>
#include <string>
#include <vector>

/** Small scenes built in code, and their pictures, for benchmarks, stability cases and tests. */
namespace gnomon::measure {

/** Item number \a index of \a things, in their order. \pre there are more than \a index */
template <typename T>
scene::Handle<T> handle_at(const scene::Pool<T> &things, std::size_t index)
{
  auto thing = things.begin();
  for (std::size_t i = 0; i < index; i++) {
    ++thing;
  }
  return (*thing).handle;
}

/** A double-sided Lambertian material. */
inline scene::Handle<scene::Material> add_material(scene::Scene &scene, const glm::vec3 &albedo)
{
  scene::Material material;
  material.name = "material" + std::to_string(scene.materials().size());
  material.base_color = albedo;
  material.metallic = 0.0F;
  material.specular_color = glm::vec3(0.0F);
  material.is_double_sided = true;
  return scene.add(std::move(material));
}

/** A texture with nearest filtering. \a texels: four bytes each, rows from the top. */
inline scene::Handle<scene::Texture> add_texture(scene::Scene &scene, std::uint32_t width,
                                                 const std::vector<std::uint8_t> &texels)
{
  scene::Texture texture;
  texture.image = scene.add(scene::Image{"image", width, std::uint32_t(texels.size()) / 4 / width, texels});
  texture.magnified = texture.minified = scene::TextureFilter::Nearest;
  texture.mip = scene::MipFilter::None;
  return scene.add(texture);
}

/** A square of half size 1 in the plane z = 0 that faces +Z. It has uvs if its material has a texture. */
inline scene::Handle<scene::Mesh> add_square_mesh(scene::Scene &scene, scene::Handle<scene::Material> material)
{
  scene::Mesh mesh;
  mesh.name = "square";
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  if (scene.materials()[material].base_color_texture) {
    // Seen from +Z, the image is upright.
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.material = material;
  return scene.add(std::move(mesh));
}

/** A closed box from -1 to 1. The uvs show the whole image on each side. */
inline scene::Handle<scene::Mesh> add_box_mesh(scene::Scene &scene, scene::Handle<scene::Material> material)
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
      }
      for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) {
        mesh.indices.push_back(first + i);
      }
    }
  }
  mesh.material = material;
  return scene.add(std::move(mesh));
}

/** A root node with \a mesh, named by its number among the nodes. */
inline scene::Handle<scene::Node> add_object(scene::Scene &scene, scene::Handle<scene::Mesh> mesh,
                                             const glm::dmat4 &world_from_object)
{
  scene::Node node;
  node.name = "object" + std::to_string(scene.nodes().size());
  node.parent_from_node = world_from_object;
  node.meshes = {mesh};
  return scene.add(std::move(node));
}

/** A root node with \a lamp and its name. */
inline scene::Handle<scene::Lamp> add_lamp(scene::Scene &scene, scene::Lamp lamp, const glm::dmat4 &world_from_lamp)
{
  scene::Node node;
  node.name = lamp.name;
  node.parent_from_node = world_from_lamp;
  node.lamp = scene.add(std::move(lamp));
  return scene.nodes()[scene.add(std::move(node))].lamp;
}

/** A lamp at \a position with the direction \a forward, named by its number among the lamps. */
inline scene::Handle<scene::Lamp> add_lamp(scene::Scene &scene, scene::LampKind kind, const glm::vec3 &position,
                                           const glm::vec3 &forward, float intensity)
{
  scene::Lamp lamp;
  lamp.name = "lamp" + std::to_string(scene.lamps().size());
  lamp.kind = kind;
  lamp.intensity = intensity;
  const glm::vec3 up = std::abs(glm::normalize(forward).y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  return add_lamp(scene, std::move(lamp), glm::inverse(glm::lookAt(position, position + forward, up)));
}

/** Removes the lamps that \a is_chosen accepts, with their nodes; the last first, so that slots are reused in order. */
template <std::predicate<const scene::Lamp &> Predicate>
void remove_lamps(scene::Scene &scene, Predicate &&is_chosen)
{
  const std::vector<scene::PlacedLamp> lamps = scene.placed_lamps();
  for (auto lamp = lamps.rbegin(); lamp != lamps.rend(); ++lamp) {
    if (is_chosen(*lamp)) {
      scene.remove(scene.nodes()[lamp->node].lamp);
      scene.remove(lamp->node);
    }
  }
}

inline void remove_lamps(scene::Scene &scene)
{
  remove_lamps(scene, [](const scene::Lamp & /*lamp*/) { return true; });
}

/** A camera that belongs to no scene. \a vertical_angle: radians. */
inline scene::PlacedCamera camera_at(const glm::vec3 &position, const glm::vec3 &target, float vertical_angle = 0.8F)
{
  scene::PlacedCamera camera;
  camera.name = "camera";
  const glm::vec3 up = std::abs(glm::normalize(target - position).y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
  camera.world_from_camera = glm::inverse(glm::lookAt(position, target, up));
  camera.vertical_angle = vertical_angle;
  return camera;
}

/** A root node with \a camera and its name. */
inline scene::Handle<scene::Node> add_camera(scene::Scene &scene, const scene::PlacedCamera &camera)
{
  scene::Node node;
  node.name = camera.name;
  node.parent_from_node = camera.world_from_camera;
  node.camera = scene.add(scene::Camera(camera));
  return scene.add(std::move(node));
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

/** A scene renderer that syncs on construction and reads back its pictures. */
class Renderer {
 public:
  Renderer(gpu::Device &device, const scene::Scene &scene, glm::ivec2 size_px, const eevee::Settings &settings = {})
      : renderer_(device, scene, size_px, settings),
        render_scene(renderer_.render_scene()),
        engine(renderer_.engine()),
        viewport(renderer_.viewport())
  {
    sync();
  }
  /** Call after editing the scene. */
  void sync()
  {
    renderer_.sync();
  }
  /** Draws a picture and writes it to \a target. */
  void draw(const scene::PlacedCamera &camera, const draw::Target &target = {}, const eevee::DrawLimits &limits = {})
  {
    renderer_.draw(camera, limits, target);
  }
  Picture picture(const scene::PlacedCamera &camera, const draw::Target &target = {})
  {
    draw(camera, target);
    return picture();
  }
  /** The last picture that was drawn. */
  Picture picture()
  {
    return {viewport.size_px(), renderer_.read_picture()};
  }
  [[nodiscard]] eevee::Inspection inspect()
  {
    return renderer_.inspect();
  }

 private:
  eevee::SceneRenderer renderer_;

 public:
  render_scene::RenderScene &render_scene;
  eevee::Engine &engine;
  draw::Viewport &viewport;
};

}  // namespace gnomon::measure
