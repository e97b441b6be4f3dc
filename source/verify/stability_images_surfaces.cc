// SPDX-License-Identifier: MIT
#include "internal/stability_images.hh"

#include <fmt/format.h>

namespace gnomon::verify {

void add_surface_images(ImageCases &cases)
{
  for (const float metallic : {0.0F, 1.0F}) {
    cases.add({"material", metallic > 0.0F ? "metal" : "dielectric", "picture of a scene of this roughness",
               "roughness", exact_rays},
              // The metal shows a highlight smaller than a pixel on black. Measured: 0.16.
              metallic > 0.0F ? 0.25 : sharp_bound, {0.0, 1e-6, 1e-3, 0.03, 0.1, 0.3, 1.0},
              [metallic](TestViewRenderer &renderer, double roughness) {
                TestView test_view = table(LampKind::Point);
                edit_material(test_view, [&](scene::Material &material) {
                  material.metallic = metallic;
                  material.roughness = float(roughness);
                  material.specular_color = glm::vec3(1.0F);
                });
                return relative_rmse(renderer.draw(test_view, with(ShadowKind::Hard)),
                                     truth(test_view, with(ShadowKind::Hard)));
              });
  }
  cases.add(
      {"material", "mirror of a sun", "radiance of smooth metal where it reflects the sun", "roughness", "closed form",
       "relative"},
      1e-6, {0.0, 0.01, 0.03, 0.1, 1.0}, [](TestViewRenderer &renderer, double roughness) {
        TestView test_view = ground(LampKind::Sun, {}, {0, 0, -1});
        edit_material(test_view, [&](scene::Material &material) {
          material.metallic = 1.0F;
          material.base_color = glm::vec3(1.0F);
          material.roughness = float(roughness);
        });
        test_view.camera.kind = scene::CameraKind::Orthographic;
        test_view.camera.half_width = test_view.camera.half_height = 1.0F;
        const Picture picture = renderer.draw(test_view, with(ShadowKind::None, {8, 8}, 1));
        // At normal incidence: D / 4, without masking. Walter et al. 2007, eq. 33 at an angle of 0.
        const double alpha = std::max(double(float(roughness)) * double(float(roughness)), 1e-3);
        const double expected = 1.0 / (4.0 * pi * alpha * alpha);
        return largest_error(picture, Picture{picture.size_px, {picture.pixels.size(), glm::vec4(float(expected))}});
      });
  cases.add({"triangles", "without area", "picture of a scene with additional triangles",
             "1 equal corners, 2 two equal corners, 3 in a line, 4 1e-30 high, 5 1e-38 large, 6 1e12 long",
             "picture without"},
            0.0, {1, 2, 3, 4, 5, 6}, [](TestViewRenderer &renderer, double kind) {
              TestView test_view = table(LampKind::Point);
              const Picture without = renderer.draw(test_view, with(ShadowKind::Hard));
              scene::Mesh mesh = test_view.scene.meshes()[test_view.scene.meshes().first()];
              switch (int(kind)) {
                case 1: mesh.positions.assign(4, {0.1F, 0.2F, 1}); break;
                case 2: mesh.positions = {{0, 0, 1}, {0, 0, 1}, {1, 0, 1}, {1, 0, 1}}; break;
                case 3: mesh.positions = {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}, {-1, -1, 1}}; break;
                case 4: mesh.positions = {{0, 0, 1}, {1, 0, 1}, {1, 0, 1}, {0, 1e-30F, 1}}; break;
                case 5: mesh.positions = {{0, 0, 1}, {1e-38F, 0, 1}, {1e-38F, 1e-38F, 1}, {0, 1e-38F, 1}}; break;
                default: mesh.positions = {{-1e12F, 0, 1}, {1e12F, 0, 1}, {1e12F, 0, 1}, {-1e12F, 0, 1}}; break;
              }
              add_object(test_view.scene, test_view.scene.add(std::move(mesh)), glm::mat4(1.0F));
              return relative_rmse(renderer.draw(test_view, with(ShadowKind::Hard)), without);
            });
  struct Matrix {
    const char *name;
    const char *parameter;
    std::vector<double> values;
    glm::mat4 (*make)(double value);
  };
  const std::vector<Matrix> matrices = {{"sheared",
                                         "shear",
                                         {0.0, 0.5, 2.0, 10.0},
                                         [](double shear) {
                                           glm::mat4 matrix(1.0F);
                                           matrix[2][0] = float(shear);
                                           matrix[0][1] = 0.3F * float(shear);
                                           return matrix;
                                         }},
                                        {"mirrored",
                                         "axis",
                                         {0, 1, 2},
                                         [](double axis) {
                                           glm::mat4 matrix(1.0F);
                                           matrix[int(axis)][int(axis)] = -1.0F;
                                           return matrix;
                                         }},
                                        {"flattened",
                                         "thickness",
                                         {0.0, 1e-30, 1e-10, 1e-6, 1e-3},
                                         [](double thickness) {
                                           return scaled({1.0F, 1.0F, float(thickness)});
                                         }},
                                        {"stretched",
                                         "ratio",
                                         {1e-3, 1.0, 10.0},
                                         [](double ratio) {
                                           return scaled({1.0F, 1.0F, float(ratio)});
                                         }},
                                        {"singular", "axes left", {0, 1}, [](double axes) {
                                           return scaled({float(axes), 0.0F, 0.0F});
                                         }}};
  for (const Matrix &matrix : matrices) {
    for (const ShadowKind shadow : {ShadowKind::Hard, ShadowKind::Esm}) {
      cases.add({"matrix", fmt::format("{}, {}", matrix.name, name_of(shadow)),
                 "picture of a scene whose box has this matrix", matrix.parameter, exact_rays},
                bound_of(shadow), matrix.values,
                [make = matrix.make, shadow](TestViewRenderer &renderer, double value) {
                  TestView test_view = table(LampKind::Point);
                  const scene::Object box = test_view.scene.objects()[1];
                  test_view.scene.set_transform(box.node, glm::mat4(box.world_from_object) * make(value));
                  return relative_rmse(renderer.draw(test_view, with(shadow)), truth(test_view, with(shadow)));
                });
    }
  }
}

}  // namespace gnomon::verify
