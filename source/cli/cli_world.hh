// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"
#include "gltf_import.hh"
#include "output_roles.hh"

#include <CLI/App.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace gnomon::cli {

/** Options for the world, of all commands that light a scene. */
struct WorldOptions {
  /**
   * A file, a radiance R,G,B, "studio" or "none". Empty: the scene's own world, or the studio if the scene has neither
   * lamps nor a world.
   */
  std::string world;
  /** The layer of the file; empty: \see read_picture. */
  std::string layer;
  /** Factor of the world's radiance. */
  float strength = 1.0F;
  float rotation_degrees = 0.0F;
};

void add_world_options(CLI::App &command, WorldOptions &options);
/** The arguments that give another process these options. */
[[nodiscard]] std::vector<std::string> arguments_of(const WorldOptions &options);

/** Adds `--background`: "none", "world" or a radiance R,G,B. Empty: not given. */
void add_background_option(CLI::App &command, std::string &background);

/** Adds `--only-below`, for all commands that import scenes. */
void add_only_below_option(CLI::App &command, std::filesystem::path &folder);

/**
 * Adds the files of \a scene, and that of \a options, to \a roles. \throws output::Conflict where an output would
 * replace one
 */
void add_inputs(output::Roles &roles, const scene::Scene &scene, const WorldOptions &options);

/**
 * Imports a scene, with the picture of its own world: ImportOptions::read_picture is replaced. Without another world,
 * the layer of \a world is that of this picture. \throws gltf::ImportError, and UsageError if there is no such variant
 */
[[nodiscard]] scene::Scene import_scene(const std::string &path, const WorldOptions &world,
                                        const gltf::ImportOptions &options = {});

/**
 * An equirectangular picture, whose texels may be negative or infinite (scene::clamp_radiances). \a layer: \see
 * read_picture. Adds what the file states and the
 * reader ignores to \a warnings. \throws std::runtime_error naming \a path, also for a
 * picture that says that it is a cube map
 */
[[nodiscard]] scene::WorldPicture read_world_picture(const std::filesystem::path &path, const std::string &layer,
                                                     std::vector<std::string> &warnings);

/** One line for people: its picture, or its radiance. */
[[nodiscard]] std::string world_text(const scene::World &world);

/**
 * Set the world of \a scene according to \a options. If the scene then has a world, the default lamp that the importer
 * has added is removed.
 * \return true if the studio is used because neither the options nor the scene have a world or lamps
 * \throws std::runtime_error naming the file and the reason
 */
bool light_by_world(scene::Scene &scene, const scene::PlacedCamera &camera, const WorldOptions &options);

/** The background of `--background`. \a fallback: if \a option is empty. \throws UsageError */
[[nodiscard]] eevee::Background background_of(const std::string &option, const eevee::Background &fallback);

/** Parses "R,G,B" with finite numbers of at least 0. Returns an empty value for any other text. */
[[nodiscard]] std::optional<glm::vec3> parse_color(const std::string &text);

}  // namespace gnomon::cli
