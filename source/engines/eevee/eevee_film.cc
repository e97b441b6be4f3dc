// SPDX-License-Identifier: MIT
#include "eevee_film.hh"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::eevee {

double filter_cdf(double x_px)
{
  // Blackman-Harris (Harris 1978): a0 - a1 cos + a2 cos 2 - a3 cos 3, integrated term by term.
  constexpr double A0 = 0.35875;
  constexpr double A1 = 0.48829;
  constexpr double A2 = 0.14128;
  constexpr double A3 = 0.01168;
  const double t = std::clamp(x_px / FILTER_SUPPORT_PX + 0.5, 0.0, 1.0);
  const double a = 2.0 * std::numbers::pi * t;
  const double wave = -A1 * std::sin(a) + A2 * std::sin(2.0 * a) / 2.0 - A3 * std::sin(3.0 * a) / 3.0;
  return t + wave / (2.0 * std::numbers::pi * A0);
}

double filter_inverse_cdf(double share)
{
  double low = -0.5 * FILTER_SUPPORT_PX;
  double high = -low;
  // The function rises everywhere; 50 halvings reach the last bit of a float.
  for (int i = 0; i < 50; i++) {
    const double middle = 0.5 * (low + high);
    (filter_cdf(middle) < share ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

glm::vec2 film_offset_px(int index, int count, std::uint32_t seed)
{
  if (count <= 1) {
    return {0.0F, 0.0F};
  }
  // A lattice of rank 1 by the golden ratio; a seed moves it around the unit square.
  constexpr double GOLDEN = 0.6180339887498949;
  const double shift_x = double(seed * 2654435761U) / 4294967296.0;
  const double shift_y = double(seed * 2246822519U) / 4294967296.0;
  const auto fraction = [](double value) { return value - std::floor(value); };
  const double u = fraction((index + 0.5) / count + shift_x);
  const double v = fraction(0.5 + index * GOLDEN + shift_y);
  return {float(filter_inverse_cdf(u)), float(filter_inverse_cdf(v))};
}

}  // namespace gnomon::eevee
