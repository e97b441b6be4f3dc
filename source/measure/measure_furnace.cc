// SPDX-License-Identifier: MIT
#include "measure_furnace.hh"

#include "measure_light.hh"

#include "reference_multiscatter.hh"
#include "scene_parallel.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

// From here on `float` is double.
#define SHARED_DOUBLE
#include "eevee_multiscatter_shared.h"
#include "eevee_shape_shared.h"

namespace gnomon::measure {

namespace {

using shared_double::LobeAlbedo;
using shared_double::Multiscatter;

using std::numbers::pi;
constexpr std::array<double, 9> roughnesses = {0.03, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 1.0};
/** Cosines of the view to the normal. */
constexpr std::array<double, 7> views = {1.0, 0.9, 0.7, 0.5, 0.3, 0.15, 0.05};

LobeAlbedo albedo_at(double alpha, double cosine)
{
  return shared_double::lobe_albedo(multiscatter_texel(alpha, cosine), alpha, cosine);
}

/** A white surface and its view. All channels are equal. */
struct Furnace {
  double alpha;
  /** Reflectance at normal incidence; 1 at grazing incidence. */
  glm::dvec3 f0;
  glm::dvec3 diffuse;
  glm::dvec3 view;
  Multiscatter multiscatter;

  Furnace(bool is_metal, double roughness, double cos_v)
      : alpha(std::max(roughness * roughness, double(shared_double::ALPHA_MIN))),
        f0(is_metal ? 1.0 : 0.04),
        diffuse(is_metal ? 0.0 : 1.0),
        view(std::sqrt((1.0 - cos_v) * (1.0 + cos_v)), 0.0, cos_v),
        multiscatter(shared_double::make_multiscatter(multiscatter_texel(alpha, cos_v), alpha, cos_v, f0, 1.0))
  {
  }

  /** Specular light of a single scattering. */
  [[nodiscard]] double specular() const
  {
    const reference::LobeIntegrals lobe = reference::integrated_lobe(alpha, view.z);
    return f0.x * (1.0 - lobe.missing) + (1.0 - f0.x) * lobe.schlick;
  }
  /** All other light. Most directions are near the horizon, where the albedo of smooth surfaces changes. */
  [[nodiscard]] double smooth(int count, bool is_multi) const
  {
    double sum = 0.0;
    for (int i = 0; i < count; i++) {
      const double t = (i + 0.5) / count;
      const double cos_l = t * t * t;
      const double weight = 2.0 * cos_l * 3.0 * t * t / count;
      if (is_multi) {
        sum += weight * pi * smooth_brdf(albedo_at(alpha, cos_l));
        continue;
      }
      const double sin_l = std::sqrt((1.0 - cos_l) * (1.0 + cos_l));
      for (int j = 0; j < count; j++) {
        const double angle = pi * (j + 0.5) / count;
        const glm::dvec3 light(sin_l * std::cos(angle), sin_l * std::sin(angle), cos_l);
        const double kept = 1.0 - fresnel(glm::dot(view, glm::normalize(light + view)));
        sum += weight * diffuse.x * kept / count;
      }
    }
    return sum;
  }
  /** With multiple scattering, under a sun whose angle is π and whose radiance is 1. */
  [[nodiscard]] double under_sun() const
  {
    // The largest extent of a sun in light_shape_block.
    const double extent = std::tan(1.57);
    const LampShape sun{
        .outline = LampOutline::Round, .center = {0, 0, 1}, .axis_x = {extent, 0, 0}, .axis_y = {0, extent, 0}};
    const double form_factor = whole_diffuse(sun);
    const LobeAlbedo light = shared_double::albedo_over_lamp(albedo_at(alpha, 1.0), multiscatter.mean, form_factor);
    const WholeSpecular specular = whole_specular(sun, {alpha, view});
    const double across = glm::dot(view, glm::normalize(specular.to_light + view));
    const double albedo = shared_double::single_albedo(multiscatter.view, f0, 1.0).x;
    return glm::mix(fresnel(across) * specular.by_ratio, albedo * specular.covered, specular.covered) +
           pi * form_factor * smooth_brdf(light);
  }

 private:
  [[nodiscard]] double fresnel(double across) const
  {
    return shared_double::fresnel_schlick(f0, 1.0, across).x;
  }
  [[nodiscard]] double smooth_brdf(const LobeAlbedo &light) const
  {
    return shared_double::smooth_brdf(multiscatter, light, diffuse, f0, 1.0).x;
  }
};

void include(FurnaceRange &range, double value)
{
  range.least = std::min(range.least, value);
  range.largest = std::max(range.largest, value);
}

}  // namespace

std::vector<FurnaceRow> white_furnace(int point_count)
{
  std::vector<FurnaceRow> rows(2 * roughnesses.size());
  scene::parallel_for(rows.size(), 0, [&](std::size_t i) {
    const bool is_metal = i < roughnesses.size();
    FurnaceRow &row = rows[i];
    row.material = is_metal ? "metal" : "dielectric";
    row.roughness = roughnesses[i % roughnesses.size()];
    row.single = row.multi = row.multi_sun = {HUGE_VAL, -HUGE_VAL};
    for (const double cos_v : views) {
      const Furnace furnace(is_metal, row.roughness, cos_v);
      const double specular = furnace.specular();
      include(row.single, specular + furnace.smooth(point_count, false));
      include(row.multi, specular + furnace.smooth(point_count, true));
      include(row.multi_sun, furnace.under_sun());
    }
  });
  return rows;
}

}  // namespace gnomon::measure
