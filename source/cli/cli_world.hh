// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"

#include <CLI/App.hpp>

#include <string>

namespace gnomon::cli {

/** The options of `gnomon render` for the world and the background. */
struct WorldOptions {
  /** A file, a colour, "studio" or "none"; empty: the scene's own, or the studio where it has neither lamps nor world.
   */
  std::string world;
  float strength = 1.0F;
  float rotation_degrees = 0.0F;
  /** "none", "world" or a colour; empty: none, and grey behind what the studio lights in a PNG. */
  std::string background;
};

void add_world_options(CLI::App &command, WorldOptions &options);

/**
 * Give \a scene the world that \a options ask for; a lamp that the importer made up goes where the world lights.
 * \return whether that is the studio, and nothing asked for it.
 * \throws std::runtime_error naming the file and the reason.
 */
bool light_by_world(scene::Scene &scene, const scene::PlacedCamera &camera, const WorldOptions &options);

/** \a default_color: where \a options ask for nothing; nothing: no background. \throws UsageError */
[[nodiscard]] eevee::Background background_of(const WorldOptions &options, std::optional<glm::vec3> default_color);

/** "R,G,B", numbers of at least 0; nothing: it is something else. */
[[nodiscard]] std::optional<glm::vec3> parse_color(const std::string &text);

}  // namespace gnomon::cli
