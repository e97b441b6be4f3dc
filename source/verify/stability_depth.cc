// SPDX-License-Identifier: MIT
// Depths: the engine's reversed depth, and forward depths, which lose distant values.
#include "internal/stability_cases.hh"

#include "draw_view.hh"
#include "eevee_depth_shared.h"
#include "shadows/shadow_sun_fit.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::verify {

namespace {

constexpr const char *depth_group = "depth";
constexpr const char *distance_parameter = "distance, m";
constexpr float infinite = std::numeric_limits<float>::infinity();

/** Distances from near to far, dense next to the far plane, where a reversed depth approaches 0. */
std::vector<double> distances(double near, double far)
{
  std::vector<double> steps = log_steps(near, 0.5 * far, 81);
  const std::vector<double> from_far = log_steps(0.5, 1e-6, 21);
  for (std::size_t i = 1; i < from_far.size(); i++) {
    steps.push_back(far * (1.0 - from_far[i]));
  }
  return steps;
}

/** Relative error of a distance that is converted to depth and back. */
double round_trip_error(float distance, float near, float far, int projection)
{
  const float depth = shared::depth_of_distance(distance, near, far, projection);
  const float back = shared::distance_of_depth(depth, near, far, projection);
  const double scale = projection == PROJECTION_ORTHOGRAPHIC ? double(far) : double(distance);
  return std::abs(double(back) - double(distance)) / (float_epsilon * scale);
}

/** The same for a depth that is 0 at the near plane. */
double forward_error(float distance, float near, float far)
{
  const float depth = far * (distance - near) / (distance * (far - near));
  const float back = near * far / (far - depth * (far - near));
  return std::abs(double(back) - double(distance)) / (float_epsilon * double(distance));
}

/** The same for a reversed depth in a clip space of [-1, 1]. */
double unclipped_error(float distance, float near, float far)
{
  const float depth = shared::depth_of_distance(distance, near, far, PROJECTION_PERSPECTIVE);
  const float ndc = 2.0F * depth - 1.0F;
  const float stored = 0.5F * ndc + 0.5F;
  const float back = shared::distance_of_depth(stored, near, far, PROJECTION_PERSPECTIVE);
  return std::abs(double(back) - double(distance)) / (float_epsilon * double(distance));
}

/** Error of the projection matrix: its depth, solved for the distance in double. */
double matrix_error(const glm::mat4 &clip_from_view, float distance)
{
  const glm::vec4 clip = clip_from_view * glm::vec4(0.0F, 0.0F, -distance, 1.0F);
  const double depth = clip.z / clip.w;
  const double a = clip_from_view[2][2];
  const double b = clip_from_view[3][2];
  // The depth is (b - a·d) / w, and w is d or 1.
  const double back = clip_from_view[2][3] != 0.0F ? b / (depth + a) : (b - depth) / a;
  return std::abs(back - double(distance)) / float_epsilon;
}

void add_perspective_cases(std::vector<StabilityCase> &cases)
{
  const auto add = [&](const std::string &name, bool is_baseline, double near, double far, auto error) {
    cases.push_back(
        {.group = depth_group,
         .name = name,
         .quantity = "distance, as a depth and back",
         .parameter = distance_parameter,
         .reference = "closed form",
         .unit = epsilon_unit,
         // Three roundings in each direction; a reversed depth represents distances with a relative error.
         .bound = 3.0,
         .is_baseline = is_baseline,
         .run = swept(distances(near, far), [=](double x) { return error(float(x), float(near), float(far)); })});
  };
  for (const double near : {1e-6, 1e-2, 1.0}) {
    for (const double ratio : {10.0, 1e3, 1e6, 1e9}) {
      const std::string range = fmt::format("near {:g} m, far/near {:g}", near, ratio);
      add("reversed, " + range, false, near, near * ratio,
          [](float d, float n, float f) { return round_trip_error(d, n, f, PROJECTION_PERSPECTIVE); });
      if (ratio >= 1e3) {
        add("forward, " + range, true, near, near * ratio, forward_error);
      }
    }
    add(fmt::format("reversed, near {:g} m, far infinite", near), false, near, 1e9 * near,
        [](float d, float n, float) { return round_trip_error(d, n, 0.0F, PROJECTION_PERSPECTIVE_INFINITE); });
    add(fmt::format("reversed in [-1, 1], near {:g} m, far/near 1e+09", near), true, near, 1e9 * near, unclipped_error);
  }
}

void add_matrix_cases(std::vector<StabilityCase> &cases)
{
  for (const double ratio : {1.001, 10.0, 1e3, 1e6, 1e9}) {
    const double near = 1e-2;
    const double far = near * ratio;
    // Two roundings of the terms of z, and one of the quotient.
    cases.push_back({.group = depth_group,
                     .name = fmt::format("perspective matrix, far/near {:g}", ratio),
                     .quantity = "distance, from the depth of the matrix",
                     .parameter = distance_parameter,
                     .reference = "double",
                     .unit = epsilon_unit,
                     .bound = 1.5,
                     .run = swept(ratio < 2.0 ? even_steps(near, far, 101) : distances(near, far), [=](double d) {
                       const glm::mat4 matrix = draw::perspective(1.0F, 1.0F, float(near), float(far));
                       return matrix_error(matrix, float(d)) / d;
                     })});
  }
  cases.push_back({.group = depth_group,
                   .name = "perspective matrix, near to 1e-6 m",
                   .quantity = "distance of 0.7 m, from the depth of the matrix with an infinite far plane",
                   .parameter = "near plane, m",
                   .reference = "double",
                   .unit = epsilon_unit,
                   .bound = 1.0,
                   .run = swept(log_steps(1e-6, 0.69, 101), [](double near) {
                     return matrix_error(draw::perspective(1.0F, 1.0F, float(near), infinite), 0.7F) / 0.7;
                   })});
  for (const double near : {-1e6, 0.0, 1e-6}) {
    const double far = 1e6;
    cases.push_back({.group = depth_group,
                     .name = fmt::format("orthographic matrix, near {:g} m", near),
                     .quantity = "distance, from the depth of the matrix, relative to the range",
                     .parameter = distance_parameter,
                     .reference = "double",
                     .unit = epsilon_unit,
                     .bound = 1.0,
                     .run = swept(even_steps(near, far, 101), [=](double d) {
                       const glm::mat4 matrix = draw::orthographic(1.0F, 1.0F, float(near), float(far));
                       return matrix_error(matrix, float(d)) / (far - near);
                     })});
  }
}

void add_other_cases(std::vector<StabilityCase> &cases)
{
  for (const double ratio : {10.0, 1e9}) {
    const float near = 1e-2F;
    const auto far = float(near * ratio);
    cases.push_back({.group = depth_group,
                     .name = fmt::format("parallel, far/near {:g}", ratio),
                     .quantity = "distance, as a depth and back, relative to the far plane's",
                     .parameter = distance_parameter,
                     .reference = "closed form",
                     .unit = epsilon_unit,
                     .bound = 1.5,
                     .run = swept(distances(double(near), double(far)), [=](double d) {
                       return round_trip_error(float(d), near, far, PROJECTION_ORTHOGRAPHIC);
                     })});
  }
  for (const int projection : {PROJECTION_PERSPECTIVE, PROJECTION_PERSPECTIVE_INFINITE}) {
    const std::string name = projection == PROJECTION_PERSPECTIVE ? "far finite" : "far infinite";
    cases.push_back({.group = depth_group,
                     .name = "behind the eye, " + name,
                     .quantity = "depth: finite and nearer than everything",
                     .parameter = "distance behind, m",
                     .reference = "closed form",
                     .unit = violation_unit,
                     .bound = 0.0,
                     .run = swept(log_steps(1e-45, 1e30, 151), [=](double behind) {
                       const float depth = shared::depth_of_distance(float(-behind), 0.1F, 100.0F, projection);
                       return std::isfinite(depth) ? violated(depth > 1.0F) : double(depth);
                     })});
    cases.push_back({.group = depth_group,
                     .name = "cleared, " + name,
                     .quantity = "distance of depth 0: finite and larger than that of depth 1e-6",
                     .parameter = "near plane, m",
                     .reference = "closed form",
                     .unit = violation_unit,
                     .bound = 0.0,
                     .run = swept(log_steps(1e-6, 1e7, 131), [=](double x) {
                       const auto near = float(x);
                       const float cleared = shared::distance_of_depth(0.0F, near, 1e9F * near, projection);
                       const float other = shared::distance_of_depth(1e-6F, near, 1e9F * near, projection);
                       return std::isfinite(cleared) ? violated(cleared > other) : double(cleared);
                     })});
  }
  for (const double lambda : {0.0, 0.8, 1.0}) {
    cases.push_back({.group = depth_group,
                     .name = fmt::format("cascade splits, lambda {:g}", lambda),
                     .quantity = "ends of four slices from 1e-6 m: in order, from near to far",
                     .parameter = "far/near",
                     .reference = "closed form",
                     .unit = violation_unit,
                     .bound = 0.0,
                     .run = swept(log_steps(1.0, 1e15, 101), [=](double ratio) {
                       const double near = 1e-6;
                       const std::vector<double> splits = eevee::cascade_splits(near, near * ratio, 4, lambda);
                       return violated(splits.front() == near && splits.back() == near * ratio &&
                                       std::ranges::is_sorted(splits) &&
                                       std::ranges::all_of(splits, [](double split) { return std::isfinite(split); }));
                     })});
  }
}

}  // namespace

void add_depth_cases(std::vector<StabilityCase> &cases)
{
  add_perspective_cases(cases);
  add_matrix_cases(cases);
  add_other_cases(cases);
}

}  // namespace gnomon::verify
