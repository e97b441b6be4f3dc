// SPDX-License-Identifier: MIT
#include "internal/shared_function_sweeps.hh"

#include <algorithm>
#include <limits>
#include <numbers>

namespace gnomon::verify {

namespace {

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

/** 1 - 1 / √(1 + alpha² / cos²), without cancellation. */
double missing_scale(double alpha, double cosine)
{
  return cosine > 0.0 ? -std::expm1(-0.5 * std::log1p(alpha * alpha / (cosine * cosine))) : 1.0;
}

/**
 * Solid angle of two triangles that share a diagonal (van Oosterom and Strackee 1983, eq. 8), in long double because of
 * its cancellation.
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

/** Change of the solid angle if the corners move by their own magnitude: the factor of their rounding errors. */
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
  // The gradient is the magnetic field of a current along the rim (Biot and Savart): near the rim that of a long wire,
  // and at most the rim's length over the squared distance.
  const double size = glm::length(right) + glm::length(up);
  return (glm::length(center) + size) * std::min(2.0 / rim, 4.0 * size / (rim * rim));
}

/** The distance that stands for the intersection of parallels. */
constexpr double line_far = 1e16F;

double ggx_distribution(double c, double alpha)
{
  const double t = c * c * (alpha * alpha - 1.0) + 1.0;
  return alpha * alpha / (std::numbers::pi * t * t);
}

double ggx_masking(double c, double alpha)
{
  // Walter et al. 2007, eq. 34, in terms of the tangent.
  return 2.0 / (1.0 + std::sqrt(1.0 + alpha * alpha * (1.0 - c * c) / (c * c)));
}

}  // namespace

void add_light_sweeps(std::vector<Sweep> &sweeps)
{
  // The magnitude includes both dot products, whose terms may cancel.
  sweeps.push_back({"line_plane_distance",
                    many(20000,
                         [](Random &random) {
                           const glm::vec3 point = random.box(100.0);
                           In in{glm::vec4(random.box(100.0), point.x), glm::vec4(random.direction(), point.y),
                                 glm::vec4(random.direction(), point.z)};
                           if (random.uniform(0, 1) < 0.05F) {
                             // Parallel or nearly parallel, in some cases within the plane.
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

  // Driver: Mesa's atan is a polynomial with a relative error of 2e-5 (Vulkan allows 5e-4).
  sweeps.push_back({"rectangle_solid_angle",
                    [] {
                      std::vector<In> arguments = many(40000, [](Random &random) {
                        // Along axes, so that the edges are exactly orthogonal, or rotated, so that they are to 1e-7.
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

  // Only sums of positive terms: relative errors of a few roundings.
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

  {
    std::vector<In> arguments;
    for (const float c : cosines(0.0F)) {
      for (const float alpha : alphas) {
        arguments.push_back({.a = {alpha, c, 0, 0}});
      }
    }
    const auto scale = [](const Exact &in) { return one(missing_scale(in.a.x, in.a.y)); };
    sweeps.push_back({"missing_scale", arguments, scale, scale, 1e-6, 6, 12});
    // The first coordinate is a difference of roots. The constants are rounded to float in double, too.
    sweeps.push_back(
        {"multiscatter_place", arguments,
         [](const Exact &in) {
           const double least = std::sqrt(double(1e-3F));
           const double twice = 2.0 * in.a.x;
           return dvec4((std::sqrt(in.a.x) - least) / (1.0 - least),
                        0.625 * (1.0 + twice) / (1.0 + twice / std::max(in.a.y, 1e-300)) + 0.375 * in.a.y, 0, 0);
         },
         [](const Exact &in) {
           return dvec4(std::sqrt(in.a.x) + std::sqrt(double(1e-3F)), 1e-30 + in.a.y + in.a.y / in.a.x, 0, 0);
         },
         1e-6, 4, 8});
  }
  sweeps.push_back({"lobe_albedo",
                    many(20000,
                         [](Random &random) {
                           return In{.a = {random.uniform(0.06, 2.4), random.uniform(0.0, 0.5), 0, 0},
                                     .b = {random.one_of(alphas), random.uniform(0.0, 1.0), 0, 0}};
                         }),
                    [](const Exact &in) {
                      const double root = std::clamp(1.0 - (in.b.y + in.a.y), 0.0, 1.0);
                      return dvec4(std::min(in.a.x * missing_scale(in.b.x, in.b.y), 1.0), std::pow(root, 5.0), 0, 0);
                    },
                    // The fifth power of a difference that may be near 0.
                    [](const Exact &in) { return dvec4(in.a.x * missing_scale(in.b.x, in.b.y), 1, 0, 0); }, 1e-6, 8,
                    16});
  sweeps.push_back({"multiscatter_color",
                    many(20000,
                         [](Random &random) {
                           const glm::vec3 f0(random.uniform(0, 1), random.log_uniform(1e-6, 1),
                                              random.one_of(std::array{0.0F, 1.0F}));
                           return In{glm::vec4(f0, random.one_of(std::array{0.0F, 0.5F, 1.0F})),
                                     glm::vec4(random.log_uniform(1e-6, 0.7))};
                         }),
                    [](const Exact &in) {
                      // The series of reflections.
                      const dvec3 fresnel = (20.0 * dvec3(in.a) + in.a.w) / 21.0;
                      dvec3 light = fresnel * fresnel * (1.0 - in.b.x);
                      dvec3 sum(0.0);
                      for (int i = 0; i < 150; i++) {
                        sum += light;
                        light *= fresnel * in.b.x;
                      }
                      return dvec4(sum, 0);
                    },
                    // The difference of f90 and f0 may cancel with f0.
                    [](const Exact &in) { return dvec4(dvec3(in.a) + in.a.w, 0); }, 0.5, 8, 12});
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
                      // Where the window closes, the result is a difference of two numbers near 1.
                      const double window = 1.0 - std::pow(in.a.x * in.a.z, 2.0);
                      return one(window < -1e-6 ? 0.0 : 1.0 / std::max(in.a.x + in.a.y, 1e-12));
                    },
                    0.5, 2, 4});
  sweeps.push_back(
      {"hemi_irradiance", many(2000, [](Random &random) { return In{.a = glm::vec4(random.uniform(-1, 1))}; }),
       [](const Exact &in) { return one((1.0 + in.a.x) / 2.0); }, [](const Exact &) { return one(1.0); }, 1e-6, 1, 1});
}

}  // namespace gnomon::verify
