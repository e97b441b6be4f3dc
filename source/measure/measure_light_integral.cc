// SPDX-License-Identifier: MIT
#include "measure_light.hh"

#include "eevee_sobol.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

// From here on `float` is double.
#define SHARED_DOUBLE
#include "eevee_bsdf_shared.h"

namespace gnomon::measure {

namespace {

constexpr double pi = std::numbers::pi;

/** Maps the unit square evenly to the unit disk. */
glm::dvec2 on_disk(const glm::dvec2 &u)
{
  const double radius = std::sqrt(u.x);
  return {radius * std::cos(2.0 * pi * u.y), radius * std::sin(2.0 * pi * u.y)};
}

/** Points of a lamp, even over its area. */
class LampSampler {
 public:
  explicit LampSampler(const LampShape &lamp)
      : lamp_(lamp), normal_(glm::normalize(glm::cross(lamp.axis_x, lamp.axis_y))), area_(lamp.area())
  {
  }
  /** Unit vector to a point of the lamp. */
  [[nodiscard]] glm::dvec3 sample(const glm::dvec2 &u) const
  {
    const glm::dvec2 at = lamp_.outline == LampOutline::Rectangle ? 2.0 * u - 1.0 : on_disk(u);
    return glm::normalize(lamp_.center + at.x * lamp_.axis_x + at.y * lamp_.axis_y);
  }
  /** Density of sample, 1/sr; 0 if the direction misses the lamp. */
  [[nodiscard]] double density(const glm::dvec3 &to_light) const
  {
    const double along = glm::dot(normal_, to_light);
    const double distance = glm::dot(normal_, lamp_.center) / along;
    if (!(distance > 0.0 && std::isfinite(distance))) {
      return 0.0;
    }
    const glm::dvec3 offset = distance * to_light - lamp_.center;
    const glm::dvec2 at(glm::dot(offset, lamp_.axis_x) / glm::dot(lamp_.axis_x, lamp_.axis_x),
                        glm::dot(offset, lamp_.axis_y) / glm::dot(lamp_.axis_y, lamp_.axis_y));
    const double from_center = lamp_.outline == LampOutline::Rectangle ? std::max(std::abs(at.x), std::abs(at.y))
                                                                       : std::sqrt(glm::dot(at, at));
    // Samples on the rim are on the lamp, whatever the rounding.
    return from_center <= 1.0 + 1e-9 ? distance * distance / (area_ * std::abs(along)) : 0.0;
  }

 private:
  LampShape lamp_;
  glm::dvec3 normal_;
  double area_;
};

/** Lambertian reflection with an albedo of 1. */
struct DiffuseLobe {
  static double value(const glm::dvec3 &to_light)
  {
    return to_light.z / pi;
  }
  static glm::dvec3 sample(const glm::dvec2 &u)
  {
    return {on_disk(u), std::sqrt(1.0 - u.x)};
  }
  static double density(const glm::dvec3 &to_light)
  {
    return std::max(to_light.z, 0.0) / pi;
  }
};

/** Reflection by the microfacets of a lobe, times the cosine of the light. */
struct MicrofacetLobe {
  SpecularLobe lobe;

  [[nodiscard]] double value(const glm::dvec3 &to_light) const
  {
    const double cos_h = glm::normalize(to_light + lobe.view).z;
    return shared_double::ggx_lobe(to_light.z, lobe.view.z, std::min(cos_h, 1.0), lobe.alpha) * to_light.z;
  }
  /** Normals by their distribution times their cosine (Walter et al. 2007, eq. 35 and 36). */
  [[nodiscard]] glm::dvec3 sample(const glm::dvec2 &u) const
  {
    const double slope_sq = lobe.alpha * lobe.alpha * u.x / (1.0 - u.x);
    const double cos_h = 1.0 / std::sqrt(1.0 + slope_sq);
    const double sin_h = std::sqrt(slope_sq) * cos_h;
    const glm::dvec3 half_vector(sin_h * std::cos(2.0 * pi * u.y), sin_h * std::sin(2.0 * pi * u.y), cos_h);
    return 2.0 * glm::dot(lobe.view, half_vector) * half_vector - lobe.view;
  }
  [[nodiscard]] double density(const glm::dvec3 &to_light) const
  {
    const glm::dvec3 half_vector = glm::normalize(to_light + lobe.view);
    const double across = glm::dot(lobe.view, half_vector);
    return shared_double::ggx_distribution(std::min(half_vector.z, 1.0), lobe.alpha) * half_vector.z / (4.0 * across);
  }
};

template <typename Lobe>
Integral integrated(const LampShape &lamp, const Lobe &lobe, int point_count)
{
  const LampSampler sampler(lamp);
  const auto contribution = [&](const glm::dvec3 &to_light) {
    if (!(to_light.z > 0.0)) {
      return 0.0;
    }
    const double of_lamp = sampler.density(to_light);
    return of_lamp > 0.0 ? lobe.value(to_light) / (of_lamp + lobe.density(to_light)) : 0.0;
  };
  std::array<double, integral_set_count> means{};
  double sum = 0.0;
  for (int set = 0; set < integral_set_count; set++) {
    double &mean = means[std::size_t(set)];
    for (int i = 0; i < point_count; i++) {
      const auto index = std::uint32_t(i);
      const auto seed = std::uint32_t(2 * set);
      mean += contribution(sampler.sample(glm::dvec2(eevee::sobol_point(index, seed)))) +
              contribution(lobe.sample(glm::dvec2(eevee::sobol_point(index, seed + 1))));
    }
    mean /= point_count;
    sum += mean;
  }
  Integral integral{.value = sum / integral_set_count};
  double squares = 0.0;
  for (const double mean : means) {
    squares += (mean - integral.value) * (mean - integral.value);
  }
  integral.standard_error = std::sqrt(squares / (integral_set_count * (integral_set_count - 1)));
  return integral;
}

}  // namespace

double LampShape::area() const
{
  return (outline == LampOutline::Rectangle ? 4.0 : pi) * glm::length(glm::cross(axis_x, axis_y));
}

Integral integrated_diffuse(const LampShape &lamp, int point_count)
{
  return integrated(lamp, DiffuseLobe(), point_count);
}

Integral integrated_specular(const LampShape &lamp, const SpecularLobe &lobe, int point_count)
{
  return integrated(lamp, MicrofacetLobe{lobe}, point_count);
}

}  // namespace gnomon::measure
