// SPDX-License-Identifier: MIT
#pragma once

#include "scene_types.hh"

namespace gnomon::scene {

/** Unit of Lamp::intensity. */
[[nodiscard]] constexpr const char *intensity_unit(LampKind kind)
{
  switch (kind) {
    case LampKind::Point:
    case LampKind::Spot: return "W/sr";
    case LampKind::Sun:
    case LampKind::Hemi: return "W/m²";
    case LampKind::Area: break;
  }
  return "W";
}

}  // namespace gnomon::scene
