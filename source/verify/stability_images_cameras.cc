// SPDX-License-Identifier: MIT
#include "internal/stability_images.hh"

#include <fmt/format.h>

namespace gnomon::verify {

void add_camera_images(ImageCases &cases)
{
  const auto add = [&](const std::string &name, double bound, const char *parameter, std::vector<double> values,
                       std::function<void(TestView &, double)> change) {
    cases.add({"camera", name, "picture with this camera parameter", parameter, exact_rays}, bound, std::move(values),
              [change = std::move(change)](TestViewRenderer &renderer, double value) {
                TestView test_view = table(LampKind::Point);
                change(test_view, value);
                return relative_rmse(renderer.draw(test_view, with(ShadowKind::Hard)),
                                     truth(test_view, with(ShadowKind::Hard)));
              });
  };
  add("near", sharp_bound, "m", {1e-12, 1e-6, 1e-3, 1.0},
      [](TestView &test_view, double near) { test_view.camera.near = float(near); });
  add("far / near", sharp_bound, "ratio", {20, 1e3, 1e6, 1e9, 1e12}, [](TestView &test_view, double ratio) {
    test_view.camera.near = ratio > 1e6 ? 1e-6F : 1.0F;
    test_view.camera.far = float(double(test_view.camera.near) * ratio);
  });
  const auto with_lens = [](double radius, double focus) {
    TestView test_view = table(LampKind::Point);
    test_view.camera.aperture_radius = float(radius);
    test_view.camera.focus_distance = float(focus);
    return test_view;
  };
  for (const double focus : {1e-12, 0.1, 10.0, 1e12, 0.0}) {
    cases.add({"camera", fmt::format("small aperture, focus {:g} m", focus), "picture with this aperture", "m",
               "the picture of a pinhole"},
              1e-3, {0.0, 1e-24, 1e-18}, [=](TestViewRenderer &renderer, double radius) {
                const DrawSettings settings = with(ShadowKind::Hard, {64, 48}, 4);
                return relative_rmse(renderer.draw(with_lens(radius, focus), settings),
                                     renderer.draw(with_lens(0.0, focus), settings));
              });
    cases.add({"camera", fmt::format("wide aperture, focus {:g} m", focus), "pixels that are not finite", "m",
               "closed form", "share of pixels"},
              0.0, {1e-2, 1.0, 1e3, 1e6, 1e12}, [=](TestViewRenderer &renderer, double radius) {
                const Picture picture = renderer.draw(with_lens(radius, focus), with(ShadowKind::Hard, {64, 48}, 4));
                return double(picture.non_finite_count()) / double(picture.pixels.size());
              });
  }
  // Small objects in the picture have a larger fraction of edges.
  add("angle", 0.06, "rad", {1e-4, 1e-2, 0.5, 1.0, 2.0},
      [](TestView &test_view, double angle) { test_view.camera.vertical_angle = float(angle); });
  add("parallel", 0.06, "half height, m", {1e-4, 1e-2, 1.0, 3.0}, [](TestView &test_view, double half) {
    test_view.camera.kind = scene::CameraKind::Orthographic;
    test_view.camera.half_height = float(half);
    test_view.camera.half_width = float(half * 64.0 / 48.0);
  });
  const auto parallel_far = [](TestView &test_view, double far) {
    test_view.camera.kind = scene::CameraKind::Orthographic;
    test_view.camera.half_height = 2.0F;
    test_view.camera.half_width = 2.0F * 64.0F / 48.0F;
    test_view.camera.far = float(far);
  };
  add("parallel, far", sharp_bound, "m", {10, 1e3, 1e5}, parallel_far);
  // Depths of a parallel view are linear: at 1e9 m the spacing of floats is 60 m, and the object drawn last is in
  // front. Measured: 0.08.
  add("parallel, too far", 0.15, "m", {1e6, 1e9, 1e12}, parallel_far);
  // Two-sided: the picture shows the box's inner walls. One-sided: it shows the ground through them.
  for (const bool is_double_sided : {true, false}) {
    for (const bool is_lamp_inside : {true, false}) {
      add(fmt::format("inside a box, {}, lamp {}", is_double_sided ? "two-sided" : "one-sided",
                      is_lamp_inside ? "inside too" : "outside"),
          // Relative to a radiance of 1.
          sharp_bound, "half size of the box, m", {0.1, 1.0, 10.0}, [=](TestView &test_view, double half) {
            scene::Scene &scene = test_view.scene;
            edit_material(test_view, [&](scene::Material &material) { material.is_double_sided = is_double_sided; });
            const glm::vec3 at(0.3F, -5, 4);
            add_object(scene, handle_at(scene.meshes(), 1), moved(at) * scaled(glm::vec3(float(half))));
            test_view.camera.near = 1e-4F;
            if (is_lamp_inside) {
              const scene::PlacedLamp lamp = scene.placed_lamps().front();
              glm::dmat4 matrix = lamp.world_from_lamp;
              matrix[3] = glm::vec4(at + float(half) * glm::vec3(0.3F, -0.5F, 0.4F), 1.0F);
              scene.set_transform(lamp.node, matrix);
              edit_lamp(test_view, [&](scene::Lamp &changed) { changed.intensity = float(half * half); });
            }
          });
    }
  }
  cases.add({"camera", "depths apart", "pixels of a red plate where a green one behind it is visible",
             "distance between the plates, relative", "closed form", "share of pixels"},
            0.0, {1e-2, 1e-3, 1e-4, 1e-5, 3e-6}, [](TestViewRenderer &renderer, double gap) {
              TestView test_view;
              for (const int i : {0, 1}) {
                const auto material = add_material(test_view.scene, glm::vec3(0.0F));
                test_view.scene.edit(material, [&](scene::Material &changed) {
                  changed.emissive = i == 0 ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
                });
                // Tilted by the same angle, so that depths differ between pixels.
                const double distance = i == 0 ? 100.0 : 100.0 * (1.0 + gap);
                add_object(test_view.scene, add_square_mesh(test_view.scene, material),
                           glm::mat4(glm::rotate(glm::translate(glm::dmat4(1.0), {0, 0, -distance}), 0.5, {1, 2, 0})) *
                               scaled(glm::vec3(1e3F)));
              }
              test_view.camera = camera_at({0, 0, 0}, {0, 0, -1});
              test_view.camera.near = 1e-6F;
              test_view.camera.far = 1e3F;
              const Picture picture = renderer.draw(test_view, with(ShadowKind::None, {64, 48}, 1));
              std::size_t wrong = 0;
              for (const glm::vec4 &pixel : picture.pixels) {
                wrong += std::abs(pixel.r - 1.0F) > 1e-5F || pixel.g > 1e-5F ? 1 : 0;
              }
              return picture.non_finite_count() > 0 ? std::nan("") : double(wrong) / double(picture.pixels.size());
            });
}

}  // namespace gnomon::verify
