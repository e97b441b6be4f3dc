// SPDX-License-Identifier: MIT
#include "internal/shared_function_sweeps.hh"

#include "eevee_esm_shared.h"

#include <algorithm>
#include <numbers>

namespace gnomon::verify {

void add_esm_sweeps(std::vector<Sweep> &sweeps)
{
  sweeps.push_back({"log_sum",
                    many(30000,
                         [](Random &random) {
                           // Four distances with a spread of 0 to 1e30 m around one of up to 1 km.
                           const float base = random.log_uniform(1e-3, 1e3);
                           const float spread =
                               random.one_of(std::array{0.0F, random.log_uniform(1e-4, 1e3),
                                                        random.log_uniform(1e-4, 1e3), random.log_uniform(1.0, 1e30)});
                           In in;
                           for (int i = 0; i < 4; i++) {
                             in.a[i] = base + spread * random.uniform(0, 1);
                             in.c[i] = random.one_of(std::array{0.25F, 0.03125F});
                           }
                           in.b.x = random.log_uniform(0.01, 1e4);
                           return in;
                         }),
                    [](const Exact &in) {
                      const long double exponent = in.b.x;
                      const double highest = std::max({in.a.x, in.a.y, in.a.z, in.a.w});
                      long double sum = 0.0L;
                      for (int i = 0; i < 4; i++) {
                        sum += in.c[i] * std::exp(exponent * (static_cast<long double>(in.a[i]) - highest));
                      }
                      return one(double(highest + std::log(sum) / exponent));
                    },
                    [](const Exact &in) {
                      return one(std::max({in.a.x, in.a.y, in.a.z, in.a.w}) + 1.0 / in.b.x);
                    },
                    1e-6, 4, 16});
  sweeps.push_back({"esm_visibility",
                    many(30000,
                         [](Random &random) {
                           const float distance = random.log_uniform(1e-3, 1e3);
                           const float exponent = random.log_uniform(0.01, 1e4);
                           const float stored =
                               random.one_of(std::array{distance, distance - random.log_uniform(1e-3, 80.0) / exponent,
                                                        random.log_uniform(1e-3, 1e3), 1e30F});
                           return In{.a = {exponent, stored, distance, 0}};
                         }),
                    [](const Exact &in) { return one(std::min(1.0, std::exp(in.a.x * (in.a.y - in.a.z)))); },
                    [](const Exact &in) {
                      // A relative error of the exponent is multiplied by the exponent in the power. The smallest
                      // magnitude belongs to numbers that a driver may flush to 0.
                      const double exponent = std::min(in.a.x * (in.a.y - in.a.z), 0.0);
                      return one(std::exp(exponent) * (1.0 - exponent) + 1e-30);
                    },
                    1e-6, 2, 8});

  {
    std::vector<In> encoded;
    std::vector<In> decoded;
    for (const float range : {1e-3F, 1.0F, 37.5F, 1e6F}) {
      for (const int format : {ESM_FLOAT, ESM_HALF}) {
        // Multiples of 1/4096 plus an offset, so that rounding does not decide between two steps.
        for (int i = 0; i <= 4096; i += 3) {
          encoded.push_back({.a = {range * (float(i) + 0.25F) / 4096.25F, range, format, 0}});
          decoded.push_back({.a = {float(i) / 2048.0F - 1.0F, range, format, 0}});
        }
      }
    }
    sweeps.push_back(
        {"esm_variance_visibility",
         many(20000,
              [](Random &random) {
                In in;
                in.b.x = random.log_uniform(0.01, 100.0);
                in.a = {random.uniform(1, 2), random.log_uniform(1e-2, 10.0), 0, random.log_uniform(1e-3, 1.0)};
                in.a.z = in.a.x + random.uniform(-3, 60) / in.b.x;
                return in;
              }),
         [](const Exact &in) {
           const double t = std::expm1(std::clamp(in.b.x * (in.a.z - in.a.x), 0.0, 40.0));
           const double least = std::min(in.b.x * in.a.w, 1.0);
           const double v = std::max(in.a.y, std::max(least * least, 1e-6));
           const auto cut = double(0.1F);
           return one(std::max(v / (v + t * t) - cut, 0.0) / (1.0 - cut));
         },
         // Where the bound is steep, rounding of the difference of distances is multiplied by c / √v.
         [](const Exact &in) { return one(1.0 + in.b.x * in.a.z / std::sqrt(in.a.y)); }, 1e-6, 4, 16});
    sweeps.push_back({"esm_encoded", encoded,
                      [](const Exact &in) {
                        return one(in.a.z == ESM_HALF ? std::round(4096.0 * in.a.x / in.a.y) / 2048.0 - 1.0 : in.a.x);
                      },
                      [](const Exact &in) { return one(in.a.z == ESM_HALF ? 1.0 : in.a.x); }, 1e-6, 0, 0});
    sweeps.push_back({"esm_decoded", decoded,
                      [](const Exact &in) { return one(in.a.z == ESM_HALF ? (1.0 + in.a.x) / 2.0 * in.a.y : in.a.x); },
                      [](const Exact &in) { return one(in.a.y + 1.0); }, 1e-6, 1, 1});
    sweeps.push_back({"esm_format_error",
                      many(1000,
                           [](Random &random) {
                             const float format = random.one_of(std::array{0.0F, 1.0F});
                             return In{.a = {random.log_uniform(1e-3, 1e6), format, 0, 0}};
                           }),
                      [](const Exact &in) { return one(in.a.y == ESM_HALF ? in.a.x / 8192.0 : 0.0); },
                      [](const Exact &in) { return one(in.a.x); }, 1e-6, 0, 1});
    sweeps.push_back({"esm_visibility_error",
                      many(10000,
                           [](Random &random) {
                             return In{.a = {random.log_uniform(0.01, 1e4), random.log_uniform(1e-7, 10.0), 0, 0}};
                           }),
                      [](const Exact &in) { return one(-std::expm1(-in.a.x * in.a.y)); },
                      [](const Exact &) { return one(1.0); }, 1e-6, 1, 4});
    std::vector<In> points;
    for (const int count : {1, 4, 8, 32, 64}) {
      for (int i = 0; i < count; i++) {
        points.push_back({.a = {i, count, 0, 0}});
      }
    }
    sweeps.push_back({"esm_disk_point", points,
                      [](const Exact &in) {
                        const int ring = int(in.a.x) / 4;
                        const double radius = in.a.y == 1.0 ? 0.0 : std::sqrt((ring + 0.5) * 4.0 / in.a.y);
                        const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
                        const double angle = ring * golden + (int(in.a.x) % 4) * std::numbers::pi / 2.0;
                        return dvec4(radius * std::cos(angle), radius * std::sin(angle), 0, 0);
                      },
                      // The golden angle is rounded, and drivers' sines are inaccurate for large angles.
                      [](const Exact &in) { return dvec4(1, 1, 0, 0) * (1.0 + in.a.x / 4.0); }, 2, 3, 20});
    sweeps.push_back({"esm_cone_direction",
                      many(20000,
                           [](Random &random) {
                             const float angle = random.uniform(0, 2.0 * std::numbers::pi);
                             const float radius = random.uniform(0, 1);
                             return In{.a = glm::vec4(random.direction(), 0),
                                       .b = {radius * std::cos(angle), radius * std::sin(angle),
                                             random.one_of(std::array{0.0F, 1e-3F, 0.12F, 1.0F}), 0}};
                           }),
                      [](const Exact &in) {
                        // The rotation from the nearer of +Z and -Z to the axis.
                        const dvec3 n = dvec3(in.a);
                        const double side = n.z >= 0.0 ? 1.0 : -1.0;
                        const double scale = 1.0 / (1.0 + std::abs(n.z));
                        const dvec3 x(1.0 - n.x * n.x * scale, -n.x * n.y * scale, -side * n.x);
                        const dvec3 y(-side * n.x * n.y * scale, side * (1.0 - n.y * n.y * scale), -n.y);
                        const double r2 = in.b.x * in.b.x + in.b.y * in.b.y;
                        const double cosine = 1.0 - in.b.z * r2;
                        const double sine_a_radius = std::sqrt(in.b.z * (1.0 + cosine));
                        return dvec4(cosine * n + sine_a_radius * (in.b.x * x + in.b.y * y), 0);
                      },
                      [](const Exact &) { return dvec4(1, 1, 1, 0); }, 4, 8, 16});
    sweeps.push_back({"esm_bias",
                      many(20000,
                           [](Random &random) {
                             return In{.a = {random.log_uniform(1e-3, 1e3), random.uniform(-1, 1),
                                             random.log_uniform(1e-4, 0.1), random.log_uniform(1e-6, 1e-2)}};
                           }),
                      [](const Exact &in) {
                        const double tangent = std::min(std::tan(std::acos(std::abs(in.a.y))), 10.0);
                        return one(in.a.x * (1.25 * in.a.z * tangent + 4e-7) + in.a.w);
                      },
                      [](const Exact &in) {
                        // The tangent of a cosine near 1 is the square root of a small difference.
                        const double tangent = std::tan(std::acos(std::abs(in.a.y)));
                        return one(in.a.x * in.a.z * (std::min(tangent, 10.0) + 1.0 / std::max(tangent, 1e-3)) +
                                   in.a.x * 1e-6 + in.a.w);
                      },
                      1, 4, 8});
    sweeps.push_back({"esm_gathered_visibility",
                      many(20000,
                           [](Random &random) {
                             In in;
                             in.c.x = random.log_uniform(0.01, 100.0);
                             in.b = {random.uniform(1, 10), random.uniform(0, 1), random.uniform(0, 1), 0};
                             for (int i = 0; i < 4; i++) {
                               in.a[i] = in.b.x - random.uniform(-3, 3) / in.c.x;
                             }
                             return in;
                           }),
                      [](const Exact &in) {
                        const auto visible = [&](int i) {
                          return std::min(1.0, std::exp(in.c.x * (in.a[i] - in.b.x)));
                        };
                        const double u = in.b.y;
                        const double v = in.b.z;
                        return one((1.0 - v) * ((1.0 - u) * visible(3) + u * visible(2)) +
                                   v * ((1.0 - u) * visible(0) + u * visible(1)));
                      },
                      [](const Exact &in) { return one(1.0 + in.c.x * in.b.x); }, 1e-6, 3, 6});
  }
}

}  // namespace gnomon::verify
