// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec4.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::verify {

/** What a function is called with, in as many numbers as it takes. */
template <typename T>
struct Arguments {
  glm::vec<4, T> a{0};
  glm::vec<4, T> b{0};
  glm::vec<4, T> c{0};
};

/** An expression of `a`, `b` and `c` that calls a shared function, as C++ has compiled it with T for `float`. */
template <typename T>
struct CompiledFunction {
  std::string_view name;
  /** Text of the expression: GLSL too. */
  std::string_view expression;
  glm::vec<4, T> (*call)(const Arguments<T> &arguments);
};

/** shared_function_list.h in float, and the same in double. */
[[nodiscard]] std::span<const CompiledFunction<float>> functions_in_float();
[[nodiscard]] std::span<const CompiledFunction<double>> functions_in_double();

/** What one function is called with, and what comes out in truth. */
struct Sweep {
  /** Of the function, in shared_function_list.h. */
  std::string_view name;
  std::vector<Arguments<float>> arguments;
  /** Mathematics, written otherwise than the function. */
  glm::dvec4 (*closed_form)(const Arguments<double> &arguments);
  /** What a rounding in the function is relative to. */
  glm::dvec4 (*magnitude)(const Arguments<double> &arguments);
  /** Largest difference from the truth, in float's epsilon (2^-23) times the magnitude: of the double build, … */
  double double_epsilons;
  /** … of the float build, … */
  double float_epsilons;
  /** … and of a driver. */
  double driver_epsilons;
};

/** One for each shared function. */
[[nodiscard]] const std::vector<Sweep> &sweeps();

/**
 * Difference of \a result from the truth, the largest of its numbers, in float's epsilon times the magnitude; infinite
 * where either is not finite.
 */
[[nodiscard]] double epsilons(const Sweep &sweep, const Arguments<float> &arguments, const glm::dvec4 &result);

/** The same of what the float build gives. */
[[nodiscard]] double float_epsilons(const Sweep &sweep, const Arguments<float> &arguments);

/** Where results differ most from the truth. */
struct Deviation {
  /** In float's epsilon times the magnitude; infinite where a result is not finite. */
  double epsilons = 0.0;
  /** Arguments and results. */
  std::string where;
};

/** \a results: one for each of the sweep's arguments. */
[[nodiscard]] Deviation deviation(const Sweep &sweep, std::span<const glm::dvec4> results);

[[nodiscard]] inline Arguments<double> in_double(const Arguments<float> &arguments)
{
  return {arguments.a, arguments.b, arguments.c};
}

}  // namespace gnomon::verify
