// SPDX-License-Identifier: MIT
#pragma once

#include "draw_target.hh"
#include "scene_property.hh"

#include <array>

namespace gnomon::scene {

template <>
inline constexpr std::array<std::string_view, 4> words<draw::ViewTransform>{"standard", "raw", "agx", "pbr-neutral"};

}  // namespace gnomon::scene

namespace gnomon::render_scene {

/** How a picture becomes display colours, for the members of draw::Target with the same names. */
struct Display {
  draw::ViewTransform view_transform = draw::ViewTransform::PbrNeutral;
  float exposure = 0.0F;

  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

inline void set_display(draw::Target &target, const Display &display)
{
  target.view_transform = display.view_transform;
  target.exposure = display.exposure;
}

template <typename Visit>
constexpr void Display::for_each_property(Visit &&visit)
{
  using scene::property;
  visit(property(&Display::view_transform, {.name = "view_transform",
                                            .key = "transform",
                                            .option = "view",
                                            .label = "View transform",
                                            .sentence = "Conversion of scene-linear light to display colours."}));
  visit(
      property(&Display::exposure, {.name = "exposure",
                                    .option = "exposure",
                                    .label = "Exposure",
                                    .unit = "stops",
                                    .min = -draw::exposure_max,
                                    .max = draw::exposure_max,
                                    .sentence = "Light is multiplied by 2 to this power before the view transform."}));
}

}  // namespace gnomon::render_scene
