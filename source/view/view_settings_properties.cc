// SPDX-License-Identifier: MIT
#include "view_property_makers.hh"

#include <algorithm>
#include <array>
#include <optional>

namespace gnomon::view {

namespace {

/** Settings of shadows of all lamps, \see eevee::ShadowSettings. */
void add_shadow_properties(Properties<Settings> &made)
{
  using eevee::ShadowSettings;
  constexpr double bytes_per_mib = 0x1p20;
  constexpr const char *group = "Shadow settings";
  const auto add_choice = [&](const char *name, const char *label, std::vector<const char *> options,
                              int (*get)(const ShadowSettings &), void (*set)(ShadowSettings &, int)) {
    made.choices.push_back({.name = name,
                            .label = label,
                            .options = std::move(options),
                            .get = [=](const Settings &settings) { return get(settings.eevee.shadow); },
                            .set = [=](Settings &settings, int value) { set(settings.eevee.shadow, value); },
                            .group = group});
  };
  const auto add_number = [&](const char *name, const char *label, const char *unit, Limits limits,
                              double (*get)(const ShadowSettings &),
                              void (*set)(ShadowSettings &, double)) -> NumberProperty<Settings> & {
    made.numbers.push_back({.name = name,
                            .label = label,
                            .unit = [=](const Settings &) { return unit; },
                            .width = 1,
                            .min = limits.min,
                            .max = limits.max,
                            .get = [=](const Settings &settings, int) { return get(settings.eevee.shadow); },
                            .set = [=](Settings &settings, int, double value) { set(settings.eevee.shadow, value); },
                            .group = group});
    return made.numbers.back();
  };
  const auto make_optional = [](NumberProperty<Settings> &property, std::optional<float> eevee::EsmSettings::*member) {
    property.absent = "automatic";
    property.is_absent = [=](const Settings &settings) { return !(settings.eevee.shadow.esm.*member); };
    property.remove = [=](Settings &settings) { (settings.eevee.shadow.esm.*member).reset(); };
  };

  // Widths of the square kernels, and 0 for the disk.
  static constexpr std::array pcf_widths = {1, 3, 5, 0};
  add_choice(
      "pcf", "PCF kernel", {"1", "3x3", "5x5", "disk"},
      [](const ShadowSettings &shadow) {
        return int(std::ranges::find(pcf_widths, shadow.pcf.width) - pcf_widths.begin());
      },
      [](ShadowSettings &shadow, int value) { shadow.pcf.width = pcf_widths[std::size_t(value)]; });
  add_choice(
      "esm", "ESM filter", {"4", "32", "separable"},
      [](const ShadowSettings &shadow) { return int(shadow.esm.kernel); },
      [](ShadowSettings &shadow, int value) { shadow.esm.kernel = eevee::EsmKernel(value); });
  add_choice(
      "cascade_range", "Maps cover", {"view", "depth"},
      [](const ShadowSettings &shadow) { return int(shadow.is_fitted_to_depth); },
      [](ShadowSettings &shadow, int value) { shadow.is_fitted_to_depth = value == 1; });
  add_choice(
      "cascade_count", "Cascades", {"automatic", "1", "2", "3", "4"},
      [](const ShadowSettings &shadow) { return shadow.cascades.count; },
      [](ShadowSettings &shadow, int value) { shadow.cascades.count = value; });
  static_assert(eevee::cascade_count_max == 4);
  add_choice(
      "casters", "Faces of casters", {"all", "front", "back"},
      [](const ShadowSettings &shadow) { return int(shadow.caster_faces); },
      [](ShadowSettings &shadow, int value) { shadow.caster_faces = eevee::CasterFaces(value); });

  add_number(
      "pcf_lookups", "PCF lookups", "", {1.0, 64.0},
      [](const ShadowSettings &shadow) { return double(shadow.pcf.taps); },
      [](ShadowSettings &shadow, double value) { shadow.pcf.taps = stored<int>(value); })
      .applies = [](const Settings &settings) { return settings.eevee.shadow.pcf.width == 0; };
  add_number(
      "cascade_lambda", "Cascade lambda", "", {0.0, 1.0},
      [](const ShadowSettings &shadow) { return double(shadow.cascades.lambda); },
      [](ShadowSettings &shadow, double value) { shadow.cascades.lambda = float(value); });
  add_number(
      "esm_size", "ESM layer size", "px", {esm_size_min, esm_size_max},
      [](const ShadowSettings &shadow) { return double(shadow.esm.size_px); },
      [](ShadowSettings &shadow, double value) { shadow.esm.size_px = stored<int>(value); });
  make_optional(add_number(
                    "exponent", "ESM exponent", "1/m", {0.01, 1e4},
                    [](const ShadowSettings &shadow) { return double(shadow.esm.exponent.value_or(10.0F)); },
                    [](ShadowSettings &shadow, double value) { shadow.esm.exponent = float(value); }),
                &eevee::EsmSettings::exponent);
  make_optional(
      add_number(
          "filter_radius", "ESM filter radius", "°", {0.0, esm_filter_degrees_max},
          [](const ShadowSettings &shadow) {
            return shadow.esm.filter_angle ? double(*shadow.esm.filter_angle) * degrees_per_radian : 1.0;
          },
          [](ShadowSettings &shadow, double value) { shadow.esm.filter_angle = float(value / degrees_per_radian); }),
      &eevee::EsmSettings::filter_angle);
  add_number(
      "shadow_memory", "Memory limit", "MiB", {1.0, 65536.0},
      [](const ShadowSettings &shadow) { return double(shadow.memory_bytes_max) / bytes_per_mib; },
      [](ShadowSettings &shadow, double value) {
        shadow.memory_bytes_max = stored<std::size_t>(value * bytes_per_mib);
      });
}

Properties<Settings> make_settings_properties()
{
  Properties<Settings> made;
  const auto shadow_of = [](auto &settings) -> auto &
  {
    return settings.eevee.shadow;
  };
  made.choices.push_back({"shadow",
                          "Shadows",
                          shadow_kinds,
                          [=](const Settings &settings) { return int(shadow_of(settings).kind); },
                          [=](Settings &settings, int value) { shadow_of(settings).kind = scene::ShadowKind(value); },
                          {}});
  made.choices.push_back({"background",
                          "Background",
                          {"grey", "world"},
                          [](const Settings &settings) {
                            return settings.eevee.background.kind == eevee::Background::Kind::World ? 1 : 0;
                          },
                          [](Settings &settings, int value) {
                            settings.eevee.background.kind =
                                value == 1 ? eevee::Background::Kind::World : eevee::Background::Kind::None;
                          },
                          {}});
  made.choices.push_back(
      choice("transform", "View transform", {"standard", "raw", "agx", "pbr-neutral"}, &Settings::view_transform));
  made.choices.push_back({"specular",
                          "Specular",
                          {"single", "multi"},
                          [](const Settings &settings) { return int(settings.eevee.has_multiscatter); },
                          [](Settings &settings, int value) { settings.eevee.has_multiscatter = value == 1; },
                          {}});
  made.choices.push_back({"cascades",
                          "Show cascades",
                          off_on,
                          [](const Settings &settings) { return int(settings.eevee.has_cascade_tint); },
                          [](Settings &settings, int value) { settings.eevee.has_cascade_tint = value == 1; },
                          {}});
  made.choices.push_back(choice("density", "Show texel density", off_on, &Settings::has_texel_density));
  made.choices.push_back({"times",
                          "Measure times",
                          off_on,
                          [](const Settings &settings) { return int(settings.eevee.is_timed); },
                          [](Settings &settings, int value) { settings.eevee.is_timed = value == 1; },
                          {}});
  made.numbers.push_back(
      {"samples", "Samples", [](const Settings &) { return "per pixel"; }, 1, 1.0, 65536.0,
       [](const Settings &settings, int) { return double(settings.eevee.sample_count); },
       [](Settings &settings, int, double value) { settings.eevee.sample_count = stored<int>(value); }});
  made.numbers.push_back(
      {"noise", "Noise threshold", [](const Settings &) { return ""; }, 1, 0.0, 1.0,
       [](const Settings &settings, int) { return double(settings.eevee.noise_threshold); },
       [](Settings &settings, int, double value) { settings.eevee.noise_threshold = float(value); }});
  made.numbers.push_back({"shadow_size", "Shadow size", [](const Settings &) { return "px"; }, 1, 16.0, 8192.0,
                          [=](const Settings &settings, int) { return double(shadow_of(settings).map_size_px); },
                          [=](Settings &settings, int, double value) {
                            shadow_of(settings).map_size_px = stored<int>(value);
                            shadow_of(settings).cube_size_px = std::max(1, stored<int>(value) / 2);
                          }});
  made.numbers.push_back(number("error", "Maximum error", "RMSE", &Settings::error_max, 0.0, 1.0));
  made.numbers.back().slider_zero = "no limit";
  made.numbers.push_back(number("seconds", "Time limit", "s", &Settings::seconds_max, 0.0, 3600.0));
  made.numbers.push_back(number("budget", "Time budget", "ms a frame", &Settings::budget_ms, 0.0, 1000.0));
  made.numbers.push_back(number("exposure", "Exposure", "stops", &Settings::exposure, -20.0, 20.0));
  add_shadow_properties(made);
  return made;
}

}  // namespace

template <>
const Properties<Settings> &properties()
{
  static const Properties<Settings> made = make_settings_properties();
  return made;
}

}  // namespace gnomon::view
