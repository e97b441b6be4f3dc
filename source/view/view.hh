// SPDX-License-Identifier: MIT
#pragma once

#include "gltf_import.hh"

#include <glm/vec2.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

/** A window on a scene: looks at it, edits it and saves it. doc/view.md describes it. */
namespace gnomon::view {

/** Write an image file, or throw std::runtime_error naming it. Rows from the bottom, four channels. */
struct ImageWriters {
  std::function<void(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba)> png;
  /** Scene-linear radiance. */
  std::function<void(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const float> rgba)> exr;
};

struct Options {
  /** Empty: nothing is open at first. */
  std::filesystem::path scene{};
  /** Commands to run; empty: a person uses the window. */
  std::filesystem::path script{};
  /** Written when all viewports are complete, after the script; then the program ends. Empty: none. */
  std::filesystem::path screenshot{};
  /** A folder as the repository's `shaders`, whose files may be edited meanwhile. Empty: those of the build. */
  std::filesystem::path shaders{};
  /** Of all scenes that are opened: gltf::ImportOptions::only_below. */
  std::filesystem::path only_below{};
  glm::ivec2 size_px{1440, 860};
  ImageWriters writers{};
  /** Reads the picture of a world. */
  gltf::ReadPicture read_picture{};
};

/**
 * Open a window, and return when it is closed or the script has ended. Broken files and invalid values are messages in
 * the window.
 * \throws std::runtime_error where there is no display or no folder with shaders, where a command of the script fails,
 * naming the file and the line, and, with a script, where the driver reports an error
 */
void run(const Options &options);

}  // namespace gnomon::view
