// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_scene_renderer.hh"
#include "measure_scene.hh"

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace gnomon::test {

/** A few boxes over a ground, lamps with shadows of every kind, and seeded edits of all of them. */
class FramesScene {
 public:
  FramesScene()
  {
    using namespace measure;
    for (int i = 0; i < 3; i++) {
      materials_.push_back(add_material(scene, glm::vec3(0.2F * float(i + 1))));
    }
    texture_ = add_texture(scene, 2, {255, 0, 0, 255, 0, 255, 0, 0, 0, 0, 255, 255, 255, 255, 255, 0});
    scene.edit(materials_[2], [&](scene::Material &material) {
      material.base_color_texture = texture_;
      material.alpha_mode = scene::AlphaMode::Mask;
    });
    add_object(scene, add_square_mesh(scene, materials_[0]), glm::scale(glm::dmat4(1.0), glm::dvec3(200.0)));
    meshes_ = {add_box_mesh(scene, materials_[1]), add_box_mesh(scene, materials_[2])};
    // All vertex streams.
    scene.edit(meshes_[0], [](scene::Mesh &mesh) {
      mesh.colors.assign(mesh.positions.size(), {0.9F, 0.6F, 0.8F, 1.0F});
    });
    for (int i = 0; i < 4; i++) {
      boxes_.push_back(add_box(i));
    }
    lamps_ = {add_lamp(scene, scene::LampKind::Point, {2, 2, 4}, {0, 0, -1}, 40.0F),
              add_lamp(scene, scene::LampKind::Spot, {-2, -2, 5}, {0.2F, 0.2F, -1}, 40.0F),
              add_lamp(scene, scene::LampKind::Sun, {0, 0, 9}, {0.3F, 0.1F, -1}, 1.0F),
              add_lamp(scene, scene::LampKind::Point, {-3, 3, 4}, {0, 0, -1}, 20.0F)};
    scene.edit(lamps_[3], [](scene::Lamp &lamp) { lamp.shadow.kind = scene::ShadowKind::Esm; });
    scene::Lamp area;
    area.kind = scene::LampKind::Area;
    area.intensity = 10.0F;
    lamps_.push_back(add_lamp(scene, std::move(area), glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, -3.0, 4.0))));
    for (const std::size_t i : {0, 1, 3}) {
      scene.edit(lamps_[i], [](scene::Lamp &lamp) { lamp.radius = 0.1F; });
    }
    scene.edit(lamps_[2], [](scene::Lamp &lamp) { lamp.angle = 0.01F; });
  }

  /** One edit, a different one for each \a frame, the same in each scene. */
  void edit(int frame)
  {
    switch (frame % 9) {
      case 0: move(boxes_[random() % boxes_.size()]); break;
      case 1:
        scene.edit(lamps_[random() % lamps_.size()],
                   [&](scene::Lamp &lamp) { lamp.intensity = float(1 + random() % 9); });
        break;
      case 2:
        if (boxes_.size() < 8) {
          boxes_.push_back(add_box(frame));
        }
        break;
      case 3: move(node_of_lamp(random() % lamps_.size())); break;
      case 4:
        scene.edit(materials_[random() % 3],
                   [&](scene::Material &value) { value.base_color.g = 0.1F * float(random() % 9); });
        break;
      case 5:
        if (boxes_.size() > 2) {
          scene.remove(boxes_.back());
          boxes_.pop_back();
        }
        break;
      case 6:
        scene.edit(scene.textures()[texture_].image,
                   [&](scene::Image &value) { value.texels[0] = std::uint8_t(random()); });
        break;
      case 7:
        scene.edit(meshes_[random() % 2],
                   [&](scene::Mesh &value) { value.positions[0].z = 1.0F + 0.01F * float(random() % 9); });
        break;
      default: break;
    }
  }

  /** On a circle around the scene, which ends after \a count frames. */
  [[nodiscard]] static scene::PlacedCamera camera(int frame, int count = 32)
  {
    const float angle = 6.2831853F * float(frame % count) / float(count);
    return measure::camera_at({8.0F * std::cos(angle), 8.0F * std::sin(angle), 5.0F}, {0, 0, 0});
  }

  scene::Scene scene;

 private:
  std::uint32_t random()
  {
    return std::uint32_t(random_());
  }
  scene::Handle<scene::Node> add_box(int number)
  {
    return measure::add_object(scene, meshes_[std::size_t(number % 2)], box_at(number % 3, number % 5));
  }
  static glm::dmat4 box_at(int x, int y)
  {
    return glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(1.6 * x - 2.0, 1.2 * y - 2.0, 0.6)), glm::dvec3(0.5));
  }
  void move(scene::Handle<scene::Node> node)
  {
    const glm::dvec3 offset(0.1 * double(random() % 9) - 0.4, 0.1 * double(random() % 9) - 0.4, 0.0);
    scene.edit(node, [&](scene::Node &value) { value.parent_from_node[3] += glm::dvec4(offset, 0.0); });
  }
  scene::Handle<scene::Node> node_of_lamp(std::size_t lamp) const
  {
    for (const scene::PlacedLamp &placed : scene.placed_lamps()) {
      if (scene.nodes()[placed.node].lamp == lamps_[lamp]) {
        return placed.node;
      }
    }
    return {};
  }

  std::minstd_rand random_;
  std::vector<scene::Handle<scene::Material>> materials_;
  scene::Handle<scene::Texture> texture_;
  std::vector<scene::Handle<scene::Mesh>> meshes_;
  std::vector<scene::Handle<scene::Node>> boxes_;
  std::vector<scene::Handle<scene::Lamp>> lamps_;
};

/** Small maps of all kinds. */
[[nodiscard]] inline eevee::Settings frames_settings()
{
  return {.shadow = {.cube_size_px = 32, .map_size_px = 64, .esm = {.size_px = 16}, .is_fitted_to_depth = true},
          .sample_count = 1};
}

}  // namespace gnomon::test
