// SPDX-License-Identifier: MIT
// Area lamps: rectangles that are distant, edge-on, touched or without area, and lines that almost miss a plane.
#include "internal/stability_cases.hh"

#include "eevee_area_shared.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <numbers>

namespace gnomon::verify {

namespace {

constexpr const char *area_group = "area";
const glm::dvec3 unit_x(1, 0, 0);
const glm::dvec3 unit_y(0, 1, 0);

/** Solid angle of a square of 2 m, as the sum of the angles between the planes through its edges, less 2π. */
double naive_solid_angle(const glm::dvec3 &center)
{
  const shared::vec3 c(center);
  const std::array<shared::vec3, 4> corner = {c + shared::vec3(-1, -1, 0), c + shared::vec3(1, -1, 0),
                                              c + shared::vec3(1, 1, 0), c + shared::vec3(-1, 1, 0)};
  float sum = -2.0F * std::numbers::pi_v<float>;
  for (std::size_t i = 0; i < 4; i++) {
    const shared::vec3 a = glm::normalize(glm::cross(corner[i], corner[(i + 1) % 4]));
    const shared::vec3 b = glm::normalize(glm::cross(corner[(i + 1) % 4], corner[(i + 2) % 4]));
    sum += std::acos(glm::dot(-a, b));
  }
  return sum;
}

}  // namespace

void add_area_cases(std::vector<StabilityCase> &cases)
{
  const auto add = [&](const std::string &name, const std::string &parameter, std::vector<double> steps, auto center_at,
                       auto right_at, auto up_at) {
    cases.push_back(case_of(
        {area_group, name, "rectangle_solid_angle",
         "solid angle of a rectangle, relative to its size and its condition", parameter, std::move(steps),
         [=](double x) {
           return Arguments<float>{
               .a = glm::vec4(center_at(x), 0.0F), .b = glm::vec4(right_at(x), 0.0F), .c = glm::vec4(up_at(x), 0.0F)};
         },
         // Edges along axes are exactly orthogonal. Measured: 0.31.
         0.6}));
  };
  const auto always = [](const glm::dvec3 &v) { return [=](double) { return v; }; };
  add(
      "approached in the middle", "height, m", log_steps(1e-18, 1e6, 145),
      [](double height) { return glm::dvec3(0.25, -0.5, height); }, always(unit_x), always(unit_y));
  add(
      "approached beside the rim", "height, m", log_steps(1e-12, 1e6, 109),
      [](double height) { return glm::dvec3(1.5, 0.0, height); }, always(unit_x), always(unit_y));
  add(
      "approached at the rim", "height, m", log_steps(1e-12, 1e6, 109),
      [](double height) { return glm::dvec3(1.0, 0.0, height); }, always(unit_x), always(unit_y));
  add(
      "approached at a corner", "height, m", log_steps(1e-12, 1e6, 109),
      [](double height) { return glm::dvec3(1.0, 1.0, height); }, always(unit_x), always(unit_y));
  add(
      "far away", "distance, m", log_steps(1.0, 1e7, 101),
      [](double distance) { return distance * glm::normalize(glm::dvec3(1, 2, 3)); }, always(unit_x), always(unit_y));
  add(
      "from grazing to facing", "angle from the plane, rad", log_steps(1e-6, 0.5 * std::numbers::pi, 101),
      [](double angle) { return 3.0 * glm::dvec3(std::cos(angle), 0.0, std::sin(angle)); }, always(unit_x),
      always(unit_y));
  add(
      "scaled", "half an edge, m", log_steps(1e-6, 1e5, 101),
      [](double size) { return size * glm::dvec3(0.3, 0.2, 1.0); }, [](double size) { return size * unit_x; },
      [](double size) { return size * unit_y; });
  add("a line, nearly", "shorter half edge, m", log_steps(1e-8, 1.0, 101), always(glm::dvec3(0.3, 0.2, 1.0)),
      always(unit_x), [](double size) { return size * unit_y; });

  const auto add_angle = [&](const std::string &name, bool is_baseline, double bound, const std::string &parameter,
                             std::vector<double> steps, std::function<double(double)> error_at) {
    cases.push_back({.group = area_group,
                     .name = name,
                     .quantity = "solid angle of a rectangle",
                     .parameter = parameter,
                     .reference = "closed form",
                     .unit = "relative",
                     .bound = bound,
                     .is_baseline = is_baseline,
                     .run = swept(std::move(steps), std::move(error_at))});
  };
  const auto ours = [](const glm::dvec3 &center) {
    return double(shared::rectangle_solid_angle(shared::vec3(center), shared::vec3(unit_x), shared::vec3(unit_y)));
  };
  for (const bool is_naive : {true, false}) {
    // The next term of the series is 1 / distance², and the engine's form has a dozen roundings.
    add_angle(
        is_naive ? "planes' angles, far away" : "area over squared distance, far away", is_naive, 3e-6, "distance, m",
        log_steps(1e3, 1e7, 81), [=](double distance) {
          const glm::dvec3 center(0, 0, distance);
          return std::abs((is_naive ? naive_solid_angle(center) : ours(center)) * distance * distance / 4.0 - 1.0);
        });
    add_angle(is_naive ? "planes' angles, touched corner to middle" : "half a space, touched corner to middle",
              is_naive, 4.0 * float_epsilon, "distance from the corner, inwards, m",
              even_steps(is_naive ? 0.0 : 0.01, 1.0, 101), [=](double inwards) {
                const glm::dvec3 center(1.0 - inwards, 1.0 - inwards, 0.0);
                return std::abs((is_naive ? naive_solid_angle(center) : ours(center)) / (2.0 * std::numbers::pi) - 1.0);
              });
  }
  cases.push_back({.group = area_group,
                   .name = "no area, edge-on, touched outside",
                   .quantity = "solid angle: 0",
                   .parameter = "distance, m",
                   .reference = "closed form: 0",
                   .unit = "sr",
                   .bound = 0.0,
                   .run = swept(log_steps(1.001, 1e8, 101), [](double x) {
                     const shared::vec3 right(1, 0, 0);
                     const shared::vec3 up(0, 1, 0);
                     const shared::vec3 none(0.0F);
                     const shared::vec3 aside(float(x), 0.0F, 0.0F);
                     const shared::vec3 above(0.3F, 0.2F, float(x));
                     return double(shared::rectangle_solid_angle(aside, right, up) +
                                   shared::rectangle_solid_angle(above, none, up) +
                                   shared::rectangle_solid_angle(above, right, none) +
                                   shared::rectangle_solid_angle(above, right, 2.0F * right) +
                                   shared::rectangle_solid_angle(none, none, none));
                   })});
  for (const double height : {0.0, 1e-6, 1.0}) {
    cases.push_back(
        {.group = area_group,
         .name = fmt::format("grazing line from {:g} m", height),
         .quantity = "distance of a line's intersection with a plane, at most LINE_FAR",
         .parameter = "rise of the line",
         .reference = "closed form",
         .unit = epsilon_unit,
         // One division; the other operations are exact for vectors along an axis.
         .bound = 1.0,
         .run = swept(zero_and_log_steps(1e-38, 1.0, 115), [=](double rise) {
           const shared::vec3 origin(0.0F, 0.0F, float(height));
           const shared::vec3 direction(1.0F, 0.0F, float(-rise));
           const double given = shared::line_plane_distance(origin, direction, {5.0F, 7.0F, 0.0F}, {0.0F, 0.0F, 1.0F});
           const double far = double(shared::LINE_FAR);
           const double truth = rise > 0.0 ? std::min(double(origin.z) / double(float(rise)), far) : far;
           if (height == 0.0) {
             return rise > 0.0 ? std::abs(given) : std::abs(given / far - 1.0);
           }
           // The plane is below, and behind only if the line does not rise.
           return std::abs((rise > 0.0 ? given : std::abs(given)) / truth - 1.0) / float_epsilon;
         })});
  }
}

}  // namespace gnomon::verify
