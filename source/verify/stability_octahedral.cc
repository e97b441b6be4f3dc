// SPDX-License-Identifier: MIT
// Directions on the octahedral map and on the faces of a cube: folds, edges, corners, vector lengths.
#include "internal/stability_cases.hh"

#include "eevee_octahedral_shared.h"
#include "eevee_shadow_shared.h"
#include "shadows/shadow_casters.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gnomon::verify {

namespace {

constexpr const char *octahedral_group = "octahedral";
/**
 * Error bound, rad: coordinates near 1 are rounded to 6e-8, which is twice as much on the octahedron and up to three
 * times more on the sphere, in two axes.
 */
constexpr double angle_bound = 5e-7;
/** Error bound, rad, if one of the two coordinates is exact. Measured: 3e-8. */
constexpr double edge_bound = 1e-7;
constexpr std::array<const char *, 6> axis_names = {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};

glm::dvec3 axis_of(std::size_t i)
{
  glm::dvec3 axis(0.0);
  axis[int(i / 2)] = i % 2 == 0 ? 1.0 : -1.0;
  return axis;
}

double angle_between(const glm::dvec3 &a, const glm::dvec3 &b)
{
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

double round_trip_error(const shared::vec3 &v)
{
  return angle_between(glm::dvec3(v),
                       glm::dvec3(shared::octahedral_to_direction(shared::octahedral_from_direction(v))));
}

/** Error of the form with GLSL's sign(), which is 0 at 0, and without a minimum norm. */
double naive_round_trip_error(const shared::vec3 &v)
{
  const float norm = std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
  const shared::vec3 n = v / norm;
  const shared::vec2 p =
      n.z < 0.0F ? shared::vec2((1.0F - std::abs(n.y)) * glm::sign(n.x), (1.0F - std::abs(n.x)) * glm::sign(n.y))
                 : shared::vec2(n);
  const shared::vec3 back = shared::octahedral_to_direction(0.5F * p + 0.5F);
  return angle_between(v == shared::vec3(0.0F) ? glm::dvec3(0, 0, 1) : glm::dvec3(v), glm::dvec3(back));
}

void add_round_trip_cases(std::vector<StabilityCase> &cases)
{
  const auto add = [&](const std::string &name, const std::string &parameter, std::vector<double> steps,
                       std::function<double(double)> error_at, double bound = angle_bound, bool is_baseline = false) {
    cases.push_back({.group = octahedral_group,
                     .name = name,
                     .quantity = "direction, converted to the map and back",
                     .parameter = parameter,
                     .reference = "closed form",
                     .unit = "rad",
                     .bound = bound,
                     .is_baseline = is_baseline,
                     .run = swept(std::move(steps), std::move(error_at))});
  };
  for (std::size_t i = 0; i < 6; i++) {
    const glm::dvec3 axis = axis_of(i);
    const glm::dvec3 across = axis_of((i + 2) % 6);
    const glm::dvec3 up = axis_of((i + 5) % 6);
    add(fmt::format("around {}", axis_names[i]), "angle from the axis, rad",
        log_steps(1e-12, 0.5 * std::numbers::pi, 121), [=](double tilt) {
          double worst = round_trip_error(axis);
          for (int turn = 0; turn < 16; turn++) {
            const double angle = turn * std::numbers::pi / 8.0;
            worst =
                std::max(worst, round_trip_error(std::cos(tilt) * axis +
                                                 std::sin(tilt) * (std::cos(angle) * across + std::sin(angle) * up)));
          }
          return worst;
        });
  }
  for (std::size_t i = 0; i < 6; i++) {
    for (std::size_t k = i + 1; k < 6; k++) {
      if (k / 2 == i / 2) {
        continue;
      }
      // Directions on an edge have a third component of 0, of either sign.
      const int third = 3 - int(i / 2) - int(k / 2);
      const auto error_at = [=](double share, double beside, auto trip) {
        glm::dvec3 v = (1.0 - share) * axis_of(i) + share * axis_of(k);
        v[third] = beside;
        return trip(shared::vec3(v));
      };
      const std::string name = fmt::format("edge {} to {}", axis_names[i], axis_names[k]);
      add(
          name, "position on the edge", even_steps(0.0, 1.0, 65),
          [=](double share) {
            double worst = 0.0;
            for (const double beside : {0.0, -0.0, 1e-30, -1e-30, 1e-8, -1e-8}) {
              worst = std::max(worst, error_at(share, beside, round_trip_error));
            }
            return worst;
          },
          edge_bound);
      if (k == 5) {
        add(
            "sign(0), " + name, "position on the edge", even_steps(0.0, 1.0, 65),
            [=](double share) { return error_at(share, 0.0, naive_round_trip_error); }, edge_bound, true);
      }
    }
  }
  add("around all eight diagonals", "angle from the diagonal, rad", log_steps(1e-12, 0.9, 101), [](double tilt) {
    double worst = 0.0;
    for (int i = 0; i < 8; i++) {
      const glm::dvec3 diagonal = glm::dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1) / std::sqrt(3.0);
      const glm::dvec3 across = glm::normalize(glm::cross(diagonal, glm::dvec3(0, 0, 1)));
      const glm::dvec3 up = glm::cross(diagonal, across);
      for (const glm::dvec3 &side : {across, -across, up, -up}) {
        worst = std::max(worst, round_trip_error(std::cos(tilt) * diagonal + std::sin(tilt) * side));
      }
    }
    return worst;
  });
  for (const bool is_naive : {false, true}) {
    add(
        is_naive ? "vectors of any length, no least norm" : "vectors of any length", "length",
        [] {
          std::vector<double> lengths = log_steps(1e-29, 1e37, 133);
          lengths.insert(lengths.begin(), 0.0);
          return lengths;
        }(),
        [=](double length) {
          const shared::vec3 v = shared::vec3(glm::dvec3(0.36, -0.48, 0.8) * length);
          if (is_naive) {
            return naive_round_trip_error(v);
          }
          return length == 0.0
                     ? angle_between(glm::dvec3(0, 0, 1),
                                     glm::dvec3(shared::octahedral_to_direction(shared::octahedral_from_direction(v))))
                     : round_trip_error(v);
        },
        angle_bound, is_naive);
  }
  cases.push_back({.group = octahedral_group,
                   .name = "vectors of every length, denormal to the largest",
                   .quantity = "point of the map: in [0, 1]",
                   .parameter = "length",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(log_steps(1.5e-45, 3e38, 168), [](double length) {
                     double worst = 0.0;
                     for (const float z : {-1.0F, 0.0F, 1.0F}) {
                       const shared::vec2 uv =
                           shared::octahedral_from_direction(float(length) * shared::vec3(1.0F, -1.0F, z));
                       worst = std::max(worst, violated(uv.x >= 0.0F && uv.x <= 1.0F && uv.y >= 0.0F && uv.y <= 1.0F));
                     }
                     return worst;
                   })});
}

void add_texel_cases(std::vector<StabilityCase> &cases)
{
  const std::vector<double> sizes = {1, 2, 3, 4, 7, 16, 31, 64, 257, 512, 1024, 4096, 8192, 16384};
  cases.push_back({.group = octahedral_group,
                   .name = "border of maps of 1 to 16384 px",
                   .quantity = "texel that continues the map beyond an edge or corner: inside the map, and in the "
                               "mirrored direction",
                   .parameter = "size of the map, px",
                   .reference = "closed form",
                   .unit = "rad",
                   .bound = angle_bound,
                   .run = swept(sizes, [](double size_px) {
                     const int size = int(size_px);
                     const auto direction = [&](const shared::ivec2 &texel) {
                       return shared::octahedral_to_direction((shared::vec2(texel) + 0.5F) / float(size));
                     };
                     double worst = 0.0;
                     for (int i = 0; i < 64; i++) {
                       const int along = int((size - 1) * (i / 63.0));
                       for (const bool is_column : {false, true}) {
                         for (const bool is_high : {false, true}) {
                           const int inside_at = is_high ? size - 1 : 0;
                           const int outside_at = is_high ? size : -1;
                           const shared::ivec2 inside =
                               is_column ? shared::ivec2(inside_at, along) : shared::ivec2(along, inside_at);
                           const shared::ivec2 outside =
                               is_column ? shared::ivec2(outside_at, along) : shared::ivec2(along, outside_at);
                           shared::vec3 mirrored = direction(inside);
                           mirrored[is_column ? 1 : 0] *= -1.0F;
                           const shared::ivec2 found = shared::octahedral_texel(outside, size);
                           if (found.x < 0 || found.x >= size || found.y < 0 || found.y >= size) {
                             return std::numeric_limits<double>::infinity();
                           }
                           worst = std::max(worst, angle_between(glm::dvec3(mirrored), glm::dvec3(direction(found))));
                         }
                       }
                     }
                     return worst;
                   })});
  cases.push_back({.group = octahedral_group,
                   .name = "solid angles of all texels",
                   .quantity = "sum of the texels' solid angles, of 4 pi",
                   .parameter = "size of the map, px",
                   .reference = "closed form: 1",
                   .unit = "relative",
                   // The error of the midpoint rule, whose largest terms cancel. Measured: 1e-7.
                   .bound = 1e-6,
                   .run = swept({32, 48, 64, 96, 128}, [](double size_px) {
                     const int size = int(size_px);
                     double sum = 0.0;
                     for (int y = 0; y < size; y++) {
                       for (int x = 0; x < size; x++) {
                         const shared::vec2 uv = (shared::vec2(float(x), float(y)) + 0.5F) / float(size);
                         const double angle = shared::octahedral_texel_angle(shared::octahedral_to_direction(uv), size);
                         sum += angle * angle;
                       }
                     }
                     return std::abs(sum / (4.0 * std::numbers::pi) - 1.0);
                   })});
}

void add_cube_cases(std::vector<StabilityCase> &cases)
{
  for (std::size_t i = 0; i < 6; i++) {
    for (std::size_t k = i + 1; k < 6; k++) {
      if (k / 2 == i / 2) {
        continue;
      }
      const int third = 3 - int(i / 2) - int(k / 2);
      cases.push_back({.group = "cube",
                       .name = fmt::format("edge between {} and {}", axis_names[i], axis_names[k]),
                       .quantity = "face: one of the two, with the direction within its 90°",
                       .parameter = "angle from the edge, rad",
                       .reference = "closed form",
                       .unit = violation_unit,
                       .bound = 0.0,
                       .run = swept(log_steps(1e-9, 0.7, 91), [=](double angle) {
                         double worst = 0.0;
                         for (const double side : {-angle, 0.0, angle}) {
                           for (const double along : {-0.999999, -0.5, 0.0, -0.0, 1e-30, 0.5, 0.999999}) {
                             const double turn = 0.25 * std::numbers::pi + side;
                             glm::dvec3 v = std::cos(turn) * axis_of(i) + std::sin(turn) * axis_of(k);
                             v[third] = along * std::min(std::cos(turn), std::sin(turn));
                             const shared::vec3 direction(v);
                             const int face = shared::cube_face(direction);
                             const shared::vec3 seen = shared::cube_face_project(face, direction);
                             const bool is_shown =
                                 seen.z > 0.0F && std::abs(seen.x) <= seen.z && std::abs(seen.y) <= seen.z;
                             // In float the nearest directions may be on the edge, which belongs to the earlier axis.
                             const bool is_right = face == int(side > 1e-7 ? k : side < -1e-7 ? i : std::size_t(face));
                             worst = std::max(worst, violated(is_shown && is_right));
                           }
                         }
                         return worst;
                       })});
    }
  }
  cases.push_back({.group = "cube",
                   .name = "faces that a box touches",
                   .quantity = "faces of the points of a box: all in the mask of the box",
                   .parameter = "size of the box, m, 1 m from the lamp",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(log_steps(1e-9, 1e6, 121), [](double size) {
                     double missing = 0.0;
                     for (int i = 0; i < 26; i++) {
                       const int c = i < 13 ? i : i + 1;
                       const glm::vec3 center(float(c % 3 - 1), float(c / 3 % 3 - 1), float(c / 9 - 1));
                       scene::Bounds box;
                       box.extend(center - float(size));
                       box.extend(center + float(size));
                       const std::uint32_t mask = eevee::cube_face_mask(box, 1.0F);
                       for (int p = 0; p < 27; p++) {
                         const glm::vec3 point =
                             center + float(size) * glm::vec3(float(p % 3 - 1), float(p / 3 % 3 - 1), float(p / 9 - 1));
                         if (point != glm::vec3(0.0F)) {
                           missing =
                               std::max(missing, violated((mask >> unsigned(shared::cube_face(point)) & 1U) != 0));
                         }
                       }
                     }
                     return missing;
                   })});
  cases.push_back(case_of({"cube", "faces of 1 to 16384 px", "cube_uv_scale", "fraction of a face's width for 90°",
                           "size of the face, px", log_steps(1, 16384, 101), [](double size) {
                             return Arguments<float>{.a = {std::floor(float(size)), 0.0F, 0.0F, 0.0F}};
                           }}));
}

}  // namespace

void add_octahedral_cases(std::vector<StabilityCase> &cases)
{
  add_round_trip_cases(cases);
  add_texel_cases(cases);
  add_cube_cases(cases);
}

}  // namespace gnomon::verify
