// SPDX-License-Identifier: MIT
#include "internal/stability_images.hh"

#include <fmt/format.h>

#include <limits>

namespace gnomon::verify {

void add_lamp_images(ImageCases &cases)
{
  for (const ShadowKind shadow : {ShadowKind::Hard, ShadowKind::Pcf, ShadowKind::Esm, ShadowKind::Evsm}) {
    cases.add({"lamp", fmt::format("at the receiver, {}", name_of(shadow)),
               "picture of a ground under a lamp at this height", "height, m", exact_rays, "median error"},
              // Exponential maps limit the tangent in the normal offset to 10; here it is 1e9. Measured: 0.23.
              bound_of(shadow) == sharp_bound ? 0.003 : 0.3, {0.0, 1e-9, 1e-6, 1e-3, 1e-2, 1.0},
              [shadow](TestViewRenderer &renderer, double height) {
                const TestView test_view = ground(LampKind::Point, {0.02F, 0.01F, float(height)}, {0, 0, -1});
                return median_error(renderer.draw(test_view, with(shadow)), truth(test_view, with(shadow)));
              });
    cases.add({"lamp", fmt::format("inside a box, {}", name_of(shadow)), "light outside a closed box", "half size, m",
               "closed form: none", "largest radiance relative to that without the box"},
              // ESM has a visibility of exp(-c · d) just behind the wall.
              shadow == ShadowKind::Esm ? 1e-3 : 0.0, {1e-4, 1e-2, 0.3, 1.0},
              [shadow](TestViewRenderer &renderer, double half) {
                TestView test_view = ground(LampKind::Point, {0.02F, 0.01F, 1.5F}, {0, 0, -1});
                const Picture open = renderer.draw(test_view, with(shadow));
                const glm::vec3 at = glm::vec3(0.02F, 0.01F, 1.5F) + float(half) * glm::vec3(0.03F, -0.2F, 0.1F);
                const auto box = add_box_mesh(test_view.scene, test_view.scene.materials().first());
                add_object(test_view.scene, box, moved(at) * scaled(glm::vec3(float(half))));
                // The visible outer walls of the box are dark, too.
                const Picture closed = renderer.draw(test_view, with(shadow));
                double most = 0.0;
                double brightest = 0.0;
                for (std::size_t i = 0; i < open.pixels.size(); i++) {
                  most = std::max(most, double(closed.pixels[i].r));
                  brightest = std::max(brightest, double(open.pixels[i].r));
                }
                return closed.non_finite_count() > 0 ? std::nan("") : most / brightest;
              });
  }
  for (const Variant &variant : variants) {
    cases.add({"lamp", fmt::format("behind everything, {}", variant.name()), "radiance of a ground lit from below",
               "depth below, m", "closed form: none", "largest radiance"},
              0.0, {1e-6, 1e-3, 1.0, 1e3}, [variant](TestViewRenderer &renderer, double depth) {
                TestView test_view = ground(variant.lamp, {0, 0, float(-depth)}, {0.2F, 0, 1});
                edit_lamp(test_view, [&](scene::Lamp &lamp) { lamp.intensity = float(depth * depth); });
                const Picture picture = renderer.draw(test_view, with(variant.shadow));
                return largest_error(picture, Picture{picture.size_px, {picture.pixels.size(), glm::vec4(0.0F)}});
              });
  }
  cases.add({"lamp", "in a wall's plane", "picture of a ground and a wall whose plane contains the lamp",
             "distance from the plane, m", exact_rays},
            sharp_bound, {0.0, 1e-7, 1e-6, 1e-4, 1e-2, -1e-6, -1e-2}, [](TestViewRenderer &renderer, double off) {
              TestView test_view = ground(LampKind::Point, {float(off), 0.3F, 1.0F}, {0, 0, -1});
              add_object(test_view.scene, test_view.scene.meshes().first(),
                         glm::rotate(moved({0, 0, 0.25F}), 0.5F * float(pi), {0, 1, 0}) * scaled({0.25F, 0.5F, 1}));
              return relative_rmse(renderer.draw(test_view, with(ShadowKind::Hard)),
                                   truth(test_view, with(ShadowKind::Hard)));
            });
  cases.add({"lamp", "radius", "picture of a small lamp", "radius, m", exact_rays}, sharp_bound,
            {0.0, 1e-12, 1e-6, 1e-3, 1e-2}, [](TestViewRenderer &renderer, double radius) {
              TestView test_view = table(LampKind::Point);
              edit_lamp(test_view, [&](scene::Lamp &lamp) { lamp.radius = float(radius); });
              return relative_rmse(renderer.draw(test_view, with(ShadowKind::Hard)),
                                   truth(test_view, with(ShadowKind::Hard)));
            });
  for (const ShadowKind shadow : {ShadowKind::Hard, ShadowKind::Esm}) {
    cases.add(
        {"lamp", fmt::format("range, {}", name_of(shadow)), "picture of a lamp of this range", "range, m", exact_rays},
        // At 5 m the lamp lights only the top of the box.
        0.1, {1e-6, 1e-3, 1.0, 5.0, 7.0, 1e3, 1e6, 1e12}, [shadow](TestViewRenderer &renderer, double range) {
          TestView test_view = table(LampKind::Point);
          edit_lamp(test_view, [&](scene::Lamp &lamp) { lamp.range = float(range); });
          return relative_rmse(renderer.draw(test_view, with(shadow)), truth(test_view, with(shadow)));
        });
  }
  for (const LampKind kind : {LampKind::Point, LampKind::Spot, LampKind::Sun, LampKind::Hemi}) {
    cases.add({"lamp", fmt::format("intensity, {}", name_of(kind)), "picture divided by the lamp's intensity",
               "W/sr or W/m²", "picture at 1"},
              // At 1e-30 the products of the lit pass are near the smallest floats.
              1e-4, {1e-30, 1e-6, 1.0, 1e6, 1e12, 1e21, 1e30}, [kind](TestViewRenderer &renderer, double intensity) {
                TestView test_view = table(kind);
                edit_lamp(test_view, [](scene::Lamp &lamp) { lamp.intensity = 1.0F; });
                const Picture at_one = renderer.draw(test_view, with(ShadowKind::Hard));
                edit_lamp(test_view, [&](scene::Lamp &lamp) { lamp.intensity = float(intensity); });
                Picture picture = renderer.draw(test_view, with(ShadowKind::Hard));
                for (glm::vec4 &pixel : picture.pixels) {
                  pixel = glm::vec4(glm::dvec3(pixel) / double(float(intensity)), pixel.a);
                }
                return relative_rmse(picture, at_one);
              });
  }
  cases.add({"lamp", "denormal intensity", "difference from the picture at intensity 1, times the intensity", "W/sr",
             "picture at 1", "smallest normal floats"},
            // GPUs may flush denormals to 0. The loss in each of the film's nine texels is below one smallest normal
            // float.
            16.0, {1e-45, 1e-42, 1e-39, 1e-38, 1e-36}, [](TestViewRenderer &renderer, double intensity) {
              TestView test_view = table(LampKind::Point);
              edit_lamp(test_view, [](scene::Lamp &lamp) { lamp.intensity = 1.0F; });
              const Picture at_one = renderer.draw(test_view, with(ShadowKind::Hard));
              edit_lamp(test_view, [&](scene::Lamp &lamp) { lamp.intensity = float(intensity); });
              const Picture picture = renderer.draw(test_view, with(ShadowKind::Hard));
              double most = 0.0;
              for (std::size_t i = 0; i < picture.pixels.size(); i++) {
                const double expected = double(at_one.pixels[i].r) * double(float(intensity));
                most = std::max(most, std::abs(double(picture.pixels[i].r) - expected));
              }
              return picture.non_finite_count() > 0 ? std::nan("") : most / double(std::numeric_limits<float>::min());
            });
  for (const double blend : {0.0, 1e-6, 0.01, 0.5, 1.0}) {
    cases.add(
        {"spot", fmt::format("blend {}", blend), "picture filled by a spot's cone", "opening, degrees", exact_rays},
        // Edges. At 0.001° the rounding of a direction is 1 % of the angle.
        0.05, {1e-3, 1e-2, 0.1, 1, 30, 90, 120, 179, 180}, [blend](TestViewRenderer &renderer, double degrees) {
          TestView test_view = ground(LampKind::Spot, {0, 0, 4.0F}, {0.0F, 0.0F, -1.0F});
          const auto outer_angle = float(std::min(degrees * pi / 360.0, 0.5 * pi));
          edit_lamp(test_view, [&](scene::Lamp &lamp) {
            lamp.spot_outer_angle = outer_angle;
            lamp.spot_blend = float(blend);
          });
          // The picture is slightly wider than the cone.
          const double half = 4.0 * std::tan(std::min(double(outer_angle), 0.8));
          test_view.camera = camera_at({0, 0, 3}, {0, 0, 0}, float(2.0 * std::atan(1.5 * half / 3.0)));
          return relative_rmse(renderer.draw(test_view, with(ShadowKind::None)),
                               truth(test_view, with(ShadowKind::None)));
        });
  }
  for (const ShadowKind shadow : {ShadowKind::Hard, ShadowKind::Pcf, ShadowKind::Esm, ShadowKind::Evsm}) {
    cases.add({"spot", fmt::format("opening, {}", name_of(shadow)), "picture of a spot with its shadow", "degrees",
               exact_rays},
              bound_of(shadow), {90, 119, 120, 121, 150, 180}, [shadow](TestViewRenderer &renderer, double degrees) {
                TestView test_view = table(LampKind::Spot);
                edit_lamp(test_view, [&](scene::Lamp &lamp) {
                  lamp.spot_outer_angle = float(std::min(degrees * pi / 360.0, 0.5 * pi));
                });
                return relative_rmse(renderer.draw(test_view, with(shadow)), truth(test_view, with(shadow)));
              });
  }
  for (const Variant &variant : variants) {
    if (variant.lamp == LampKind::Spot) {
      continue;
    }
    const auto error_at = [variant](TestViewRenderer &renderer, double elevation) {
      const glm::vec3 to_lamp(std::cos(elevation), 0, std::sin(elevation));
      TestView test_view = ground(variant.lamp, 6.0F * to_lamp, -to_lamp);
      // A caster above, outside of the picture. Without it a sun would have no map.
      add_object(test_view.scene, test_view.scene.meshes().first(), moved({6, -6, 0.5F}) * scaled(glm::vec3(0.05F)));
      return median_error(renderer.draw(test_view, with(variant.shadow)), truth(test_view, with(variant.shadow)));
    };
    const CaseText text = {"grazing",        variant.name(), "picture of a ground under light at this elevation",
                           "elevation, rad", exact_rays,     "median error"};
    if (bound_of(variant.shadow) == sharp_bound) {
      cases.add(text, 1e-3, {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0}, error_at);
    }
    else {
      cases.add(text, 5e-3, {1e-2, 0.1, 1.0}, error_at);
      CaseText flat = text;
      flat.name += ", flat";
      // Exponential maps limit the tangent in the normal offset to 10. Measured: 0.24.
      cases.add(flat, 0.3, {1e-6, 1e-4, 1e-3}, error_at);
    }
  }
}

}  // namespace gnomon::verify
