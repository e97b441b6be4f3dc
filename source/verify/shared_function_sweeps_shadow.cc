// SPDX-License-Identifier: MIT
#include "internal/shared_function_sweeps.hh"

#include <algorithm>
#include <numbers>

namespace gnomon::verify {

namespace {

/** \a p mirrored on the edge of the diamond |x| + |y| = 1 in its quadrant. */
dvec2 folded(dvec2 p)
{
  const dvec2 sign(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
  return p - (glm::dot(sign, p) - 1.0) * sign;
}

/** OpenGL 4.5 core, table 8.19: sc, tc and ma of a face, as signed components of \a v. */
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

/**
 * The texel of the map that continues the map at \a texel outside of it, computed by reflecting points of the plane
 * instead of indices.
 */
dvec2 continued_texel(dvec2 texel, double size)
{
  dvec2 p = (texel + 0.5) / size * 2.0 - 1.0;
  for (int axis = 0; axis < 2; axis++) {
    if (std::abs(p[axis]) > 1.0) {
      // A point beyond the edge corresponds to the point at the same distance within, on the other side of the edge's
      // middle.
      p[axis] = std::copysign(2.0, p[axis]) - p[axis];
      p[1 - axis] = -p[1 - axis];
    }
  }
  return glm::floor((p + 1.0) * 0.5 * size);
}

}  // namespace

void add_shadow_sweeps(std::vector<Sweep> &sweeps)
{
  sweeps.push_back({"octahedral_texel_weight",
                    many(5000, [](Random &random) { return In{.a = glm::vec4(random.direction(), 0)}; }),
                    [](const Exact &in) {
                      // 1 / r³ for the point of the octahedron in that direction.
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
    // Results are integers, so they are exact.
    sweeps.push_back({"octahedral_texel", arguments,
                      [](const Exact &in) { return dvec4(continued_texel(dvec2(in.a), in.a.z), 0, 0); },
                      [](const Exact &) { return dvec4(1, 1, 0, 0); }, 0, 0, 0});
  }

  // Components are selected and negated, so results are exact.
  sweeps.push_back({"cube_face", direction_arguments(),
                    [](const Exact &in) {
                      int face = 0;
                      for (int i = 0; i < 6; i++) {
                        const double along = i % 2 == 0 ? in.a[i / 2] : -in.a[i / 2];
                        const double largest = face % 2 == 0 ? in.a[face / 2] : -in.a[face / 2];
                        face = along > largest ? i : face;
                      }
                      // In a tie the earlier axis wins, for either sign.
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
                    // Three border texels on each side; for small faces an eighth of the face.
                    [](const Exact &in) { return one(in.a.x < 24.0 ? 0.75 : (in.a.x - 6.0) / in.a.x); },
                    [](const Exact &) { return one(1.0); }, 0.5, 1, 2});
  sweeps.push_back({"shadow_normal_offset",
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
         // Depth of the plane at a texel's centre, relative to the lookup's position.
         const auto at = [&](double x, double y) { return in.a.x + in.a.y * (x + in.b.x) + in.a.z * (y + in.b.y); };
         return dvec4(at(0, 1), at(1, 1), at(1, 0), at(0, 0));
       },
       [](const Exact &in) { return dvec4(in.a.x + 5.0 * std::abs(in.a.y) + 5.0 * std::abs(in.a.z)); }, 1e-6, 2, 2});
  sweeps.push_back({"texels_lit",
                    many(10000,
                         [](Random &random) {
                           // Few levels, so that many are equal. A receiver may be behind the far end.
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
  const std::vector<In> points = many(3000, [](Random &random) {
    const float count = std::floor(random.uniform(1, 64.9));
    return In{.a = {std::floor(random.uniform(0, count - 0.01)), count, 0, 0}};
  });
  sweeps.push_back({"vogel_radius", points, [](const Exact &in) { return one(std::sqrt((in.a.x + 0.5) / in.a.y)); },
                    [](const Exact &) { return one(1.0); }, 1e-6, 2, 4});
  sweeps.push_back({"vogel_disk", points,
                    [](const Exact &in) {
                      // The golden angle: 2 pi (1 - 1 / golden ratio).
                      const double angle = in.a.x * std::numbers::pi * (3.0 - std::sqrt(5.0));
                      const double radius = std::sqrt((in.a.x + 0.5) / in.a.y);
                      return dvec4(radius * std::cos(angle), radius * std::sin(angle), 0, 0);
                    },
                    // The constant of the angle has seven digits; drivers' sines are accurate to about 1e-5.
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
}

}  // namespace gnomon::verify
