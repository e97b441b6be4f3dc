// SPDX-License-Identifier: MIT
#include "measure_light.hh"

#include "eevee_area_shared.h"
#include "eevee_multiscatter_shared.h"
#include "eevee_shape_shared.h"
#include "eevee_tables.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <span>

namespace gnomon::measure {

using shared::vec2;
using shared::vec3;
using shared::vec4;

namespace {

/** Square of the sine of half the angle that a round lamp spans. */
double sine_sq(const LampShape &lamp)
{
  const double radius_sq = glm::dot(lamp.axis_x, lamp.axis_x);
  return radius_sq / (radius_sq + glm::dot(lamp.center, lamp.center));
}

int corner_count(const LampShape &lamp)
{
  return lamp.outline == LampOutline::Rectangle ? RECTANGLE_CORNERS : ELLIPSE_CORNERS;
}

/** Irradiance on a surface that faces the lamp, if all of its light came from \a point. */
double point_irradiance(const LampShape &lamp, const glm::dvec3 &point)
{
  if (lamp.outline == LampOutline::Round) {
    return double(shared::PI) * sine_sq(lamp);
  }
  const glm::dvec3 area = glm::normalize(glm::cross(lamp.axis_x, lamp.axis_y)) * lamp.area();
  const double distance_sq = glm::dot(point, point);
  return std::abs(glm::dot(area, point)) / (distance_sq * std::sqrt(distance_sq));
}

/** The point of \a lamp that is nearest to the line from the shaded point along the unit vector \a direction. */
glm::dvec3 nearest_point(const LampShape &lamp, const glm::dvec3 &direction)
{
  if (lamp.outline == LampOutline::Round) {
    const glm::dvec3 offset = direction * glm::dot(lamp.center, direction) - lamp.center;
    const double radius = glm::length(lamp.axis_x);
    return lamp.center + offset * std::min(radius / std::max(glm::length(offset), 1e-18), 1.0);
  }
  const vec3 normal(glm::cross(lamp.axis_x, lamp.axis_y));
  const auto distance = double(shared::line_plane_distance(vec3(0.0F), vec3(direction), vec3(lamp.center), normal));
  // Behind the shaded point, the lamp is taken to be far away along the line.
  const glm::dvec3 offset = (distance > 0.0 ? distance : double(shared::LINE_FAR)) * direction - lamp.center;
  glm::dvec2 at(glm::dot(offset, lamp.axis_x) / glm::dot(lamp.axis_x, lamp.axis_x),
                glm::dot(offset, lamp.axis_y) / glm::dot(lamp.axis_y, lamp.axis_y));
  at = lamp.outline == LampOutline::Rectangle ? glm::clamp(at, -1.0, 1.0) : at / std::max(glm::length(at), 1.0);
  return lamp.center + at.x * lamp.axis_x + at.y * lamp.axis_y;
}

/** Angle of a lamp; solid angle of a flat lamp. Half of it widens a lobe. \see point_specular */
double extent(const LampShape &lamp)
{
  if (lamp.outline == LampOutline::Round) {
    return std::min(glm::length(lamp.axis_x) / glm::length(lamp.center), 1.0);
  }
  // The square of the same area, for an ellipse.
  const double scale = lamp.outline == LampOutline::Rectangle ? 1.0 : 0.5 * std::sqrt(double(shared::PI));
  return double(shared::rectangle_solid_angle(vec3(lamp.center), vec3(scale * lamp.axis_x), vec3(scale * lamp.axis_y)));
}

/** The lobe towards its viewer, times the cosine of the light. */
double lobe_cosine(const SpecularLobe &lobe, const glm::dvec3 &to_light)
{
  const glm::dvec3 half_vector = glm::normalize(to_light + lobe.view);
  return double(shared::ggx_lobe(float(to_light.z), float(lobe.view.z), std::min(float(half_vector.z), 1.0F),
                                 float(lobe.alpha))) *
         to_light.z;
}

}  // namespace

/** Bilinear lookup in \a table. Centres of texels are at whole numbers of \a texel. */
static glm::vec4 filtered(std::span<const float> table, const glm::ivec2 &size, const vec2 &texel)
{
  const glm::ivec2 low(glm::floor(texel));
  const vec2 part = texel - vec2(low);
  const auto at = [&](const glm::ivec2 &offset) {
    const glm::ivec2 place = glm::clamp(low + offset, glm::ivec2(0), size - 1);
    const float *texels = &table[std::size_t(4 * (place.y * size.x + place.x))];
    return vec4(texels[0], texels[1], texels[2], texels[3]);
  };
  return glm::mix(glm::mix(at({0, 0}), at({1, 0}), part.x), glm::mix(at({0, 1}), at({1, 1}), part.x), part.y);
}

glm::vec4 ltc_texel(const glm::vec2 &texco)
{
  const glm::ivec2 size(2 * LTC_TABLE_SIZE, LTC_TABLE_SIZE);
  return filtered(eevee::ltc_table(), size, texco * vec2(size) - 0.5F);
}

glm::vec4 multiscatter_texel(double alpha, double cosine)
{
  const vec2 place = shared::multiscatter_place(float(alpha), float(cosine));
  return filtered(eevee::multiscatter_table(), glm::ivec2(MULTISCATTER_TABLE_SIZE),
                  place * float(MULTISCATTER_TABLE_SIZE - 1));
}

double whole_diffuse(const LampShape &lamp)
{
  if (lamp.outline == LampOutline::Round) {
    const auto sine_squared = float(sine_sq(lamp));
    const auto cosine = float(lamp.center.z / glm::length(lamp.center));
    return double(sine_squared * shared::disk_cosine(sine_squared, cosine));
  }
  const vec3 up(0.0F, 0.0F, 1.0F);
  return double(shared::flat_flux(vec3(lamp.center), vec3(lamp.axis_x), vec3(lamp.axis_y), corner_count(lamp), up).z);
}

WholeSpecular whole_specular(const LampShape &lamp, const SpecularLobe &lobe)
{
  const vec3 view(lobe.view);
  const auto alpha = float(lobe.alpha);
  const vec4 matrix = ltc_texel(shared::ltc_texco(alpha, view.z));
  const vec3 flux = shared::flat_flux(
      shared::ltc_transformed(matrix, vec3(lamp.center)), shared::ltc_transformed(matrix, vec3(lamp.axis_x)),
      shared::ltc_transformed(matrix, vec3(lamp.axis_y)), corner_count(lamp), shared::ltc_up(matrix));
  const vec3 center(lamp.center);
  const vec3 axis_x(lamp.axis_x);
  const vec3 axis_y(lamp.axis_y);
  const bool is_small = shared::is_small_lamp(center, axis_x, axis_y, alpha);
  const vec3 to_light = shared::direction_or_zero(is_small ? center : shared::ltc_restored(matrix, flux));
  if ((flux.z <= 0.0F && !is_small) || to_light.z <= 0.0F) {
    return {};
  }
  const auto lobe_value = float(lobe_cosine(lobe, glm::dvec3(to_light)));
  if (is_small) {
    const float area = shared::flat_lamp_area_along(axis_x, axis_y, lamp.outline == LampOutline::Rectangle, to_light);
    const double light = double(lobe_value * shared::flat_lamp_solid_angle(area, glm::dot(center, center)));
    return {.light = light, .by_ratio = light, .to_light = glm::dvec3(to_light)};
  }
  const float ratio =
      std::min(lobe_value / std::max(shared::ltc_density(matrix, to_light), 1e-30F), shared::LTC_RATIO_MAX);
  WholeSpecular result{.by_ratio = double(flux.z * ratio),
                       .to_light = glm::dvec3(to_light),
                       .covered = double(shared::ltc_covered(matrix, flux.z))};
  const auto albedo = double(ltc_texel(shared::ltc_texco(alpha, view.z) + vec2(0.5F, 0.0F)).x);
  result.light = glm::mix(result.by_ratio, albedo * result.covered, result.covered);
  return result;
}

double whole_specular_multi(const LampShape &lamp, const SpecularLobe &lobe)
{
  const WholeSpecular whole = whole_specular(lamp, lobe);
  const vec4 texel = multiscatter_texel(lobe.alpha, lobe.view.z);
  const double albedo = 1.0 - double(shared::lobe_albedo(texel, float(lobe.alpha), float(lobe.view.z)).missing);
  return glm::mix(whole.by_ratio, albedo * whole.covered, whole.covered);
}

double point_diffuse(const LampShape &lamp)
{
  const double cosine = std::max(lamp.center.z / glm::length(lamp.center), 0.0);
  return point_irradiance(lamp, lamp.center) * cosine / double(shared::PI);
}

double point_specular(const LampShape &lamp, const SpecularLobe &lobe)
{
  // Between the normal for the widest lobe and the mirrored view for the narrowest.
  const glm::dvec3 mirrored(-lobe.view.x, -lobe.view.y, lobe.view.z);
  const glm::dvec3 dominant =
      glm::normalize(glm::mix(glm::dvec3(0.0, 0.0, 1.0), mirrored, 1.0 - lobe.alpha * lobe.alpha));
  const glm::dvec3 point = nearest_point(lamp, dominant);
  const glm::dvec3 to_light = glm::normalize(point);
  if (to_light.z <= 0.0) {
    return 0.0;
  }
  const double widened = std::min(lobe.alpha + 0.5 * extent(lamp), 1.0);
  const double dimmed = lobe.alpha / widened;
  return point_irradiance(lamp, point) * dimmed * dimmed * lobe_cosine(lobe, to_light);
}

}  // namespace gnomon::measure
