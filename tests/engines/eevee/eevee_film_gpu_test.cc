// SPDX-License-Identifier: MIT
// The film as the driver draws it, compared with the sum that its weights define.
#include "eevee_pixel_filter.hh"
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>

namespace gnomon::eevee {
namespace {

/** An emissive rectangle, in pixels from the middle of the picture; y is up. */
struct Patch {
  glm::dvec2 minimum;
  glm::dvec2 maximum;
  glm::vec3 radiance;
};

/** Edges at all places in quads of pixels, and at the rim of the picture. */
constexpr std::array<Patch, 4> patches = {{{{-20.0, -20.0}, {20.0, 20.0}, {0.1F, 0.2F, 0.3F}},
                                           {{-5.38, -20.0}, {-3.38, 2.62}, {7.0F, 0.5F, 0.0F}},
                                           {{-1.38, -3.38}, {-0.38, -2.38}, {0.0F, 1e4F, 2.0F}},
                                           {{0.62, -4.38}, {20.0, 3.62}, {1.0F, 2.0F, 5.0F}}}};

glm::dvec3 radiance_at(const glm::dvec2 &place_px)
{
  glm::dvec3 radiance(0.0);
  for (const Patch &patch : patches) {
    if (glm::all(glm::greaterThan(place_px, patch.minimum)) && glm::all(glm::lessThan(place_px, patch.maximum))) {
      radiance = glm::dvec3(patch.radiance);
    }
  }
  return radiance;
}

class FilmGpuTest : public test::SharedDeviceTest {};

TEST_F(FilmGpuTest, EachPixelAddsTheWeightedSamplesOfNinePixels)
{
  scene::Scene scene;
  double height = 0.0;
  for (const Patch &patch : patches) {
    const auto material = test::add_material(scene, glm::vec3(0.0F));
    scene.edit(material, [&](scene::Material &edited) { edited.emissive = patch.radiance; });
    const glm::dvec2 centre = 0.5 * (patch.minimum + patch.maximum);
    const glm::dvec2 half = 0.5 * (patch.maximum - patch.minimum);
    test::add_object(scene, test::add_square_mesh(scene, material),
                     glm::scale(glm::translate(glm::dmat4(1.0), {centre, height}), {half, 1.0}));
    height += 0.1;
  }
  // An odd size: quads at the right and at the top are not whole.
  const glm::ivec2 size_px(15, 11);
  scene::PlacedCamera camera = test::camera_at({0, 0, 5}, {0, 0, 0}, 0.2F);
  camera.kind = scene::CameraKind::Orthographic;
  camera.far = 10.0F;
  camera.half_width = 0.5F * float(size_px.x);
  camera.half_height = 0.5F * float(size_px.y);
  for (const int count : {1, 5}) {
    test::Renderer renderer(*device, scene, size_px, {.sample_count = count});
    const test::Picture picture = renderer.picture(camera);
    const double weight_sum = film_weight_sum(count, 0);
    for (int y = 0; y < size_px.y; y++) {
      for (int x = 0; x < size_px.x; x++) {
        const glm::dvec2 centre = glm::dvec2(x, y) + 0.5 - 0.5 * glm::dvec2(size_px);
        glm::dvec3 sum(0.0);
        double largest = 0.0;
        for (int i = 0; i < count; i++) {
          const FilmWeights weights = film_weights(i, count, 0, weight_sum);
          for (int row = 0; row < 3; row++) {
            for (int column = 0; column < 3; column++) {
              const glm::dvec3 radiance =
                  radiance_at(centre + glm::dvec2(film_offset_px(i, count, 0)) + glm::dvec2(column - 1, row - 1));
              sum += double(weights.columns[column]) * double(weights.rows[row]) * radiance;
              largest = std::max(largest, glm::length(radiance));
            }
          }
        }
        // The largest of the nine is added and subtracted.
        test::expect_near(glm::vec3(picture.at(x, y)), glm::vec3(sum), float(1e-6 * largest));
        ASSERT_FALSE(HasFailure()) << count << " samples, pixel " << x << ", " << y;
      }
    }
  }
}

}  // namespace
}  // namespace gnomon::eevee
