// SPDX-License-Identifier: MIT
#include "measure_flip.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace gnomon::measure {

namespace {

/** The paper's display: 3840 pixels over 0.7 m at a distance of 0.7 m. */
constexpr double pixels_per_degree = 3840.0 * std::numbers::pi / 180.0;

/** One value for each pixel, in the picture's order. */
using Plane = std::vector<float>;

/** X, Y and Z of the chromaticity (x, y) for Y = 1. */
glm::dvec3 xyz(double x, double y)
{
  return {x / y, 1.0, (1.0 - x - y) / y};
}

/** Matrix from linear R, G and B to X, Y and Z, each divided by that of white, so that (1, 1, 1) maps to itself. */
glm::mat3 make_relative_xyz_from_rgb()
{
  // Rec. 709's primaries. D65 has the five digits that FLIP's authors use.
  const glm::dmat3 primaries(xyz(0.64, 0.33), xyz(0.3, 0.6), xyz(0.15, 0.06));
  const glm::dvec3 white = xyz(0.31271, 0.32902);
  const glm::dvec3 amounts = glm::inverse(primaries) * white;
  glm::dmat3 matrix;
  for (int c = 0; c < 3; c++) {
    matrix[c] = amounts[c] * primaries[c] / white;
  }
  return glm::mat3(matrix);
}

const glm::mat3 relative_xyz_from_rgb = make_relative_xyz_from_rgb();
const glm::mat3 rgb_from_relative_xyz = glm::inverse(relative_xyz_from_rgb);

/** CIELAB with the Hunt effect: a and b are scaled down in the dark. */
glm::vec3 hunt_lab(glm::vec3 rgb)
{
  const glm::vec3 relative = relative_xyz_from_rgb * rgb;
  constexpr float knee = 6.0F / 29.0F;
  glm::vec3 f;
  for (int c = 0; c < 3; c++) {
    f[c] =
        relative[c] > knee * knee * knee ? std::cbrt(relative[c]) : relative[c] / (3.0F * knee * knee) + 4.0F / 29.0F;
  }
  const float lightness = 116.0F * f.y - 16.0F;
  return {lightness, 0.01F * lightness * 500.0F * (f.x - f.y), 0.01F * lightness * 200.0F * (f.y - f.z)};
}

/** HyAB distance to the power of 0.7. */
float colour_distance(glm::vec3 a, glm::vec3 b)
{
  const glm::vec3 off = a - b;
  return std::pow(std::abs(off.x) + glm::length(glm::vec2(off.y, off.z)), 0.7F);
}

/** Error between two colours of hunt_lab, in [0, 1]. */
float colour_error(glm::vec3 a, glm::vec3 b)
{
  // Green and blue have the largest distance of all colours.
  static const float largest = colour_distance(hunt_lab({0.0F, 1.0F, 0.0F}), hunt_lab({0.0F, 0.0F, 1.0F}));
  // Smaller differences take most of the range.
  const float turn = 0.4F * largest;
  const float distance = colour_distance(a, b);
  return distance < turn ? 0.95F * distance / turn : 0.95F + 0.05F * (distance - turn) / (largest - turn);
}

/** Weights at offsets from -radius to radius. */
using Kernel = std::vector<float>;

template <typename Function>
Kernel make_kernel(int radius, const Function &function)
{
  Kernel kernel;
  for (int d = -radius; d <= radius; d++) {
    kernel.push_back(float(function(double(d))));
  }
  return kernel;
}

/** Scales the positive values to a sum of 1 and the negative ones to a sum of -1. */
void normalise(Kernel &kernel)
{
  float above = 0.0F;
  float below = 0.0F;
  for (const float value : kernel) {
    (value > 0.0F ? above : below) += std::abs(value);
  }
  for (float &value : kernel) {
    if (value != 0.0F) {
      value /= value > 0.0F ? above : below;
    }
  }
}

/** sums[i] += factor * values[i] */
void add(std::span<float> sums, float factor, std::span<const float> values)
{
  for (std::size_t i = 0; i < sums.size(); i++) {
    sums[i] += factor * values[i];
  }
}

/**
 * Repeats the pixels at the edge beyond it. Does not mirror the kernel; all kernels here are symmetric or
 * antisymmetric, and only magnitudes are used.
 */
Plane convolve_x(glm::ivec2 size_px, const Plane &plane, const Kernel &kernel)
{
  const auto width = std::size_t(size_px.x);
  const std::size_t radius = kernel.size() / 2;
  Plane result(plane.size(), 0.0F);
  std::vector<float> row(width + 2 * radius);
  for (std::size_t start = 0; start < plane.size(); start += width) {
    const std::span<const float> values = std::span(plane).subspan(start, width);
    std::fill_n(row.begin(), radius, values.front());
    std::ranges::copy(values, row.begin() + std::ptrdiff_t(radius));
    std::fill_n(row.end() - std::ptrdiff_t(radius), radius, values.back());
    for (std::size_t k = 0; k < kernel.size(); k++) {
      add(std::span(result).subspan(start, width), kernel[k], std::span(row).subspan(k, width));
    }
  }
  return result;
}

/** \see convolve_x */
Plane convolve_y(glm::ivec2 size_px, const Plane &plane, const Kernel &kernel)
{
  const auto width = std::size_t(size_px.x);
  const int radius = int(kernel.size() / 2);
  Plane result(plane.size(), 0.0F);
  for (int y = 0; y < size_px.y; y++) {
    const std::span<float> sums = std::span(result).subspan(std::size_t(y) * width, width);
    int from = y - radius;
    for (const float factor : kernel) {
      const auto inside = std::size_t(std::clamp(from++, 0, size_px.y - 1));
      add(sums, factor, std::span(plane).subspan(inside * width, width));
    }
  }
  return result;
}

/** amplitude · sqrt(π / spread) · exp(-π² d² / spread), d in degrees. */
struct Sensitivity {
  double amplitude = 0.0;
  double spread = 0.0;
};

/** Removes detail that is too fine to be visible. */
Plane filter(glm::ivec2 size_px, const Plane &plane, std::span<const Sensitivity> sensitivities)
{
  constexpr double pi = std::numbers::pi;
  // Three standard deviations of the widest kernel, for all kernels.
  static const int radius = int(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * pi * pi)) * pixels_per_degree));
  Plane result(plane.size(), 0.0F);
  double total = 0.0;
  for (const Sensitivity &part : sensitivities) {
    Kernel kernel = make_kernel(radius, [&part](double d_px) {
      const double d = d_px / pixels_per_degree;
      return std::exp(-pi * pi * d * d / part.spread);
    });
    const double sum = std::accumulate(kernel.begin(), kernel.end(), 0.0);
    normalise(kernel);
    const double weight = part.amplitude * std::sqrt(pi / part.spread) * sum * sum;
    total += weight;
    add(result, float(weight), convolve_y(size_px, convolve_x(size_px, plane, kernel), kernel));
  }
  for (float &value : result) {
    value /= float(total);
  }
  return result;
}

/** For each pixel the strength of an edge and of a point or line, each from 0 to √2. */
std::vector<glm::vec2> features(glm::ivec2 size_px, const Plane &luminance)
{
  constexpr double sigma_px = 0.5 * 0.082 * pixels_per_degree;
  static const int radius = int(std::ceil(3.0 * sigma_px));
  const auto gaussian = [](double d_px) { return std::exp(-0.5 * d_px * d_px / (sigma_px * sigma_px)); };
  Kernel smooth = make_kernel(radius, gaussian);
  Kernel slope = make_kernel(radius, [&gaussian](double d_px) { return d_px * gaussian(d_px); });
  Kernel bend = make_kernel(
      radius, [&gaussian](double d_px) { return (d_px * d_px / (sigma_px * sigma_px) - 1.0) * gaussian(d_px); });
  for (Kernel *kernel : {&smooth, &slope, &bend}) {
    normalise(*kernel);
  }
  const Plane smooth_x = convolve_x(size_px, luminance, smooth);
  const Plane edge_x = convolve_y(size_px, convolve_x(size_px, luminance, slope), smooth);
  const Plane edge_y = convolve_y(size_px, smooth_x, slope);
  const Plane point_x = convolve_y(size_px, convolve_x(size_px, luminance, bend), smooth);
  const Plane point_y = convolve_y(size_px, smooth_x, bend);
  std::vector<glm::vec2> strengths(luminance.size());
  for (std::size_t i = 0; i < strengths.size(); i++) {
    strengths[i] = {glm::length(glm::vec2(edge_x[i], edge_y[i])), glm::length(glm::vec2(point_x[i], point_y[i]))};
  }
  return strengths;
}

/** The visible colours and features of a picture. */
struct Perceived {
  /** \see hunt_lab */
  std::vector<glm::vec3> colours;
  /** \see features */
  std::vector<glm::vec2> features;
};

Perceived see(glm::ivec2 size_px, std::span<const glm::vec4> picture)
{
  // Y, Cx and Cz of the paper without their factors and offset, which linear filters with a sum of 1 preserve.
  Plane luminance;
  Plane red_green;
  Plane blue_yellow;
  for (const glm::vec4 &pixel : picture) {
    const glm::vec3 relative = relative_xyz_from_rgb * glm::clamp(glm::vec3(pixel), 0.0F, 1.0F);
    luminance.push_back(relative.y);
    red_green.push_back(relative.x - relative.y);
    blue_yellow.push_back(relative.y - relative.z);
  }
  Perceived seen;
  seen.features = features(size_px, luminance);
  luminance = filter(size_px, luminance, std::array{Sensitivity{1.0, 0.0047}});
  red_green = filter(size_px, red_green, std::array{Sensitivity{1.0, 0.0053}});
  blue_yellow = filter(size_px, blue_yellow, std::array{Sensitivity{34.1, 0.04}, Sensitivity{13.5, 0.025}});
  for (std::size_t i = 0; i < picture.size(); i++) {
    const float y = luminance[i];
    const glm::vec3 rgb = rgb_from_relative_xyz * glm::vec3(y + red_green[i], y, y - blue_yellow[i]);
    seen.colours.push_back(hunt_lab(glm::clamp(rgb, 0.0F, 1.0F)));
  }
  return seen;
}

}  // namespace

double mean_flip(glm::ivec2 size_px, std::span<const glm::vec4> picture, std::span<const glm::vec4> reference)
{
  const Perceived a = see(size_px, picture);
  const Perceived b = see(size_px, reference);
  double sum = 0.0;
  for (std::size_t i = 0; i < picture.size(); i++) {
    const glm::vec2 off = glm::abs(a.features[i] - b.features[i]);
    const float feature_error = std::sqrt(std::max(off.x, off.y) / std::numbers::sqrt2_v<float>);
    // Rounding may leave the range by some millionths.
    sum += double(std::min(std::pow(colour_error(a.colours[i], b.colours[i]), 1.0F - feature_error), 1.0F));
  }
  return sum / double(picture.size());
}

}  // namespace gnomon::measure
