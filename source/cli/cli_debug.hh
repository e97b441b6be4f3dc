// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"

#include <string>
#include <string_view>

namespace gnomon::cli {

/** What --debug asks for. */
struct DebugView {
  enum class Kind {
    None,
    /** Layers of a lamp's shadow instead of the picture. */
    Shadow,
    /** The picture, tinted by cascades. */
    Cascades,
  };
  Kind kind = Kind::None;
  std::string lamp;
  /** As eevee::Engine::shadow_layers names it; empty: all. */
  std::string layer;
};

/** `cascades`, or `shadow:LAMP[:LAYER]`; empty: none. \throws UsageError */
[[nodiscard]] DebugView parse_debug(const std::string &text);

/**
 * The picture of \a view, of Kind::Shadow, for the view that was drawn last. \see eevee::ShadowPicture
 * \throws std::runtime_error naming the scene and the lamps, or the lamp's layers, that there are.
 */
[[nodiscard]] const gpu::Texture &shadow_picture(const DebugView &view, const scene::Scene &scene,
                                                 eevee::Engine &engine, draw::Viewport &viewport);

/** Bytes for a PNG, of floats that are display-referred, four a pixel. */
[[nodiscard]] std::vector<std::uint8_t> to_bytes(std::span<const float> rgba);

/** The fourth of four floats a pixel, in all four. */
[[nodiscard]] std::vector<float> alpha_in_all(std::span<const float> rgba);

}  // namespace gnomon::cli
