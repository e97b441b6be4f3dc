// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec4.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::verify {

/** Arguments of a shared function. A function uses as many of the numbers as it needs. */
template <typename T>
struct Arguments {
  glm::vec<4, T> a{0};
  glm::vec<4, T> b{0};
  glm::vec<4, T> c{0};
};

/** An expression of `a`, `b` and `c` that calls a shared function, compiled as C++ with T for `float`. */
template <typename T>
struct CompiledFunction {
  std::string_view name;
  /** Text of the expression, which is also valid GLSL. */
  std::string_view expression;
  glm::vec<4, T> (*call)(const Arguments<T> &arguments);
};

/** The functions of shared_function_list.h, compiled in float and in double. */
[[nodiscard]] std::span<const CompiledFunction<float>> functions_in_float();
[[nodiscard]] std::span<const CompiledFunction<double>> functions_in_double();

/** Arguments for one function, its exact result, and error bounds. */
struct Sweep {
  /** The function's name in shared_function_list.h. */
  std::string_view name;
  std::vector<Arguments<float>> arguments;
  /** The exact result, computed by a different method than the function's. */
  glm::dvec4 (*closed_form)(const Arguments<double> &arguments);
  /** Magnitude to which the function's rounding errors are relative. */
  glm::dvec4 (*magnitude)(const Arguments<double> &arguments);
  /** Largest error of the double build, in units of float's epsilon (2^-23) times the magnitude. */
  double double_epsilons;
  /** The same for the float build. */
  double float_epsilons;
  /** The same for a driver. */
  double driver_epsilons;
};

/** One or more for each shared function. */
[[nodiscard]] const std::vector<Sweep> &sweeps();

/**
 * Largest error of a component of \a result, in units of float's epsilon times the magnitude; infinite if the result or
 * the exact value is not finite.
 */
[[nodiscard]] double epsilons(const Sweep &sweep, const Arguments<float> &arguments, const glm::dvec4 &result);

/** The same for the result of the float build. */
[[nodiscard]] double float_epsilons(const Sweep &sweep, const Arguments<float> &arguments);

/** The largest error of a sweep. */
struct Deviation {
  /** In units of float's epsilon times the magnitude; infinite if a result is not finite. */
  double epsilons = 0.0;
  /** Text with the arguments and both results. */
  std::string where;
};

/** \a results: one for each entry of the sweep's arguments. */
[[nodiscard]] Deviation deviation(const Sweep &sweep, std::span<const glm::dvec4> results);

[[nodiscard]] inline Arguments<double> in_double(const Arguments<float> &arguments)
{
  return {arguments.a, arguments.b, arguments.c};
}

}  // namespace gnomon::verify
