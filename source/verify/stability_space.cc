// SPDX-License-Identifier: MIT
// Spaces: far from the world's origin, at scales from 1e-4 to 1e5, and with ill-conditioned matrices.
#include "internal/stability_cases.hh"

#include "draw_objects.hh"
#include "draw_view.hh"
#include "eevee_camera.hh"
#include "shadows/shadow_sun_fit.hh"
#include "shadows/shadow_view_volume.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace gnomon::verify {

namespace {

constexpr const char *space_group = "space";
constexpr const char *offset_parameter = "world offset, m";
using Long3 = glm::vec<3, long double>;

std::vector<double> offsets()
{
  return zero_and_log_steps(1e-3, 1e8, 89);
}

/** A rotation about an arbitrary axis. */
glm::dmat4 turned()
{
  return glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
}

/**
 * Error of world-space normals of planes of all directions, relative to the cross product of their transformed
 * tangents.
 */
double normal_error(const glm::mat4 &world_from_object)
{
  const glm::mat3 matrix = draw::normal_matrix(world_from_object);
  const glm::mat<3, 3, long double> exact(world_from_object);
  const long double side = glm::dot(glm::cross(exact[0], exact[1]), exact[2]) < 0.0L ? -1.0L : 1.0L;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  double worst = 0.0;
  for (int i = 0; i < 32; i++) {
    const glm::vec3 n = i < 3 ? glm::vec3(i == 0, i == 1, i == 2) : glm::vec3(unit(random), unit(random), unit(random));
    const Long3 helper = std::abs(n.z) < std::abs(n.x) ? Long3(0, 0, 1) : Long3(1, 0, 0);
    const Long3 tangent = glm::cross(helper, Long3(n));
    const Long3 bitangent = glm::cross(Long3(n), tangent);
    const Long3 truth = side * glm::cross(exact * tangent, exact * bitangent);
    const glm::dvec3 given(matrix * n);
    if (!(std::isfinite(given.x) && std::isfinite(given.y) && std::isfinite(given.z))) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    const glm::dvec3 direction(truth / glm::length(truth));
    // A sum of three rounded terms: relative to the largest of them.
    const double terms = std::abs(double(n.x)) * glm::length(glm::dvec3(matrix[0])) +
                         std::abs(double(n.y)) * glm::length(glm::dvec3(matrix[1])) +
                         std::abs(double(n.z)) * glm::length(glm::dvec3(matrix[2]));
    const double wrong = glm::length(given - glm::dot(given, direction) * direction);
    const bool is_turned = glm::dot(given, direction) < -terms * 4.0 * float_epsilon;
    worst = std::max(worst, is_turned ? 1.0 / float_epsilon : wrong / (terms * float_epsilon));
  }
  return worst;
}

void add_normal_cases(std::vector<StabilityCase> &cases)
{
  const auto add = [&](const std::string &name, const std::string &parameter, std::vector<double> steps,
                       auto matrix_at) {
    cases.push_back(
        {.group = space_group,
         .name = "normals, " + name,
         .quantity = "world-space normal with its sign",
         .parameter = parameter,
         .reference = "long double",
         .unit = epsilon_unit,
         // Roundings of the matrix elements, three products and two sums.
         .bound = 1.5,
         .run = swept(std::move(steps), [=](double x) { return normal_error(glm::mat4(turned() * matrix_at(x))); })});
  };
  const auto scaled = [](double x, double y, double z) { return glm::scale(glm::dmat4(1.0), glm::dvec3(x, y, z)); };
  add("uniform scale", "scale", log_steps(1e-15, 1e15, 121), [=](double s) { return scaled(s, s, s); });
  add("flattened", "scale of one axis", log_steps(1e-30, 1.0, 121), [=](double s) { return scaled(1, 1, s); });
  add("stretched", "scale of one axis", log_steps(1.0, 1e10, 121), [=](double s) { return scaled(1, s, 1); });
  add("a needle", "scale of two axes", log_steps(1e-12, 1.0, 121), [=](double s) { return scaled(s, s, 1); });
  add("mirrored and flattened", "scale of the mirrored axis", log_steps(1e-30, 1.0, 121),
      [=](double s) { return scaled(1, -s, 1); });
  add("sheared", "shear", log_steps(1e-3, 1e8, 111), [](double shear) {
    glm::dmat4 matrix(1.0);
    matrix[1][0] = shear;
    return matrix;
  });
  add("far away", offset_parameter, offsets(),
      [](double offset) { return glm::translate(glm::dmat4(1.0), glm::dvec3(offset, -offset, offset)); });
  for (const int rank : {0, 1, 2}) {
    cases.push_back({.group = space_group,
                     .name = fmt::format("normals, singular of rank {}", rank),
                     .quantity = rank == 2 ? "normal of the plane that the object is flattened to" : "normals: 0",
                     .parameter = "scale",
                     .reference = "closed form",
                     .unit = "rad",
                     // One rounding for each component.
                     .bound = rank == 2 ? 2.0 * float_epsilon : 0.0,
                     .run = swept(log_steps(1e-15, 1e15, 121), [=](double scale) {
                       // The matrix is exact in float, and therefore singular: columns (1, 0, 1), (2, 0, 2) or (0, 1,
                       // 0), and 0.
                       glm::mat4 matrix(0.0F);
                       const auto s = float(scale);
                       if (rank > 0) {
                         matrix[0] = {s, 0.0F, s, 0.0F};
                         matrix[1] = rank == 2 ? glm::vec4(0.0F, s, 0.0F, 0.0F) : 2.0F * matrix[0];
                       }
                       const glm::mat3 normals = draw::normal_matrix(matrix);
                       const glm::dvec3 z(normals[2]);
                       if (rank < 2) {
                         return glm::length(glm::dvec3(normals[0])) + glm::length(glm::dvec3(normals[1])) +
                                glm::length(z);
                       }
                       return glm::length(glm::cross(glm::normalize(z), glm::normalize(glm::dvec3(-1, 0, 1))));
                     })});
  }
  cases.push_back({.group = space_group,
                   .name = "mirrored or not",
                   .quantity = "orientation of objects that are scaled and sheared",
                   .parameter = "scale of one axis",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(log_steps(1e-30, 1e10, 121), [=](double scale) {
                     double worst = 0.0;
                     for (const double side : {-1.0, 1.0}) {
                       glm::dmat4 matrix = scaled(scale, side * scale, 1.0);
                       matrix[2][0] = 3.0;
                       worst = std::max(worst, violated(draw::is_mirrored(glm::mat4(matrix)) == (side < 0.0)));
                     }
                     return worst;
                   })});
}

/** A camera at \a position with an arbitrary rotation. */
scene::PlacedCamera camera_at(const glm::dvec3 &position)
{
  scene::PlacedCamera camera;
  camera.aspect = 1.5F;
  // Rounded to float, like the engine's views.
  camera.world_from_camera = glm::mat4(glm::translate(glm::dmat4(1.0), position) * turned());
  return camera;
}

/** Error of the picture position of a point in camera space, in frame heights. */
double place_error(const scene::PlacedCamera &camera, const glm::dvec3 &in_camera)
{
  const draw::View view = eevee::view_of(camera, {900, 600});
  const glm::dmat4 &world_from_camera = camera.world_from_camera;
  const glm::vec3 point(world_from_camera * glm::dvec4(in_camera, 1.0));
  const glm::dvec4 exact = glm::dmat4(view.clip_from_view()) * glm::inverse(world_from_camera) * glm::dvec4(point, 1.0);
  const glm::vec4 clip = view.clip_from_world() * glm::vec4(point, 1.0F);
  return glm::distance(glm::dvec2(clip) / double(clip.w), glm::dvec2(exact) / exact.w);
}

void add_view_cases(std::vector<StabilityCase> &cases)
{
  for (const scene::CameraKind kind : {scene::CameraKind::Perspective, scene::CameraKind::Orthographic}) {
    const std::string name = kind == scene::CameraKind::Perspective ? "perspective" : "parallel";
    cases.push_back({.group = space_group,
                     .name = name + " camera far from the origin",
                     .quantity = "position in the picture of a point 100 m away",
                     .parameter = offset_parameter,
                     .reference = "double",
                     .unit = "epsilons of offset / distance",
                     // The matrix's translation and the point are sums of three products: a few roundings of the offset
                     // each, over a frame of 84 m or 2 m.
                     .bound = kind == scene::CameraKind::Perspective ? 6.0 : 300.0,
                     .run = swept(offsets(), [=](double offset) {
                       scene::PlacedCamera camera = camera_at(offset * glm::dvec3(1, -1, 1));
                       camera.kind = kind;
                       return place_error(camera, {0.3, 0.2, -100.0}) / (float_epsilon * (1.0 + offset / 100.0));
                     })});
    cases.push_back({.group = space_group,
                     .name = name + " camera at scales of 1e-4 to 1e5",
                     .quantity = "position in the picture of a point",
                     .parameter = "scale",
                     .reference = "double",
                     .unit = epsilon_unit,
                     .bound = 4.0,
                     .run = swept(log_steps(1e-4, 1e5, 91), [=](double scale) {
                       scene::PlacedCamera camera = camera_at(scale * glm::dvec3(1, -1, 1));
                       camera.kind = kind;
                       camera.near = float(1e-2 * scale);
                       camera.half_width = float(1.5 * scale);
                       camera.half_height = float(scale);
                       return place_error(camera, scale * glm::dvec3(0.3, 0.2, -5.0)) / float_epsilon;
                     })});
    for (const bool is_far : {false, true}) {
      cases.push_back({.group = space_group,
                       .name = fmt::format("culling, {}, {}", name, is_far ? "far from the origin" : "scaled"),
                       .quantity = "visible points whose spheres are culled",
                       .parameter = is_far ? offset_parameter : "scale",
                       .reference = "double",
                       .unit = violation_unit,
                       .bound = 0.0,
                       .run = swept(is_far ? offsets() : log_steps(1e-4, 1e5, 91), [=](double x) {
                         const double scale = is_far ? 1.0 : x;
                         scene::PlacedCamera camera = camera_at((is_far ? x : scale) * glm::dvec3(1, -1, 1));
                         camera.kind = kind;
                         camera.near = float(0.1 * scale);
                         camera.far = float(100.0 * scale);
                         camera.half_width = float(15.0 * scale);
                         camera.half_height = float(10.0 * scale);
                         const draw::View view = eevee::view_of(camera, {900, 600});
                         const glm::dmat4 &world_from_camera = camera.world_from_camera;
                         const glm::dmat4 clip_from_world =
                             glm::dmat4(view.clip_from_view()) * glm::inverse(world_from_camera);
                         std::mt19937 random(9);
                         std::uniform_real_distribution<double> unit(0.0, 1.0);
                         double missed = 0.0;
                         for (int i = 0; i < 200; i++) {
                           // Near the sides of the frustum.
                           const double distance = scale * 0.1 * std::pow(1000.0, unit(random));
                           const double w = kind == scene::CameraKind::Perspective ? distance : 1.0;
                           const double a = i % 2 == 0 ? 0.999999 : 2.0 * unit(random) - 1.0;
                           const double b = i % 2 == 0 ? 2.0 * unit(random) - 1.0 : -0.999999;
                           const glm::dvec4 in_camera(a * w / double(view.clip_from_view()[0][0]),
                                                      b * w / double(view.clip_from_view()[1][1]), -distance, 1.0);
                           const glm::vec3 point(world_from_camera * in_camera);
                           const glm::dvec4 clip = clip_from_world * glm::dvec4(point, 1.0);
                           const bool is_seen = std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w &&
                                                clip.z >= 0.0 && clip.z <= clip.w;
                           missed += is_seen ? violated(view.touches({point, 0.0F})) : 0.0;
                         }
                         return missed;
                       })});
    }
  }
  cases.push_back({.group = space_group,
                   .name = "views through singular matrices",
                   .quantity = "frustum planes of flattened, sheared, mirrored and zero views: finite",
                   .parameter = "scale of one axis",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(zero_and_log_steps(1e-38, 1e15, 107), [](double scale) {
                     double worst = 0.0;
                     for (const glm::dvec3 &axes : {glm::dvec3(1, 1, scale), glm::dvec3(scale, -1, 1),
                                                    glm::dvec3(scale), glm::dvec3(0, scale, 0)}) {
                       glm::dmat4 matrix = glm::scale(turned(), axes);
                       matrix[1][0] += 100.0 * scale;
                       const draw::View view(glm::mat4(matrix), draw::perspective(1.0F, 1.0F, 0.1F, 100.0F));
                       for (const glm::vec4 &plane : view.frustum_planes_ws()) {
                         const bool is_plane = std::isfinite(plane.x + plane.y + plane.z + plane.w);
                         worst = std::max(worst, violated(is_plane));
                       }
                       worst = std::max(worst, violated(view.touches({glm::vec3(0.0F), -1.0F})));
                     }
                     return worst;
                   })});
  cases.push_back({.group = space_group,
                   .name = "angles of a camera, 1e-6 rad to pi",
                   .quantity = "height of the frame at distance 1",
                   .parameter = "vertical angle, rad",
                   .reference = "double",
                   .unit = "epsilons times the condition of the tangent",
                   .bound = 1.0,
                   .run = swept(
                       [] {
                         std::vector<double> steps = log_steps(1e-6, 3.0, 81);
                         const std::vector<double> from_pi = log_steps(0.1, 1e-7, 31);
                         for (const double beside : from_pi) {
                           steps.push_back(std::numbers::pi - beside);
                         }
                         return steps;
                       }(),
                       [](double angle) {
                         scene::PlacedCamera camera;
                         camera.vertical_angle = float(angle);
                         const double half = 0.5 * std::min(double(camera.vertical_angle), double(3.1415F));
                         const double given = 1.0 / double(eevee::view_of(camera, {1, 1}).clip_from_view()[1][1]);
                         const double condition = 1.0 + 2.0 * half / std::sin(2.0 * half);
                         return std::abs(given / std::tan(half) - 1.0) / (float_epsilon * condition);
                       })});
}

void add_bounds_cases(std::vector<StabilityCase> &cases)
{
  cases.push_back(
      {.group = space_group,
       .name = "boxes far from the origin",
       .quantity = "distance of a rotated box's corners outside of its world box",
       .parameter = offset_parameter,
       .reference = "double",
       .unit = "epsilons of offset + size",
       .bound = 2.0,
       .run = swept(offsets(), [](double offset) {
         scene::Bounds box;
         box.extend(glm::vec3(-1, -2, -3));
         box.extend(glm::vec3(3, 2, 1));
         const glm::mat4 matrix(glm::translate(glm::dmat4(1.0), offset * glm::dvec3(1, -1, 1)) * turned());
         const scene::Bounds world = scene::transformed(box, matrix);
         double worst = 0.0;
         for (int i = 0; i < 8; i++) {
           const glm::dvec3 corner(glm::dmat4(matrix) * glm::dvec4(i & 1 ? box.max.x : box.min.x,
                                                                   i & 2 ? box.max.y : box.min.y,
                                                                   i & 4 ? box.max.z : box.min.z, 1.0));
           for (int axis = 0; axis < 3; axis++) {
             worst = std::max({worst, double(world.min[axis]) - corner[axis], corner[axis] - double(world.max[axis])});
           }
         }
         return worst / (float_epsilon * (offset + 4.0));
       })});
  cases.push_back({.group = space_group,
                   .name = "visible part of a box around the camera, near to 1e-6 m",
                   .quantity = "camera inside geometry: the visible range is finite, in front of it and not empty",
                   .parameter = "near plane, m",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(log_steps(1e-6, 9.0, 71), [](double near) {
                     scene::PlacedCamera camera = camera_at(glm::dvec3(0.0));
                     camera.near = float(near);
                     const draw::View view = eevee::view_of(camera, {900, 600});
                     const scene::Bounds box{glm::vec3(-10.0F), glm::vec3(10.0F)};
                     const eevee::VisibleRange range = eevee::visible_range(view, eevee::visible_corners(view, box));
                     return violated(std::isfinite(range.far) && range.near > 0.0 && range.far > range.near);
                   })});
  for (const bool is_far : {false, true}) {
    cases.push_back(
        {.group = space_group,
         .name = fmt::format("visible part of a box, {}", is_far ? "far from the origin" : "scaled"),
         .quantity = "distance of its corners outside of the frustum and the box, relative to the box's size",
         .parameter = is_far ? offset_parameter : "scale",
         .reference = "double",
         .unit = "double epsilons of 1 + offset / size",
         // Relative to the planes as rounded to float.
         .bound = 8.0,
         .run = swept(is_far ? offsets() : log_steps(1e-4, 1e5, 91), [=](double x) {
           const double size = is_far ? 10.0 : 10.0 * x;
           const glm::dvec3 center = (is_far ? x : size) * glm::dvec3(1, -1, 1);
           scene::PlacedCamera camera = camera_at(center);
           camera.near = float(0.01 * size);
           camera.far = float(2.0 * size);
           const draw::View view = eevee::view_of(camera, {900, 600});
           const scene::Bounds box{glm::vec3(center - size), glm::vec3(center + size)};
           double worst = 0.0;
           for (const glm::dvec3 &corner : eevee::visible_corners(view, box)) {
             for (int axis = 0; axis < 3; axis++) {
               worst = std::max({worst, double(box.min[axis]) - corner[axis], corner[axis] - double(box.max[axis])});
             }
             for (const glm::vec4 &plane : view.frustum_planes_ws()) {
               worst = std::max(worst, -(glm::dot(glm::dvec3(plane), corner) + double(plane.w)));
             }
           }
           return worst / (std::numeric_limits<double>::epsilon() * (size + glm::length(center)));
         })});
  }
}

}  // namespace

void add_space_cases(std::vector<StabilityCase> &cases)
{
  add_normal_cases(cases);
  add_view_cases(cases);
  add_bounds_cases(cases);
}

}  // namespace gnomon::verify
