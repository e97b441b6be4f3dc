// SPDX-License-Identifier: MIT
#include "internal/stability_images.hh"

#include "eevee_esm_shared.h"
#include "eevee_light_shared.h"
#include "eevee_shadow_shared.h"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::verify {

namespace {

/** A picture with the same value at all pixels. */
Picture even(const Picture &like, double value)
{
  return {like.size_px, {like.pixels.size(), glm::vec4(glm::vec3(float(value)), 1.0F)}};
}

/** \a count lamps at the position of one, with the same total intensity. 0: no lamp. */
TestView crowd(LampKind kind, int count)
{
  TestView test_view = table(kind);
  const scene::PlacedLamp lamp = test_view.scene.placed_lamps().front();
  remove_lamps(test_view.scene);
  for (int i = 0; i < count; i++) {
    scene::Lamp one = lamp;
    one.name = fmt::format("lamp{}", i);
    one.intensity = lamp.intensity / float(count);
    // Small enough for the shadows of all lamps.
    one.shadow.size = one.shadow.esm_size = 32;
    add_lamp(test_view.scene, std::move(one), lamp.world_from_lamp);
  }
  return test_view;
}

/** Whether a reported limit names the lamp. */
bool is_named(const eevee::Report &report, int lamp)
{
  return std::ranges::any_of(
      report.limits, [&](const std::string &limit) { return limit.find(fmt::format("'lamp{}'", lamp)) != limit.npos; });
}

}  // namespace

void add_count_images(ImageCases &cases)
{
  cases.add({"size", "of pictures", "radiance of a ground under a sun, at every pixel",
             "1 1x1, 2 16384x1, 3 1x16384, 4 16384x16 (or the largest edge of the device), 5 3x5", "closed form",
             "largest error, relative"},
            // Rounding of the film's weights.
            1e-6, {1, 2, 3, 4, 5}, [](TestViewRenderer &renderer, double kind) {
              const int edge = std::min(16384, renderer.limits().texture_size_max);
              const std::array<glm::ivec2, 5> sizes = {{{1, 1}, {edge, 1}, {1, edge}, {edge, 16}, {3, 5}}};
              TestView test_view = ground(LampKind::Sun, {}, {0, 0, -1});
              test_view.camera.kind = scene::CameraKind::Orthographic;
              test_view.camera.half_width = test_view.camera.half_height = 1e-4F;
              const Picture picture = renderer.draw(test_view, with(ShadowKind::Hard, sizes[std::size_t(kind) - 1], 1));
              return largest_error(picture, even(picture, 0.8 / pi));
            });
  struct Count {
    Variant variant;
    int most;
  };
  const DrawSettings one_sample = with(ShadowKind::None, {64, 48}, 1);
  for (const LampKind kind : {LampKind::Point, LampKind::Spot, LampKind::Sun, LampKind::Hemi}) {
    // A sum with as many roundings as lamps. Above LIGHT_MAX they are read from a texture.
    cases.add({"count", fmt::format("lamps, {}", name_of(kind)), "picture of this many lamps at one position", "lamps",
               "picture of one lamp"},
              2e-5, {0, 1, LIGHT_MAX - 1, LIGHT_MAX, LIGHT_MAX + 1, 1000},
              [kind, one_sample](TestViewRenderer &renderer, double count) {
                Picture expected = renderer.draw(crowd(kind, 1), one_sample);
                for (glm::vec4 &pixel : expected.pixels) {
                  pixel *= count > 0.0 ? 1.0F : 0.0F;
                }
                return relative_rmse(renderer.draw(crowd(kind, int(count)), one_sample), expected);
              });
  }
  for (const Count &count : {Count{{LampKind::Point, ShadowKind::Hard}, SHADOW_CUBE_MAX},
                             {{LampKind::Spot, ShadowKind::Hard}, SHADOW_MAP_MAX},
                             {{LampKind::Point, ShadowKind::Esm}, ESM_MAX}}) {
    const DrawSettings settings = with(count.variant.shadow, {16, 12}, 1);
    cases.add({"count", fmt::format("shadows, {}", count.variant.name()),
               "picture of this many lamps with shadows at one position; a lamp without a shadow map is named", "lamps",
               "picture of one lamp"},
              2e-5, {1, double(count.most), double(count.most + 1)},
              [count, settings](TestViewRenderer &renderer, double lamps) {
                const Picture by_one = renderer.draw(crowd(count.variant.lamp, 1), settings);
                const TestView test_view = crowd(count.variant.lamp, int(lamps));
                const Picture picture = renderer.draw(test_view, settings);
                const bool is_lost = is_named(renderer.report(settings), int(lamps) - 1);
                // The lamp that loses its shadow also lights receivers in shadow. This is the documented effect of the
                // limit, and the limit is named.
                return is_lost == (lamps > count.most) ? (is_lost ? 0.0 : relative_rmse(picture, by_one)) : 1.0;
              });
  }
}

}  // namespace gnomon::verify
