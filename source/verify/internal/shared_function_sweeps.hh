// SPDX-License-Identifier: MIT
#pragma once

#include "shared_functions.hh"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <random>

/** Helpers for the sweeps, and one list of sweeps for each area of the shared functions. */
namespace gnomon::verify {

using glm::dvec2;
using glm::dvec3;
using glm::dvec4;
using In = Arguments<float>;
using Exact = Arguments<double>;

/** Random numbers that are the same in every run. */
class Random {
 public:
  float uniform(double low, double high)
  {
    return float(low + (high - low) * unit());
  }
  /** Logarithmically uniform. \pre low above 0. */
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

/** \a count arguments, each made by \a make. */
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

/** Vectors of random directions and lengths, and vectors along axes, diagonals and edges of a cube. */
[[nodiscard]] std::vector<In> direction_arguments();

// Tolerances, in float epsilons. Double: 1e-6 for its rounding; 0.5 if literals of the function are rounded to float.
// Float: half an epsilon for each rounding on the longest path, less if the measured errors do not accumulate. Driver:
// more for divisions (Vulkan allows 2.5 epsilons, and GLSL's sqrt counts as a division), and for exp, log and pow (3 +
// 2·|x|). Mesa's rasteriser rounds all other operations correctly, and these as accurately as C++.

void add_depth_sweeps(std::vector<Sweep> &sweeps);
void add_esm_sweeps(std::vector<Sweep> &sweeps);
void add_light_sweeps(std::vector<Sweep> &sweeps);
void add_shadow_sweeps(std::vector<Sweep> &sweeps);
void add_view_transform_sweeps(std::vector<Sweep> &sweeps);

}  // namespace gnomon::verify
