// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_inspection.hh"

#include <string>
#include <string_view>

namespace gnomon::cli {

/** The argument of --debug. */
struct DebugView {
  enum class Kind {
    None,
    /** Layers of a lamp's shadow instead of the picture. */
    Shadow,
    /** The picture, tinted by cascades. */
    Cascades,
    /** The picture, coloured by the texel density of a lamp's shadow. */
    Density,
  };
  Kind kind = Kind::None;
  std::string lamp;
  /** A name for eevee::find_layer; empty for all layers. */
  std::string layer;
};

/** Parses `cascades`, `shadow:LAMP[:LAYER]` or `density:LAMP`; empty: none. \throws UsageError */
[[nodiscard]] DebugView parse_debug(const std::string &text);

/**
 * Index of the lamp of \a view in the view that was drawn last: the first of that name that has a visible shadow.
 * \throws std::runtime_error naming the scene and its lamps if there is none
 */
[[nodiscard]] std::size_t shadowed_lamp(const DebugView &view, const scene::Scene &scene,
                                        const eevee::Inspection &inspection);

/**
 * The picture of \a view for the view that was drawn last. \pre \a view has Kind::Shadow. \see eevee::ShadowPicture
 * \throws std::runtime_error naming the scene and its lamps, or the lamp's layers, if there is no such lamp or layer.
 */
[[nodiscard]] const gpu::Texture &shadow_picture(const DebugView &view, const scene::Scene &scene,
                                                 const eevee::Inspection &inspection);

/** Converts display-referred floats, four for each pixel, to bytes for a PNG. */
[[nodiscard]] std::vector<std::uint8_t> to_bytes(std::span<const float> rgba);

/** Copies the fourth float of each pixel to the other three. */
[[nodiscard]] std::vector<float> alpha_in_all(std::span<const float> rgba);

}  // namespace gnomon::cli
