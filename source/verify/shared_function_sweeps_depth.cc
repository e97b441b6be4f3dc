// SPDX-License-Identifier: MIT
#include "internal/shared_function_sweeps.hh"

#include "eevee_depth_shared.h"

#include <algorithm>

namespace gnomon::verify {

namespace {

std::vector<In> depth_arguments(bool is_distance)
{
  std::vector<In> arguments = many(30000, [&](Random &random) {
    const int projection =
        random.one_of(std::array{PROJECTION_PERSPECTIVE, PROJECTION_PERSPECTIVE_INFINITE, PROJECTION_ORTHOGRAPHIC});
    const float near = random.log_uniform(1e-4, 1e2);
    const float far = near * (1.0F + random.log_uniform(1e-3, 1e9));
    const float share = random.uniform(0, 1);
    float x = share;
    if (is_distance) {
      // Distances from behind the eye to beyond the far plane.
      x = random.one_of(std::array{near, far, near + share * (far - near), random.log_uniform(0.5 * near, 2.0 * far),
                                   0.0F, -share * near});
    }
    else {
      x = random.one_of(std::array{0.0F, 1.0F, share, random.log_uniform(1e-12, 1.0)});
    }
    return In{.a = glm::vec4(x, near, far, float(projection))};
  });
  return arguments;
}

}  // namespace

void add_depth_sweeps(std::vector<Sweep> &sweeps)
{
  sweeps.push_back({"depth_of_distance", depth_arguments(true),
                    [](const Exact &in) {
                      // The function clamps smaller distances.
                      const long double d = in.a.x;
                      const long double in_front = std::max(d, static_cast<long double>(1e-30F));
                      const long double n = in.a.y;
                      const long double f = in.a.z;
                      switch (int(in.a.w)) {
                        case PROJECTION_PERSPECTIVE: return one(double(n * (f - in_front) / (in_front * (f - n))));
                        case PROJECTION_PERSPECTIVE_INFINITE: return one(double(n / in_front));
                        default: return one(double((f - d) / (f - n)));
                      }
                    },
                    [](const Exact &in) {
                      const double d = in.a.x;
                      const double in_front = std::max(d, 1e-30);
                      const double n = in.a.y;
                      const double f = in.a.z;
                      switch (int(in.a.w)) {
                        case PROJECTION_PERSPECTIVE: return one(std::abs(n * (f - in_front) / (in_front * (f - n))));
                        case PROJECTION_PERSPECTIVE_INFINITE: return one(n / in_front);
                        default: return one(std::abs((f - d) / (f - n)));
                      }
                    },
                    1e-6, 3, 6});
  sweeps.push_back({"distance_of_depth", depth_arguments(false),
                    [](const Exact &in) {
                      const long double depth = in.a.x;
                      const long double n = in.a.y;
                      const long double f = in.a.z;
                      switch (int(in.a.w)) {
                        case PROJECTION_PERSPECTIVE:
                          return one(double(1.0L / (depth * (1.0L / n - 1.0L / f) + 1.0L / f)));
                        case PROJECTION_PERSPECTIVE_INFINITE: return one(double(n / std::max(depth, 1e-30L)));
                        default: return one(double(depth * n + (1.0L - depth) * f));
                      }
                    },
                    [](const Exact &in) {
                      const double depth = in.a.x;
                      const double n = in.a.y;
                      const double f = in.a.z;
                      switch (int(in.a.w)) {
                        case PROJECTION_PERSPECTIVE: return one(1.0 / (depth * (1.0 / n - 1.0 / f) + 1.0 / f));
                        case PROJECTION_PERSPECTIVE_INFINITE: return one(n / std::max(depth, 1e-30));
                        default: return one(f);
                      }
                    },
                    0.5, 3, 6});
}

}  // namespace gnomon::verify
