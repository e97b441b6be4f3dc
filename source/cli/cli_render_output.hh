// SPDX-License-Identifier: MIT
#pragma once

#include "cli_aov.hh"
#include "cli_render_options.hh"

#include <glm/vec4.hpp>

namespace gnomon::cli {

/** A rendered picture, or a part of it, with the values that are written beside it. Rows from the bottom. */
struct RenderedPicture {
  /** The size of the arrays that follow. */
  glm::ivec2 size_px{0};
  std::vector<glm::vec4> pixels{};
  /** Display-referred RGBA bytes of a PNG; empty: made from pixels. */
  std::vector<std::uint8_t> display{};
  /** The values of --debug density; empty without it. */
  std::vector<float> density{};
  Alpha alpha = Alpha::Dropped;
  AovLayers aov{};
  /** Samples of each pixel, and the share of the whole picture's that they are (eevee::Engine::sample_share). */
  int sample_count = 0;
  double sample_share = 1.0;
  /** RenderOptions::settings_text. */
  std::string settings{};
  /** Camera, device, frame and part. */
  Metadata metadata{};
};

/**
 * Writes the picture to options.output; a part of it where options.is_part().
 * \return the number of values that are not finite; they are printed, and nothing is written unless it is 0
 */
std::size_t write_picture(const RenderOptions &options, const RenderedPicture &picture);

/**
 * Writes the first samples of an unfinished picture beside options.output, for `gnomon merge` with the others.
 * \return the path
 */
std::filesystem::path write_checkpoint(const RenderOptions &options, const RenderedPicture &picture);
/** The path of write_checkpoint. */
[[nodiscard]] std::filesystem::path checkpoint_path(const RenderOptions &options);

}  // namespace gnomon::cli
