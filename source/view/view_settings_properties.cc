// SPDX-License-Identifier: MIT
#include "view_property_makers.hh"

#include "eevee_settings.hh"

#include <algorithm>
#include <array>

namespace gnomon::view {

namespace {

/** Filters of percentage-closer filtering: square kernels, and the disk with its number of lookups. */
void add_pcf_properties(Properties<WindowSettings> &made)
{
  // Widths of the square kernels; 0: the disk.
  static constexpr std::array widths = {1, 3, 5, 0};
  ChoiceProperty<WindowSettings> kernel{
      .name = "pcf",
      .label = "PCF kernel",
      .options = {"1", "3x3", "5x5", "disk"},
      .get =
          [](const WindowSettings &settings) {
            return int(std::ranges::find(widths, settings.eevee.shadow.pcf.width) - widths.begin());
          },
      .set = [](WindowSettings &settings, int value) { settings.eevee.shadow.pcf.width = widths[std::size_t(value)]; }};
  kernel.group = eevee::shadow_settings_group.data();
  made.choices.push_back(std::move(kernel));
  NumberProperty<WindowSettings> lookups = number_property<WindowSettings>(
      {.name = "pcf_lookups",
       .label = "PCF lookups",
       .group = eevee::shadow_settings_group,
       .min = 1,
       .max = eevee::PcfKernel::taps_max},
      [](auto &settings) -> auto & { return settings.eevee.shadow.pcf.taps; });
  lookups.applies = [](const WindowSettings &settings) { return settings.eevee.shadow.pcf.width == 0; };
  made.numbers.push_back(std::move(lookups));
}

Properties<WindowSettings> make_settings_properties()
{
  using Kind = eevee::Background::Kind;
  Properties<WindowSettings> made;
  add_rows<WindowSettings>(
      made, [](auto &settings) -> auto & { return settings; });
  add_rows<eevee::Settings>(
      made, [](auto &settings) -> auto & { return settings.eevee; });
  add_rows<render_scene::Display>(
      made, [](auto &settings) -> auto & { return settings.display; });
  add_rows<eevee::ShadowSettings>(
      made, [](auto &settings) -> auto & { return settings.eevee.shadow; }, "automatic");
  add_pcf_properties(made);
  made.choices.push_back(
      {"background",
       "Background",
       {"grey", "world"},
       [](const WindowSettings &settings) { return settings.eevee.background.kind == Kind::World ? 1 : 0; },
       [](WindowSettings &settings, int value) {
         settings.eevee.background.kind = value == 1 ? Kind::World : Kind::None;
       },
       {}});
  // A viewport always has a number of samples.
  NumberProperty<WindowSettings> &samples = named(made.numbers, "samples");
  samples.absent = nullptr;
  NumberProperty<WindowSettings> &size = named(made.numbers, "shadow_size");
  size.set = [set = size.set](WindowSettings &settings, int i, double value) {
    set(settings, i, value);
    settings.eevee.shadow.cube_size_px = std::max(1, settings.eevee.shadow.map_size_px / 2);
  };
  named(made.numbers, "error").slider_zero = "no limit";
  return made;
}

}  // namespace

template <>
const Properties<WindowSettings> &properties()
{
  static const Properties<WindowSettings> made = make_settings_properties();
  return made;
}

}  // namespace gnomon::view
