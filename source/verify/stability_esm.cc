// SPDX-License-Identifier: MIT
// Exponential shadow maps: forms that overflow when stored and filtered, and the engine's form over the same ranges.
#include "internal/stability_cases.hh"

#include "eevee_esm_shared.h"
#include "eevee_octahedral_shared.h"
#include "shadows/shadow_octahedral_store.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

namespace gnomon::verify {

namespace {

constexpr const char *esm_group = "esm";
/** Exponents, 1/m: the limits for a lamp, and 5 and 80 of the two seeds. */
constexpr std::array<float, 5> exponents = {0.01F, 1.0F, 5.0F, 80.0F, 1e4F};
/** Largest x with a finite exp(x) in float and in half. */
constexpr double float_limit = 88.7228391;
constexpr double half_limit = 11.0901;
/**
 * Error bound for 32 taps, in float's epsilon times (farthest distance + 1 / exponent). The sum has 32 additions and as
 * many rescalings; its logarithm is divided by the exponent, and the distance is rounded. Measured: 4.6.
 */
constexpr double filter_bound = 8.0;

enum class Form { Naive, Unsafe, Safe };

using Taps = std::vector<float>;

/** Taps from the nearest to the farthest, the worst order for a running sum. */
Taps taps_from(double nearest, double spread, int count)
{
  Taps taps;
  for (int i = 0; i < count; i++) {
    taps.push_back(float(nearest + spread * i / (count - 1)));
  }
  return taps;
}

double exactly_filtered(const Taps &taps, double exponent)
{
  const long double highest = *std::ranges::max_element(taps);
  long double sum = 0.0L;
  for (const float tap : taps) {
    sum += std::exp((tap - highest) * exponent);
  }
  return double(highest + std::log(sum / static_cast<long double>(taps.size())) / exponent);
}

float rounded_to_half(float value)
{
  return glm::unpackHalf1x16(glm::packHalf1x16(value));
}

/** Filtered distance of a layer, metres. */
float filtered(Form form, bool is_half, const Taps &taps, float exponent)
{
  const float weight = 1.0F / float(taps.size());
  switch (form) {
    case Form::Naive: {
      float sum = 0.0F;
      for (const float tap : taps) {
        sum += weight * std::exp(exponent * tap);
      }
      return std::log(is_half ? rounded_to_half(sum) : sum) / exponent;
    }
    case Form::Unsafe: {
      // Subtracts the first tap instead of the largest.
      float sum = 0.0F;
      for (const float tap : taps) {
        sum += weight * std::exp(exponent * (tap - taps[0]));
      }
      return taps[0] + std::log(sum) / exponent;
    }
    default: {
      shared::LogSum sum = shared::log_sum_begin(taps[0], weight);
      for (std::size_t i = 1; i < taps.size(); i++) {
        sum = shared::log_sum_add(sum, exponent, taps[i], weight);
      }
      const float value = shared::log_sum_value(sum, exponent);
      const float range = 1.01F * *std::ranges::max_element(taps);
      const int format = is_half ? ESM_HALF : ESM_FLOAT;
      return shared::esm_decoded(shared::esm_encoded(value, range, format), range, format);
    }
  }
}

double filter_error(Form form, bool is_half, const Taps &taps, float exponent)
{
  const double difference =
      std::abs(double(filtered(form, is_half, taps, exponent)) - exactly_filtered(taps, double(exponent)));
  const double farthest = *std::ranges::max_element(taps);
  const double rounded = float_epsilon * (farthest + 1.0 / double(exponent));
  // Half floats: in units of the format's largest error plus the filter's.
  return is_half ? difference / (shared::esm_format_error(1.01F * float(farthest), ESM_HALF) + filter_bound * rounded)
                 : difference / rounded;
}

double filter_bound_of(bool is_half)
{
  return is_half ? 1.0 : filter_bound;
}

const char *filter_unit_of(bool is_half)
{
  return is_half ? "half steps of 16 bits, and the filter's bound" : epsilon_unit;
}

const char *storage_name(bool is_half)
{
  return is_half ? "16f" : "32f";
}

/** Pairs of a baseline and the engine's form over the same range. */
void add_filter_cases(std::vector<StabilityCase> &cases)
{
  const auto add = [&](Form form, bool is_half, float exponent, const std::string &swept_name,
                       const std::string &parameter, int count, std::vector<double> steps, auto taps_at) {
    const char *form_name = form == Form::Naive ? "naive" : form == Form::Unsafe ? "unsafe log" : "safe";
    cases.push_back(
        {.group = esm_group,
         .name = fmt::format("{} {} {:g}/m, {}", form_name, storage_name(is_half), exponent, swept_name),
         .quantity = fmt::format("filtered distance of a layer for {} taps", count),
         .parameter = parameter,
         .reference = "long double",
         .unit = filter_unit_of(is_half),
         .bound = filter_bound_of(is_half),
         .is_baseline = form != Form::Safe,
         .run = swept(std::move(steps), [=](double x) { return filter_error(form, is_half, taps_at(x), exponent); })});
  };
  for (const float exponent : exponents) {
    for (const bool is_half : {false, true}) {
      const double limit = (is_half ? half_limit : float_limit) / double(exponent);
      for (const Form form : {Form::Naive, Form::Safe}) {
        add(form, is_half, exponent, "limit of exp(c z)", "distance, m", 2, even_steps(0.01 * limit, 2.0 * limit, 200),
            [](double z) { return taps_from(z, 0.0, 2); });
      }
      add(Form::Safe, is_half, exponent, "any distance", "distance, m", 32, log_steps(1e-3, 1e6, 181),
          [=](double z) { return taps_from(z, 0.25 * z, 32); });
      add(Form::Safe, is_half, exponent, "any spread", "spread of the taps, m", 32, log_steps(1e-3, 1e6, 181),
          [](double spread) { return taps_from(1.0, spread, 32); });
    }
    const double limit = float_limit / double(exponent);
    for (const Form form : {Form::Unsafe, Form::Safe}) {
      add(form, false, exponent, "limit of the spread", "spread of the taps, m", 2,
          even_steps(0.01 * limit, 2.0 * limit, 200), [=](double spread) { return taps_from(0.0, spread, 2); });
    }
  }
}

/** Error of the visibility due to 16 bits: with linear distances, and with the format that the engine selects. */
void add_format_cases(std::vector<StabilityCase> &cases)
{
  for (const float exponent : exponents) {
    const auto worst_error = [=](float range, auto stored) {
      double worst = 0.0;
      for (int i = 1; i <= 64; i++) {
        // Values between the format's steps.
        const float distance = range * (float(i) - 0.37F) / 64.0F;
        worst = std::max(worst, 1.0 - double(shared::esm_visibility(exponent, stored(distance), distance)));
      }
      return worst;
    };
    const StabilityCase common{.group = esm_group,
                               .name = "",
                               .quantity = "visibility of a lit receiver, from a stored distance",
                               .parameter = "range of the lamp, m",
                               .reference = "closed form: 1",
                               .unit = "visibility",
                               .bound = double(eevee::esm_half_error_max),
                               .run = {}};
    StabilityCase linear = common;
    linear.name = fmt::format("linear halves 16f {:g}/m", exponent);
    linear.is_baseline = true;
    linear.run = swept(log_steps(1e-3, 1e6, 91), [=](double range) {
      // Beyond 65504 m a half is infinite. This makes the stored value non-finite, while the visibility saturates.
      const auto farthest = double(rounded_to_half(float(range)));
      return std::isfinite(farthest) ? worst_error(float(range), rounded_to_half) : farthest;
    });
    cases.push_back(linear);
    StabilityCase chosen = common;
    chosen.name = fmt::format("format as chosen {:g}/m", exponent);
    chosen.run = [=] {
      const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
      eevee::ShaderCache shaders;
      eevee::OctahedralStore store;
      return swept(log_steps(1e-3, 1e6, 91), [&](double range) {
        const eevee::EsmLamp lamp{"lamp", float(range), {.exponent = exponent, .size_px = 4}};
        store.sync(*device, shaders, {&lamp, 1});
        const shared::EsmData &data = store.data(0);
        return worst_error(data.range, [&](float distance) {
          return shared::esm_decoded(shared::esm_encoded(distance, data.range, data.format), data.range, data.format);
        });
      })();
    };
    cases.push_back(chosen);
  }
}

/** Variance Σ w·e² / (Σ w·e)² - 1 of 32 taps with e = exp(c·z). */
void add_variance_cases(std::vector<StabilityCase> &cases)
{
  constexpr int count = 32;
  constexpr float weight = 1.0F / count;
  const auto exact = [](const Taps &taps, float exponent) {
    const long double highest = *std::ranges::max_element(taps);
    long double sum = 0.0L;
    long double squares = 0.0L;
    for (const float tap : taps) {
      const long double e = std::exp((tap - highest) * static_cast<long double>(exponent));
      sum += e / count;
      squares += e * e / count;
    }
    return double(squares / (sum * sum) - 1.0L);
  };
  const auto naive = [](const Taps &taps, float exponent) {
    float sum = 0.0F;
    float squares = 0.0F;
    for (const float tap : taps) {
      const float e = std::exp(exponent * tap);
      sum += weight * e;
      squares += weight * e * e;
    }
    return squares / (sum * sum) - 1.0F;
  };
  const auto safe = [](const Taps &taps, float exponent) {
    shared::LogSum sum = shared::log_sum_begin(taps[0], weight);
    shared::LogSum squares = sum;
    for (std::size_t i = 1; i < taps.size(); i++) {
      sum = shared::log_sum_add(sum, exponent, taps[i], weight);
      squares = shared::log_sum_add(squares, 2.0F * exponent, taps[i], weight);
    }
    return shared::log_sum_variance(sum, squares, 1.0F);
  };
  for (const float exponent : exponents) {
    const auto error = [=](const auto &form, const Taps &taps) {
      const double truth = exact(taps, exponent);
      return std::abs(double(form(taps, exponent)) - truth) / (float_epsilon * (1.0 + truth));
    };
    const auto add = [&](const std::string &name, bool is_baseline, const std::string &parameter,
                         std::vector<double> steps, std::function<double(double)> error_at) {
      cases.push_back({.group = esm_group,
                       .name = fmt::format("{} {:g}/m", name, exponent),
                       .quantity = "relative variance of exp(c z) over 32 taps",
                       .parameter = parameter,
                       .reference = "long double",
                       .unit = epsilon_unit,
                       // Three sums of 32 terms, whose differences from the farthest tap are multiplied by the
                       // exponent; terms below exp(-16) are negligible. Measured: 11.
                       .bound = 20.0,
                       .is_baseline = is_baseline,
                       .run = swept(std::move(steps), std::move(error_at))});
    };
    const double limit = 0.5 * float_limit / double(exponent);
    const auto around = [=](double z) { return taps_from(z, 0.0, count); };
    const std::vector<double> steps = even_steps(0.01 * limit, 2.0 * limit, 200);
    add("evsm naive 32f, limit of exp(2 c z)", true, "distance, m", steps,
        [=](double z) { return error(naive, around(z)); });
    add("evsm safe 32f, limit of exp(2 c z)", false, "distance, m", steps,
        [=](double z) { return error(safe, around(z)); });
    add("evsm safe 32f, any spread", false, "spread of the taps, m", log_steps(1e-3, 1e6, 181),
        [=](double spread) { return error(safe, taps_from(0.0, spread, count)); });
  }
}

void add_esm_visibility_cases(std::vector<StabilityCase> &cases)
{
  for (const float exponent : exponents) {
    cases.push_back(case_of({esm_group, fmt::format("visibility {:g}/m", exponent), "esm_visibility",
                             "visibility of a receiver behind a caster at 10 m", "distance behind the caster, m",
                             log_steps(1e-6, 1e6, 121),
                             [=](double behind) {
                               return Arguments<float>{.a = {exponent, 10.0F, float(10.0 + behind), 0.0F}};
                             },
                             // Differences from 10 m are almost exact: one rounding less. Measured: 0.35.
                             1.0}));
  }
  for (const float variance : {1e-6F, 1e-2F, 31.0F}) {
    cases.push_back(case_of(
        {esm_group, fmt::format("evsm visibility, variance {:g}", variance), "esm_variance_visibility",
         "visibility by Chebyshev's bound, caster at 10 m, 80/m", "distance behind the caster, m",
         log_steps(1e-6, 1e6, 121),
         [=](double behind) {
           return Arguments<float>{.a = {10.0F, variance, float(10.0 + behind), 1e-3F}, .b = {80.0F, 0.0F, 0.0F, 0.0F}};
         },
         // Differences from 10 m are almost exact, which the sweep's magnitude does not consider: 8 epsilons of 1.
         // Measured: 3.5.
         8.0 / (1.0 + 800.0 / std::sqrt(double(variance)))}));
  }
  for (const float distance : {1e-3F, 1.0F, 1e6F}) {
    cases.push_back(
        case_of({esm_group, fmt::format("bias at {:g} m, grazing", distance), "esm_bias", "normal offset of a receiver",
                 "cosine to the lamp", log_steps(1e-6, 1.0, 121), [=](double cosine) {
                   return Arguments<float>{.a = {distance, float(cosine), 2e-3F, 0.0F}};
                 }}));
  }
  for (const eevee::EsmMethod method : {eevee::EsmMethod::Esm, eevee::EsmMethod::Evsm}) {
    cases.push_back({.group = esm_group,
                     .name = method == eevee::EsmMethod::Esm ? "derived exponent of esm" : "derived exponent of evsm",
                     .quantity = "exponent for the range, with maps of 4 to 8192 px, in [0.01, 1e4]",
                     .parameter = "range of the lamp, m",
                     .reference = "closed form",
                     .unit = "relative",
                     // Roundings of two products and a quotient.
                     .bound = 4.0 * float_epsilon,
                     .run = swept(log_steps(1e-6, 1e30, 145), [=](double range) {
                       double worst = 0.0;
                       for (int size_px = 4; size_px <= 8192; size_px *= 2) {
                         const float angle = eevee::esm_filter_angle(size_px);
                         const double texel = std::sqrt(4.0 * std::numbers::pi) / size_px;
                         // A plane at 45° has a spread of ± c·a·d at half the range.
                         const double wanted = method == eevee::EsmMethod::Esm
                                                   ? 0.5 / (std::max(double(angle), texel) * range / 2.0)
                                                   : 0.0625 / (double(angle) * range / 2.0);
                         const double truth = std::clamp(wanted, double(0.01F), 1e4);
                         const double given = eevee::esm_exponent(method, angle, size_px, float(range));
                         worst = std::max(worst, std::abs(given / truth - 1.0));
                       }
                       return worst;
                     })});
  }
}

/** The filter's cone, from +Z (the middle of a map) to a diagonal, where texels have the smallest solid angle. */
void add_cone_cases(std::vector<StabilityCase> &cases)
{
  constexpr double angle = 0.01;
  const float versine = float(2.0 * std::pow(std::sin(0.5 * angle), 2.0));
  const auto opening = [=](const shared::vec3 &axis) {
    const shared::vec3 direction = shared::esm_cone_direction(axis, {0.6F, 0.8F}, versine);
    return double(std::asin(std::min(glm::length(glm::cross(axis, direction)), 1.0F)));
  };
  // A fixed offset from a vector on the octahedron that is not normalised.
  const auto naive_opening = [=](const shared::vec3 &axis) {
    const float norm = std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z);
    return std::atan(angle * double(norm));
  };
  for (const bool is_naive : {true, false}) {
    cases.push_back({.group = esm_group,
                     .name = is_naive ? "cone of a vector not normalised" : "cone",
                     .quantity = "opening of the filter's cone, of 0.01 rad",
                     .parameter = "angle from the map's middle to its diagonal, rad",
                     .reference = "closed form",
                     .unit = "relative",
                     // The rounding of a unit vector, 1e-7, over an angle of 0.01.
                     .bound = 2e-5,
                     .is_baseline = is_naive,
                     .run = swept(even_steps(0.0, std::acos(1.0 / std::sqrt(3.0)), 101), [=](double tilt) {
                       const auto across = float(std::sin(tilt) / std::numbers::sqrt2);
                       const shared::vec3 axis(across, across, float(std::cos(tilt)));
                       return std::abs((is_naive ? naive_opening(axis) : opening(axis)) / angle - 1.0);
                     })});
  }
  for (const float wide : {1e-8F, 0.12F, 2.0F}) {
    for (const double pole : {1.0, -1.0}) {
      cases.push_back(case_of(
          {esm_group, fmt::format("cone of versine {:g} near {}Z", wide, pole > 0.0 ? '+' : '-'), "esm_cone_direction",
           "direction in the cone", "axis' angle from the pole, rad", log_steps(1e-8, 0.5 * std::numbers::pi, 101),
           [=](double tilt) {
             return Arguments<float>{.a = {float(std::sin(tilt)), 0.0F, float(pole * std::cos(tilt)), 0.0F},
                                     .b = {0.6F, -0.5F, wide, 0.0F}};
           },
           // One component of the axis is 0. Measured: 0.7.
           2.0}));
    }
  }
}

}  // namespace

void add_esm_cases(std::vector<StabilityCase> &cases)
{
  add_filter_cases(cases);
  add_format_cases(cases);
  add_variance_cases(cases);
  add_esm_visibility_cases(cases);
  add_cone_cases(cases);
}

}  // namespace gnomon::verify
