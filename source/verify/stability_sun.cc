// SPDX-License-Identifier: MIT
// A sun's maps: fitted to scenes of any scale and position, low suns, flat and point-like casters, deep views.
#include "internal/stability_cases.hh"

#include "shadows/shadow_casters.hh"
#include "shadows/shadow_sun_fit.hh"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace gnomon::verify {

namespace {

constexpr const char *sun_group = "sun";
constexpr int size_px = 1024;

/** A sun with \a elevation above the horizon, rad. +Y is up. */
scene::PlacedLamp sun_at(double elevation)
{
  scene::PlacedLamp lamp;
  lamp.kind = scene::LampKind::Sun;
  const glm::dvec3 z =
      glm::normalize(glm::dvec3(std::cos(elevation) * 0.8, std::sin(elevation), std::cos(elevation) * 0.6));
  const glm::dvec3 x = glm::normalize(glm::cross(std::abs(z.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0), z));
  lamp.world_from_lamp = glm::mat4(
      glm::dmat4(glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0), glm::dvec4(0, 0, 0, 1)));
  return lamp;
}

eevee::Caster caster_of(const glm::dvec3 &center, const glm::dvec3 &half)
{
  eevee::Caster caster;
  caster.bounds_ws.extend(glm::vec3(center - half));
  caster.bounds_ws.extend(glm::vec3(center + half));
  return caster;
}

/** Boxes of 1 m over 10 m, times \a scale, around \a center, and their visible part from above. */
struct Field {
  std::vector<eevee::Caster> casters;
  draw::View view;
  eevee::VisibleRange visible;
  float pixel_size;

  Field(const glm::dvec3 &center, double scale, double near, double far)
      : view(glm::mat4(glm::lookAt(center + scale * glm::dvec3(0, 12, 9), center, glm::dvec3(0, 1, 0))),
             draw::perspective(0.6F, 0.4F, float(near), float(far))),
        pixel_size(0.001F)
  {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    scene::Bounds all;
    for (int i = 0; i < 12; i++) {
      casters.push_back(
          caster_of(center + scale * 5.0 * glm::dvec3(unit(random), 0.1, unit(random)), glm::dvec3(0.5 * scale)));
      all.extend(casters.back().bounds_ws);
    }
    std::vector<glm::dvec3> corners;
    for (int i = 0; i < 8; i++) {
      corners.emplace_back(i & 1 ? all.max.x : all.min.x, i & 2 ? all.max.y : all.min.y, i & 4 ? all.max.z : all.min.z);
    }
    visible = eevee::visible_range(view, corners);
  }

  [[nodiscard]] std::vector<eevee::SunFit> fits(double elevation, int count) const
  {
    return eevee::fit_sun(glm::mat4(sun_at(elevation).world_from_lamp), view, visible, casters, size_px,
                          {.count = count}, pixel_size);
  }
};

/** Distance of casters' corners outside of a map and of its depth range, in half maps. */
double outside_of(const eevee::SunFit &fit, const std::vector<eevee::Caster> &casters)
{
  double worst = 0.0;
  for (const eevee::Caster &caster : casters) {
    const scene::Bounds &box = caster.bounds_ws;
    for (int i = 0; i < 8; i++) {
      const glm::vec4 clip =
          fit.view.clip_from_world() *
          glm::vec4(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z, 1.0F);
      worst = std::max({worst, std::abs(double(clip.x)) - 1.0, std::abs(double(clip.y)) - 1.0, -double(clip.z),
                        double(clip.z) - 1.0});
      worst = std::isfinite(clip.x + clip.y + clip.z) ? worst : std::numeric_limits<double>::infinity();
    }
  }
  return worst;
}

bool is_finite(const eevee::SunFit &fit)
{
  const glm::mat4 &matrix = fit.view.clip_from_world();
  for (int i = 0; i < 16; i++) {
    if (!std::isfinite(matrix[i / 4][i % 4])) {
      return false;
    }
  }
  return fit.texel() > 0.0;
}

}  // namespace

void add_sun_cases(std::vector<StabilityCase> &cases)
{
  for (const double elevation : {1e-6, 0.1, 0.5 * std::numbers::pi}) {
    const std::string of = fmt::format("sun at {:.3g} rad", elevation);
    cases.push_back({.group = sun_group,
                     .name = "scene at scales of 1e-4 to 1e5, " + of,
                     .quantity = "distance of casters outside of their map",
                     .parameter = "scale",
                     .reference = "closed form",
                     .unit = "half maps",
                     .bound = 0.0,
                     .run = swept(log_steps(1e-4, 1e5, 91), [=](double scale) {
                       const Field field(glm::dvec3(0.0), scale, 0.1 * scale, 1e3 * scale);
                       return outside_of(field.fits(elevation, 1).at(0), field.casters);
                     })});
    cases.push_back({.group = sun_group,
                     .name = "texels at scales of 1e-4 to 1e5, " + of,
                     .quantity = "texel relative to that of scale 1: extents are rounded to steps of 2^(1/8)",
                     .parameter = "scale",
                     .reference = "closed form",
                     .unit = "octaves",
                     // One step below and one above.
                     .bound = 0.126,
                     .run = swept(log_steps(1e-4, 1e5, 91), [=](double scale) {
                       const auto texel_at = [&](double s) {
                         return Field(glm::dvec3(0.0), s, 0.1 * s, 1e3 * s).fits(elevation, 1).at(0).texel();
                       };
                       return std::abs(std::log2(texel_at(scale) / scale / texel_at(1.0)));
                     })});
    cases.push_back({.group = sun_group,
                     .name = "scene at world offsets, " + of,
                     .quantity = "distance of casters outside of their map",
                     .parameter = "world offset, m",
                     .reference = "closed form",
                     .unit = "half maps",
                     // The map's margin of 1/32 covers all rounding down to the smallest scale.
                     .bound = 0.0,
                     .run = swept(zero_and_log_steps(1e-3, 1e8, 89), [=](double offset) {
                       // At least the resolution of coordinates.
                       const double scale = std::max(1.0, 64.0 * float_epsilon * offset);
                       const Field field(offset * glm::dvec3(1, 0, -1), scale, 0.1 * scale, 1e3 * scale);
                       return outside_of(field.fits(elevation, 1).at(0), field.casters);
                     })});
  }
  cases.push_back({.group = sun_group,
                   .name = "elevations of 1e-9 to 90°",
                   .quantity = "all maps: finite, with texels above 0",
                   .parameter = "elevation, rad",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(log_steps(1e-9, 0.5 * std::numbers::pi, 101), [](double elevation) {
                     const std::vector<eevee::SunFit> fits = Field(glm::dvec3(0.0), 1.0, 0.1, 1e3).fits(elevation, 4);
                     return violated(!fits.empty() && std::ranges::all_of(fits, is_finite));
                   })});
  cases.push_back({.group = sun_group,
                   .name = "views of any depth",
                   .quantity = "cascades: finite, from fine to coarse, the last one around the whole scene",
                   .parameter = "far/near",
                   .reference = "closed form",
                   .unit = violation_unit,
                   .bound = 0.0,
                   .run = swept(log_steps(1.1, 1e9, 91), [](double ratio) {
                     const Field field(glm::dvec3(0.0), 1.0, 1e-6, 1e-6 * ratio);
                     eevee::VisibleRange range = field.visible;
                     range.near = range.far / ratio;
                     double worst = 0.0;
                     for (int count = 1; count <= eevee::cascade_count_max; count++) {
                       const std::vector<eevee::SunFit> fits =
                           eevee::fit_sun(glm::mat4(sun_at(0.5).world_from_lamp), field.view, range, field.casters,
                                          size_px, {.count = count}, field.pixel_size);
                       const bool is_sorted =
                           std::ranges::is_sorted(fits, {}, [](const eevee::SunFit &fit) { return fit.texel(); });
                       worst = std::max(worst,
                                        violated(!fits.empty() && is_sorted && std::ranges::all_of(fits, is_finite)));
                     }
                     return worst;
                   })});
  for (const bool is_flat : {false, true}) {
    cases.push_back(
        {.group = sun_group,
         .name = is_flat ? "flat casters" : "casters of a point",
         .quantity = "map of a caster without height or size above its receiver: finite, and contains the caster",
         .parameter = is_flat ? "size of the caster, m" : "distance above the receiver, m",
         .reference = "closed form",
         .unit = violation_unit,
         .bound = 0.0,
         .run = swept(log_steps(1e-4, 1e5, 91), [=](double x) {
           const eevee::Caster caster =
               is_flat ? caster_of({0, 2.0 * x, 0}, {x, 0, x}) : caster_of({1, 2.0 + x, 3}, glm::dvec3(0.0));
           const draw::View view(glm::mat4(1.0F), draw::perspective(1.0F, 1.0F, 0.1F, 100.0F));
           const double reach = is_flat ? x : 1.0;
           const eevee::VisibleRange range =
               eevee::visible_range(view, {glm::dvec3(-reach, 0, -reach), glm::dvec3(reach + 2.0, 0, reach + 4.0)});
           const std::vector<eevee::SunFit> fits =
               eevee::fit_sun(glm::mat4(sun_at(0.5 * std::numbers::pi).world_from_lamp), view, range, {caster}, size_px,
                              {.count = 1}, 0.001F);
           return violated(fits.size() == 1 && is_finite(fits[0]) && outside_of(fits[0], {caster}) <= 0.0);
         })});
  }
}

}  // namespace gnomon::verify
