// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"

#include "scene_property.hh"

#include <array>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

/**
 * The rows of the engine's settings. Checks of the engine, options, Python, the window, reports and the documentation
 * read them: add a setting here, and use it. A member of Settings, ShadowSettings or EsmSettings without a row is
 * refused by a test, unless the test says why it needs none. \see scene_property.hh
 */
namespace gnomon::scene {

template <>
inline constexpr std::array<std::string_view, 3> words<eevee::EsmKernel>{"4", "32", "separable"};
template <>
inline constexpr std::array<std::string_view, 4> words<eevee::LayerPass>{"best", "six", "geometry", "layered"};
template <>
inline constexpr std::array<std::string_view, 3> words<eevee::CasterFaces>{"all", "front", "back"};

}  // namespace gnomon::scene

namespace gnomon::eevee {

inline constexpr std::string_view shadow_settings_group = "Shadow settings";

/** The kernel that \a text names: 1, 3x3, 5x5, or disk:N with N lookups, 1 to 64. Empty for any other text. */
[[nodiscard]] std::optional<PcfKernel> pcf_kernel_of(std::string_view text);
/** The text of \a kernel for pcf_kernel_of. */
[[nodiscard]] std::string text_of(const PcfKernel &kernel);

/** Where a number of \a settings is out of its limits: the row's name, the number and the limits. Empty: nowhere. */
template <typename Settings>
[[nodiscard]] std::string fault_of(const Settings &settings)
{
  std::string fault;
  Settings::for_each_property([&](const auto &row) {
    scene::for_each_number(row.access(settings), [&](double number) {
      if (fault.empty() && !row.allows(number)) {
        fault = scene::range_fault(row, number);
      }
    });
  });
  return fault;
}

template <typename Visit>
constexpr void EsmSettings::for_each_property(Visit &&visit)
{
  using scene::property;
  visit(property(&EsmSettings::kernel, {.name = "esm_kernel",
                                        .key = "esm",
                                        .option = "esm",
                                        .label = "ESM filter",
                                        .group = shadow_settings_group,
                                        .sentence = "Filter of ESM and EVSM: 4 or 32 taps, or separable."}));
  visit(property(&EsmSettings::size_px,
                 {.name = "esm_size_px",
                  .key = "esm_size",
                  .option = "shadow-size",
                  .label = "ESM layer size",
                  .group = shadow_settings_group,
                  .unit = "px",
                  .min = 4,
                  .max = 8192,
                  .sentence = "Texels along an edge of an octahedral layer, for ESM and EVSM of lamps except suns."}));
  visit(property(&EsmSettings::exponent,
                 {.name = "shadow_exponent",
                  .key = "exponent",
                  .label = "ESM exponent",
                  .group = shadow_settings_group,
                  .unit = "1/m",
                  .min = 0.01,
                  .max = 1e4,
                  .first = 10,
                  .sentence = "Exponential shadows: exponent. Absent: it follows the size and the lamp's range."}));
  visit(property(&EsmSettings::filter_angle,
                 {.name = "shadow_filter_angle",
                  .key = "filter_radius",
                  .label = "ESM filter radius",
                  .group = shadow_settings_group,
                  .unit = "rad",
                  .max = std::numbers::pi / 4,
                  .first = std::numbers::pi / 180,
                  .sentence = "Exponential shadows: half the opening angle of the filter. Absent: that of a texel."}));
  visit(property(&EsmSettings::bias, {.name = "shadow_bias",
                                      .max = 100,
                                      .sentence = "Exponential shadows: factor of the bias that is derived from the "
                                                  "texel size."}));
  visit(property(&EsmSettings::format,
                 {.name = "shadow_esm_format",
                  .sentence = "ESM: numbers of the octahedral layer. Absent: the smaller one that is accurate."}));
}

template <typename Visit>
constexpr void ShadowSettings::for_each_property(Visit &&visit)
{
  using scene::part_property;
  using scene::property;
  visit(property(&ShadowSettings::kind, {.name = "shadow_kind",
                                         .key = "shadow",
                                         .option = "shadow",
                                         .label = "Shadows",
                                         .sentence = "Method of the shadows of lamps without one of their own "
                                                     "(gnomon_shadow). none: no lamp has a shadow."}));
  visit(property(&ShadowSettings::cube_size_px,
                 {.name = "cube_size_px",
                  .option = "shadow-size",
                  .unit = "px",
                  .min = 1,
                  .max = 16384,
                  .sentence = "Texels along an edge of a cube's face, for points, area lamps and wide spots."}));
  visit(property(&ShadowSettings::map_size_px,
                 {.name = "map_size_px",
                  .key = "shadow_size",
                  .option = "shadow-size",
                  .label = "Shadow size",
                  .unit = "px",
                  .min = 1,
                  .max = 16384,
                  .sentence = "Texels along an edge of a map, for spots and suns. Pictures for which there is time may "
                              "have other sizes for suns."}));
  visit(property(&ShadowSettings::pcf, {.name = "pcf",
                                        .option = "pcf",
                                        .label = "PCF kernel",
                                        .group = shadow_settings_group,
                                        .sentence = "Filter kernel of PCF: 1, 3x3, 5x5, or disk:N for N lookups on a "
                                                    "disk, 1 to 64."}));
  EsmSettings::for_each_property([&](const auto &row) {
    visit(part_property<ShadowSettings>(
        [access = row](auto &settings) -> auto & { return access.access(settings.esm); }, row));
  });
  visit(part_property<ShadowSettings>([](auto &settings) -> auto & { return settings.cascades.count; },
                                      {.name = "cascade_count",
                                       .option = "cascades",
                                       .label = "Cascades",
                                       .group = shadow_settings_group,
                                       .max = cascade_count_max,
                                       .zero = "automatic",
                                       .first = 1,
                                       .sentence = "Shadow maps of each sun. 0: as many as are needed for texels no "
                                                   "larger than pixels."}));
  visit(part_property<ShadowSettings>([](auto &settings) -> auto & { return settings.cascades.lambda; },
                                      {.name = "cascade_lambda",
                                       .option = "cascade-lambda",
                                       .label = "Cascade lambda",
                                       .group = shadow_settings_group,
                                       .max = 1,
                                       .sentence = "Distribution of the cascades over the distance. 0: even. 1: "
                                                   "logarithmic."}));
  visit(part_property<ShadowSettings>([](auto &settings) -> auto & { return settings.cascades.can_resize; },
                                      {.name = "can_resize_cascades",
                                       .sentence = "Cascades that are fitted to the visible surfaces have maps of "
                                                   "other sizes than map_size_px where these are enough or needed."}));
  visit(
      part_property<ShadowSettings>([](auto &settings) -> auto & { return settings.cascades.texel_in_pixels_enlarged; },
                                    {.name = "cascade_texel_max",
                                     .unit = "px",
                                     .min = texel_in_pixels,
                                     .max = 1e6,
                                     .sentence = "Edge of the texels of cascades, in pixels, above which "
                                                 "can_resize_cascades makes maps larger."}));
  visit(property(&ShadowSettings::is_fitted_to_depth,
                 {.name = "is_fitted_to_depth",
                  .key = "cascade_range",
                  .option = "cascade-range",
                  .automatic = "auto",
                  .label = "Maps cover",
                  .group = shadow_settings_group,
                  .switch_words = {"view", "depth"},
                  .sentence = "What shadow maps cover. view: the scene within the camera's frustum (cascades) or "
                              "around the lamp. depth: the visible surfaces, so that edges of shadows move with the "
                              "camera."}));
  visit(property(&ShadowSettings::can_have_short_maps,
                 {.name = "can_have_short_maps",
                  .sentence = "Maps of suns and spots may have 16-bit depths where these are accurate."}));
  visit(property(&ShadowSettings::layer_pass,
                 {.name = "layer_pass",
                  .option = "cube-pass",
                  .makes_picture = false,
                  .sentence = "Drawing of the layers of a lamp. six: one pass for each. geometry, layered: one pass "
                              "for all. best: the best one that the device has."}));
  visit(property(&ShadowSettings::caster_faces, {.name = "caster_faces",
                                                 .key = "casters",
                                                 .option = "casters",
                                                 .label = "Faces of casters",
                                                 .group = shadow_settings_group,
                                                 .sentence = "Faces of one-sided materials that cast shadows."}));
  visit(property(&ShadowSettings::memory_bytes_max,
                 {.name = "shadow_bytes_max",
                  .key = "shadow_memory",
                  .option = "shadow-memory",
                  .label = "Memory limit",
                  .group = shadow_settings_group,
                  .unit = "bytes",
                  .min = 1,
                  .max = 0x1p40,
                  .sentence = "Most memory of all shadow layers; their sizes are reduced to fit."}));
}

template <typename Visit>
constexpr void Settings::for_each_property(Visit &&visit)
{
  using scene::property;
  visit(property(&Settings::sample_count, {.name = "sample_count",
                                           .key = "samples",
                                           .option = "samples",
                                           .label = "Samples",
                                           .unit = "per pixel",
                                           .min = 1,
                                           .max = 65536,
                                           .zero = "no limit",
                                           .sentence = "Samples of a picture. 0: as many as fit into a time."}));
  visit(property(&Settings::seed, {.name = "seed",
                                   .option = "seed",
                                   .max = std::numeric_limits<std::uint32_t>::max(),
                                   .sentence = "Selects the random positions of the samples and points of lamps."}));
  visit(property(&Settings::noise_threshold,
                 {.name = "noise_threshold",
                  .key = "noise",
                  .option = "noise-threshold",
                  .label = "Noise threshold",
                  .max = 1000,
                  .sentence = "After the first samples, draw further ones only for pixels that differ from a neighbour "
                              "by more than this, relative to the square root of their brightness. 0: all pixels get "
                              "all samples."}));
  visit(property(&Settings::has_multiscatter,
                 {.name = "has_multiscatter",
                  .key = "specular",
                  .option = "specular",
                  .label = "Specular",
                  .switch_words = {"single", "multi"},
                  .sentence = "Reflections of light among microfacets. single: one, as glTF's model has it. multi: "
                              "several, so that rough surfaces lose no light."}));
  visit(property(&Settings::light_threshold, {.name = "light_threshold",
                                              .option = "light-threshold",
                                              .unit = "W/m²",
                                              .max = 1e30,
                                              .sentence = "Irradiance that may be left out of the light of each point "
                                                          "and spot lamp."}));
  visit(property(&Settings::emissive_point_count,
                 {.name = "emissive_point_count",
                  .option = "emissive-points",
                  .max = emissive_point_max,
                  .sentence = "Points of emissive surfaces that light other surfaces in each of several samples. 0: "
                              "emissive surfaces give no light to others."}));
  visit(property(&Settings::background, {.name = "background",
                                         .option = "background",
                                         .label = "Background",
                                         .sentence = "What is seen where there is no surface: nothing (transparent), "
                                                     "the world, or a radiance, W/(sr m²)."}));
  visit(
      property(&Settings::has_cascade_tint,
               {.name = "has_cascade_tint",
                .key = "cascades",
                .label = "Show cascades",
                .sentence = "The picture is multiplied by a colour for each cascade of the first sun with a shadow."}));
  visit(property(&Settings::is_timed, {.name = "is_timed",
                                       .key = "times",
                                       .label = "Measure times",
                                       .makes_picture = false,
                                       .sentence = "The time of each step on the device is measured."}));
  visit(property(&Settings::clustered_lamps_min,
                 {.name = "clustered_lamps_min",
                  .min = 1,
                  .makes_picture = false,
                  .sentence = "From this number of lamps with a range, pixels visit only the lamps that can reach "
                              "them."}));
}

}  // namespace gnomon::eevee
