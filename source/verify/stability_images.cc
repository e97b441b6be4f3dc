// SPDX-License-Identifier: MIT
#include "internal/stability_images.hh"

#include <fmt/format.h>

namespace gnomon::verify {

const char *name_of(LampKind kind)
{
  switch (kind) {
    case LampKind::Point: return "point";
    case LampKind::Sun: return "sun";
    case LampKind::Spot: return "spot";
    case LampKind::Hemi: return "hemi";
    case LampKind::Area: break;
  }
  return "area";
}

const char *name_of(ShadowKind kind)
{
  switch (kind) {
    case ShadowKind::None: return "no shadow";
    case ShadowKind::Hard: return "hard";
    case ShadowKind::Pcf: return "pcf";
    case ShadowKind::Esm: return "esm";
    case ShadowKind::Evsm: break;
  }
  return "evsm";
}

std::string Variant::name() const
{
  return fmt::format("{}, {}", name_of(lamp), name_of(shadow));
}

TestView table(LampKind kind)
{
  TestView test_view;
  scene::Scene &scene = test_view.scene;
  const auto material = add_material(scene, {0.8F, 0.6F, 0.4F});
  const auto square = add_square_mesh(scene, material);
  const auto box = add_box_mesh(scene, material);
  add_object(scene, square, scaled(glm::vec3(5.0F)));
  add_object(scene, box, glm::rotate(moved({0.8F, 0.2F, 0.7F}), 0.5F, {0.2F, 0.1F, 1}) * scaled(glm::vec3(0.6F)));
  add_object(scene, square, glm::rotate(moved({-1.1F, -0.4F, 1.2F}), 0.4F, {1, 0.5F, 0}) * scaled(glm::vec3(0.8F)));
  const auto lamp = add_lamp(scene, kind, {1.5F, -1.5F, 4.5F}, {-1.6F, 1.7F, -4}, kind == LampKind::Sun ? 3.0F : 60.0F);
  scene.edit(lamp, [](scene::Lamp &changed) {
    changed.spot_outer_angle = 0.7F;
    changed.spot_blend = 0.3F;
  });
  test_view.camera = camera_at({0.3F, -5, 4}, {0, 0, 0.3F});
  return test_view;
}

TestView ground(LampKind kind, const glm::vec3 &lamp_position, const glm::vec3 &forward)
{
  TestView test_view;
  add_object(test_view.scene, add_square_mesh(test_view.scene, add_material(test_view.scene, glm::vec3(0.8F))),
             scaled(glm::vec3(8.0F)));
  add_lamp(test_view.scene, kind, lamp_position, forward, 1.0F);
  test_view.camera = camera_at({0.05F, 0.03F, 3}, {0.05F, 0.03F, 0}, 0.6F);
  return test_view;
}

std::vector<StabilityCase> image_stability_cases(gpu::Device &device)
{
  ImageCases cases(device);
  add_placement_images(cases);
  add_camera_images(cases);
  add_lamp_images(cases);
  add_surface_images(cases);
  add_count_images(cases);
  add_fold_images(cases);
  return cases.take();
}

}  // namespace gnomon::verify
