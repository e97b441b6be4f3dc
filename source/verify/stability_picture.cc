// SPDX-License-Identifier: MIT
// Pictures from samples to files: sizes from 1 to 16384 pixels, numbers of samples, view transforms.
#include "internal/stability_cases.hh"

#include "draw_view_transform_shared.h"
#include "eevee_camera.hh"
#include "eevee_pixel_filter.hh"

#include <fmt/format.h>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gnomon::verify {

namespace {

constexpr const char *picture_group = "picture";

void add_sample_cases(std::vector<StabilityCase> &cases)
{
  const std::vector<double> sizes = {1, 2, 3, 5, 16, 64, 255, 256, 1000, 1024, 1920, 4096, 8191, 8192, 16383, 16384};
  cases.push_back(
      {.group = picture_group,
       .name = "samples of pictures of 1 px to 16384",
       .quantity = "offset of the picture for a sample at half a pixel",
       .parameter = "width and height, px",
       .reference = "double",
       .unit = "epsilons of the size",
       // Roundings of the offset and of its sum with the matrix.
       .bound = 0.5,
       .run = swept(sizes, [](double size) {
         const glm::ivec2 size_px{int(size)};
         const draw::View view = eevee::view_of({}, size_px);
         double worst = 0.0;
         for (const double distance : {0.1, 1.0, 1e6}) {
           const glm::vec4 point(float(0.1 * distance), float(-0.2 * distance), float(-distance), 1.0F);
           const glm::vec4 before = view.clip_from_view() * point;
           const glm::vec4 after = eevee::with_sample_offset(view, {0.5F, -0.5F}, size_px).clip_from_view() * point;
           for (int axis = 0; axis < 2; axis++) {
             const double moved_px = (double(after[axis]) - double(before[axis])) / double(after.w) * 0.5 * size;
             worst = std::max(worst, std::abs(moved_px - (axis == 0 ? -0.5 : 0.5)));
           }
         }
         return worst / (float_epsilon * size);
       })});
  cases.push_back(
      {.group = picture_group,
       .name = "pictures of any shape",
       .quantity = "camera's frame of 3:2: completely visible and as large as possible",
       .parameter = "width / height",
       .reference = "closed form",
       .unit = epsilon_unit,
       .bound = 2.0,
       .run = swept(log_steps(1.0 / 16384, 16384, 57), [](double shape) {
         const glm::ivec2 size_px =
             shape < 1.0 ? glm::ivec2(1, std::lround(1.0 / shape)) : glm::ivec2(std::lround(shape), 1);
         double worst = 0.0;
         for (const scene::CameraKind kind : {scene::CameraKind::Perspective, scene::CameraKind::Orthographic}) {
           scene::PlacedCamera camera;
           camera.kind = kind;
           camera.aspect = 1.5F;
           camera.half_width = 1.5F;
           const glm::mat4 matrix = eevee::view_of(camera, size_px).clip_from_view();
           const double half_height =
               kind == scene::CameraKind::Perspective ? std::tan(0.5 * double(camera.vertical_angle)) : 1.0;
           const double larger = std::max(half_height * 1.5 * double(matrix[0][0]), half_height * double(matrix[1][1]));
           worst = std::max(worst, std::abs(larger - 1.0) / float_epsilon);
         }
         return worst;
       })});
  const std::vector<double> counts = {1, 2, 3, 4, 5, 7, 16, 31, 64, 100, 256, 1000, 1024, 4096, 16384};
  cases.push_back({.group = picture_group,
                   .name = "pixel filter of 1 to 16384 samples",
                   .quantity = "sum of all samples' weights: 1",
                   .parameter = "samples",
                   .reference = "closed form: 1",
                   .unit = epsilon_unit,
                   // Each weight is rounded once and multiplied once.
                   .bound = 1.0,
                   .run = swept(counts, [](double count) {
                     double worst = 0.0;
                     for (const std::uint32_t seed : {0U, 1U, 4294967295U}) {
                       const double weight_sum = eevee::film_weight_sum(int(count), seed);
                       double sum = 0.0;
                       for (int i = 0; i < int(count); i++) {
                         const eevee::FilmWeights weights = eevee::film_weights(i, int(count), seed, weight_sum);
                         const glm::dvec3 columns(weights.columns);
                         const glm::dvec3 rows(weights.rows);
                         sum += (columns.x + columns.y + columns.z) * (rows.x + rows.y + rows.z);
                       }
                       worst = std::max(worst, std::abs(sum - 1.0) / float_epsilon);
                     }
                     return worst;
                   })});
  cases.push_back({.group = picture_group,
                   .name = "sample places of 1 to 16384 samples",
                   .quantity = "position in the pixel: in [-0.5, 0.5]",
                   .parameter = "samples",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(counts, [](double count) {
                     double worst = 0.0;
                     for (const std::uint32_t seed : {0U, 1U, 77U, 4294967295U}) {
                       for (int i = 0; i < int(count); i++) {
                         const glm::vec2 place = eevee::film_offset_px(i, int(count), seed);
                         worst = std::max(worst, violated(std::abs(place.x) <= 0.5F && std::abs(place.y) <= 0.5F));
                       }
                     }
                     return worst;
                   })});
}

void add_display_cases(std::vector<StabilityCase> &cases)
{
  cases.push_back(case_of({picture_group, "sRGB from denormals to 1", "srgb_encoded", "encoded value", "linear value",
                           log_steps(1.5e-45, 1.0, 180),
                           [](double linear) { return Arguments<float>{.a = glm::vec4(float(linear))}; }}));
  for (const auto &[transform, name] :
       {std::pair(VIEW_TRANSFORM_STANDARD, "standard"), std::pair(VIEW_TRANSFORM_RAW, "raw")}) {
    for (const double sign : {-1.0, 1.0}) {
      cases.push_back(
          case_of({picture_group, fmt::format("view {} of {} radiance", name, sign < 0.0 ? "negative" : "huge"),
                   "view_transformed", "displayed value", "radiance", log_steps(1e-38, 3e38, 153),
                   [=, transform = transform](double radiance) {
                     return Arguments<float>{.a = glm::vec4(glm::vec3(float(sign * radiance)), float(transform))};
                   }}));
    }
  }
  // Properties instead of a closed form: values are in [0, 1], and with more light the largest channel does not fall by
  // half a step of 8 bits. AgX's polynomial ends at 0.9987, to which saturated colours fall from 1 as they fade to
  // white. Measured: 0.0014.
  constexpr float fall_max = 0.5F / 255.0F;
  for (const auto &[transform, name] :
       {std::pair(VIEW_TRANSFORM_AGX, "agx"), std::pair(VIEW_TRANSFORM_PBR_NEUTRAL, "pbr-neutral")}) {
    for (const glm::vec3 &tint : {glm::vec3(1.0F), glm::vec3(1.0F, 0.0F, 0.0F), glm::vec3(0.1F, 0.4F, 1.0F)}) {
      cases.push_back({.group = picture_group,
                       .name = fmt::format("view {} of ({:g} {:g} {:g})", name, tint.r, tint.g, tint.b),
                       .quantity = "displayed values: in [0, 1], the largest not falling",
                       .parameter = "radiance",
                       .reference = "invariant",
                       .unit = violation_unit,
                       .bound = 0.0,
                       .run = swept(log_steps(1e-38, 3e38, 153), [=, transform = transform](double radiance) {
                         const auto shown = [&](double light) {
                           return shared::view_transformed(float(light) * tint, transform);
                         };
                         const glm::vec3 now = shown(radiance);
                         const glm::vec3 before = shown(0.5 * radiance);
                         const auto largest = [](const glm::vec3 &v) { return std::max({v.x, v.y, v.z}); };
                         const bool is_in_range = glm::all(glm::greaterThanEqual(now, glm::vec3(0.0F))) &&
                                                  glm::all(glm::lessThanEqual(now, glm::vec3(1.0F)));
                         return violated(is_in_range && largest(now) >= largest(before) - fall_max);
                       })});
    }
  }
}

}  // namespace

void add_picture_cases(std::vector<StabilityCase> &cases)
{
  add_sample_cases(cases);
  add_display_cases(cases);
}

}  // namespace gnomon::verify
