// SPDX-License-Identifier: MIT
#pragma once

#include "draw_target.hh"
#include "eevee_engine.hh"

namespace gnomon::view {

/** Of all viewports. */
struct Settings {
  eevee::Settings eevee{};
  draw::ViewTransform view_transform = draw::ViewTransform::PbrNeutral;
  /** Stops. */
  float exposure = 0.0F;
  /** A picture is complete once its RMSE is estimated to be at most this: \see ErrorEstimate. 0: no limit. */
  float error_max = 0.0F;
  /** A picture is complete once it has its samples, or after this time. 0: no limit. */
  float seconds_max = 0.0F;
  /**
   * Time that the viewports may take in each frame, milliseconds: they show a preview after an edit, and refine it.
   * 0: each frame draws one whole sample.
   */
  float budget_ms = 33.0F;
  /** Colour the pictures by the texel density of the selected lamp's shadow. */
  bool has_texel_density = false;
};

/** What the window starts with. */
[[nodiscard]] inline Settings default_settings()
{
  Settings settings;
  settings.eevee.sample_count = 32;
  return settings;
}

/**
 * What the engine draws with. With a maximum error, the number of samples is not known before: their order is then one
 * of which any number is spread evenly, and eevee::Settings::sample_count is a maximum that the viewport keeps.
 */
[[nodiscard]] inline eevee::Settings engine_settings(const Settings &settings)
{
  eevee::Settings drawn = settings.eevee;
  drawn.has_surfaces = settings.has_texel_density;
  drawn.sample_count = settings.error_max > 0.0F ? 0 : drawn.sample_count;
  return drawn;
}

}  // namespace gnomon::view
