// SPDX-License-Identifier: MIT
// Lamps: cones, fall-off, near planes, and the largest number of lights.
#include "internal/stability_cases.hh"

#include "eevee_lamps.hh"
#include "eevee_light_cluster_shared.h"
#include "eevee_shadow_shared.h"
#include "shadows/shadow_casters.hh"
#include "shadows/shadow_cube.hh"
#include "shadows/shadow_spot.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gnomon::verify {

namespace {

constexpr const char *lamps_group = "lamps";
constexpr double degree = std::numbers::pi / 180.0;

/** 1 - cos, without cancellation. */
double one_minus_cos(double angle)
{
  const double sine = std::sin(0.5 * angle);
  return 2.0 * sine * sine;
}

/** Angles from a cone's axis, dense next to its edge. */
std::vector<double> angles_around(double edge)
{
  std::vector<double> angles = even_steps(0.0, std::numbers::pi, 91);
  for (const double beside : log_steps(1e-9, 0.1, 25)) {
    angles.push_back(std::clamp(edge - beside, 0.0, std::numbers::pi));
    angles.push_back(std::clamp(edge + beside, 0.0, std::numbers::pi));
  }
  std::ranges::sort(angles);
  return angles;
}

void add_spot_cases(std::vector<StabilityCase> &cases)
{
  for (const double cone : {0.0, 1.0, 45.0, 90.0, 120.0, 179.0, 180.0}) {
    const auto drop_outer = float(one_minus_cos(0.5 * cone * degree));
    for (const float blend : {0.0F, 1e-6F, 0.5F, 1.0F}) {
      cases.push_back(case_of({lamps_group, fmt::format("cone of {:g}°, blend {:g}", cone, blend), "spot_mask",
                               "transmission of a spot's cone", "angle from the axis, rad",
                               angles_around(0.5 * cone * degree), [=](double angle) {
                                 return Arguments<float>{.a = {float(one_minus_cos(angle)), drop_outer, blend, 0.0F}};
                               }}));
    }
  }
  cases.push_back({.group = lamps_group,
                   .name = "cones of 0 to 180°, blends of 0 to 1",
                   .quantity = "transmission: finite, in [0, 1], and not rising away from the axis",
                   .parameter = "opening, degrees",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(even_steps(0.0, 180.0, 121), [](double cone) {
                     const auto drop_outer = float(one_minus_cos(0.5 * cone * degree));
                     double worst = 0.0;
                     for (const float blend : {0.0F, 1e-30F, 1e-6F, 1e-3F, 0.1F, 0.5F, 1.0F}) {
                       float before = 1.0F;
                       for (const double angle : angles_around(0.5 * cone * degree)) {
                         const float mask = shared::spot_mask(float(one_minus_cos(angle)), drop_outer,
                                                              shared::spot_inv_width(drop_outer, blend));
                         worst = std::max(worst, violated(mask >= 0.0F && mask <= before));
                         before = mask;
                       }
                     }
                     return worst;
                   })});
  for (const double cone : {1e-6, 1e-3, 0.1, 2.0, 20.0, 180.0}) {
    cases.push_back({.group = lamps_group,
                     .name = fmt::format("engine's cone of {:g}°", cone),
                     .quantity = "transmission of a spot with a blend of 1, from its entry of light_block",
                     .parameter = "angle from the axis, rad",
                     .reference = "double",
                     .unit = epsilon_unit,
                     // 1 - cos of both angles and the width are rounded by half an epsilon each, and so is each step to
                     // t, which smoothstep multiplies by at most 1.5; it has three more roundings.
                     .bound = 1.5 * 5 * 0.5 + 1.5,
                     .run = swept(even_steps(0.0, 0.5 * cone * degree, 121), [=](double angle) {
                       scene::PlacedLamp lamp;
                       lamp.kind = scene::LampKind::Spot;
                       lamp.spot_outer_angle = float(0.5 * cone * degree);
                       lamp.spot_blend = 1.0F;
                       const shared::LightData light = eevee::light_data(lamp);
                       const double mask =
                           shared::spot_mask(float(one_minus_cos(angle)), light.spot_drop_outer, light.spot_inv_width);
                       const double drop_outer = one_minus_cos(double(lamp.spot_outer_angle));
                       const double t = std::clamp((drop_outer - one_minus_cos(angle)) / drop_outer, 0.0, 1.0);
                       return std::abs(mask - t * t * (3.0 - 2.0 * t)) / float_epsilon;
                     })});
  }
  cases.push_back({.group = lamps_group,
                   .name = "spot's view, narrow to wide",
                   .quantity = "position in the map of a receiver on the cone's edge: inside",
                   .parameter = "half of the opening, rad",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(log_steps(1e-6, double(eevee::spot_map_angle_max), 121), [](double angle) {
                     double worst = 0.0;
                     for (const int size_px : {1, 16, 16384}) {
                       const draw::View view = eevee::shadow_spot_view(glm::mat4(1.0F), float(angle), 1e-3F, size_px);
                       const glm::vec4 clip =
                           view.clip_from_world() * glm::vec4(float(std::tan(angle)), 0.0F, -1.0F, 1.0F);
                       worst =
                           std::max(worst, violated(std::abs(clip.x) <= clip.w && clip.z <= clip.w && clip.z > 0.0F));
                     }
                     return worst;
                   })});
}

void add_falloff_cases(std::vector<StabilityCase> &cases)
{
  for (const float radius : {0.0F, 1e-4F, 1.0F}) {
    for (const float range : {0.0F, 1e-3F, 1e4F}) {
      cases.push_back(case_of({lamps_group, fmt::format("fall-off, radius {:g} m, range {:g} m", radius, range),
                               "distance_falloff", "irradiance of a lamp of 1 W/sr", "distance, m",
                               zero_and_log_steps(1e-8, 1e8, 161), [=](double distance) {
                                 return Arguments<float>{.a = {float(distance * distance), radius * radius,
                                                               range > 0.0F ? 1.0F / (range * range) : 0.0F, 0.0F}};
                               }}));
    }
  }
  cases.push_back({.group = lamps_group,
                   .name = "ranges of 1e-30 to 1e30 m",
                   .quantity = "irradiance at the lamp's position and at 1 m: finite, and equal to the closed form",
                   .parameter = "range, m",
                   .reference = "closed form",
                   .unit = "relative",
                   .bound = 1e-6,
                   .run = swept(log_steps(1e-30, 1e30, 121), [](double range) {
                     scene::PlacedLamp lamp;
                     lamp.range = float(range);
                     const shared::LightData light = eevee::light_data(lamp);
                     const double at_lamp = shared::distance_falloff(0.0F, light.radius_sq, light.range_inv_sq);
                     const double away = shared::distance_falloff(1.0F, light.radius_sq, light.range_inv_sq);
                     const double window = std::max(1.0 - std::pow(range, -4.0), 0.0);
                     // The window's slope is 4 where it closes.
                     return std::max(std::abs(at_lamp / 1e12 - 1.0), std::abs(away - window));
                   })});
  cases.push_back({.group = lamps_group,
                   .name = "radii of 1e-30 to 1e12 m",
                   .quantity = "irradiance of a lamp of 1 W/sr at its own position: 1 / radius², at most 1e12",
                   .parameter = "radius, m",
                   .reference = "closed form",
                   .unit = epsilon_unit,
                   .bound = 1.5,
                   .run = swept(log_steps(1e-30, 1e12, 127), [](double radius) {
                     scene::PlacedLamp lamp;
                     lamp.radius = float(radius);
                     const double given = shared::distance_falloff(0.0F, eevee::light_data(lamp).radius_sq, 0.0F);
                     const double truth = 1.0 / std::max(std::pow(double(lamp.radius), 2.0), 1e-12);
                     return std::abs(given / truth - 1.0) / float_epsilon;
                   })});
  cases.push_back(case_of({lamps_group, "hemi", "hemi_irradiance", "visible fraction of a uniform sky from a surface",
                           "angle from the sky's axis, rad", even_steps(0.0, std::numbers::pi, 91), [](double angle) {
                             return Arguments<float>{.a = {float(std::cos(angle)), 0.0F, 0.0F, 0.0F}};
                           }}));
}

void add_count_cases(std::vector<StabilityCase> &cases)
{
  const std::vector<double> counts = {
      0, 1, 2, LIGHT_MAX - 1, LIGHT_MAX, LIGHT_MAX + 1, 4 * LIGHT_MAX, LIGHT_COUNT_MAX, LIGHT_COUNT_MAX + 2};
  for (const scene::LampKind kind : {scene::LampKind::Point, scene::LampKind::Sun, scene::LampKind::Spot}) {
    const char *name = kind == scene::LampKind::Point ? "points" : kind == scene::LampKind::Sun ? "suns" : "spots";
    cases.push_back({.group = lamps_group,
                     .name = fmt::format("0, 1, max and max+1 {}", name),
                     .quantity = "lights that differ from the lamp of their index, and lamps above the "
                                 "limit that are not named",
                     .parameter = "lamps",
                     .reference = "closed form",
                     .unit = violation_unit,
                     .bound = 0.0,
                     .run = swept(counts, [=](double count) {
                       std::vector<scene::PlacedLamp> placed(static_cast<std::size_t>(count));
                       for (std::size_t i = 0; i < placed.size(); i++) {
                         placed[i].kind = kind;
                         placed[i].name = fmt::format("<{}>", i);
                         placed[i].intensity = float(i + 1);
                       }
                       const eevee::Lamps lamps = eevee::make_lamps(placed);
                       const int drawn = std::min(int(count), LIGHT_COUNT_MAX);
                       double wrong = std::abs(lamps.light_count() - drawn);
                       for (int i = 0; i < drawn; i++) {
                         wrong += violated(lamps.lights[std::size_t(i)].color.r == float(i + 1));
                       }
                       for (int i = drawn; i < int(count); i++) {
                         wrong += violated(!lamps.limits.empty() &&
                                           lamps.limits[0].find(fmt::format("<{}>", i)) != std::string::npos);
                       }
                       return wrong;
                     })});
  }
}

/** A caster: a triangle around the lamp's axis, \a distance below the lamp, with a known mesh. */
struct CasterBelow {
  scene::Mesh mesh;
  glm::mat4 world_from_object{1.0F};
  eevee::Caster caster;

  CasterBelow(const glm::vec3 &lamp, float distance, float size)
  {
    for (const glm::vec3 &corner : {glm::vec3(-1, 0, -1), glm::vec3(3, 0, -1), glm::vec3(-1, 0, 3)}) {
      mesh.positions.push_back(lamp + size * corner - glm::vec3(0, distance, 0));
      mesh.bounds.extend(mesh.positions.back());
    }
    mesh.indices = {0, 1, 2};
    caster.bounds_ws = mesh.bounds;
    caster.mesh = &mesh;
    caster.world_from_object = &world_from_object;
  }
};

void add_near_cases(std::vector<StabilityCase> &cases)
{
  constexpr float infinite = std::numeric_limits<float>::infinity();
  for (const double size : {1e-3, 1.0, 1e5}) {
    cases.push_back({.group = lamps_group,
                     .name = fmt::format("near plane before a caster of {:g} m", size),
                     .quantity =
                         "lamp's near plane: above 0, and nearer than the caster along a face's diagonal or 1e-4 "
                         "of the caster's radius",
                     .parameter = "distance of the caster, m",
                     .reference = "closed form",
                     .unit = violation_unit,
                     .bound = 0.0,
                     .run = swept(zero_and_log_steps(1e-9, 1e7, 129), [=](double distance) {
                       const CasterBelow below(glm::vec3(0.0F), float(distance), float(size));
                       const float near = eevee::lamp_near(glm::vec3(0.0F), infinite, {below.caster});
                       const float least = std::max(1e-4F * below.caster.bounds_ws.radius(), 1e-6F);
                       return std::isfinite(near)
                                  ? violated(near > 0.0F && near <= std::max(float(distance / std::sqrt(3.0)), least))
                                  : double(near);
                     })});
  }
  cases.push_back({.group = lamps_group,
                   .name = "lamp inside a caster's box",
                   .quantity = "distance of the nearest triangle",
                   .parameter = "distance, m",
                   .reference = "closed form",
                   .unit = epsilon_unit,
                   .bound = 1.0,
                   .run = swept(log_steps(1e-6, 1.0, 121), [](double distance) {
                     CasterBelow below(glm::vec3(0.0F), float(distance), 1.0F);
                     below.caster.bounds_ws.extend(glm::vec3(0.0F, 1.0F, 0.0F));
                     const double found = eevee::distance_to(below.caster, glm::vec3(0.0F));
                     return std::abs(found / double(float(distance)) - 1.0) / float_epsilon;
                   })});
  cases.push_back({.group = lamps_group,
                   .name = "collinear and zero-area casters",
                   .quantity = "distance of a lamp from a triangle that is a line, and a point",
                   .parameter = "length of the triangle, m",
                   .reference = "closed form",
                   .unit = epsilon_unit,
                   // Computed in double except for the last step.
                   .bound = 1.0,
                   .run = swept(zero_and_log_steps(1e-38, 1e6, 133), [](double length) {
                     scene::Mesh mesh;
                     const auto half = float(0.5 * length);
                     mesh.positions = {{-half, 0, 0}, {0, 0, 0}, {half, 0, 0}};
                     mesh.indices = {0, 1, 2, 1, 1, 1};
                     const glm::mat4 identity(1.0F);
                     eevee::Caster caster;
                     caster.bounds_ws = {glm::vec3(-1e7F), glm::vec3(1e7F)};
                     caster.mesh = &mesh;
                     caster.world_from_object = &identity;
                     const double found = eevee::distance_to(caster, {0.0F, 1.0F, 0.0F});
                     return std::abs(found - 1.0) / float_epsilon;
                   })});
  cases.push_back({.group = lamps_group,
                   .name = "range without a caster",
                   .quantity = "lamp's near plane: above 0, before the range",
                   .parameter = "range, m",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(log_steps(1e-5, 1e30, 141), [](double range) {
                     const float near = eevee::lamp_near(glm::vec3(0.0F), float(range), {});
                     return std::isfinite(near) ? violated(near > 0.0F && near < float(range)) : double(near);
                   })});
}

void add_shadow_cases(std::vector<StabilityCase> &cases)
{
  cases.push_back(case_of({"shadow", "normal offset over texels", "shadow_normal_offset", "normal offset of a receiver",
                           "edge of a texel, m", log_steps(1e-9, 1e6, 151), [](double texel) {
                             return Arguments<float>{.a = {float(texel), 2.0F, 1e-6F, 1.0F}};
                           }}));
  cases.push_back(
      case_of({"shadow", "normal offset over world offsets", "shadow_normal_offset", "normal offset of a receiver",
               "largest coordinate, m", log_steps(1e-3, 1e8, 111), [](double offset) {
                 return Arguments<float>{.a = {1e-3F, 1.0F, 0.0F, float(offset)}};
               }}));
  cases.push_back(case_of({"shadow", "slope of a plane seen edge-on", "slope_quotient",
                           "change of depth per texel, 0 for a plane without area", "denominator",
                           zero_and_log_steps(1e-38, 1e10, 145), [](double denominator) {
                             return Arguments<float>{.a = {1.0F, float(denominator), 0.0F, 0.0F}};
                           }}));
  for (const float depth : {0.0F, 1e-6F, 1.0F}) {
    cases.push_back(case_of(
        {"shadow", fmt::format("depths of a grazing plane at {:g}", depth), "plane_depths",
         "depth of a plane at four texels", "slope, depth per texel", log_steps(1e-12, 1e6, 109), [=](double slope) {
           return Arguments<float>{.a = {depth, float(slope), -float(slope), 0.0F}, .b = {-0.25F, -0.75F, 0.0F, 0.0F}};
         }}));
  }
  for (const bool is_far : {false, true}) {
    cases.push_back({.group = "shadow",
                     .name = is_far ? "cube's views, far receiver" : "cube's views, near receiver",
                     .quantity = "depth of a receiver on a face's axis, through the matrices, relative",
                     .parameter = "world offset of the lamp, m",
                     .reference = "closed form",
                     .unit = "epsilons of offset / distance",
                     // The receiver and its difference from the lamp are rounded.
                     .bound = 1.0,
                     .run = swept(zero_and_log_steps(1e-3, 1e8, 111), [=](double offset) {
                       const double near = 1e-3;
                       // At least the resolution of coordinates.
                       const double distance = std::max(is_far ? 1e4 : 0.1, 64.0 * float_epsilon * offset);
                       const glm::vec3 lamp = glm::vec3(glm::dvec3(offset, -offset, offset));
                       const std::array<draw::View, 6> views = eevee::shadow_cube_views(lamp, float(near), 1024);
                       double worst = 0.0;
                       for (std::size_t face = 0; face < 6; face++) {
                         glm::dvec3 receiver(lamp);
                         receiver[int(face / 2)] += face % 2 == 0 ? distance : -distance;
                         const glm::vec4 clip = views[face].clip_from_world() * glm::vec4(receiver, 1.0F);
                         const double depth = double(clip.z) / double(clip.w);
                         worst = std::max(worst, std::abs(depth * distance / double(float(near)) - 1.0));
                       }
                       return worst / (float_epsilon * (1.0 + offset / distance));
                     })});
  }
}

}  // namespace

void add_lamp_cases(std::vector<StabilityCase> &cases)
{
  add_spot_cases(cases);
  add_falloff_cases(cases);
  add_count_cases(cases);
  add_near_cases(cases);
  add_shadow_cases(cases);
}

}  // namespace gnomon::verify
