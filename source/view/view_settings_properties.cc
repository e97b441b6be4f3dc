// SPDX-License-Identifier: MIT
#include "view_property_makers.hh"

#include <algorithm>

namespace gnomon::view {

static Properties<Settings> make_settings_properties()
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
  made.choices.push_back({"times",
                          "Measure times",
                          off_on,
                          [](const Settings &settings) { return int(settings.eevee.is_timed); },
                          [](Settings &settings, int value) { settings.eevee.is_timed = value == 1; },
                          {}});
  made.numbers.push_back({"samples", "Samples", [](const Settings &) { return "per pixel"; }, 1, 1.0, 65536.0,
                          [](const Settings &settings, int) { return double(settings.eevee.sample_count); },
                          [](Settings &settings, int, double value) { settings.eevee.sample_count = int(value); }});
  made.numbers.push_back(
      {"noise", "Noise threshold", [](const Settings &) { return ""; }, 1, 0.0, 1.0,
       [](const Settings &settings, int) { return double(settings.eevee.noise_threshold); },
       [](Settings &settings, int, double value) { settings.eevee.noise_threshold = float(value); }});
  made.numbers.push_back({"shadow_size", "Shadow size", [](const Settings &) { return "px"; }, 1, 16.0, 8192.0,
                          [=](const Settings &settings, int) { return double(shadow_of(settings).map_size_px); },
                          [=](Settings &settings, int, double value) {
                            shadow_of(settings).map_size_px = int(value);
                            shadow_of(settings).cube_size_px = std::max(1, int(value) / 2);
                          }});
  made.numbers.push_back(number("error", "Maximum error", "RMSE", &Settings::error_max, 0.0, 1.0));
  made.numbers.push_back(number("seconds", "Time limit", "s", &Settings::seconds_max, 0.0, 3600.0));
  made.numbers.push_back(number("budget", "Time budget", "ms a frame", &Settings::budget_ms, 0.0, 1000.0));
  made.numbers.push_back(number("exposure", "Exposure", "stops", &Settings::exposure, -20.0, 20.0));
  return made;
}

template <>
const Properties<Settings> &properties()
{
  static const Properties<Settings> made = make_settings_properties();
  return made;
}

}  // namespace gnomon::view
