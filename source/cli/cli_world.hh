// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"

#include <CLI/App.hpp>

#include <string>

namespace gnomon::cli {

/** Options of `gnomon render` for the world and the background. */
struct WorldOptions {
  /**
   * A file, a radiance R,G,B, "studio" or "none". Empty: the scene's own world, or the studio if the scene has neither
   * lamps nor a world.
   */
  std::string world;
  /** Factor of the world's radiance. */
  float strength = 1.0F;
  float rotation_degrees = 0.0F;
  /** "none", "world" or a radiance R,G,B. Empty: none, or light grey in a PNG that the default studio lights. */
  std::string background;
};

void add_world_options(CLI::App &command, WorldOptions &options);

/**
 * Set the world of \a scene according to \a options. If the scene then has a world, the default lamp that the importer
 * has added is removed.
 * \return true if the studio is used because neither the options nor the scene have a world or lamps
 * \throws std::runtime_error naming the file and the reason
 */
bool light_by_world(scene::Scene &scene, const scene::PlacedCamera &camera, const WorldOptions &options);

/**
 * The background according to \a options. \a default_color: the background if the options have none; may be empty.
 * \throws UsageError
 */
[[nodiscard]] eevee::Background background_of(const WorldOptions &options, std::optional<glm::vec3> default_color);

/** Parses "R,G,B" with finite numbers of at least 0. Returns an empty value for any other text. */
[[nodiscard]] std::optional<glm::vec3> parse_color(const std::string &text);

}  // namespace gnomon::cli
