// SPDX-License-Identifier: MIT
#include "eevee_pixel_filter.hh"

#include <cmath>
#include <numbers>

namespace gnomon::eevee {

double filter_weight(double distance_px)
{
  if (std::abs(distance_px) >= 0.5 * filter_support_px) {
    return 0.0;
  }
  const double a = 2.0 * std::numbers::pi * distance_px / filter_support_px;
  return 0.35875 + 0.48829 * std::cos(a) + 0.14128 * std::cos(2.0 * a) + 0.01168 * std::cos(3.0 * a);
}

/** The van der Corput sequence in base 2: the binary digits of \a index, reversed behind the point. In [0, 1). */
static double radical_inverse(std::uint32_t index)
{
  double inverse = 0.0;
  for (double digit = 0.5; index != 0; index >>= 1, digit *= 0.5) {
    inverse += (index & 1) != 0 ? digit : 0.0;
  }
  return inverse;
}

glm::vec2 film_offset_px(int index, int count, std::uint32_t seed)
{
  if (count == 1) {
    return {0.0F, 0.0F};
  }
  // A seed moves the lattice around the unit square.
  const double shift_x = double(seed * 2654435761U) / 4294967296.0;
  const double shift_y = double(seed * 2246822519U) / 4294967296.0;
  const auto fraction = [](double value) { return value - std::floor(value); };
  if (count == 0) {
    // An extensible lattice in base 2. Its generating vector is that of Cools, Kuo and Nuyens, "Constructing embedded
    // lattice rules for multivariate integration", 2006.
    constexpr double generator = 182667.0;
    const double inverse = radical_inverse(std::uint32_t(index));
    return {float(fraction(inverse + 0.5 + shift_x) - 0.5), float(fraction(inverse * generator + 0.5 + shift_y) - 0.5)};
  }
  // A lattice of rank 1 by the golden ratio.
  constexpr double golden = 0.6180339887498949;
  return {float(fraction((index + 0.5) / count + shift_x) - 0.5), float(fraction(index * golden + shift_y) - 0.5)};
}

namespace {

/** Filter weights, along one axis, of the samples in the previous pixel, the pixel itself and the next pixel. */
glm::dvec3 axis_weights(double offset_px)
{
  return {filter_weight(offset_px - 1.0), filter_weight(offset_px), filter_weight(offset_px + 1.0)};
}

double sum(const glm::dvec3 &weights)
{
  return weights.x + weights.y + weights.z;
}

}  // namespace

double film_weight_sum(int count, std::uint32_t seed)
{
  if (count == 0) {
    return film_share(0, 1, seed, 1.0);
  }
  double total = 0.0;
  for (int i = 0; i < count; i++) {
    total += film_share(i, count, seed, 1.0);
  }
  return total;
}

double film_share(int index, int count, std::uint32_t seed, double weight_sum)
{
  const glm::vec2 offset_px = film_offset_px(index, count, seed);
  return sum(axis_weights(offset_px.x)) * sum(axis_weights(offset_px.y)) / weight_sum;
}

FilmWeights film_weights(int index, int count, std::uint32_t seed, double weight_sum)
{
  const glm::vec2 offset_px = film_offset_px(index, count, seed);
  return {glm::vec3(axis_weights(offset_px.x) / weight_sum), glm::vec3(axis_weights(offset_px.y))};
}

}  // namespace gnomon::eevee
