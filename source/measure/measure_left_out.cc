// SPDX-License-Identifier: MIT
#include "measure_left_out.hh"

#include "measure_scene.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace gnomon::measure {

namespace {

/** A checkerboard of two colours, one of which is transparent. */
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

scene::Material material_of(std::string name)
{
  scene::Material material;
  material.name = std::move(name);
  material.base_color = glm::vec3(0.6F);
  material.metallic = 0.0F;
  material.specular_color = glm::vec3(0.0F);
  material.is_double_sided = true;
  return material;
}

scene::Handle<scene::Texture> add_texture(scene::Scene &scene, std::string name)
{
  return scene.add(scene::Texture{.image = scene.add(checks(std::move(name)))});
}

/** A box with a material of its own. */
void add_box(scene::Scene &scene, const scene::Material &material, const glm::vec3 &position,
             const glm::vec3 &half_size)
{
  scene::Node node;
  node.name = material.name;
  node.parent_from_node = glm::scale(glm::translate(glm::mat4(1.0F), position), half_size);
  node.meshes = {add_box_mesh(scene, scene.add(material))};
  scene.edit(node.meshes[0], [&](scene::Mesh &mesh) {
    mesh.name = "box of " + material.name;
    if (!material.base_color_texture) {
      mesh.uvs.clear();
    }
  });
  scene.add(std::move(node));
}

void add_lamp(scene::Scene &scene, std::string name, scene::LampKind kind, const glm::vec3 &position, float intensity)
{
  scene::Lamp lamp;
  lamp.name = std::move(name);
  lamp.kind = kind;
  lamp.intensity = intensity;
  lamp.spot_outer_angle = 0.6F;
  measure::add_lamp(scene, std::move(lamp), glm::inverse(glm::lookAt(position, glm::vec3(0.0F), glm::vec3(0, 1, 0))));
}

scene::Scene full_scene()
{
  scene::Scene scene;
  scene.path = "full";
  scene::Material specular = material_of("specular");
  specular.specular_color = glm::vec3(1.0F);
  specular.roughness = 0.3F;
  scene::Material textured = material_of("textured");
  textured.base_color_texture = add_texture(scene, "checks");
  scene::Material masked = material_of("masked");
  masked.base_color_texture = add_texture(scene, "holes");
  masked.alpha_mode = scene::AlphaMode::Mask;
  scene::Material one_sided = material_of("one-sided");
  one_sided.is_double_sided = false;

  add_box(scene, material_of("plain"), {0.0F, -0.1F, 0.0F}, {6.0F, 0.1F, 6.0F});
  add_box(scene, specular, {-2.0F, 0.6F, 0.5F}, glm::vec3(0.6F));
  add_box(scene, textured, {0.0F, 0.6F, 0.0F}, glm::vec3(0.6F));
  add_box(scene, masked, {2.0F, 0.6F, 0.5F}, glm::vec3(0.6F));
  add_box(scene, one_sided, {0.0F, 0.5F, 2.0F}, glm::vec3(0.4F));
  add_lamp(scene, "POINT", scene::LampKind::Point, {-1.5F, 3.0F, 2.0F}, 12.0F);
  add_lamp(scene, "SUN", scene::LampKind::Sun, {3.0F, 6.0F, 2.0F}, 1.0F);
  add_lamp(scene, "SPOT", scene::LampKind::Spot, {3.0F, 4.0F, 3.0F}, 30.0F);
  add_camera(scene, camera_at({1.0F, 4.0F, 8.0F}, glm::vec3(0.0F)));
  return scene;
}

void remove_lamps(scene::Scene &scene, scene::LampKind kind)
{
  measure::remove_lamps(scene, [kind](const scene::Lamp &lamp) { return lamp.kind == kind; });
}

template <std::invocable<scene::Material &> Change>
void edit_materials(scene::Scene &scene, Change change)
{
  for (const auto &[handle, material] : scene.materials()) {
    scene.edit(handle, change);
  }
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
  measure::remove_lamps(add("no lamp").scene);
  remove_lamps(add("no sun").scene, scene::LampKind::Sun);
  remove_lamps(add("no point").scene, scene::LampKind::Point);
  remove_lamps(add("no spot").scene, scene::LampKind::Spot);
  add("no shadow").settings.shadow.kind = scene::ShadowKind::None;
  scene::Scene &untextured = add("no texture").scene;
  edit_materials(untextured, [](scene::Material &material) { material.base_color_texture = {}; });
  for (const auto &[handle, mesh] : untextured.meshes()) {
    untextured.edit(handle, [](scene::Mesh &changed) { changed.uvs.clear(); });
  }
  edit_materials(add("no alpha").scene,
                 [](scene::Material &material) { material.alpha_mode = scene::AlphaMode::Opaque; });
  edit_materials(add("no specular").scene,
                 [](scene::Material &material) { material.specular_color = glm::vec3(0.0F); });
  scene::Scene &no_receiver = add("no visible receiver").scene;
  no_receiver.set_transform(no_receiver.placed_cameras().front().node,
                            camera_at({1.0F, 4.0F, 20.0F}, {1.0F, 4.0F, 40.0F}).world_from_camera);
  LeftOutCase &nothing = add("nothing at all");
  const scene::PlacedCamera camera = nothing.scene.placed_cameras().front();
  nothing.scene = {};
  nothing.scene.path = nothing.name;
  add_camera(nothing.scene, camera);
  return cases;
}

}  // namespace gnomon::measure
