// SPDX-License-Identifier: MIT
#include "measure_light.hh"

#include "scene_parallel.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace gnomon::measure {

namespace {

constexpr std::array<double, 5> roughnesses = {0.1, 0.25, 0.5, 0.75, 1.0};
/** Angles of the view to the normal, degrees. */
constexpr std::array<double, 4> views = {0.0, 30.0, 60.0, 80.0};
/** Angles of the lamp's centre to the surface, degrees. The first is the zenith, which has one azimuth. */
constexpr std::array<double, 4> elevations = {90.0, 60.0, 30.0, 5.0};
/** From the plane of the normal and the view, degrees. 180: where the view is mirrored. */
constexpr std::array<double, 3> azimuths = {180.0, 90.0, 0.0};
/** Half the longer axis, or the radius, metres. */
constexpr std::array<double, 3> sizes = {0.1, 0.5, 2.0};
/** Distances of the lamp's centre, metres. */
constexpr std::array<double, 3> distances = {0.5, 2.0, 8.0};
constexpr std::array<std::pair<LampOutline, const char *>, 3> outlines = {
    {{LampOutline::Round, "round"}, {LampOutline::Rectangle, "rectangle"}, {LampOutline::Ellipse, "ellipse"}}};

/** A lamp and, for specular light, a lobe; with the values that were computed for them. */
struct LightCase {
  std::size_t outline = 0;
  double size = 0.0;
  double distance = 0.0;
  double elevation = 0.0;
  double azimuth = 0.0;
  /** 0: diffuse light, for which there is no view. */
  double roughness = 0.0;
  double view = 0.0;

  Integral integral{};
  double whole = 0.0;
  double multi = 0.0;
  double point = 0.0;
  /** The value that an error is relative to. */
  double scale = 0.0;

  [[nodiscard]] bool is_diffuse() const
  {
    return roughness == 0.0;
  }
};

/** A lamp that faces the shaded point. A rectangle or ellipse is half as wide as long, and at 30° to the horizontal. */
LampShape shape_of(const LightCase &one)
{
  const double elevation = glm::radians(one.elevation);
  const double azimuth = glm::radians(one.azimuth);
  const glm::dvec3 to_lamp(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                           std::sin(elevation));
  const glm::dvec3 across(-std::sin(azimuth), std::cos(azimuth), 0.0);
  const glm::dvec3 along = glm::cross(to_lamp, across);
  const double turn = glm::radians(30.0);
  const LampOutline outline = outlines[one.outline].first;
  return {.outline = outline,
          .center = one.distance * to_lamp,
          .axis_x = one.size * (std::cos(turn) * across + std::sin(turn) * along),
          .axis_y = (outline == LampOutline::Round ? 1.0 : 0.5) * one.size *
                    (std::cos(turn) * along - std::sin(turn) * across)};
}

/** The cases of one lamp, size, distance and lobe that differ in directions only. */
std::vector<LightCase> cases_of_directions(LightCase one)
{
  std::vector<LightCase> cases;
  for (const double view : views) {
    one.view = view;
    for (const double elevation : elevations) {
      one.elevation = elevation;
      for (const double azimuth : azimuths) {
        one.azimuth = azimuth;
        cases.push_back(one);
        if (elevation == elevations.front() || one.is_diffuse()) {
          break;
        }
      }
    }
    if (one.is_diffuse()) {
      break;
    }
  }
  return cases;
}

void compute(std::vector<LightCase> &cases, int point_count)
{
  double largest = 0.0;
  for (LightCase &one : cases) {
    const LampShape lamp = shape_of(one);
    if (one.is_diffuse()) {
      one.integral = integrated_diffuse(lamp, point_count);
      one.whole = one.multi = whole_diffuse(lamp);
      one.point = point_diffuse(lamp);
    }
    else {
      const double view = glm::radians(one.view);
      const SpecularLobe lobe{one.roughness * one.roughness, {std::sin(view), 0.0, std::cos(view)}};
      one.integral = integrated_specular(lamp, lobe, point_count);
      one.whole = whole_specular(lamp, lobe).light;
      one.multi = whole_specular_multi(lamp, lobe);
      one.point = point_specular(lamp, lobe);
    }
    largest = std::max(largest, one.integral.value);
  }
  for (LightCase &one : cases) {
    one.scale = std::max({one.integral.value, 0.01 * largest, std::numeric_limits<double>::min()});
  }
}

LightErrors errors_of(const std::vector<const LightCase *> &cases, double LightCase::*value)
{
  LightErrors result;
  std::vector<double> errors;
  for (const LightCase *one : cases) {
    if (std::isfinite(one->*value) && one->*value >= 0.0) {
      errors.push_back(std::abs(one->*value - one->integral.value) / one->scale);
    }
  }
  result.bad_count = cases.size() - errors.size();
  if (!errors.empty()) {
    std::ranges::sort(errors);
    const auto at = [&](double share) { return errors[std::size_t(std::ceil(share * double(errors.size() - 1)))]; };
    result.median = at(0.5);
    result.p95 = at(0.95);
    result.largest = errors.back();
  }
  return result;
}

}  // namespace

std::vector<LightErrorRow> light_errors(int point_count)
{
  std::vector<std::vector<LightCase>> groups;
  for (std::size_t outline = 0; outline < outlines.size(); outline++) {
    for (const double size : sizes) {
      for (const double distance : distances) {
        LightCase one{.outline = outline, .size = size, .distance = distance};
        groups.push_back(cases_of_directions(one));
        for (const double roughness : roughnesses) {
          one.roughness = roughness;
          groups.push_back(cases_of_directions(one));
        }
      }
    }
  }
  scene::parallel_for(groups.size(), 0, [&](std::size_t i) { compute(groups[i], point_count); });

  std::vector<LightErrorRow> rows;
  for (const bool is_diffuse : {true, false}) {
    const auto add = [&](const char *parameter, const std::string &value, const auto &is_chosen) {
      std::vector<const LightCase *> chosen;
      LightErrorRow row{.light = is_diffuse ? "diffuse" : "specular", .parameter = parameter, .value = value};
      for (const std::vector<LightCase> &group : groups) {
        for (const LightCase &one : group) {
          if (one.is_diffuse() == is_diffuse && is_chosen(one)) {
            chosen.push_back(&one);
            row.integral_error = std::max(row.integral_error, one.integral.standard_error / one.scale);
          }
        }
      }
      row.case_count = chosen.size();
      row.whole = errors_of(chosen, &LightCase::whole);
      row.multi = errors_of(chosen, &LightCase::multi);
      row.point = errors_of(chosen, &LightCase::point);
      rows.push_back(std::move(row));
    };
    const auto add_each = [&](const char *parameter, const auto &values, double LightCase::*member, const char *unit) {
      for (const double value : values) {
        add(parameter, fmt::format("{}{}", value, unit), [&](const LightCase &one) { return one.*member == value; });
      }
    };
    add("all", "", [](const LightCase & /*one*/) { return true; });
    for (std::size_t i = 0; i < outlines.size(); i++) {
      add("outline", outlines[i].second, [i](const LightCase &one) { return one.outline == i; });
    }
    if (!is_diffuse) {
      add_each("roughness", roughnesses, &LightCase::roughness, "");
      add_each("view", views, &LightCase::view, " deg");
    }
    add_each("elevation", elevations, &LightCase::elevation, " deg");
    add_each("size", sizes, &LightCase::size, " m");
    add_each("distance", distances, &LightCase::distance, " m");
  }
  return rows;
}

}  // namespace gnomon::measure
