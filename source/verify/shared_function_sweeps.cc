// SPDX-License-Identifier: MIT
#include "internal/shared_function_sweeps.hh"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace gnomon::verify {

namespace {

/** Directions to the face centres, edge middles and corners of a cube, ties between axes, and zeros of both signs. */
std::vector<glm::vec3> special_directions()
{
  std::vector<glm::vec3> directions;
  const std::array<float, 6> steps = {-1.0F, -0.5F, -0.0F, 0.0F, 0.5F, 1.0F};
  for (const float x : steps) {
    for (const float y : steps) {
      for (const float z : steps) {
        if (x != 0.0F || y != 0.0F || z != 0.0F) {
          directions.emplace_back(x, y, z);
        }
      }
    }
  }
  return directions;
}

}  // namespace

std::vector<In> direction_arguments()
{
  std::vector<In> arguments = many(
      20000, [](Random &random) { return In{.a = glm::vec4(random.direction() * random.log_uniform(1e-9, 1e9), 0)}; });
  for (const glm::vec3 &v : special_directions()) {
    arguments.push_back({.a = glm::vec4(v, 0)});
  }
  return arguments;
}

const std::vector<Sweep> &sweeps()
{
  static const std::vector<Sweep> all = [] {
    std::vector<Sweep> sweeps;
    add_light_sweeps(sweeps);
    add_depth_sweeps(sweeps);
    add_esm_sweeps(sweeps);
    add_shadow_sweeps(sweeps);
    add_view_transform_sweeps(sweeps);
    return sweeps;
  }();
  return all;
}

double epsilons(const Sweep &sweep, const Arguments<float> &arguments, const dvec4 &result)
{
  const Exact in = in_double(arguments);
  const dvec4 truth = sweep.closed_form(in);
  const dvec4 magnitude = sweep.magnitude(in);
  double worst = 0.0;
  for (int k = 0; k < 4; k++) {
    const double difference = std::abs(result[k] - truth[k]);
    const double one =
        difference == 0.0 ? 0.0 : difference / (double(std::numeric_limits<float>::epsilon()) * magnitude[k]);
    worst = std::isfinite(one) ? std::max(worst, one) : std::numeric_limits<double>::infinity();
  }
  return worst;
}

Deviation deviation(const Sweep &sweep, std::span<const dvec4> results)
{
  Deviation worst;
  for (std::size_t i = 0; i < sweep.arguments.size(); i++) {
    const double one = epsilons(sweep, sweep.arguments[i], results[i]);
    if (one > worst.epsilons) {
      const auto text = [](const dvec4 &v) { return fmt::format("({:.9g} {:.9g} {:.9g} {:.9g})", v.x, v.y, v.z, v.w); };
      const Exact in = in_double(sweep.arguments[i]);
      worst = {one, fmt::format("a {} b {} c {}: {} instead of {}", text(in.a), text(in.b), text(in.c),
                                text(results[i]), text(sweep.closed_form(in)))};
    }
  }
  return worst;
}

double float_epsilons(const Sweep &sweep, const Arguments<float> &arguments)
{
  const auto functions = functions_in_float();
  const auto function = std::ranges::find(functions, sweep.name, &CompiledFunction<float>::name);
  return epsilons(sweep, arguments, dvec4(function->call(arguments)));
}

}  // namespace gnomon::verify
