// SPDX-License-Identifier: MIT
#include "internal/shared_function_sweeps.hh"

#include "draw_view_transform_shared.h"

#include <glm/common.hpp>

#include <algorithm>

namespace gnomon::verify {

namespace {

double srgb(double linear)
{
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double agx_curve_exact(double x)
{
  return std::max(15.5 * std::pow(x, 6) - 40.14 * std::pow(x, 5) + 31.96 * std::pow(x, 4) - 6.868 * std::pow(x, 3) +
                      0.4298 * x * x + 0.1191 * x - 0.00232,
                  0.0);
}

dvec3 agx_exact(const dvec3 &linear)
{
  // Column-major.
  const glm::dmat3 rec2020_from_rec709(0.6274, 0.0691, 0.0164, 0.3293, 0.9195, 0.0880, 0.0433, 0.0113, 0.8956);
  const glm::dmat3 inset(0.856627153315983, 0.137318972929847, 0.11189821299995, 0.0951212405381588, 0.761241990602591,
                         0.0767994186031903, 0.0482516061458583, 0.101439036467562, 0.811302368396859);
  const glm::dmat3 outset(1.1271005818144368, -0.1413297634984383, -0.14132976349843826, -0.11060664309660323,
                          1.157823702216272, -0.11060664309660294, -0.016493938717834573, -0.016493938717834257,
                          1.2519364065950405);
  const glm::dmat3 rec709_from_rec2020(1.6605, -0.1246, -0.0182, -0.5876, 1.1329, -0.1006, -0.0728, -0.0083, 1.1187);
  dvec3 curved = inset * (rec2020_from_rec709 * linear);
  for (int k = 0; k < 3; k++) {
    const double stops = std::log2(std::max(curved[k], 1e-10));
    curved[k] = agx_curve_exact(glm::clamp((stops + 12.47393) / (4.026069 + 12.47393), 0.0, 1.0));
  }
  return rec709_from_rec2020 * glm::pow(glm::max(outset * curved, dvec3(0.0)), dvec3(2.2));
}

dvec3 pbr_neutral_exact(const dvec3 &linear)
{
  const double smallest = std::min({linear.x, linear.y, linear.z});
  const dvec3 color = linear - (smallest < 0.08 ? smallest - 6.25 * smallest * smallest : 0.04);
  const double peak = std::max({color.x, color.y, color.z});
  if (peak < 0.76) {
    return color;
  }
  const double new_peak = 1.0 - 0.24 * 0.24 / (peak + 0.24 - 0.76);
  return glm::mix(color * (new_peak / peak), dvec3(new_peak), 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0));
}

}  // namespace

void add_view_transform_sweeps(std::vector<Sweep> &sweeps)
{
  {
    std::vector<In> arguments;
    for (int i = 0; i <= 4096; i++) {
      arguments.push_back({.a = glm::vec4(float(i) / 4096.0F)});
    }
    for (int i = -50; i <= 50; i++) {
      arguments.push_back({.a = glm::vec4(0.0031308F + float(i) * 1e-7F)});
    }
    // The function's literals are floats.
    sweeps.push_back({"srgb_encoded", arguments, [](const Exact &in) { return one(srgb(in.a.x)); },
                      [](const Exact &) { return one(1.0); }, 0.5, 2, 16});
    sweeps.push_back({"agx_curve", std::vector<In>(arguments.begin(), arguments.begin() + 4097),
                      [](const Exact &in) { return one(agx_curve_exact(in.a.x)); },
                      // Magnitude of the terms, which cancel in the sum.
                      [](const Exact &) { return one(32.0); }, 0.5, 1, 4});
    const auto lights = many(10000, [](Random &random) {
      const auto light = [&] { return random.log_uniform(1e-5, 1e3); };
      return In{.a = glm::vec4(light(), light(), light(), 0.0F)};
    });
    // The curve's terms cancel, and the outset matrix amplifies the remainder by 1.3 and 2.2.
    sweeps.push_back({"agx", lights, [](const Exact &in) { return dvec4(agx_exact(dvec3(in.a)), 0); },
                      [](const Exact &) { return dvec4(64, 64, 64, 0); }, 1, 2, 8});
    sweeps.push_back({"pbr_neutral", lights, [](const Exact &in) { return dvec4(pbr_neutral_exact(dvec3(in.a)), 0); },
                      // Small channels retain the rounding error of the values subtracted from them.
                      [](const Exact &) { return dvec4(1, 1, 1, 0); }, 4, 8, 16});
    sweeps.push_back(
        {"view_transformed",
         many(10000,
              [](Random &random) {
                return In{.a = glm::vec4(glm::vec3(1.0F) + random.box(2.0),
                                         random.one_of(std::array{VIEW_TRANSFORM_STANDARD, VIEW_TRANSFORM_RAW}))};
              }),
         [](const Exact &in) {
           dvec3 clipped = glm::clamp(dvec3(in.a), 0.0, 1.0);
           if (int(in.a.w) == VIEW_TRANSFORM_STANDARD) {
             clipped = {srgb(clipped.x), srgb(clipped.y), srgb(clipped.z)};
           }
           return dvec4(clipped, 0);
         },
         [](const Exact &) { return dvec4(1, 1, 1, 0); }, 0.5, 2, 16});
  }
}

}  // namespace gnomon::verify
