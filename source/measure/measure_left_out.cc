// SPDX-License-Identifier: MIT
#include "measure_left_out.hh"

#include "internal/measure_scene.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace gnomon::measure {

namespace {

/** Checks of two colours, of which one is clear. */
scene::Image checks(std::string name)
{
  constexpr std::uint32_t edge = 64;
  scene::Image image{.name = std::move(name), .width = edge, .height = edge, .texels = {}};
  for (std::uint32_t i = 0; i < edge * edge; i++) {
    const bool is_dark = ((i % edge / 8) + (i / edge / 8)) % 2 == 0;
    for (const int value : {is_dark ? 60 : 220, is_dark ? 80 : 200, is_dark ? 120 : 160, is_dark ? 0 : 255}) {
      image.texels.push_back(std::uint8_t(value));
    }
  }
  return image;
}

std::uint32_t add_material(scene::Scene &scene, std::string name)
{
  scene::Material material;
  material.name = std::move(name);
  material.base_color = glm::vec3(0.6F);
  material.metallic = 0.0F;
  material.specular_color = glm::vec3(0.0F);
  material.is_double_sided = true;
  scene.materials.push_back(material);
  return std::uint32_t(scene.materials.size() - 1);
}

std::int32_t add_texture(scene::Scene &scene, std::string name)
{
  scene.images.push_back(checks(std::move(name)));
  scene.textures.push_back({.image = std::uint32_t(scene.images.size() - 1)});
  return std::int32_t(scene.textures.size() - 1);
}

void add_box(scene::Scene &scene, std::uint32_t material, const glm::vec3 &position, const glm::vec3 &half_size)
{
  const std::uint32_t mesh = add_box_mesh(scene, material);
  scene.meshes[mesh].name = "box of " + scene.materials[material].name;
  if (scene.materials[material].base_color_texture < 0) {
    scene.meshes[mesh].uvs.clear();
  }
  scene.objects.push_back(
      {scene.materials[material].name, mesh, glm::scale(glm::translate(glm::mat4(1.0F), position), half_size)});
}

void add_lamp(scene::Scene &scene, std::string name, scene::LampKind kind, const glm::vec3 &position, float intensity)
{
  scene::Lamp lamp;
  lamp.name = std::move(name);
  lamp.kind = kind;
  lamp.intensity = intensity;
  lamp.spot_outer_angle = 0.6F;
  lamp.world_from_lamp = glm::inverse(glm::lookAt(position, glm::vec3(0.0F), glm::vec3(0, 1, 0)));
  scene.lamps.push_back(std::move(lamp));
}

scene::Scene full_scene()
{
  scene::Scene scene;
  scene.path = "full";
  const std::uint32_t plain = add_material(scene, "plain");
  const std::uint32_t specular = add_material(scene, "specular");
  scene.materials[specular].specular_color = glm::vec3(1.0F);
  scene.materials[specular].roughness = 0.3F;
  const std::uint32_t textured = add_material(scene, "textured");
  scene.materials[textured].base_color_texture = add_texture(scene, "checks");
  const std::uint32_t masked = add_material(scene, "masked");
  scene.materials[masked].base_color_texture = add_texture(scene, "holes");
  scene.materials[masked].alpha_mode = scene::AlphaMode::Mask;
  const std::uint32_t one_sided = add_material(scene, "one-sided");
  scene.materials[one_sided].is_double_sided = false;

  add_box(scene, plain, {0.0F, -0.1F, 0.0F}, {6.0F, 0.1F, 6.0F});
  add_box(scene, specular, {-2.0F, 0.6F, 0.5F}, glm::vec3(0.6F));
  add_box(scene, textured, {0.0F, 0.6F, 0.0F}, glm::vec3(0.6F));
  add_box(scene, masked, {2.0F, 0.6F, 0.5F}, glm::vec3(0.6F));
  add_box(scene, one_sided, {0.0F, 0.5F, 2.0F}, glm::vec3(0.4F));
  add_lamp(scene, "POINT", scene::LampKind::Point, {-1.5F, 3.0F, 2.0F}, 12.0F);
  add_lamp(scene, "SUN", scene::LampKind::Sun, {3.0F, 6.0F, 2.0F}, 1.0F);
  add_lamp(scene, "SPOT", scene::LampKind::Spot, {3.0F, 4.0F, 3.0F}, 30.0F);
  scene::Camera camera;
  camera.name = "camera";
  camera.world_from_camera =
      glm::inverse(glm::lookAt(glm::vec3(1.0F, 4.0F, 8.0F), glm::vec3(0.0F), glm::vec3(0, 1, 0)));
  scene.cameras.push_back(camera);
  return scene;
}

void remove_lamps(scene::Scene &scene, scene::LampKind kind)
{
  std::erase_if(scene.lamps, [kind](const scene::Lamp &lamp) { return lamp.kind == kind; });
}

}  // namespace

std::vector<LeftOutCase> left_out_cases()
{
  eevee::Settings settings;
  settings.shadow.kind = scene::ShadowKind::Pcf;
  std::vector<LeftOutCase> cases = {{"full", full_scene(), settings}};
  const auto add = [&](std::string name) -> LeftOutCase & {
    cases.push_back({name, full_scene(), settings});
    cases.back().scene.path = std::move(name);
    return cases.back();
  };
  add("no lamp").scene.lamps.clear();
  remove_lamps(add("no sun").scene, scene::LampKind::Sun);
  remove_lamps(add("no point").scene, scene::LampKind::Point);
  remove_lamps(add("no spot").scene, scene::LampKind::Spot);
  add("no shadow").settings.shadow.kind = scene::ShadowKind::None;
  scene::Scene &untextured = add("no texture").scene;
  for (scene::Material &material : untextured.materials) {
    material.base_color_texture = -1;
  }
  for (scene::Mesh &mesh : untextured.meshes) {
    mesh.uvs.clear();
  }
  for (scene::Material &material : add("no alpha").scene.materials) {
    material.alpha_mode = scene::AlphaMode::Opaque;
  }
  for (scene::Material &material : add("no specular").scene.materials) {
    material.specular_color = glm::vec3(0.0F);
  }
  scene::Camera &camera = add("no visible receiver").scene.cameras.front();
  camera.world_from_camera =
      glm::inverse(glm::lookAt(glm::vec3(1.0F, 4.0F, 20.0F), glm::vec3(1.0F, 4.0F, 40.0F), glm::vec3(0, 1, 0)));
  LeftOutCase &nothing = add("nothing at all");
  const std::vector<scene::Camera> cameras = nothing.scene.cameras;
  nothing.scene = {};
  nothing.scene.path = nothing.name;
  nothing.scene.cameras = cameras;
  return cases;
}

}  // namespace gnomon::measure
