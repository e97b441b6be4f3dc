// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"
#include "render_display.hh"

namespace gnomon::view {

/** The settings of all viewports. */
struct WindowSettings {
  eevee::Settings eevee{};
  render_scene::Display display{};
  /** \see ErrorEstimate */
  float error_max = 0.0F;
  float seconds_max = 0.0F;
  float budget_ms = 33.0F;
  bool has_texel_density = false;

  /** Visit the settings that only the window has. */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

template <typename Visit>
constexpr void WindowSettings::for_each_property(Visit &&visit)
{
  using scene::property;
  visit(property(&WindowSettings::error_max,
                 {.name = "error_max",
                  .key = "error",
                  .label = "Maximum error",
                  .unit = "RMSE",
                  .max = 1,
                  .sentence = "A picture is complete once its error is estimated to be at most this. 0: no limit."}));
  visit(property(&WindowSettings::seconds_max,
                 {.name = "seconds_max",
                  .key = "seconds",
                  .label = "Time limit",
                  .unit = "s",
                  .max = 3600,
                  .sentence = "A picture is complete once it has its samples, or after this time. 0: no limit."}));
  visit(property(&WindowSettings::budget_ms,
                 {.name = "budget_ms",
                  .key = "budget",
                  .label = "Time budget",
                  .unit = "ms a frame",
                  .max = 1000,
                  .makes_picture = false,
                  .sentence = "Time that the viewports may take in each frame: they show a preview after an edit, and "
                              "refine it. 0: each frame draws one whole sample."}));
  visit(property(&WindowSettings::has_texel_density,
                 {.name = "has_texel_density",
                  .key = "density",
                  .label = "Show texel density",
                  .sentence = "The pictures are coloured by the texel density of the selected lamp's shadow."}));
}

/** The settings that the window starts with. */
[[nodiscard]] inline WindowSettings default_settings()
{
  WindowSettings settings;
  settings.eevee.sample_count = 32;
  return settings;
}

/**
 * The settings that the engine draws with. With a maximum error, the number of samples is not known before: their order
 * is then one of which any number is spread evenly, and eevee::Settings::sample_count is a maximum that the viewport
 * keeps.
 */
[[nodiscard]] inline eevee::Settings engine_settings(const WindowSettings &settings)
{
  eevee::Settings drawn = settings.eevee;
  drawn.has_surfaces = settings.has_texel_density;
  drawn.sample_count = settings.error_max > 0.0F ? 0 : drawn.sample_count;
  return drawn;
}

}  // namespace gnomon::view
