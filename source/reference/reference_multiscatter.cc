// SPDX-License-Identifier: MIT
#include "reference_multiscatter.hh"

#include "scene_parallel.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

// This header defines `float` as double, so it must come last.
#define SHARED_DOUBLE
#include "eevee_multiscatter_shared.h"

namespace gnomon::reference {

namespace {

/** The cosine at \a y of multiscatter_place. */
double cosine_at(double alpha, double y)
{
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 50; i++) {
    const double middle = 0.5 * (low + high);
    (shared_double::multiscatter_place(alpha, middle).y < y ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double alpha_at(double x)
{
  const double least = std::sqrt(double(shared_double::ALPHA_MIN));
  const double root = least + (1.0 - least) * x;
  return root * root;
}

/** Means over all directions, weighted by their cosines, of the albedos that are interpolated between \a column. */
LobeIntegrals mean_of(double alpha, const std::vector<glm::dvec4> &column)
{
  constexpr int parts = 16;
  const auto last = double(column.size() - 1);
  LobeIntegrals sum;
  double low_sq = 0.0;
  for (std::size_t i = 0; i + 1 < column.size(); i++) {
    for (int j = 0; j < parts; j++) {
      const double middle = (j + 0.5) / parts;
      const double high = cosine_at(alpha, (double(i) + double(j + 1) / parts) / last);
      const double cosine = cosine_at(alpha, (double(i) + middle) / last);
      const shared_double::LobeAlbedo albedo =
          shared_double::lobe_albedo(glm::mix(column[i], column[i + 1], middle), alpha, cosine);
      const double weight = high * high - low_sq;
      low_sq = high * high;
      sum.missing += weight * albedo.missing;
      sum.schlick += weight * albedo.schlick * (1.0 - albedo.missing);
    }
  }
  return sum;
}

}  // namespace

LobeIntegrals integrated_lobe(double alpha, double cosine)
{
  // The lobe divided by the density of the reflected light is Smith's masking of the light. Reflected light below the
  // horizon is missing.
  constexpr int rings = 96;
  constexpr int steps = 64;
  const double a2 = alpha * alpha;
  const glm::dvec3 view(std::sqrt((1.0 - cosine) * (1.0 + cosine)), 0.0, cosine);
  const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha * view.x, 0.0, view.z));
  const glm::dvec3 up(-stretched.z, 0.0, stretched.x);
  const double share = 0.5 * (1.0 + stretched.z);
  LobeIntegrals sum;
  for (int i = 0; i < rings; i++) {
    // Narrow rings at the rim of the disk, where the distribution has its long tail.
    const double t = (i + 0.5) / rings;
    const double weight = 4.0 * t * t * t / (rings * steps);
    const double radius = std::sqrt(1.0 - t * t * t * t);
    for (int j = 0; j < steps; j++) {
      // The other half of the disk is its mirror image.
      const double angle = std::numbers::pi * ((j + 0.5) / steps - 0.5);
      const double x = radius * std::cos(angle);
      const double y = (1.0 - share) * std::sqrt(1.0 - x * x) + share * radius * std::sin(angle);
      const double z = std::sqrt(std::max(1.0 - x * x - y * y, 0.0));
      const glm::dvec3 n = x * glm::dvec3(0.0, 1.0, 0.0) + y * up + z * stretched;
      const glm::dvec3 half_vector = glm::normalize(glm::dvec3(alpha * n.x, alpha * n.y, std::max(n.z, 0.0)));
      const double across = glm::dot(view, half_vector);
      const double cos_l = 2.0 * across * half_vector.z - view.z;
      if (!(cos_l > 0.0)) {
        sum.missing += weight;
        continue;
      }
      const double root = std::sqrt(a2 + (1.0 - a2) * cos_l * cos_l);
      const double m = std::clamp(1.0 - across, 0.0, 1.0);
      // 1 - 2 cos / (cos + root), which would cancel.
      sum.missing += weight * a2 * (1.0 - cos_l) * (1.0 + cos_l) / ((root + cos_l) * (root + cos_l));
      sum.schlick += weight * 2.0 * cos_l / (root + cos_l) * m * m * m * m * m;
    }
  }
  return sum;
}

MultiscatterTable::MultiscatterTable(int size) : size_(size), texels_(std::size_t(size) * std::size_t(size))
{
  const auto last = double(size - 1);
  scene::parallel_for(std::size_t(size), 0, [&](std::size_t x) {
    const double alpha = alpha_at(double(x) / last);
    std::vector<glm::dvec4> column;
    for (int y = 0; y < size; y++) {
      const double cosine = cosine_at(alpha, double(y) / last);
      const LobeIntegrals lobe = integrated_lobe(alpha, cosine);
      const double schlick = lobe.schlick / (1.0 - lobe.missing);
      column.emplace_back(lobe.missing / shared_double::missing_scale(alpha, cosine),
                          1.0 - cosine - std::pow(schlick, 0.2), 0.0, 0.0);
    }
    const LobeIntegrals mean = mean_of(alpha, column);
    for (int y = 0; y < size; y++) {
      glm::dvec4 &texel = texels_[std::size_t(y) * std::size_t(size) + x];
      texel = column[std::size_t(y)];
      texel.z = mean.missing / (alpha * alpha);
      texel.w = mean.schlick / (1.0 - mean.missing);
    }
  });
}

glm::dvec4 MultiscatterTable::at(double alpha, double cosine) const
{
  const glm::dvec2 place = glm::clamp(shared_double::multiscatter_place(alpha, cosine), 0.0, 1.0) * double(size_ - 1);
  const glm::ivec2 low = glm::min(glm::ivec2(place), size_ - 2);
  const glm::dvec2 part = place - glm::dvec2(low);
  const glm::dvec4 *first = &texels_[std::size_t(low.y) * std::size_t(size_) + std::size_t(low.x)];
  return glm::mix(glm::mix(first[0], first[1], part.x), glm::mix(first[size_], first[size_ + 1], part.x), part.y);
}

const MultiscatterTable &multiscatter_table()
{
  // With 48 rows, the error is half that of the engine's table of 32.
  static const MultiscatterTable table(48);
  return table;
}

}  // namespace gnomon::reference
