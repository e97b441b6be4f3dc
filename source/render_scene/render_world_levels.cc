// SPDX-License-Identifier: MIT
#include "render_world.hh"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::render_scene {

namespace {

constexpr double pi = std::numbers::pi;

/** A grid of cells of the sphere with equal angles. Rows from the bottom. */
struct Cells {
  glm::ivec2 size{0};
  /** Integrals of the radiance over the solid angle of each cell. Each row is stored twice, one after the other. */
  std::vector<glm::vec3> fluxes;
  /** Solid angle of a cell of each row. */
  std::vector<double> solid_angles;
};

/** Divides \a picture into cells of \a step by \a step texels. */
Cells cells_of(std::span<const glm::vec3> picture, int step)
{
  Cells cells;
  cells.size = WorldLight::size / step;
  const auto columns = std::size_t(cells.size.x);
  cells.fluxes.resize(2 * columns * std::size_t(cells.size.y), glm::vec3(0.0F));
  for (int y = 0; y < cells.size.y; y++) {
    glm::vec3 *row = &cells.fluxes[2 * columns * std::size_t(y)];
    double solid_angle = 0.0;
    for (int b = y * step; b < (y + 1) * step; b++) {
      const double area = texel_solid_angle(b, WorldLight::size.x, WorldLight::size.y);
      solid_angle += step * area;
      for (int x = 0; x < WorldLight::size.x; x++) {
        row[x / step] += float(area) * picture[std::size_t(b) * std::size_t(WorldLight::size.x) + std::size_t(x)];
      }
    }
    cells.solid_angles.push_back(solid_angle);
    std::copy_n(row, columns, row + columns);
  }
  return cells;
}

/**
 * Adds \a weights.size() copies of \a row to \a sum: copy d is moved by d cells to the left and multiplied by the
 * weight d. \pre row.size() == 2 * sum.size()
 */
void add_moved(std::span<glm::vec3> sum, std::span<const glm::vec3> row, std::span<const float> weights)
{
  for (std::size_t d = 0; d < weights.size(); d++) {
    const float weight = weights[d];
    if (weight > 0.0F) {
      const glm::vec3 *moved = &row[d];
      for (std::size_t x = 0; x < sum.size(); x++) {
        sum[x] += weight * moved[x];
      }
    }
  }
}

/**
 * Filters \a cells with the GGX lobe of \a alpha around the direction of each cell. The weights of one row of cells for
 * another row depend on the difference of the columns only.
 */
std::vector<glm::vec3> lobes(const Cells &cells, double alpha)
{
  const double a2 = alpha * alpha;
  // Cut the lobe where it has fallen to 1/200 of its peak, that is, where sin² of the half vector's angle is about
  // 13 a².
  const double cosine_least = 1.0 - std::min(2.0 * 13.0 * a2, 1.0);
  const int reach_rows = int(std::ceil(std::acos(cosine_least) / pi * cells.size.y));
  const auto columns = std::size_t(cells.size.x);
  std::vector<double> column_cosines;
  for (int d = 0; d < cells.size.x; d++) {
    column_cosines.push_back(std::cos(2.0 * pi * d / cells.size.x));
  }
  std::vector<glm::vec3> result;
  std::vector<glm::vec3> sum(columns);
  std::vector<float> weights(columns);
  for (int y = 0; y < cells.size.y; y++) {
    const double elevation = ((y + 0.5) / cells.size.y - 0.5) * pi;
    std::ranges::fill(sum, glm::vec3(0.0F));
    double weight_sum = 0.0;
    for (int b = std::max(y - reach_rows, 0); b <= std::min(y + reach_rows, cells.size.y - 1); b++) {
      const double other = ((b + 0.5) / cells.size.y - 0.5) * pi;
      const double along = std::sin(elevation) * std::sin(other);
      const double across = std::cos(elevation) * std::cos(other);
      for (std::size_t d = 0; d < columns; d++) {
        const double cosine = along + across * column_cosines[d];
        // For a view along the normal, cos² of the half vector's angle is (1 + cosine) / 2.
        const double h_sq = 0.5 + 0.5 * cosine;
        const double t = (1.0 - h_sq) + a2 * h_sq;
        weights[d] = cosine > cosine_least ? float(cosine / (t * t)) : 0.0F;
        weight_sum += double(weights[d]) * cells.solid_angles[std::size_t(b)];
      }
      add_moved(sum, std::span(cells.fluxes).subspan(2 * columns * std::size_t(b), 2 * columns), weights);
    }
    for (const glm::vec3 &flux : sum) {
      result.push_back(weight_sum > 0.0 ? flux / float(weight_sum) : glm::vec3(0.0F));
    }
  }
  return result;
}

/** Enlarges \a coarse by the factor \a step to WorldLight::size, with bilinear interpolation. */
std::vector<glm::vec3> enlarged(const std::vector<glm::vec3> &coarse, int step)
{
  const glm::ivec2 size = WorldLight::size / step;
  std::vector<glm::vec3> result;
  result.reserve(std::size_t(WorldLight::size.x * WorldLight::size.y));
  std::vector<glm::vec3> row(std::size_t(size.x));
  for (int y = 0; y < WorldLight::size.y; y++) {
    const float v = (float(y) + 0.5F) / float(step) - 0.5F;
    const int low = std::clamp(int(std::floor(v)), 0, size.y - 2);
    const float t = std::clamp(v - float(low), 0.0F, 1.0F);
    for (std::size_t x = 0; x < row.size(); x++) {
      const std::size_t at = std::size_t(low * size.x) + x;
      row[x] = (1.0F - t) * coarse[at] + t * coarse[at + row.size()];
    }
    for (int x = 0; x < WorldLight::size.x; x++) {
      const float u = (float(x) + 0.5F) / float(step) - 0.5F;
      const int left = int(std::floor(u));
      const float s = u - float(left);
      result.push_back((1.0F - s) * row[std::size_t((left + size.x) % size.x)] +
                       s * row[std::size_t((left + 1) % size.x)]);
    }
  }
  return result;
}

}  // namespace

std::vector<std::vector<glm::vec3>> prefiltered(std::span<const glm::vec3> picture, int level_count)
{
  std::vector<std::vector<glm::vec3>> levels = {{picture.begin(), picture.end()}};
  for (int level = 1; level < level_count; level++) {
    const double roughness = double(level) / double(level_count - 1);
    // Choose cells that are several times smaller than the lobe.
    const int step = roughness < 0.2 ? 1 : roughness < 0.4 ? 2 : roughness < 0.6 ? 4 : 8;
    levels.push_back(enlarged(lobes(cells_of(picture, step), roughness * roughness), step));
  }
  return levels;
}

}  // namespace gnomon::render_scene
