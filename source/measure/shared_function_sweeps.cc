// SPDX-License-Identifier: MIT
#include "shared_functions.hh"

#include "eevee_depth_shared.h"
#include "eevee_esm_shared.h"
#include "eevee_tonemap_shared.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace gnomon::measure {

namespace {

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

dvec4 one(double value)
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

/** Cosines in [low, 1], dense at both ends. */
std::vector<float> cosines(float low)
{
  std::vector<float> values;
  for (int i = 0; i <= 64; i++) {
    values.push_back(low + (1.0F - low) * float(i) / 64.0F);
  }
  for (int i = 7; i <= 24; i++) {
    values.push_back(1.0F - std::ldexp(1.0F, -i));
    values.push_back(low + std::ldexp(1.0F, -i));
  }
  return values;
}

constexpr std::array<float, 7> alphas = {1e-3F, 2e-3F, 0.01F, 0.0625F, 0.3F, 0.7225F, 1.0F};

/** Ends, middles of edges, corners of a cube, ties, zeros of both signs. */
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

std::vector<In> direction_arguments()
{
  std::vector<In> arguments = many(
      20000, [](Random &random) { return In{.a = glm::vec4(random.direction() * random.log_uniform(1e-9, 1e9), 0)}; });
  for (const glm::vec3 &v : special_directions()) {
    arguments.push_back({.a = glm::vec4(v, 0)});
  }
  return arguments;
}

/** Mirrored on the diamond's edge of the quadrant that \a p is in. */
dvec2 folded(dvec2 p)
{
  const dvec2 sign(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
  return p - (glm::dot(sign, p) - 1.0) * sign;
}

// --- truths

/** Of two triangles that share a diagonal (van Oosterom and Strackee 1983, eq. 8): long doubles bear its cancellations.
 */
double solid_angle(const Exact &in)
{
  using Vector = glm::vec<3, long double>;
  const Vector center(in.a);
  const Vector right(in.b);
  const Vector up(in.c);
  const auto triangle = [](const Vector &a, const Vector &b, const Vector &c) {
    const long double volume = std::abs(glm::dot(a, glm::cross(b - a, c - a)));
    const long double la = glm::length(a);
    const long double lb = glm::length(b);
    const long double lc = glm::length(c);
    return 2.0L * std::atan2(volume, la * lb * lc + glm::dot(a, b) * lc + glm::dot(a, c) * lb + glm::dot(b, c) * la);
  };
  const Vector a = center - right - up;
  const Vector c = center + right + up;
  return double(triangle(a, center + right - up, c) + triangle(a, c, center - right + up));
}

double distance_to_segment(const dvec3 &from, const dvec3 &to)
{
  const dvec3 along = to - from;
  const double t = -glm::dot(from, along) / std::max(glm::dot(along, along), 1e-30);
  return glm::length(from + std::clamp(t, 0.0, 1.0) * along);
}

/** How much the angle changes where the corners move by their own size: what a rounding of them is relative to. */
double solid_angle_condition(const Exact &in)
{
  const dvec3 center(in.a);
  const dvec3 right(in.b);
  const dvec3 up(in.c);
  const std::array<dvec3, 4> corners = {center - right - up, center + right - up, center + right + up,
                                        center - right + up};
  double rim = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; i++) {
    rim = std::min(rim, distance_to_segment(corners[i], corners[(i + 1) % 4]));
  }
  // Its gradient is the field of a current along the rim (Biot and Savart): that of a long wire from near, and at most
  // the rim's length over the square of its distance.
  const double size = glm::length(right) + glm::length(up);
  return (glm::length(center) + size) * std::min(2.0 / rim, 4.0 * size / (rim * rim));
}

/** Where parallels are said to meet. */
constexpr double line_far = 1e16F;

double ggx_distribution(double c, double alpha)
{
  const double t = c * c * (alpha * alpha - 1.0) + 1.0;
  return alpha * alpha / (std::numbers::pi * t * t);
}

double ggx_masking(double c, double alpha)
{
  // Walter et al. 2007, eq. 34, with the tangent.
  return 2.0 / (1.0 + std::sqrt(1.0 + alpha * alpha * (1.0 - c * c) / (c * c)));
}

double srgb(double linear)
{
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

/** Columns of OpenGL 4.5 core, table 8.19: which components, and with which sign, are sc, tc and ma of a face. */
dvec3 cube_coordinates(int face, dvec3 v)
{
  struct Row {
    int sc, tc, ma;
    double sc_sign, tc_sign, ma_sign;
  };
  constexpr std::array<Row, 6> rows = {{{2, 1, 0, -1, -1, 1},
                                        {2, 1, 0, 1, -1, -1},
                                        {0, 2, 1, 1, 1, 1},
                                        {0, 2, 1, 1, -1, -1},
                                        {0, 1, 2, 1, -1, 1},
                                        {0, 1, 2, -1, -1, -1}}};
  const Row &row = rows[std::size_t(face)];
  return {row.sc_sign * v[row.sc], row.tc_sign * v[row.tc], row.ma_sign * v[row.ma]};
}

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
      // From behind the eye to beyond the far plane.
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

/** Where \a texel lies on the map that goes on outside: by the reflection of the plane's points, not of indices. */
dvec2 continued_texel(dvec2 texel, double size)
{
  dvec2 p = (texel + 0.5) / size * 2.0 - 1.0;
  for (int axis = 0; axis < 2; axis++) {
    if (std::abs(p[axis]) > 1.0) {
      // A point beyond the edge is the one as far within, on the other side of the edge's middle.
      p[axis] = std::copysign(2.0, p[axis]) - p[axis];
      p[1 - axis] = -p[1 - axis];
    }
  }
  return glm::floor((p + 1.0) * 0.5 * size);
}

double agx_curve_exact(double x)
{
  return std::max(15.5 * std::pow(x, 6) - 40.14 * std::pow(x, 5) + 31.96 * std::pow(x, 4) - 6.868 * std::pow(x, 3) +
                      0.4298 * x * x + 0.1191 * x - 0.00232,
                  0.0);
}

dvec3 agx_exact(const dvec3 &linear)
{
  // By columns.
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

std::vector<Sweep> make_sweeps()
{
  std::vector<Sweep> sweeps;

  // Tolerances. Double: 1e-6, its own roundings; 0.5 where literals of the function are rounded to floats. Float: half
  // an epsilon for each rounding on the longest path, less what was seen not to add up. Driver: more where it divides
  // (Vulkan allows 2.5 epsilons, and GLSL's sqrt is a division), and for exp, log and pow (3 + 2·|x|). Mesa's
  // rasteriser rounds all correctly but these, and there they are as near as C++'s.

  // The magnitude holds both dot products, whose terms may cancel.
  sweeps.push_back({"line_plane_distance",
                    many(20000,
                         [](Random &random) {
                           const glm::vec3 point = random.box(100.0);
                           In in{glm::vec4(random.box(100.0), point.x), glm::vec4(random.direction(), point.y),
                                 glm::vec4(random.direction(), point.z)};
                           if (random.uniform(0, 1) < 0.05F) {
                             // Parallel, or nearly; at times in the plane.
                             in.c = {0, 0, 1, point.z};
                             in.b.z = random.one_of(std::array{0.0F, -0.0F, 1e-30F, -1e-30F, 1e-12F});
                             in.a.z = random.one_of(std::array{in.a.z, point.z});
                           }
                           return in;
                         }),
                    [](const Exact &in) {
                      const dvec3 n(in.c);
                      const double height = glm::dot(n, dvec3(in.a.w, in.b.w, in.c.w) - dvec3(in.a));
                      const double rise = glm::dot(n, dvec3(in.b));
                      if (std::abs(height) >= line_far * std::abs(rise)) {
                        return one((height < 0.0) == (rise < 0.0) ? line_far : -line_far);
                      }
                      return one(height / rise);
                    },
                    [](const Exact &in) {
                      const dvec3 n(in.c);
                      const dvec3 to_plane = dvec3(in.a.w, in.b.w, in.c.w) - dvec3(in.a);
                      const double rise = std::max(std::abs(glm::dot(n, dvec3(in.b))), 1e-30);
                      const double t = std::abs(glm::dot(n, to_plane)) / rise;
                      return one((glm::length(to_plane) + t) / rise);
                    },
                    1e-6, 2, 4});

  // Driver: Mesa's atan is a polynomial, off by 2e-5 of its value (Vulkan allows 5e-4).
  sweeps.push_back({"rectangle_solid_angle",
                    [] {
                      std::vector<In> arguments = many(40000, [](Random &random) {
                        // Along axes, so that edges are at right angles to the last bit, or turned, where they are to
                        // 1e-7.
                        glm::vec3 x(1, 0, 0);
                        glm::vec3 y(0, 1, 0);
                        if (random.uniform(0, 1) < 0.5F) {
                          x = random.direction();
                          y = glm::normalize(glm::cross(x, random.direction()));
                        }
                        const glm::vec3 z = glm::cross(x, y);
                        const float scale = random.log_uniform(1e-4, 1e5);
                        const float width = scale * random.log_uniform(1e-3, 1.0);
                        const float height = scale * random.log_uniform(1e-3, 1.0);
                        const float reach = random.log_uniform(0.1, 1e3);
                        const glm::vec3 center = x * (width * reach * random.uniform(-1, 1)) +
                                                 y * (height * reach * random.uniform(-1, 1)) +
                                                 z * (scale * random.log_uniform(1e-6, 1e3));
                        return In{glm::vec4(center, 0), glm::vec4(x * width, 0), glm::vec4(y * height, 0)};
                      });
                      return arguments;
                    }(),
                    [](const Exact &in) { return one(solid_angle(in)); },
                    [](const Exact &in) { return one(solid_angle(in) + solid_angle_condition(in)); }, 0.5, 2, 16});

  // Sums of positive terms only: relative errors of a few roundings.
  {
    std::vector<In> arguments;
    for (const float c : cosines(0.0F)) {
      for (const float alpha : alphas) {
        arguments.push_back({.a = {c, alpha, 0, 0}});
      }
    }
    sweeps.push_back({"ggx_distribution", arguments,
                      [](const Exact &in) { return one(ggx_distribution(in.a.x, in.a.y)); },
                      [](const Exact &in) { return one(ggx_distribution(in.a.x, in.a.y)); }, 0.5, 4, 8});
  }
  {
    std::vector<In> arguments;
    for (const float c : cosines(1e-6F)) {
      for (const float alpha : alphas) {
        arguments.push_back({.a = {c, alpha, 0, 0}});
      }
    }
    const auto truth = [](const Exact &in) { return one(ggx_masking(in.a.x, in.a.y) / (2.0 * in.a.x)); };
    sweeps.push_back({"ggx_masking_over_2cos", arguments, truth, truth, 1e-6, 2, 8});
  }
  {
    const auto truth = [](const Exact &in) {
      const double alpha = in.a.w;
      return one(ggx_distribution(in.a.z, alpha) * ggx_masking(in.a.x, alpha) * ggx_masking(in.a.y, alpha) /
                 (4.0 * in.a.x * in.a.y));
    };
    sweeps.push_back({"ggx_lobe",
                      many(20000,
                           [](Random &random) {
                             const std::array<float, 3> c = {random.uniform(0, 1), random.log_uniform(1e-4, 1),
                                                             1.0F - random.log_uniform(1e-7, 1)};
                             return In{.a = {std::max(c[0], 1e-4F), c[1], c[2], random.one_of(alphas)}};
                           }),
                      truth, truth, 0.5, 6, 16});
  }
  sweeps.push_back(
      {"fresnel_schlick",
       many(20000,
            [](Random &random) {
              const glm::vec3 f0(random.uniform(0, 1), random.uniform(0, 1), random.one_of(std::array{0.0F, 1.0F}));
              return In{glm::vec4(f0, random.one_of(std::array{0.0F, 0.5F, 1.0F})),
                        glm::vec4(random.uniform(-0.1, 1.1))};
            }),
       [](const Exact &in) {
         const double share = std::pow(1.0 - std::clamp(in.b.x, 0.0, 1.0), 5.0);
         return dvec4(dvec3(in.a) * (1.0 - share) + in.a.w * share, 0);
       },
       [](const Exact &in) { return dvec4(dvec3(in.a) + in.a.w, 0); }, 1e-6, 3, 4});

  sweeps.push_back({"depth_of_distance", depth_arguments(true),
                    [](const Exact &in) {
                      // In front of the eye by no less.
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

  sweeps.push_back({"log_sum",
                    many(30000,
                         [](Random &random) {
                           // Four distances, spread from nothing to 1e30 m around one up to 1 km away.
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
                      // An exponent that is off by a rounding changes the power by as much as the exponent is large.
                      // The least magnitude is that of numbers that a driver may flush to 0.
                      const double exponent = std::min(in.a.x * (in.a.y - in.a.z), 0.0);
                      return one(std::exp(exponent) * (1.0 - exponent) + 1e-30);
                    },
                    1e-6, 2, 8});

  {
    std::vector<In> encoded;
    std::vector<In> decoded;
    for (const float range : {1e-3F, 1.0F, 37.5F, 1e6F}) {
      for (const int format : {ESM_FLOAT, ESM_HALF}) {
        // Away from where a rounding decides which step is next: steps of 1/4096, and a bit.
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
         // Where the bound is steep, roundings of the difference of distances count by c / √v.
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
                      // The golden angle is rounded, and drivers' sines are not for large angles.
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
                        // The turn that takes the nearer of +Z and -Z to the axis.
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
                        // The tangent of a cosine near 1 is the root of a small difference.
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

  {
    std::vector<In> widths;
    std::vector<In> masks;
    for (int degrees = 0; degrees <= 180; degrees += 4) {
      const float drop_outer = 1.0F - std::cos(float(degrees) * 0.5F * float(std::numbers::pi) / 180.0F);
      for (const float blend : {0.0F, 1e-6F, 0.01F, 0.5F, 1.0F}) {
        widths.push_back({.a = {drop_outer, blend, 0, 0}});
        for (const float c : cosines(-1.0F)) {
          masks.push_back({.a = {1.0F - c, drop_outer, blend, 0}});
        }
        for (int i = 0; i <= 64; i++) {
          masks.push_back({.a = {drop_outer * (1.0F - blend * float(i) / 60.0F), drop_outer, blend, 0}});
        }
      }
    }
    const auto inv_width = [](const Exact &in) { return one(1.0 / std::max(in.a.x * std::max(in.a.y, 1e-6), 1e-30)); };
    sweeps.push_back({"spot_inv_width", widths, inv_width, inv_width, 0.5, 2, 6});
    const auto mask = [](const Exact &in) {
      const double width = std::max(in.a.y * std::max(in.a.z, 1e-6), 1e-30);
      const double t = std::clamp((in.a.y - in.a.x) / width, 0.0, 1.0);
      return one(t * t * (3.0 - 2.0 * t));
    };
    sweeps.push_back({"spot_mask", masks, mask, mask, 0.5, 4, 12});
  }
  sweeps.push_back({"distance_falloff",
                    many(20000,
                         [](Random &random) {
                           const float distance_sq = random.one_of(std::array{0.0F, random.log_uniform(1e-12, 1e12)});
                           const float radius_sq = random.one_of(std::array{0.0F, random.log_uniform(1e-8, 1e4)});
                           const float range = random.one_of(std::array{0.0F, random.log_uniform(1e-8, 1e8)});
                           return In{.a = {distance_sq, radius_sq, range, 0}};
                         }),
                    [](const Exact &in) {
                      const double window = 1.0 - std::pow(in.a.x * in.a.z, 2.0);
                      return one(std::max(window, 0.0) / std::max(in.a.x + in.a.y, 1e-12));
                    },
                    [](const Exact &in) {
                      // Where the window closes, a difference of two numbers near 1.
                      const double window = 1.0 - std::pow(in.a.x * in.a.z, 2.0);
                      return one(window < -1e-6 ? 0.0 : 1.0 / std::max(in.a.x + in.a.y, 1e-12));
                    },
                    0.5, 2, 4});
  sweeps.push_back(
      {"hemi_irradiance", many(2000, [](Random &random) { return In{.a = glm::vec4(random.uniform(-1, 1))}; }),
       [](const Exact &in) { return one((1.0 + in.a.x) / 2.0); }, [](const Exact &) { return one(1.0); }, 1e-6, 1, 1});

  sweeps.push_back({"octahedral_texel_weight",
                    many(5000, [](Random &random) { return In{.a = glm::vec4(random.direction(), 0)}; }),
                    [](const Exact &in) {
                      // 1 / r³ of the point of the octahedron in that direction.
                      const dvec3 point = dvec3(in.a) / (std::abs(in.a.x) + std::abs(in.a.y) + std::abs(in.a.z));
                      return one(std::pow(glm::length(point) / glm::length(dvec3(in.a)), -3.0));
                    },
                    [](const Exact &) { return one(5.2); }, 1e-6, 4, 6});
  sweeps.push_back({"octahedral_texel_angle",
                    many(5000,
                         [](Random &random) {
                           const float size = random.one_of(std::array{4.0F, 100.0F, 512.0F});
                           return In{.a = glm::vec4(random.direction(), size)};
                         }),
                    [](const Exact &in) {
                      return one(2.0 / in.a.w * std::pow(std::abs(in.a.x) + std::abs(in.a.y) + std::abs(in.a.z), 1.5));
                    },
                    [](const Exact &in) { return one(4.56 / in.a.w); }, 1e-6, 2, 4});
  sweeps.push_back({"octahedral_from_direction", direction_arguments(),
                    [](const Exact &in) {
                      const dvec3 v = dvec3(in.a) / (std::abs(in.a.x) + std::abs(in.a.y) + std::abs(in.a.z));
                      const dvec2 p = v.z < 0.0 ? folded(dvec2(v)) : dvec2(v);
                      return dvec4((p + 1.0) / 2.0, 0, 0);
                    },
                    [](const Exact &) { return dvec4(1, 1, 0, 0); }, 1e-6, 1, 3});
  sweeps.push_back({"octahedral_to_direction",
                    [] {
                      std::vector<In> arguments = many(20000, [](Random &random) {
                        return In{.a = {random.uniform(0, 1), random.uniform(0, 1), 0, 0}};
                      });
                      for (int y = 0; y <= 32; y++) {
                        for (int x = 0; x <= 32; x++) {
                          arguments.push_back({.a = {float(x) / 32.0F, float(y) / 32.0F, 0, 0}});
                        }
                      }
                      return arguments;
                    }(),
                    [](const Exact &in) {
                      const dvec2 p = dvec2(in.a) * 2.0 - 1.0;
                      const double z = 1.0 - std::abs(p.x) - std::abs(p.y);
                      return dvec4(glm::normalize(dvec3(z < 0.0 ? folded(p) : p, z)), 0);
                    },
                    [](const Exact &) { return dvec4(1, 1, 1, 0); }, 1e-6, 2, 6});
  {
    std::vector<In> arguments;
    for (const int size : {1, 2, 3, 8, 17}) {
      for (int y = -size; y < 2 * size; y++) {
        for (int x = -size; x < 2 * size; x++) {
          arguments.push_back({.a = {x, y, size, 0}});
        }
      }
    }
    // Integers.
    sweeps.push_back({"octahedral_texel", arguments,
                      [](const Exact &in) { return dvec4(continued_texel(dvec2(in.a), in.a.z), 0, 0); },
                      [](const Exact &) { return dvec4(1, 1, 0, 0); }, 0, 0, 0});
  }

  // Components chosen and negated: exact.
  sweeps.push_back({"cube_face", direction_arguments(),
                    [](const Exact &in) {
                      int face = 0;
                      for (int i = 0; i < 6; i++) {
                        const double along = i % 2 == 0 ? in.a[i / 2] : -in.a[i / 2];
                        const double largest = face % 2 == 0 ? in.a[face / 2] : -in.a[face / 2];
                        face = along > largest ? i : face;
                      }
                      // Ties go to the earlier axis, whichever its sign.
                      for (int axis = 2; axis >= 0; axis--) {
                        if (std::abs(in.a[axis]) == std::abs(in.a[face / 2])) {
                          face = 2 * axis + (in.a[axis] < 0.0 ? 1 : 0);
                        }
                      }
                      return one(face);
                    },
                    [](const Exact &) { return one(1.0); }, 0, 0, 0});
  sweeps.push_back({"cube_face_project",
                    many(6000,
                         [](Random &random) {
                           return In{.a = glm::vec4(random.box(1e6), random.one_of(std::array{0, 1, 2, 3, 4, 5}))};
                         }),
                    [](const Exact &in) { return dvec4(cube_coordinates(int(in.a.w), dvec3(in.a)), 0); },
                    [](const Exact &) { return dvec4(1, 1, 1, 0); }, 0, 0, 0});
  sweeps.push_back({"cube_uv_scale",
                    many(2000,
                         [](Random &random) {
                           return In{.a = {std::floor(random.log_uniform(1, 16384)), 0, 0, 0}};
                         }),
                    // Three texels of the border on each side, of small faces an eighth.
                    [](const Exact &in) { return one(in.a.x < 24.0 ? 0.75 : (in.a.x - 6.0) / in.a.x); },
                    [](const Exact &) { return one(1.0); }, 0.5, 1, 2});
  sweeps.push_back({"shadow_lift",
                    many(5000,
                         [](Random &random) {
                           return In{.a = {random.log_uniform(1e-6, 1e3), random.uniform(1, 3),
                                           random.log_uniform(1e-9, 1.0), random.log_uniform(1e-3, 1e6)}};
                         }),
                    [](const Exact &in) { return one(in.a.x * in.a.y / 10.0 + in.a.z + in.a.w / 1e6); },
                    [](const Exact &in) { return one(in.a.x * in.a.y / 10.0 + in.a.z + in.a.w / 1e6); }, 0.5, 2, 3});
  sweeps.push_back(
      {"plane_depths",
       many(10000,
            [](Random &random) {
              return In{{random.uniform(0, 1), random.uniform(-1, 1), random.uniform(-1, 1), 0},
                        {random.uniform(-4, 3), random.uniform(-4, 3), 0, 0}};
            }),
       [](const Exact &in) {
         // The plane's depth at a texel's centre, from the lookup's.
         const auto at = [&](double x, double y) { return in.a.x + in.a.y * (x + in.b.x) + in.a.z * (y + in.b.y); };
         return dvec4(at(0, 1), at(1, 1), at(1, 0), at(0, 0));
       },
       [](const Exact &in) { return dvec4(in.a.x + 5.0 * std::abs(in.a.y) + 5.0 * std::abs(in.a.z)); }, 1e-6, 2, 2});
  sweeps.push_back({"texels_lit",
                    many(10000,
                         [](Random &random) {
                           // Few levels, so that many are equal; a receiver may be behind the far end.
                           const std::array<float, 4> levels = {0.0F, 0.25F, 0.5F, 0.75F};
                           In in;
                           for (int i = 0; i < 4; i++) {
                             in.a[i] = random.one_of(levels);
                             in.b[i] = random.one_of(levels) - 0.25F;
                           }
                           return in;
                         }),
                    [](const Exact &in) {
                      dvec4 lit(0.0);
                      for (int i = 0; i < 4; i++) {
                        lit[i] = in.a[i] <= std::max(in.b[i], 0.0) ? 1.0 : 0.0;
                      }
                      return lit;
                    },
                    [](const Exact &) { return dvec4(1.0); }, 0, 0, 0});
  sweeps.push_back({"weighted_texels",
                    many(10000,
                         [](Random &random) {
                           const auto unit = [&] { return random.uniform(0, 1); };
                           return In{{unit(), unit(), unit(), unit()}, {unit(), unit(), unit(), unit()}};
                         }),
                    [](const Exact &in) {
                      // textureGather's order: (0, 1), (1, 1), (1, 0), (0, 0); columns in xy, rows in zw.
                      return one(in.a.x * in.b.x * in.b.w + in.a.y * in.b.y * in.b.w + in.a.z * in.b.y * in.b.z +
                                 in.a.w * in.b.x * in.b.z);
                    },
                    [](const Exact &) { return one(4.0); }, 1e-6, 2, 2});
  sweeps.push_back({"vogel_disk",
                    many(3000,
                         [](Random &random) {
                           const float count = std::floor(random.uniform(1, 64.9));
                           return In{.a = {std::floor(random.uniform(0, count - 0.01)), count, 0, 0}};
                         }),
                    [](const Exact &in) {
                      // The golden angle: 2 pi (1 - 1 / golden ratio).
                      const double angle = in.a.x * std::numbers::pi * (3.0 - std::sqrt(5.0));
                      const double radius = std::sqrt((in.a.x + 0.5) / in.a.y);
                      return dvec4(radius * std::cos(angle), radius * std::sin(angle), 0, 0);
                    },
                    // The angle's constant has seven digits; drivers' sines are good to 1e-5 or so.
                    [](const Exact &in) { return dvec4(1, 1, 0, 0) * (10.0 + in.a.x); }, 1, 100, 400});
  {
    std::vector<In> arguments = many(5000, [](Random &random) {
      const float sign = random.one_of(std::array{-1.0F, 1.0F});
      return In{.a = {random.uniform(-10, 10), sign * random.log_uniform(1e-36, 1e10), 0, 0}};
    });
    arguments.push_back({.a = {1, 0, 0, 0}});
    arguments.push_back({.a = {0, 0, 0, 0}});
    arguments.push_back({.a = {1, -0.0F, 0, 0}});
    const auto truth = [](const Exact &in) { return one(std::abs(in.a.y) > double(1e-30F) ? in.a.x / in.a.y : 0.0); };
    sweeps.push_back({"slope_quotient", arguments, truth, truth, 1e-6, 1, 4});
  }

  {
    std::vector<In> arguments;
    for (int i = 0; i <= 4096; i++) {
      arguments.push_back({.a = glm::vec4(float(i) / 4096.0F)});
    }
    for (int i = -50; i <= 50; i++) {
      arguments.push_back({.a = glm::vec4(0.0031308F + float(i) * 1e-7F)});
    }
    // Literals are floats.
    sweeps.push_back({"srgb_encoded", arguments, [](const Exact &in) { return one(srgb(in.a.x)); },
                      [](const Exact &) { return one(1.0); }, 0.5, 2, 16});
    sweeps.push_back({"agx_curve", std::vector<In>(arguments.begin(), arguments.begin() + 4097),
                      [](const Exact &in) { return one(agx_curve_exact(in.a.x)); },
                      // The terms' size, not the sum's: they cancel.
                      [](const Exact &) { return one(32.0); }, 0.5, 1, 4});
    const auto lights = many(10000, [](Random &random) {
      const auto light = [&] { return random.log_uniform(1e-5, 1e3); };
      return In{.a = glm::vec4(light(), light(), light(), 0.0F)};
    });
    // The curve's terms cancel, and the outset's rows amplify what is left by 1.3 and 2.2.
    sweeps.push_back({"agx", lights, [](const Exact &in) { return dvec4(agx_exact(dvec3(in.a)), 0); },
                      [](const Exact &) { return dvec4(64, 64, 64, 0); }, 1, 2, 8});
    sweeps.push_back({"pbr_neutral", lights, [](const Exact &in) { return dvec4(pbr_neutral_exact(dvec3(in.a)), 0); },
                      // Small channels keep the rounding of what is subtracted from them.
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
  return sweeps;
}

}  // namespace

const std::vector<Sweep> &sweeps()
{
  static const std::vector<Sweep> all = make_sweeps();
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

}  // namespace gnomon::measure
