// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_shadow_settings.hh"

#include "scene_property.hh"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

/**
 * The settings of the engine, with their rows (scene_property.hh). Checks of the engine, options, Python, the window,
 * reports and the documentation read the rows: add a setting and its row here, or of shadows in
 * eevee_shadow_settings.hh, and use it. A test refuses a member without a row, unless the test says why it needs none.
 */
namespace gnomon::eevee {

/** The part of a picture where there is no surface. */
struct Background {
  enum class Kind {
    /** Transparent black. */
    None,
    Color,
    /** The world of the scene. The same as None if the scene has no world. */
    World,
  };
  Kind kind = Kind::None;
  /** Linear radiance of Kind::Color. */
  glm::vec3 color{0.0F};
};

/** A component of the light of a picture. The components of all lamps, of the world and of emission sum to the picture.
 */
struct LightComponent {
  enum class Kind {
    All,
    /** One lamp. */
    Lamp,
    /** The world and the background. */
    World,
    /** Light that surfaces emit: seen by the camera directly, and reflected by other surfaces. */
    Emission,
  };
  Kind kind = Kind::All;
  /** Index in RenderScene::lamps, for Kind::Lamp. */
  std::size_t lamp = 0;

  [[nodiscard]] bool has(Kind component) const
  {
    return kind == Kind::All || kind == component;
  }
};

/** Number of samples for which pictures without a sample count are approximated. \see Settings::sample_count */
inline constexpr int open_ended_sample_count = 256;
/** Most points of emissive surfaces in a sample. \see Settings::emissive_point_count */
inline constexpr int emissive_point_max = 16;

/**
 * Members with a row have their name, unit and limits there. `shadow` has rows of its own. `light`, `sample_first`,
 * `sample_end`, `has_probe` and `has_surfaces` have none, because a host sets them.
 */
struct Settings {
  ShadowSettings shadow{};
  Background background{};
  /**
   * Draw only this component of the light. Sample positions, shadows, points of lamps and blended surfaces remain those
   * of the picture with all light.
   */
  LightComponent light{};
  /**
   * Samples for each pixel of a complete picture. 0: no limit; the host ends the picture with Engine::finish.
   * Approximations that depend on the number of samples then assume `open_ended_sample_count`.
   */
  int sample_count = 1;
  /**
   * Draw only the samples from `sample_first` to `sample_end` - 1 of the picture, for pictures that are drawn in parts.
   * `sample_end` is 0 for the last sample of the picture. \see Engine::sample_share
   * \pre both are 0, or 0 <= sample_first < end <= sample_count with end = `sample_end`, or `sample_count` if that is 0
   */
  int sample_first = 0;
  int sample_end = 0;
  /** Selects the random sequence of sample positions and lamp points. */
  std::uint32_t seed = 0;
  /**
   * Adaptive sampling: after the first samples (half of them, at most 4), only those pixels get further samples that
   * differ from one of the eight around them by more than this, relative to the square root of their brightness, or in
   * alpha. Thin objects that the first samples miss are lost. 0: all pixels get all samples. The setting has no effect
   * in scenes with lamps with an extent, a world, emissive surfaces, surfaces that transmit light or blended objects
   * that cast shadows, and where a component of the light or a region is drawn. \pre sample_first and sample_end are 0,
   * unless this is 0
   */
  float noise_threshold = 0.0F;
  /**
   * Microfacets reflect light more than once, so that a rough surface loses none: a white one in a white world is
   * white. Otherwise they reflect it once, as glTF's model has it. \see eevee_multiscatter_shared.h
   */
  bool has_multiscatter = false;
  /**
   * Each sample draws the light that this number of points of emissive surfaces give to other surfaces, with their
   * shadows, up to `emissive_point_max`. 0: emissive surfaces give no light to others. Default: 4 with several samples,
   * 0 with one, whose few points are a rough estimate that takes much of its time. \see emissive_points
   */
  std::optional<int> emissive_point_count{};
  /** Measure the time of each step on the device. */
  bool is_timed = false;
  /**
   * Irradiance, W/m², below which a lamp may be left out: the range of points and spots is lowered to the distance
   * beyond which they give less. The irradiance of each lamp is too small by at most this. There is no bound for the
   * highlights of smooth surfaces. 0: no light is left out.
   */
  float light_threshold = 0.0F;
  /**
   * Use clustered lighting from this many ranged lamps. Pixels then visit only the lamps that can reach their part of
   * the view. With more than LIGHT_MAX lamps, clustered lighting is always used. The picture does not depend on this
   * setting, up to rounding. At least 1.
   */
  int clustered_lamps_min = 8;
  /** Multiply the picture by a colour for each cascade of the first sun that has a shadow. */
  bool has_cascade_tint = false;
  /** Enables Inspection::probe, which needs additional targets and a pass. */
  bool has_probe = false;
  /** Enables Inspection::surfaces, which needs additional targets and a pass. */
  bool has_surfaces = false;

  /** `sample_count`, or for 0 the number that approximations assume. */
  [[nodiscard]] int planned_sample_count() const
  {
    return sample_count == 0 ? open_ended_sample_count : sample_count;
  }
  /** `emissive_point_count`, or its default. */
  [[nodiscard]] int emissive_points() const
  {
    return emissive_point_count.value_or(planned_sample_count() > 1 ? 4 : 0);
  }
  /** Visits the rows of this struct. ShadowSettings has rows of its own. */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);

  /** Number of samples from `sample_first` to `sample_end`. 0: no limit. */
  [[nodiscard]] int drawn_sample_count() const
  {
    return (sample_end == 0 ? sample_count : sample_end) - sample_first;
  }
};

template <typename Visit>
constexpr void Settings::for_each_property(Visit &&visit)
{
  using scene::property;
  visit(property(&Settings::sample_count,
                 {.name = "sample_count",
                  .key = "samples",
                  .option = "samples",
                  .label = "Samples",
                  .unit = "per pixel",
                  .min = 1,
                  .max = 65536,
                  .zero = "no limit",
                  .sentence = "Samples for each pixel of a complete picture. 0: no limit; the host or a time "
                              "limit ends the picture."}));
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
                                              .max = scene::light_max,
                                              .sentence = "Irradiance that may be left out of the light of each point "
                                                          "and spot lamp."}));
  visit(property(&Settings::emissive_point_count,
                 {.name = "emissive_point_count",
                  .option = "emissive-points",
                  .automatic = "auto",
                  .max = emissive_point_max,
                  .sentence = "Points of emissive surfaces that light other surfaces in each sample. 0: emissive "
                              "surfaces give no light to others. Absent: 4 with several samples, 0 with one."}));
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
                  .max = std::numeric_limits<int>::max(),
                  .makes_picture = false,
                  .sentence = "From this number of lamps with a range, pixels visit only the lamps that can reach "
                              "them."}));
}

}  // namespace gnomon::eevee
