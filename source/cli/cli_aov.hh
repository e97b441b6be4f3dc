// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"

#include "eevee_picture_layers.hh"

#include <string>
#include <string_view>
#include <vector>

namespace gnomon::cli {

/** Layers and header entries of an EXR file beside the picture. */
struct AovLayers {
  std::vector<Layer> layers;
  Metadata metadata;
};

/** The layers that `gnomon render --aov` asks for. */
class Aov {
 public:
  /** \a list: names separated by commas. \throws UsageError that lists the names if one is unknown */
  explicit Aov(const std::string &list);

  [[nodiscard]] bool empty() const
  {
    return names_.empty();
  }
  /** \throws std::runtime_error that lists the lamps of \a scene if a layer names a lamp that is not there, or a
   * visibility layer a name that several lamps have. */
  void check(const scene::Scene &scene) const;
  /** Warnings about things in \a scene that the layers do not show. */
  [[nodiscard]] std::vector<std::string> warnings(const scene::Scene &scene) const;
  /**
   * Renders the layers of the picture that \a renderer drew last. \a sample_count: samples of the picture.
   * \pre check() passed. Afterwards, the renderer has another picture.
   */
  [[nodiscard]] AovLayers render(eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera,
                                 int sample_count) const;

 private:
  [[nodiscard]] bool has(std::string_view name) const;
  /** Names of the lamps for which the list has a \a layer: all, or those after the dots, each once. */
  [[nodiscard]] std::vector<std::string> lamps_of(const eevee::PictureLayer &layer,
                                                  std::span<const scene::PlacedLamp> lamps) const;
  void add_light(eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera, int sample_count,
                 AovLayers &layers) const;
  void add_surfaces(eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera, int sample_count,
                    AovLayers &layers) const;

  std::vector<std::string> names_;
};

/** Names of the layers, for `--help`. */
[[nodiscard]] std::string aov_names();

}  // namespace gnomon::cli
