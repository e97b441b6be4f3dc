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
  /** A picture is complete once it has its samples, or after this time. 0: no limit. */
  float seconds_max = 0.0F;
  /**
   * Time that the viewports may take in each frame, milliseconds: they show a preview after an edit, and refine it.
   * 0: each frame draws one whole sample.
   */
  float budget_ms = 33.0F;
};

/** What the window starts with. */
[[nodiscard]] inline Settings default_settings()
{
  Settings settings;
  settings.eevee.sample_count = 32;
  return settings;
}

}  // namespace gnomon::view
