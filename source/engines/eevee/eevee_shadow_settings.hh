// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"

#include "scene_properties.hh"

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace gnomon::eevee {

/** The content of an octahedral layer of an exponential shadow map. */
enum class EsmMethod {
  /** The mean of exp(c·z) for distances z. Shadows are sharp, but light leaks behind casters over a length of 1 / c. */
  Esm,
  /**
   * The mean and the variance of exp(c·z) in two channels: an exponential variance shadow map. It is more accurate for
   * wide filters and needs twice the memory.
   */
  Evsm,
};

/** The filter of a layer. All filters average exp(exponent · distance), in log space to prevent an overflow. */
enum class EsmKernel {
  /** A cone of constant solid angle, sampled by 4 or 32 taps. The cost is proportional to taps × texels. */
  Disk4,
  Disk32,
  /**
   * For wide filters: a Gaussian with the variance of the disk, along rows and then along columns. Its shape follows
   * the texels of the map, so that its angle varies between 0.88 and 1.23 of the disk's angle.
   */
  Separable,
};

using scene::EsmFormat;

/** Settings of one lamp's exponential shadow map; names, units and limits are in the rows below. */
struct EsmSettings {
  EsmMethod method = EsmMethod::Esm;
  /** Exponent, 1/m. Default: esm_exponent. */
  std::optional<float> exponent{};
  /** Factor of shared::esm_bias. */
  float bias = 1.0F;
  /** Half the opening angle of the filter cone, radians. Default: esm_filter_angle. */
  std::optional<float> filter_angle{};
  /** Edge of the map without its border, texels. */
  int size_px = 512;
  /**
   * Format of EsmMethod::Esm. EsmMethod::Evsm always has 32 bits. Default: Half if its rounding changes visibilities by
   * at most esm_half_error_max, otherwise Float.
   */
  std::optional<EsmFormat> format{};
  /** With the default filter angle, Disk4 has the quality of Disk32 in a quarter of the time. */
  EsmKernel kernel = EsmKernel::Disk4;

  /** Visits the rows of all members but `method`. */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

/** Maximum number of cascades of a sun. */
inline constexpr int cascade_count_max = 4;

/** Least edge of a texel of a resized cascade, pixels. Maps with smaller texels get fewer. */
inline constexpr double texel_in_pixels = 0.125;

/** The distribution of a sun's cascades over the visible range. */
struct CascadeSettings {
  /**
   * Number of cascades, 1 to cascade_count_max. 0: the fewest with texels no larger than a pixel, or than
   * texel_in_pixels_max if cascades are fitted to depths.
   */
  int count = 0;
  /** Blend of uniform splits (0) and logarithmic splits (1) of the distance. \see cascade_splits */
  float lambda = 0.8F;
  /**
   * Whether cascades that are fitted to depths (ShadowSettings::is_fitted_to_depth) have maps of other sizes than asked
   * for: smaller where texels would be smaller than texel_in_pixels, and larger by resize_step where the largest number
   * of cascades has texels larger than texel_in_pixels_enlarged. Not for lamps with a size of their own.
   */
  bool can_resize = false;
  /** Edge of the texels, in pixels, above which can_resize makes maps larger. At least texel_in_pixels. */
  double texel_in_pixels_enlarged = texel_in_pixels;
};

/** The method for drawing the layers of a lamp. All methods give the same texels. */
enum class LayerPass {
  /** The best method that the device supports. */
  Best,
  /** One pass for each layer. */
  Single,
  /** One pass; the geometry shader chooses the layer of each triangle. */
  Geometry,
  /** One pass; the vertex shader chooses the layer. */
  Layered,
};

/** The faces of one-sided casters that are drawn. Both faces of two-sided materials are always drawn. */
enum class CasterFaces { All, Front, Back };

/**
 * Settings of shadows. Names, units and limits are in the rows below. Present values of a lamp (scene::LampShadow)
 * replace them. If `kind` is None, no lamp has a shadow, whatever its own kind is.
 */
struct ShadowSettings {
  /**
   * Hard: bilinear blend of the four texels around a lookup. Pcf: percentage-closer filtering with `pcf`. Esm, Evsm:
   * exponential shadow maps with `esm`; suns have Pcf instead, and a warning names them.
   */
  scene::ShadowKind kind = scene::ShadowKind::Hard;
  /** Edge of a cube face, texels. */
  int cube_size_px = 1024;
  /** Edge of a planar map, texels. */
  int map_size_px = 2048;
  PcfKernel pcf{};
  /** Settings of Esm and Evsm. EsmSettings::method is not used: `kind`, or that of the lamp, selects the method. */
  EsmSettings esm{};
  CascadeSettings cascades{};
  /**
   * Fit the maps of suns to the surfaces in the picture instead of slices of the view: the splits, positions,
   * directions and extents with the least error, \see sun_slices. Crop the cube faces and maps of other lamps to these
   * surfaces, \see map_crop. The depths of the picture are read back after the depth pre-pass whenever the view
   * changes. draw::Viewport::draw waits for them. Recorded packets use the depths of an earlier packet, so that shadows
   * follow the camera some frames later. For pictures of one camera: the edges of the shadows move when the camera
   * moves.
   */
  bool is_fitted_to_depth = false;
  /**
   * Whether maps of suns and spots may have 16-bit depths, which take half of the memory. They have them while the
   * error of these depths is at most a tenth of a texel for all maps, \see short_depth_error_max; with
   * is_fitted_to_depth, while all maps are cascades of suns that are fitted to depths, and the error is at most a
   * twentieth. Receivers are offset by it.
   */
  bool can_have_short_maps = false;
  LayerPass layer_pass = LayerPass::Best;
  CasterFaces caster_faces = CasterFaces::All;
  /** Maximum device memory of all shadow layers, bytes. \see plan_shadows */
  std::size_t memory_bytes_max = std::size_t(1) << 30U;

  /** Visits also the rows of `esm` and `cascades`. */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

}  // namespace gnomon::eevee

namespace gnomon::scene {

template <>
inline constexpr std::array<std::string_view, 3> words<eevee::EsmKernel>{"4", "32", "separable"};
template <>
inline constexpr std::array<std::string_view, 4> words<eevee::LayerPass>{"best", "six", "geometry", "layered"};
template <>
inline constexpr std::array<std::string_view, 3> words<eevee::CasterFaces>{"all", "front", "back"};

}  // namespace gnomon::scene

namespace gnomon::eevee {

/** The header of the window for settings of shadows. */
inline constexpr std::string_view shadow_settings_group = "Shadow settings";

/** The description of the same setting of a lamp, for its limits. */
[[nodiscard]] constexpr scene::Description of_lamp(std::string_view name)
{
  return scene::description_of<scene::LampShadow>(name);
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
                  .min = of_lamp("shadow_esm_size_px").min,
                  .max = of_lamp("shadow_esm_size_px").max,
                  .sentence = "Texels along an edge of an octahedral layer, for ESM and EVSM of lamps except suns."}));
  visit(property(
      &EsmSettings::exponent,
      {.name = "shadow_exponent",
       .key = "exponent",
       .label = "ESM exponent",
       .group = shadow_settings_group,
       .unit = "1/m",
       .min = of_lamp("shadow_exponent").min,
       .max = of_lamp("shadow_exponent").max,
       .first = of_lamp("shadow_exponent").first,
       .sentence = "Exponential shadows: exponent. Absent: it is derived from the size, the filter and the range of "
                   "each shadow."}));
  visit(property(
      &EsmSettings::filter_angle,
      {.name = "shadow_filter_angle",
       .key = "filter_radius",
       .label = "ESM filter radius",
       .group = shadow_settings_group,
       .unit = "rad",
       .max = of_lamp("shadow_filter_angle").max,
       .first = of_lamp("shadow_filter_angle").first,
       .sentence = "Exponential shadows: half the opening angle of the filter. Absent: half the mean angle of a "
                   "texel."}));
  visit(property(&EsmSettings::bias, {.name = "shadow_bias",
                                      .max = of_lamp("shadow_bias").max,
                                      .sentence = "Exponential shadows: factor of the bias that is derived from the "
                                                  "texel size."}));
  visit(property(&EsmSettings::format,
                 {.name = "shadow_esm_format",
                  .sentence = "ESM: format of the octahedral layer. Absent: the smaller one that is accurate."}));
}

template <typename Visit>
constexpr void ShadowSettings::for_each_property(Visit &&visit)
{
  static_assert(PcfKernel::taps_max == 64, "the sentence of pcf says 64");
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
                  .min = of_lamp("shadow_size_px").min,
                  .max = of_lamp("shadow_size_px").max,
                  .sentence = "Texels along an edge of a cube's face, for points, area lamps and wide spots."}));
  visit(
      property(&ShadowSettings::map_size_px,
               {.name = "map_size_px",
                .key = "shadow_size",
                .option = "shadow-size",
                .label = "Shadow size",
                .unit = "px",
                .min = of_lamp("shadow_size_px").min,
                .max = of_lamp("shadow_size_px").max,
                .sentence = "Texels along an edge of a map, for spots and suns. Offline pictures may have other sizes "
                            "for suns."}));
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

/**
 * The shadow kind of a lamp: \a asked, or else the kind of \a settings. None if \a settings disable shadows and for
 * hemi lamps. Pcf for a sun that requests Esm or Evsm.
 */
[[nodiscard]] scene::ShadowKind shadow_kind(scene::LampKind lamp, std::optional<scene::ShadowKind> asked,
                                            const ShadowSettings &settings);
[[nodiscard]] scene::ShadowKind shadow_kind(const scene::Lamp &lamp, const ShadowSettings &settings);

}  // namespace gnomon::eevee
