// SPDX-License-Identifier: MIT
// The reference: rays at world offsets and grazing angles, triangles without area, lamps at receivers.
#include "internal/stability_cases.hh"

#include "reference_lamp.hh"
#include "reference_tracer.hh"
#include "reference_visibility.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gnomon::verify {

namespace {

constexpr const char *reference_group = "reference";
/** Largest relative error of one rounding in double. */
constexpr double rounding = 0x1p-53;

/** A scene of triangles with the given corners. */
struct Triangles {
  scene::Scene scene;

  explicit Triangles(std::vector<glm::vec3> corners, const glm::mat4 &world_from_object = glm::mat4(1.0F))
  {
    scene::Material material;
    material.is_double_sided = true;
    scene::Mesh mesh;
    mesh.positions = std::move(corners);
    mesh.normals.assign(mesh.positions.size(), glm::vec3(0, 0, 1));
    for (std::size_t i = 0; i < mesh.positions.size(); i++) {
      mesh.indices.push_back(std::uint32_t(i));
    }
    mesh.material = scene.add(std::move(material));
    scene::Node node;
    node.name = "triangles";
    node.parent_from_node = world_from_object;
    node.meshes = {scene.add(std::move(mesh))};
    scene.add(std::move(node));
  }
};

/** A square of two triangles in z = 0 around the origin. */
std::vector<glm::vec3> square(double half)
{
  const auto h = float(half);
  return {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, -h, 0}, {h, h, 0}, {-h, h, 0}};
}

/** t of the nearest hit, or infinity. */
double hit_t(const Triangles &triangles, const glm::dvec3 &origin, const glm::dvec3 &direction)
{
  const reference::Tracer tracer(triangles.scene);
  const auto hit = tracer.closest({.origin_ws = origin, .direction_ws = direction}, reference::Faces::All);
  return hit ? hit->t : std::numeric_limits<double>::infinity();
}

void add_tracer_cases(std::vector<StabilityCase> &cases)
{
  const auto add = [&](const std::string &name, const std::string &quantity, const std::string &parameter,
                       std::vector<double> steps, double bound, std::function<double(double)> error_at) {
    cases.push_back({.group = reference_group,
                     .name = name,
                     .quantity = quantity,
                     .parameter = parameter,
                     .reference = "closed form",
                     .unit = "double roundings",
                     .bound = bound,
                     .run = swept(std::move(steps), std::move(error_at))});
  };
  const glm::dvec3 down(0, 0, -1);
  add("ray at world offsets", "distance of a plane 1 m below, relative to the offset", "world offset, m",
      zero_and_log_steps(1e-3, 1e8, 34), 4.0, [=](double offset) {
        const glm::vec3 place(glm::dvec3(offset, -offset, offset));
        const Triangles plane(square(3.0), glm::translate(glm::mat4(1.0F), place));
        return std::abs(hit_t(plane, glm::dvec3(place) + glm::dvec3(0.3, 0.2, 1.0), down) - 1.0) /
               (rounding * (1.0 + offset));
      });
  add("ray at scales of 1e-4 to 1e5", "distance of a plane, relative", "scale", log_steps(1e-4, 1e5, 37), 4.0,
      [=](double scale) {
        return std::abs(hit_t(Triangles(square(3.0 * scale)), scale * glm::dvec3(0.3, 0.2, 1.0), down) / scale - 1.0) /
               rounding;
      });
  add("grazing ray", "distance of a plane 1 m below, relative", "angle with the plane, rad",
      log_steps(1e-6, 0.5 * std::numbers::pi, 37), 8.0, [](double angle) {
        const double sine = std::sin(angle);
        return std::abs(hit_t(Triangles(square(2e6)), {-1e5, 0.2, 1.0}, {std::cos(angle), 0.0, -sine}) * sine - 1.0) /
               rounding;
      });
  // Triangles without area are not hit and do not hide others.
  for (const std::string_view shape : {"a point", "a line", "a sliver"}) {
    add(fmt::format("ray through {}", shape), "distance of a plane behind a triangle without area",
        "length of the triangle, m", log_steps(1e-30, 1e4, 35), 4.0, [=](double length) {
          std::vector<glm::vec3> corners = square(3.0);
          const auto half = float(0.5 * length);
          const glm::vec3 middle(0.25F, 0.5F, 0.5F);
          if (shape == "a point") {
            corners.insert(corners.end(), 3, middle);
          }
          else if (shape == "a line") {
            corners.insert(corners.end(), {middle - glm::vec3(half, 0, 0), middle, middle + glm::vec3(half, 0, 0)});
          }
          else {
            // Seen edge-on.
            corners.insert(corners.end(), {middle - glm::vec3(half, 0, 0), middle + glm::vec3(half, 0, 0),
                                           middle + glm::vec3(0, 0, half)});
          }
          const double t = hit_t(Triangles(corners), {0.25, 0.5, 1.0}, down);
          // If the sliver is hit edge-on, the nearest hit is its upper end.
          const double sliver = std::max(0.5 - double(half), 0.0);
          return std::min(std::abs(t - 1.0),
                          shape == "a sliver" ? std::max({sliver - t, t - 0.5, 0.0}) : std::abs(t - 1.0)) /
                 rounding;
        });
  }
  add("ray without a direction, and with a huge one", "hits of a ray without direction; distance along other rays",
      "length of the direction", log_steps(1e-150, 1e150, 31), 4.0, [=](double length) {
        const Triangles plane(square(3.0));
        const bool is_hit = std::isfinite(hit_t(plane, {0.3, 0.2, 1.0}, glm::dvec3(0.0)));
        return is_hit ? 1.0 / rounding
                      : std::abs(hit_t(plane, {0.3, 0.2, 1.0}, length * down) * length - 1.0) / rounding;
      });
}

void add_reference_visibility_cases(std::vector<StabilityCase> &cases)
{
  const auto add = [&](const std::string &name, const std::string &quantity, const std::string &parameter,
                       std::vector<double> steps, std::function<double(double)> error_at) {
    cases.push_back({.group = reference_group,
                     .name = name,
                     .quantity = quantity,
                     .parameter = parameter,
                     .reference = "closed form",
                     .unit = violation_unit,
                     .bound = 0.0,
                     .run = swept(std::move(steps), std::move(error_at))});
  };
  for (const double offset : {0.0, 1e6}) {
    const glm::vec3 place = glm::vec3(glm::dvec3(offset));
    add(fmt::format("plane lit at grazing angles, {:g} m from the origin", offset),
        "receivers hidden by their own plane", "angle with the plane, rad", log_steps(1e-6, 0.5 * std::numbers::pi, 31),
        [=](double angle) {
          const Triangles plane(square(3.0), glm::translate(glm::mat4(1.0F), place));
          const reference::Tracer tracer(plane.scene);
          double wrong = 0.0;
          for (int i = 0; i < 16; i++) {
            const glm::dvec3 at = glm::dvec3(place) + glm::dvec3(0.17 * i - 1.3, 0.11 * i - 0.9, 0.0);
            const reference::LightPoint sun{{std::cos(angle), 0.0, std::sin(angle)}, true};
            wrong += violated(reference::is_visible(tracer, reference::receiver_at(at, {0, 0, 1}), sun));
          }
          return wrong;
        });
    add(fmt::format("caster above a receiver, {:g} m from the origin", offset), "receivers not hidden by a caster",
        "height of the caster, m", log_steps(offset > 0.0 ? 1.0 : 1e-6, 1e4, 31), [=](double height) {
          std::vector<glm::vec3> corners = square(3.0);
          for (const glm::vec3 &corner : square(1.0)) {
            corners.push_back(corner + glm::vec3(0, 0, float(height)));
          }
          const Triangles both(corners, glm::translate(glm::mat4(1.0F), place));
          const reference::Tracer tracer(both.scene);
          double wrong = 0.0;
          for (int i = 0; i < 16; i++) {
            const glm::dvec3 at = glm::dvec3(place) + glm::dvec3(0.11 * i - 0.8, 0.05 * i - 0.4, 0.0);
            wrong += violated(!reference::is_visible(tracer, reference::receiver_at(at, {0, 0, 1}), {{0, 0, 1}, true}));
          }
          return wrong;
        });
  }
}

void add_light_cases(std::vector<StabilityCase> &cases)
{
  for (const scene::LampKind kind : {scene::LampKind::Point, scene::LampKind::Spot, scene::LampKind::Area}) {
    for (const float radius : {0.0F, 0.1F}) {
      if (kind == scene::LampKind::Area && radius > 0.0F) {
        continue;
      }
      const char *name = kind == scene::LampKind::Point ? "point" : kind == scene::LampKind::Spot ? "spot" : "area";
      cases.push_back(
          {.group = reference_group,
           .name = fmt::format("{} lamp at a receiver, radius {:g} m", name, radius),
           .quantity = "irradiance on the lamp's axis from its centre",
           .parameter = "distance, m",
           .reference = "closed form",
           .unit = "double roundings",
           .bound = 4.0,
           .run = swept(log_steps(1e-12, 1e8, 81), [=](double distance) {
             scene::PlacedLamp lamp;
             lamp.kind = kind;
             lamp.radius = radius;
             // The unit square maps (0, 0) to the disk's centre, and (0.5, 0.5) to the rectangle's.
             const bool is_area = kind == scene::LampKind::Area;
             const double given =
                 reference::sample_lamp(lamp, {0.0, 0.0, -distance}, glm::dvec2(is_area ? 0.5 : 0.0)).irradiance;
             const double truth = (is_area ? 0.25 : 1.0) / std::max(distance * distance, 1e-12);
             return std::abs(given / truth - 1.0) / rounding;
           })});
    }
  }
}

}  // namespace

void add_reference_cases(std::vector<StabilityCase> &cases)
{
  add_tracer_cases(cases);
  add_reference_visibility_cases(cases);
  add_light_cases(cases);
}

}  // namespace gnomon::verify
