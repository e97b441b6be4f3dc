// SPDX-License-Identifier: MIT
#pragma once

#include "gltf_import.hh"
#include "gpu_create_device.hh"

#include <glm/vec2.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

/** The interactive window, which views, edits and saves one scene. doc/view.md describes it. */
namespace gnomon::view {

/**
 * Functions that write an image file. They throw std::runtime_error, which names the file. Pixels have four channels;
 * the first row is the bottom one.
 */
struct ImageWriters {
  std::function<void(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba)> png;
  /** Scene-linear radiance. */
  std::function<void(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const float> rgba)> exr;
};

struct Options {
  /** Scene file to open at start. Empty: none. */
  std::filesystem::path scene{};
  /** File with commands to run. Empty: the window is used interactively. */
  std::filesystem::path script{};
  /**
   * Picture file of the window, written once the script has ended and all viewports are complete; the program then
   * ends. Empty: none.
   */
  std::filesystem::path screenshot{};
  /**
   * Folder with the layout of the repository's `shaders`; its files are compiled again when they change. Empty: the
   * shaders of the build.
   */
  std::filesystem::path shaders{};
  /** gltf::ImportOptions::only_below of all scenes that are opened. */
  std::filesystem::path only_below{};
  /** Auto, OpenGl or Vulkan. \see open_window */
  gpu::Backend backend = gpu::Backend::Auto;
  glm::ivec2 size_px{1440, 860};
  ImageWriters writers{};
  /** Function that reads the picture of a world. */
  gltf::ReadPicture read_picture{};
};

/**
 * Open a window, and return when it is closed or the script has ended. Broken files and invalid values are messages in
 * the window.
 * \throws std::runtime_error where there is no display, no driver or no folder with shaders, where a command of the
 * script fails, naming the file and the line, and, with a script, where the driver reports an error
 */
void run(const Options &options);

}  // namespace gnomon::view
