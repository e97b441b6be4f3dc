// SPDX-License-Identifier: MIT
#pragma once

#include "shared_functions.hh"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <random>

/** Helpers for the lists of sweeps, and these lists, one for each area of the shared functions. */
namespace gnomon::verify {

using glm::dvec2;
using glm::dvec3;
using glm::dvec4;
using In = Arguments<float>;
using Exact = Arguments<double>;

/** The same numbers in every run. */
class Random {
 public:
  float uniform(double low, double high)
  {
    return float(low + (high - low) * unit());
  }
  /** Each power of ten as often as the next. \pre low above 0. */
  float log_uniform(double low, double high)
  {
    return float(low * std::pow(high / low, unit()));
  }
  glm::vec3 box(double half)
  {
    return {uniform(-half, half), uniform(-half, half), uniform(-half, half)};
  }
  glm::vec3 direction()
  {
    for (;;) {
      const glm::vec3 v = box(1.0);
      const float length = glm::length(v);
      if (length > 0.01F && length <= 1.0F) {
        return v / length;
      }
    }
  }
  template <typename T, std::size_t N>
  T one_of(const std::array<T, N> &values)
  {
    return values[engine_() % N];
  }

 private:
  double unit()
  {
    return double(engine_()) / double(std::mt19937::max());
  }
  std::mt19937 engine_{17};
};

inline dvec4 one(double value)
{
  return {value, 0, 0, 0};
}

/** \a count times what \a make makes. */
template <typename Make>
std::vector<In> many(int count, Make &&make)
{
  std::vector<In> arguments;
  arguments.reserve(std::size_t(count));
  Random random;
  for (int i = 0; i < count; i++) {
    arguments.push_back(make(random));
  }
  return arguments;
}

/** Directions of all lengths, and those along axes, diagonals and edges of a cube. */
[[nodiscard]] std::vector<In> direction_arguments();

// Tolerances. Double: 1e-6, its own roundings; 0.5 where literals of the function are rounded to floats. Float: half
// an epsilon for each rounding on the longest path, less what was seen not to add up. Driver: more where it divides
// (Vulkan allows 2.5 epsilons, and GLSL's sqrt is a division), and for exp, log and pow (3 + 2·|x|). Mesa's
// rasteriser rounds all correctly but these, and there they are as near as C++'s.

void add_depth_sweeps(std::vector<Sweep> &sweeps);
void add_esm_sweeps(std::vector<Sweep> &sweeps);
void add_light_sweeps(std::vector<Sweep> &sweeps);
void add_shadow_sweeps(std::vector<Sweep> &sweeps);
void add_view_transform_sweeps(std::vector<Sweep> &sweeps);

}  // namespace gnomon::verify
