// SPDX-License-Identifier: MIT
// Fits linearly transformed cosines to the engine's GGX lobe (Heitz, Dupuy, Hill and Neubelt 2016), integrates its
// albedo and that of sheen, and writes all three as the table that eevee_tables.hh declares. After a change of the
// lobe, run it and commit the result:
//   gnomon_eevee_ltc_tool source/engines/eevee/tables/ltc.bin
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#define SHARED_DOUBLE
#include "eevee_shape_shared.h"
#undef float
#include "eevee_write_table.hh"

namespace {

using namespace gnomon::shared_double;
using std::numbers::pi;

constexpr int size = LTC_TABLE_SIZE;

/** The GGX lobe for one view direction. */
struct Lobe {
  vec3 view;
  double alpha;

  [[nodiscard]] double value(const vec3 &light) const
  {
    if (light.z <= 0.0) {
      return 0.0;
    }
    const vec3 half_vector = normalize(light + view);
    return ggx_lobe(light.z, view.z, half_vector.z, alpha) * light.z;
  }

  /** Density of sample(). */
  [[nodiscard]] double density(const vec3 &light) const
  {
    const vec3 half_vector = normalize(light + view);
    const double masking = 2.0 * view.z * ggx_masking_over_2cos(view.z, alpha);
    return ggx_distribution(half_vector.z, alpha) * masking / (4.0 * view.z);
  }

  /** Light reflected by a visible microfacet (Heitz 2018, "Sampling the GGX Distribution of Visible Normals"). */
  [[nodiscard]] vec3 sample(const vec2 &u) const
  {
    const vec3 stretched = normalize(vec3(alpha * view.x, alpha * view.y, view.z));
    const double across = std::hypot(stretched.x, stretched.y);
    const vec3 right = across > 1e-12 ? vec3(-stretched.y, stretched.x, 0.0) / across : vec3(1, 0, 0);
    const vec3 up = cross(stretched, right);
    const double radius = std::sqrt(u.x);
    const double x = radius * std::cos(2.0 * pi * u.y);
    double y = radius * std::sin(2.0 * pi * u.y);
    const double share = 0.5 * (1.0 + stretched.z);
    y = (1.0 - share) * std::sqrt(1.0 - x * x) + share * y;
    const vec3 n = x * right + y * up + std::sqrt(std::max(1.0 - x * x - y * y, 0.0)) * stretched;
    const vec3 h = normalize(vec3(alpha * n.x, alpha * n.y, std::max(n.z, 0.0)));
    return 2.0 * dot(view, h) * h - view;
  }
};

/** A cosine lobe under a linear transform. */
struct Ltc {
  glm::dmat3 frame{1.0};
  double m11 = 1.0;
  double m22 = 1.0;
  double m13 = 0.0;
  glm::dmat3 lobe_from_cosine{1.0};
  glm::dmat3 cosine_from_lobe{1.0};
  double determinant = 1.0;

  void update()
  {
    lobe_from_cosine = frame * glm::dmat3(m11, 0, 0, 0, m22, 0, m13, 0, 1);
    cosine_from_lobe = glm::inverse(lobe_from_cosine);
    determinant = std::abs(glm::determinant(lobe_from_cosine));
  }
  [[nodiscard]] double density(const vec3 &light) const
  {
    const vec3 original = normalize(cosine_from_lobe * light);
    const double stretch = glm::length(lobe_from_cosine * original);
    return std::max(original.z, 0.0) / pi * stretch * stretch * stretch / determinant;
  }
  [[nodiscard]] vec3 sample(const vec2 &u) const
  {
    const double radius = std::sqrt(u.x);
    const vec3 cosine(radius * std::cos(2.0 * pi * u.y), radius * std::sin(2.0 * pi * u.y), std::sqrt(1.0 - u.x));
    return normalize(lobe_from_cosine * cosine);
  }
};

template <typename Visit>
void for_grid(int count, Visit &&visit)
{
  for (int i = 0; i < count; i++) {
    for (int j = 0; j < count; j++) {
      visit(vec2((i + 0.5) / count, (j + 0.5) / count));
    }
  }
}

struct Albedo {
  double whole = 0.0;
  double schlick = 0.0;
  vec3 mean_direction{0.0};
};

Albedo albedo_of(const Lobe &lobe, int count)
{
  Albedo sum;
  for_grid(count, [&](const vec2 &u) {
    const vec3 light = lobe.sample(u);
    if (light.z > 0.0) {
      const double weight = lobe.value(light) / lobe.density(light) / (count * count);
      const double m = 1.0 - std::clamp(dot(lobe.view, normalize(light + lobe.view)), 0.0, 1.0);
      sum.whole += weight;
      sum.schlick += weight * m * m * m * m * m;
      sum.mean_direction += weight * light;
    }
  });
  return sum;
}

/** Directional albedo of a sheen lobe without its colour. */
double sheen_albedo(const vec3 &view, double alpha)
{
  constexpr int count = 256;
  double sum = 0.0;
  for_grid(count, [&](const vec2 &u) {
    // Most points are near the horizon, where the lobe is high.
    const double angle = 0.5 * pi * (1.0 - u.x * u.x);
    const vec3 light(std::sin(angle) * std::cos(pi * u.y), std::sin(angle) * std::sin(pi * u.y), std::cos(angle));
    const double cos_h = normalize(light + view).z;
    const double solid_angle = 2.0 * pi * std::sin(angle) * pi * u.x / (count * count);
    sum += sheen_lobe(light.z, view.z, cos_h, alpha) * light.z * solid_angle;
  });
  return sum;
}

/** Mean cubed difference of \a albedo times \a ltc and \a lobe. The samples are drawn from both distributions. */
double error_of(const Ltc &ltc, const Lobe &lobe, double albedo)
{
  constexpr int count = 20;
  double sum = 0.0;
  const auto add = [&](const vec3 &light) {
    const double density_lobe = light.z > 0.0 ? lobe.density(light) : 0.0;
    const double density_ltc = ltc.density(light);
    const double difference = std::abs(lobe.value(light) - albedo * density_ltc);
    sum += difference * difference * difference / (density_lobe + density_ltc + 1e-30);
  };
  for_grid(count, [&](const vec2 &u) {
    add(ltc.sample(u));
    add(lobe.sample(u));
  });
  return sum / (count * count);
}

/** The position of a minimum of \a f, a function of three numbers (Nelder and Mead 1965). */
template <typename F>
std::array<double, 3> minimized(std::array<double, 3> start, double step, F &&f)
{
  struct Corner {
    std::array<double, 3> at;
    double value;
  };
  std::array<Corner, 4> simplex;
  for (std::size_t i = 0; i < 4; i++) {
    simplex[i].at = start;
    if (i > 0) {
      simplex[i].at[i - 1] += step;
    }
    simplex[i].value = f(simplex[i].at);
  }
  for (int iteration = 0; iteration < 80; iteration++) {
    std::ranges::sort(simplex, {}, &Corner::value);
    Corner &worst = simplex[3];
    if (worst.value - simplex[0].value <= 1e-4 * std::abs(simplex[0].value)) {
      break;
    }
    std::array<double, 3> middle{};
    for (std::size_t i = 0; i < 3; i++) {
      for (std::size_t k = 0; k < 3; k++) {
        middle[k] += simplex[i].at[k] / 3.0;
      }
    }
    const auto along = [&](double t) {
      Corner corner{};
      for (std::size_t k = 0; k < 3; k++) {
        corner.at[k] = middle[k] + t * (worst.at[k] - middle[k]);
      }
      corner.value = f(corner.at);
      return corner;
    };
    const Corner reflected = along(-1.0);
    if (reflected.value < simplex[0].value) {
      const Corner expanded = along(-2.0);
      worst = expanded.value < reflected.value ? expanded : reflected;
    }
    else if (reflected.value < simplex[2].value) {
      worst = reflected;
    }
    else {
      const Corner contracted = along(reflected.value < worst.value ? -0.5 : 0.5);
      if (contracted.value < std::min(worst.value, reflected.value)) {
        worst = contracted;
      }
      else {
        for (std::size_t i = 1; i < 4; i++) {
          for (std::size_t k = 0; k < 3; k++) {
            simplex[i].at[k] = 0.5 * (simplex[i].at[k] + simplex[0].at[k]);
          }
          simplex[i].value = f(simplex[i].at);
        }
      }
    }
  }
  std::ranges::sort(simplex, {}, &Corner::value);
  return simplex[0].at;
}

/** Set the hemispherical mean of the albedo, for multiple scattering. It is the same in each row. */
void set_mean_albedos(std::vector<glm::dvec4> &table)
{
  for (int column = 0; column < size; column++) {
    double sum = 0.0;
    constexpr int steps = 32;
    const double roughness = double(column) / (size - 1);
    for (int i = 0; i < steps; i++) {
      const double cosine_sq = (i + 0.5) / steps;
      const double cosine = std::sqrt(cosine_sq);
      const Lobe lobe{.view = vec3(std::sqrt(1.0 - cosine_sq), 0.0, cosine),
                      .alpha = std::max(roughness * roughness, double(ALPHA_MIN))};
      sum += albedo_of(lobe, 64).whole / steps;
    }
    for (int row = 0; row < size; row++) {
      table[std::size_t(row) * 2 * size + std::size_t(column) + size].z = sum;
    }
  }
}

}  // namespace

int main(int argument_count, char **arguments)
{
  if (argument_count != 2) {
    std::fprintf(stderr, "usage: gnomon_eevee_ltc_tool OUTPUT.bin\n");
    return 2;
  }
  std::vector<glm::dvec4> table(2 * size * size);
  Ltc of_row;
  for (int column = size - 1; column >= 0; column--) {
    const double roughness = double(column) / (size - 1);
    Lobe lobe{.view = vec3(0, 0, 1), .alpha = std::max(roughness * roughness, double(ALPHA_MIN))};
    Ltc ltc = of_row;
    for (int row = 0; row < size; row++) {
      const double share = double(row) / (size - 1);
      const double cosine = std::max(1.0 - share * share, 1e-3);
      lobe.view = vec3(std::sqrt((1.0 - cosine) * (1.0 + cosine)), 0.0, cosine);
      const Albedo albedo = albedo_of(lobe, 128);
      const bool is_round = row == 0;
      if (!is_round) {
        const vec3 z = normalize(vec3(albedo.mean_direction.x, 0.0, albedo.mean_direction.z));
        ltc.frame = glm::dmat3(vec3(z.z, 0, -z.x), vec3(0, 1, 0), z);
      }
      const auto set = [&](const std::array<double, 3> &x) {
        ltc.m11 = std::max(x[0], 1e-7);
        ltc.m22 = is_round ? ltc.m11 : std::max(x[1], 1e-7);
        ltc.m13 = is_round ? 0.0 : x[2];
        ltc.update();
      };
      for (const double step : {0.05}) {
        const double relative = step * std::max(ltc.m11, 1e-3);
        set(minimized({ltc.m11, ltc.m22, ltc.m13}, relative, [&](const std::array<double, 3> &x) {
          set(x);
          return error_of(ltc, lobe, albedo.whole);
        }));
      }
      if (is_round) {
        of_row = ltc;
      }
      const glm::dmat3 inverse = ltc.cosine_from_lobe / ltc.cosine_from_lobe[1][1];
      const std::size_t texel = std::size_t(row) * 2 * size + std::size_t(column);
      table[texel] = {inverse[0][0], inverse[2][0], inverse[0][2], inverse[2][2]};
      table[texel + size] = {albedo.whole, albedo.schlick, 0.0,
                             sheen_albedo(lobe.view, std::max(roughness * roughness, double(SHEEN_ALPHA_MIN)))};
    }
  }
  set_mean_albedos(table);
  return write_table(arguments[1], table);
}
