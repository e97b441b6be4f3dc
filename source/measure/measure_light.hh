// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <string>
#include <vector>

/**
 * Light of a lamp with an extent, as one frame approximates it, and its numerical integration. There are no shadows.
 *
 * The shaded point is the origin of a surface with the normal +z. All results are radiances for a lamp with a radiance
 * of 1. The specular lobe is GGX with Fresnel terms of 1; the diffuse one is Lambertian with an albedo of 1.
 */
namespace gnomon::measure {

enum class LampOutline {
  /** A point lamp, spot or sun: a disk that is turned to the shaded point. */
  Round,
  Rectangle,
  Ellipse,
};

/** A lamp, relative to the shaded point. Its outline is center ± axis_x ± axis_y, or the ellipse of these half axes. */
struct LampShape {
  LampOutline outline = LampOutline::Rectangle;
  glm::dvec3 center{0.0, 0.0, 1.0};
  /** Orthogonal to each other, metres. Round: of equal length, and orthogonal to `center`. */
  glm::dvec3 axis_x{1.0, 0.0, 0.0};
  glm::dvec3 axis_y{0.0, 1.0, 0.0};

  /** m² */
  [[nodiscard]] double area() const;
};

/** A specular lobe, as seen from \a view. */
struct SpecularLobe {
  /** GGX alpha: roughness², at least ALPHA_MIN. */
  double alpha = 1.0;
  /** Unit vector towards the viewer, with y = 0 and z > 0. */
  glm::dvec3 view{0.0, 0.0, 1.0};
};

struct Integral {
  double value = 0.0;
  /** Standard error of the value, from its spread over independent point sets. */
  double standard_error = 0.0;
};

/** Number of independent point sets of an integral. */
inline constexpr int integral_set_count = 8;

/**
 * The integral of a lobe over the part of a lamp above the horizon: the sum over points of the lamp and directions of
 * the lobe, each weighted by the density of both (Veach and Guibas 1995, the balance heuristic). The points are
 * Owen-scrambled Sobol sequences, so that the result is always the same. \a point_count: of each set and kind, above 0.
 */
[[nodiscard]] Integral integrated_diffuse(const LampShape &lamp, int point_count);
[[nodiscard]] Integral integrated_specular(const LampShape &lamp, const SpecularLobe &lobe, int point_count);

struct WholeSpecular {
  double light = 0.0;
  /** The part of it that the transformed cosine alone gives; for a lamp that is small relative to the lobe, all of it.
   */
  double by_ratio = 0.0;
  /** Mean direction of the light that is reflected, for the Fresnel term. Unit vector; zero if there is no light. */
  glm::dvec3 to_light{0.0};
  /** Part of the lobe that the lamp covers. */
  double covered = 0.0;
};

/** The engine's formulas: the form factor, and linearly transformed cosines. \see eevee_lamp_shape_lib.glsl */
[[nodiscard]] double whole_diffuse(const LampShape &lamp);
[[nodiscard]] WholeSpecular whole_specular(const LampShape &lamp, const SpecularLobe &lobe);
/** The engine's formula with multiple scattering, without the light that is scattered again. */
[[nodiscard]] double whole_specular_multi(const LampShape &lamp, const SpecularLobe &lobe);

/**
 * Baselines, which the engine does not use. Diffuse: all light comes from the centre. Specular: all light comes from
 * the point of the lamp that is nearest to the dominant direction of the lobe, from a lobe that is as much dimmer as
 * the extent of the lamp would widen it (Karis 2013, Real Shading in Unreal Engine 4). For flat lamps, the solid angle
 * stands for the extent.
 */
[[nodiscard]] double point_diffuse(const LampShape &lamp);
[[nodiscard]] double point_specular(const LampShape &lamp, const SpecularLobe &lobe);

/** The texel of `ltc_table` at \a texco, filtered as the device does. \see ltc_texco */
[[nodiscard]] glm::vec4 ltc_texel(const glm::vec2 &texco);

/** The texel of `multiscatter_table`, filtered as the device does. \see multiscatter_place */
[[nodiscard]] glm::vec4 multiscatter_texel(double alpha, double cosine);

/** Errors of an approximation over some cases. */
struct LightErrors {
  double median = 0.0;
  /** The error that 95 % of the cases do not exceed. */
  double p95 = 0.0;
  double largest = 0.0;
  /** Cases whose result is not finite or is negative. The other members do not count them. */
  std::size_t bad_count = 0;
};

/** One row of the table: all cases in which one parameter has one value. */
struct LightErrorRow {
  /** "diffuse" or "specular". */
  std::string light{};
  /** "all", "outline", "roughness", "view", "elevation", "size" or "distance". */
  std::string parameter{};
  /** With its unit. */
  std::string value{};
  std::size_t case_count = 0;
  /** Largest standard error of an integral, in units of the errors. */
  double integral_error = 0.0;
  /** whole_diffuse or whole_specular. */
  LightErrors whole{};
  /** whole_diffuse or whole_specular_multi. */
  LightErrors multi{};
  /** point_diffuse or point_specular. */
  LightErrors point{};
};

/**
 * The errors for lamps of each outline, of three sizes and at three distances, that face the shaded point from four
 * elevations; for specular light also from three azimuths, and for lobes of five roughnesses and four views. An error
 * is the distance to the integral, relative to the integral, or to 1 % of the largest integral of the same lamp, size,
 * distance and roughness if that is more. \a point_count: see integrated_specular.
 */
[[nodiscard]] std::vector<LightErrorRow> light_errors(int point_count);

}  // namespace gnomon::measure
