// SPDX-License-Identifier: MIT
// Figures for doc/decisions/0005: exponential, exponential variance and moment shadow maps on the same shadows at equal
// cost. The test uses a row of a map; a square map with n texels in a row costs n² × channels × taps.
#include "eevee_esm_shared.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

namespace gnomon::eevee {
namespace {

/** Distances and positions are in [0, 1]. */
using Profile = std::function<double(double x)>;

struct Layout {
  const char *name;
  /** Distance of the nearest caster or of the receiver itself. */
  Profile nearest;
  Profile receiver;
};

std::vector<Layout> layouts()
{
  const auto flat = [](double z) { return [z](double) { return z; }; };
  const auto above = [](double at, double z, Profile receiver) {
    return [=](double x) { return x < at ? z : receiver(x); };
  };
  const Profile tilted = [](double x) { return 0.4 + 0.4 * x; };
  // Casters as thin as a quarter of the filter's window, at any distance, with gaps.
  const Profile leaves = [](double x) {
    const auto cell = std::uint32_t(std::max(x + 1.0, 0.0) * 100.0);
    const std::uint32_t hash = (cell * 2654435761U) >> 8U;
    return hash % 4 == 0 ? 0.8 : 0.2 + 0.55 * double(hash % 1021) / 1020.0;
  };
  const Profile two = [](double x) { return x < 0.3 ? 0.2 : x < 0.7 ? 0.5 : 0.8; };
  return {{"edge", above(0.5, 0.3, flat(0.8)), flat(0.8)},
          {"two occluders", two, flat(0.8)},
          {"between them", [=](double x) { return std::min(two(x), 0.5); }, flat(0.5)},
          {"tilted", above(0.5, 0.2, tilted), tilted},
          {"tilted, nothing above", tilted, tilted},
          // Light bleeds through the second caster if it is nearer to the receiver than to the first.
          {"close to the second", [](double x) { return x < 0.3   ? 0.2
                                                        : x < 0.7 ? 0.7
                                                                  : 0.8; }, flat(0.8)},
          {"leaves", leaves, flat(0.8)},
          {"among leaves", [=](double x) { return std::min(leaves(x), 0.5); }, flat(0.5)},
          {"contact", above(0.5, 0.78, flat(0.8)), flat(0.8)}};
}

/** Fraction of a window around \a x in which the lamp is visible from the receiver. */
double truth(const Layout &layout, double x, double radius)
{
  int lit = 0;
  constexpr int count = 64;
  for (int i = 0; i < count; i++) {
    const double at = x + radius * ((i + 0.5) / count * 2.0 - 1.0);
    lit += layout.nearest(at) >= layout.receiver(at) - 1e-9 ? 1 : 0;
  }
  return double(lit) / count;
}

using Texel = std::array<float, 4>;

/** A technique: stored values of a distance, filter, and visibility. */
struct Technique {
  std::string name;
  int channels = 1;
  /** Filtered values of \a distances with equal weights. */
  std::function<Texel(const std::vector<float> &distances)> filtered;
  std::function<double(const Texel &texel, double distance)> visibility;
};

Technique esm(float exponent)
{
  return {fmt::format("ESM {}", exponent), 1,
          [=](const std::vector<float> &distances) {
            const float weight = 1.0F / float(distances.size());
            shared::LogSum sum = shared::log_sum_begin(distances[0], weight);
            for (std::size_t i = 1; i < distances.size(); i++) {
              sum = shared::log_sum_add(sum, exponent, distances[i], weight);
            }
            return Texel{shared::log_sum_value(sum, exponent)};
          },
          [=](const Texel &texel, double distance) {
            return double(shared::esm_visibility(exponent, texel[0], float(distance)));
          }};
}

/** Chebyshev's bound for a receiver beyond the mean, with the usual cut of its tail against light bleeding. */
double chebyshev(double mean, double square, double value, double variance_min, double cut)
{
  if (value <= mean) {
    return 1.0;
  }
  const double variance = std::max(square - mean * mean, variance_min);
  const double bound = variance / (variance + (value - mean) * (value - mean));
  return std::clamp((bound - cut) / (1.0 - cut), 0.0, 1.0);
}

/** Lauritzen and McCool 2008: the variance of exp(c z), and, with four channels, of -exp(-d z) too. */
Technique evsm(float positive, float negative, double cut)
{
  return {fmt::format("EVSM{} {}/{} cut {}", negative > 0.0F ? 4 : 2, positive, negative, cut), negative > 0.0F ? 4 : 2,
          [=](const std::vector<float> &distances) {
            Texel sums{};
            for (const float z : distances) {
              const float p = std::exp(positive * z);
              const float n = -std::exp(-negative * z);
              sums[0] += p;
              sums[1] += p * p;
              sums[2] += n;
              sums[3] += n * n;
            }
            for (float &sum : sums) {
              sum /= float(distances.size());
            }
            return sums;
          },
          [=](const Texel &texel, double distance) {
            const double p = std::exp(positive * distance);
            const double n = -std::exp(-negative * distance);
            // As in Lauritzen: a minimum variance proportional to the slope of the warp.
            const auto least = [](double c, double warped) { return std::pow(1e-3 * c * warped, 2.0); };
            const double upper = chebyshev(texel[0], texel[1], p, least(positive, p), cut);
            return negative > 0.0F ? std::min(upper, chebyshev(texel[2], texel[3], n, least(negative, n), cut)) : upper;
          }};
}

/** Peters and Klein 2015, "Moment Shadow Mapping": Hamburger's problem for four moments. */
Technique msm(double bias)
{
  return {fmt::format("MSM4 bias {}", bias), 4,
          [](const std::vector<float> &distances) {
            Texel sums{};
            for (const float z : distances) {
              const float z2 = z * z;
              sums[0] += z;
              sums[1] += z2;
              sums[2] += z2 * z;
              sums[3] += z2 * z2;
            }
            for (float &sum : sums) {
              sum /= float(distances.size());
            }
            return sums;
          },
          [=](const Texel &texel, double z) {
            std::array<double, 4> b{};
            for (std::size_t i = 0; i < 4; i++) {
              b[i] = (1.0 - bias) * texel[i] + bias * 0.5;
            }
            // The quadratic whose roots are the distribution's other two points, from the Hankel matrix' Cholesky
            // factors.
            const double d22 = std::max(b[1] - b[0] * b[0], 1e-12);
            const double l32 = (b[2] - b[0] * b[1]) / d22;
            const double d33 = std::max(b[3] - b[1] * b[1] - l32 * l32 * d22, 1e-12);
            double c1 = z - b[0];
            double c2 = (z * z - b[1] - l32 * c1) / d33;
            c1 = c1 / d22 - l32 * c2;
            const double c0 = 1.0 - c1 * b[0] - c2 * b[1];
            const double p = c1 / c2;
            const double r = std::sqrt(std::max(0.25 * p * p - c0 / c2, 0.0));
            const double z1 = -0.5 * p - r;
            const double z2 = -0.5 * p + r;
            double shadow = 0.0;
            if (z2 < z) {
              shadow = 1.0 - (z1 * z2 - b[0] * (z1 + z2) + b[1]) / ((z - z1) * (z - z2));
            }
            else if (z1 < z) {
              shadow = (z * z2 - b[0] * (z + z2) + b[1]) / ((z2 - z1) * (z - z1));
            }
            return std::isfinite(shadow) ? 1.0 - std::clamp(shadow, 0.0, 1.0) : 1.0;
          }};
}

/** Half width of the filter's window. */
constexpr double radius = 0.02;
constexpr int taps = 32;

/** RMSE of visibilities with \a texels in a row; the edge is at several positions within a texel. */
double error_of(const Technique &technique, const Layout &layout, int texels)
{
  double squares = 0.0;
  int count = 0;
  for (int phase = 0; phase < 3; phase++) {
    const double shift = phase / 3.0 / texels;
    std::vector<Texel> row;
    for (int i = 0; i < texels; i++) {
      std::vector<float> distances;
      for (int tap = 0; tap < taps; tap++) {
        distances.push_back(
            float(layout.nearest((i + 0.5) / texels + shift + radius * ((tap + 0.5) / taps * 2.0 - 1.0))));
      }
      row.push_back(technique.filtered(distances));
    }
    for (int i = 0; i < 200; i++) {
      const double x = 0.1 + 0.8 * (i + 0.5) / 200;
      const double at = (x - shift) * texels - 0.5;
      const auto low = std::size_t(std::floor(at));
      const double fraction = at - double(low);
      // Offset from a tilted plane by a texel, as by esm_bias.
      const double slope = (layout.receiver(x + 1e-6) - layout.receiver(x)) / 1e-6;
      const double distance = layout.receiver(x) - std::abs(slope) / texels - 1e-6;
      const double visibility = (1.0 - fraction) * technique.visibility(row[low], distance) +
                                fraction * technique.visibility(row[low + 1], distance);
      squares += std::pow(visibility - truth(layout, x, radius), 2.0);
      count++;
    }
  }
  return std::sqrt(squares / count);
}

/** RMSE over all layouts. */
double error_of(const Technique &technique, int texels)
{
  double squares = 0.0;
  const std::vector<Layout> all = layouts();
  for (const Layout &layout : all) {
    squares += std::pow(error_of(technique, layout, texels), 2.0);
  }
  return std::sqrt(squares / double(all.size()));
}

/** Time to filter one texel, nanoseconds. */
double filter_time(const Technique &technique)
{
  std::vector<float> distances(taps, 0.5F);
  const auto start = std::chrono::steady_clock::now();
  constexpr int count = 20000;
  float sum = 0.0F;
  for (int i = 0; i < count; i++) {
    distances[std::size_t(i % taps)] = float(i % 97) / 97.0F;
    sum += technique.filtered(distances)[0];
  }
  const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
  EXPECT_TRUE(std::isfinite(sum));
  return time.count() / count;
}

const Technique &best_of(const std::vector<Technique> &techniques, int texels)
{
  return *std::ranges::min_element(techniques, {}, [&](const Technique &t) { return error_of(t, texels); });
}

TEST(MomentMaps, AreBetterOnTiltedPlanesAndAtContactAndWorseElsewhereAtEqualCost)
{
  std::vector<Technique> exponential;
  for (const float exponent : {10.0F, 20.0F, 40.0F, 80.0F, 160.0F, 320.0F}) {
    exponential.push_back(esm(exponent));
  }
  std::vector<Technique> variance2;
  std::vector<Technique> variance4;
  for (const double cut : {0.0, 0.2}) {
    // 88.72 / 2 is the most that floats hold.
    for (const float exponent : {10.0F, 20.0F, 40.0F}) {
      variance2.push_back(evsm(exponent, 0.0F, cut));
      variance4.push_back(evsm(exponent, 10.0F, cut));
      variance4.push_back(evsm(exponent, exponent, cut));
    }
  }
  std::vector<Technique> moments;
  for (const double bias : {3e-7, 3e-6, 3e-5}) {
    moments.push_back(msm(bias));
  }
  const std::vector<Technique> chosen = {best_of(exponential, 128), best_of(variance2, 90), best_of(variance4, 64),
                                         best_of(moments, 64)};
  for (const Technique &technique : chosen) {
    fmt::print("{:24} {} channels, {:.0f} ns a texel of {} taps\n", technique.name, technique.channels,
               filter_time(technique), taps);
  }
  for (const int texels : {64, 128}) {
    fmt::print("\n{} texels a row of one channel, fewer of more:\n{:24}", texels, "");
    for (const Technique &technique : chosen) {
      fmt::print(" {:>22}", technique.name);
    }
    for (const Layout &layout : layouts()) {
      fmt::print("\n{:24}", layout.name);
      for (const Technique &technique : chosen) {
        fmt::print(" {:22.4f}", error_of(technique, layout, int(texels / std::sqrt(double(technique.channels)))));
      }
    }
    fmt::print("\n{:24}", "all");
    for (const Technique &technique : chosen) {
      fmt::print(" {:22.4f}", error_of(technique, int(texels / std::sqrt(double(technique.channels)))));
    }
    fmt::print("\n{:24}", "all, same size");
    for (const Technique &technique : chosen) {
      fmt::print(" {:22.4f}", error_of(technique, texels));
    }
  }
  fmt::print("\n");
  const auto fewer = [](const Technique &technique) { return int(128 / std::sqrt(double(technique.channels))); };
  const auto layout = [&](std::string_view name) {
    const std::vector<Layout> all = layouts();
    return *std::ranges::find_if(all, [&](const Layout &l) { return l.name == name; });
  };
  for (std::size_t i = 1; i < chosen.size(); i++) {
    const Technique &other = chosen[i];
    for (const char *name : {"edge", "two occluders", "close to the second", "leaves", "among leaves"}) {
      EXPECT_LT(error_of(chosen[0], layout(name), 128), error_of(other, layout(name), fewer(other))) << other.name;
    }
    for (const char *name : {"tilted", "contact"}) {
      EXPECT_GT(error_of(chosen[0], layout(name), 128), error_of(other, layout(name), fewer(other))) << other.name;
    }
  }
}

}  // namespace
}  // namespace gnomon::eevee
