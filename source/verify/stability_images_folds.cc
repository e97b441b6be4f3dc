// SPDX-License-Identifier: MIT
#include "internal/stability_images.hh"

#include <fmt/format.h>

namespace gnomon::verify {

namespace {

/** Walls around a lamp, viewed from it along \a direction, with a plate in between. */
TestView room(const glm::vec3 &direction)
{
  TestView test_view;
  scene::Scene &scene = test_view.scene;
  const auto material = add_material(scene, glm::vec3(0.8F));
  const auto box = add_box_mesh(scene, material);
  const auto square = add_square_mesh(scene, material);
  add_object(scene, box, scaled({5, 4, 4.5F}));
  const glm::vec3 forward = glm::normalize(direction);
  const glm::vec3 up = std::abs(forward.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
  // Covers the left half of the picture.
  add_object(
      scene, square,
      glm::inverse(glm::lookAt(glm::vec3(0.0F), forward, up)) * moved({-1.0F, 0.1F, -2.2F}) * scaled({0.8F, 0.6F, 1}));
  add_lamp(scene, LampKind::Point, {0.05F, 0.03F, 0.02F}, {0, 0, -1}, 20.0F);
  test_view.camera = camera_at(1.2F * forward + 1.3F * up + glm::vec3(0.02F), 3.5F * forward, 1.4F);
  return test_view;
}

/** Directions of the faces, edges and corners of a cube. Each lies along a face or fold of the octahedron. */
glm::vec3 cube_direction(double index)
{
  const std::array<glm::vec3, 8> directions = {
      {{1, 0, 0}, {0, 0, 1}, {0, 0, -1}, {1, 1, 0}, {1, 0, -1}, {0, -1, 1}, {1, 1, 1}, {-1, 1, -1}}};
  return directions[std::size_t(index)];
}

}  // namespace

void add_fold_images(ImageCases &cases)
{
  for (const ShadowKind shadow : {ShadowKind::Hard, ShadowKind::Pcf, ShadowKind::Esm, ShadowKind::Evsm}) {
    cases.add({"fold", fmt::format("edges of cube and octahedron, {}", name_of(shadow)),
               "picture of a wall, an edge or a corner of a room, from a lamp in its middle",
               "0 +X, 1 +Z, 2 -Z, 3 to 5 edges, 6 and 7 corners", exact_rays},
              bound_of(shadow), {0, 1, 2, 3, 4, 5, 6, 7}, [shadow](TestViewRenderer &renderer, double index) {
                const TestView test_view = room(cube_direction(index));
                return relative_rmse(renderer.draw(test_view, with(shadow)), truth(test_view, with(shadow)));
              });
  }
  for (const ShadowKind shadow : {ShadowKind::Esm, ShadowKind::Evsm}) {
    cases.add({"exponent", fmt::format("lit stays lit, {}", name_of(shadow)),
               "share of an open ground that an exponent darkens by 2 %", "exponent, 1/m", "picture without shadows",
               "share of pixels"},
              0.0, {0.01, 0.1, 1, 10, 100, 1e3, 1e4}, [shadow](TestViewRenderer &renderer, double exponent) {
                TestView test_view = ground(LampKind::Point, {0.2F, 0.1F, 2}, {0, 0, -1});
                const Picture lit = renderer.draw(test_view, with(ShadowKind::None));
                edit_lamp(test_view, [&](scene::Lamp &lamp) { lamp.shadow.exponent = float(exponent); });
                return wrong_share(renderer.draw(test_view, with(shadow)), lit, 0.02);
              });
  }
  cases.add({"exponent", "light behind a caster", "visibility 1 m and more behind a plate, against exp(-c (d - d0))",
             "exponent, 1/m", "closed form", "largest error"},
            // The normal offset of the receiver: half a centimetre.
            0.01, {0.01, 0.1, 1, 3, 10, 100, 1e3, 1e4}, [](TestViewRenderer &renderer, double exponent) {
              TestView test_view = ground(LampKind::Point, {0.05F, 0.03F, 2}, {0, 0, -1});
              // Below the plate, so that the plate is not visible.
              test_view.camera = camera_at({0.05F, 0.03F, 0.9F}, {0.05F, 0.03F, 0}, 0.6F);
              const DrawSettings settings = with(ShadowKind::None, {64, 48}, 1);
              const Picture lit = renderer.draw(test_view, settings);
              add_object(test_view.scene, test_view.scene.meshes().first(), moved({0, 0, 1}) * scaled(glm::vec3(1.5F)));
              edit_lamp(test_view, [&](scene::Lamp &lamp) { lamp.shadow.exponent = float(exponent); });
              const Picture shadowed = renderer.draw(test_view, with(ShadowKind::Esm, {64, 48}, 1));
              if (shadowed.non_finite_count() > 0) {
                return std::nan("");
              }
              double worst = 0.0;
              for (int y = 1; y < 47; y++) {
                for (int x = 1; x < 63; x++) {
                  // Distance from the point on the ground below the lamp. The plate is half way to the lamp.
                  const double half = 0.9 * std::tan(0.3);
                  const glm::dvec2 from_middle =
                      (glm::dvec2(x + 0.5, y + 0.5) / 24.0 - glm::dvec2(64.0 / 48.0, 1.0)) * half;
                  const double distance = std::sqrt(glm::dot(from_middle, from_middle) + 4.0);
                  const double expected = std::exp(-exponent * 0.5 * distance);
                  worst = std::max(worst, std::abs(double(shadowed.at(x, y).r) / double(lit.at(x, y).r) - expected));
                }
              }
              return worst;
            });
}

}  // namespace gnomon::verify
