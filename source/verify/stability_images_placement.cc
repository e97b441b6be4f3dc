// SPDX-License-Identifier: MIT
#include "internal/stability_images.hh"

#include "shadows/shadow_cube.hh"

#include <fmt/format.h>

#include <limits>

namespace gnomon::verify {

namespace {

/** The picture mirrored from left to right. */
Picture mirrored(const Picture &picture)
{
  Picture result = picture;
  for (int y = 0; y < picture.size_px.y; y++) {
    for (int x = 0; x < picture.size_px.x; x++) {
      result.pixels[std::size_t(y * picture.size_px.x + x)] = picture.at(picture.size_px.x - 1 - x, y);
    }
  }
  return result;
}

}  // namespace

void add_placement_images(ImageCases &cases)
{
  const auto against_truth = [](TestViewRenderer &renderer, const TestView &test_view, ShadowKind shadow) {
    return relative_rmse(renderer.draw(test_view, with(shadow)), truth(test_view, with(shadow)));
  };
  for (const Variant &variant : variants) {
    const auto error_at = [variant, against_truth](TestViewRenderer &renderer, double scale) {
      return against_truth(renderer, placed(table(variant.lamp), glm::dmat4(1.0), scale), variant.shadow);
    };
    const char *quantity = "picture of a scene of 10 m, scaled with the same irradiance";
    if (bound_of(variant.shadow) == sharp_bound) {
      cases.add({"scale", variant.name(), quantity, "scale", exact_rays}, sharp_bound, {1e-4, 1e-2, 1.0, 1e2, 1e5},
                error_at);
    }
    else {
      cases.add({"scale", variant.name(), quantity, "scale", exact_rays}, soft_bound, {1e-2, 1.0, 1e2}, error_at);
      // Exponents are limited to 0.01 to 1e4 /m: shadows of a scene of a millimetre are soft, those of 1000 km hard.
      // Measured: 0.1.
      cases.add({"scale", variant.name() + ", at the limits of exponents", quantity, "scale", exact_rays}, 0.12,
                {1e-4, 1e5}, error_at);
    }
  }
  const auto offset = [](double by) { return glm::translate(glm::dmat4(1.0), by * glm::dvec3(1.0, 0.6, -0.3)); };
  for (const Variant &variant : variants) {
    // Positions are floats. An error of one ulp moves an edge by a fraction of a pixel, which is 0.13 m here. Measured
    // at 100 km, where an ulp is 8 mm: 7 per metre. From 1000 km on, with ulps of 6 cm, the case requires only that the
    // picture is finite.
    cases.add({"offset", variant.name(),
               "picture of a scene of 10 m at this distance from the origin, less 8 per metre of its coordinates' ulp",
               "m", exact_rays},
              bound_of(variant.shadow), {0.0, 1e3, 1e4, 1e5, 1e6, 1e8},
              [variant, offset, against_truth](TestViewRenderer &renderer, double by) {
                const double ulp =
                    double(std::nextafter(float(by), std::numeric_limits<float>::infinity())) - double(float(by));
                const double error = against_truth(renderer, placed(table(variant.lamp), offset(by)), variant.shadow);
                return std::isnan(error) ? error : std::max(error - 8.0 * ulp, 0.0);
              });
  }
  for (const Variant &variant : {variants[0], variants[2], variants[4], variants[8]}) {
    // At 1e8 m the exponents reach their limit, too.
    cases.add({"offset", variant.name() + ", scaled", "picture of a scene with the size of a thousandth of its offset",
               "m", exact_rays},
              variant.shadow == ShadowKind::Esm ? 0.07 : sharp_bound, {1e2, 1e4, 1e6, 1e8},
              [variant, offset, against_truth](TestViewRenderer &renderer, double by) {
                return against_truth(renderer, placed(table(variant.lamp), offset(by), 1e-4 * by), variant.shadow);
              });
  }
  // One sample: the positions of several samples are not symmetric.
  const DrawSettings one_sample = with(ShadowKind::Hard, DrawSettings().size_px, 1);
  const auto against_itself = [one_sample](TestViewRenderer &renderer, const TestView &moved_view,
                                           const TestView &test_view, bool is_mirrored) {
    const Picture picture = renderer.draw(moved_view, one_sample);
    return relative_rmse(is_mirrored ? mirrored(picture) : picture, renderer.draw(test_view, one_sample));
  };
  for (const LampKind kind : lamp_kinds) {
    // A spot's map rotates with the spot. A cube and a sun's grid are fixed in the world, so their texels change.
    // Measured: 0.035.
    cases.add({"turn", name_of(kind), "picture of a scene rotated about (1, 2, 3)", "angle, rad",
               "picture of the original scene"},
              kind == LampKind::Spot ? 1e-4 : 0.06, {0.0, 0.1, 1.0, 0.5 * pi, 2.0, pi},
              [kind, against_itself](TestViewRenderer &renderer, double turn) {
                const TestView test_view = table(kind);
                const glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), turn, glm::normalize(glm::dvec3(1, 2, 3)));
                return against_itself(renderer, placed(test_view, turned), test_view, false);
              });
    // Only rounding, also at the edges of texels.
    cases.add({"turn", fmt::format("{}, axes exchanged", name_of(kind)), "picture of a scene with exchanged axes",
               "axis", "picture of the original scene"},
              1e-4, {0, 1, 2, 3, 4, 5}, [kind, against_itself](TestViewRenderer &renderer, double axis) {
                const TestView test_view = table(kind);
                const glm::dmat4 turned{glm::dmat3(glm::transpose(glm::mat3(eevee::cubefacemat[std::size_t(axis)])))};
                return against_itself(renderer, placed(test_view, turned), test_view, false);
              });
    cases.add(
        {"mirror", name_of(kind), "picture of a mirrored scene, mirrored", "axis", "picture of the original scene"},
        1e-4, {0, 1, 2}, [kind, against_itself](TestViewRenderer &renderer, double axis) {
          const TestView test_view = table(kind);
          glm::dmat4 mirror(1.0);
          mirror[int(axis)][int(axis)] = -1.0;
          return against_itself(renderer, placed(test_view, mirror), test_view, true);
        });
  }
}

}  // namespace gnomon::verify
