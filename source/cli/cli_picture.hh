// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

/** Files of pictures. Functions that write one replace an old file as a whole, or leave it. */
namespace gnomon::cli {

/** Names and values for a picture's header. */
using Metadata = std::vector<std::pair<std::string, std::string>>;

/** Whether the fourth value of each pixel is written. */
enum class Alpha { Dropped, Written };

/** A layer of an EXR file beside the picture. */
struct Layer {
  /** The first part of the names of its channels. */
  std::string name;
  /** The last part, one letter for each channel: "RGB" gives the channels NAME.R, NAME.G and NAME.B. */
  std::string channels;
  /** A value for each channel of each pixel, rows from the bottom. */
  std::vector<float> values;
};

/**
 * Writes 32-bit floats in the channels R, G, B and, if it is written, A, by which colours are multiplied. Rows from the
 * bottom, four floats for each pixel. \pre layers have different names
 * \throws std::runtime_error naming \a path if it cannot be written; so does write_png.
 */
void write_exr(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const float> rgba,
               const Metadata &metadata, Alpha alpha = Alpha::Dropped, std::span<const Layer> layers = {});
/** Writes 8 bits a channel. Rows from the bottom, four bytes for each pixel; colours are not multiplied by alpha. */
void write_png(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba,
               const Metadata &metadata, Alpha alpha = Alpha::Dropped);
/** The bytes of a PNG file like that of write_png, without metadata and alpha. */
[[nodiscard]] std::vector<std::byte> png_bytes(glm::ivec2 size_px, std::span<const std::uint8_t> rgba);

/** A picture of any size. */
struct Picture {
  glm::ivec2 size_px{0};
  /** Scene-linear red, green, blue and 1, rows from the bottom. */
  std::vector<glm::vec4> pixels;
  /** The file says that its pixels are the six faces of a cube around the viewer. */
  bool is_cube_map = false;
  /** Statements of the file that are ignored, without its name. */
  std::vector<std::string> warnings{};
};

/**
 * Reads R, G and B, or Y as grey, of the layer \a layer of an EXR file; empty: the one without a name, or the only one.
 * The picture of an EXR file is that of its display window, black where it has no pixels. The format is that of the
 * first bytes: EXR, PNG, JPEG, WebP or Radiance HDR, or another one that OpenImageIO reads. Integer values are decoded
 * by the sRGB curve. Those of a PNG with alpha are then multiplied by it, so that transparent pixels are black. The
 * primaries are those of Rec. 709; for an EXR or HDR file that states others, there is a warning.
 * \throws std::runtime_error naming \a path if it cannot be read, is cut off, or has no such channels or layer; the
 * message lists those that it has.
 */
[[nodiscard]] Picture read_picture(const std::filesystem::path &path, const std::string &layer = {});
/** The same for a picture whose size is known. \throws std::runtime_error also for another size. */
[[nodiscard]] std::vector<glm::vec4> read_exr(const std::filesystem::path &path, glm::ivec2 size_px);

}  // namespace gnomon::cli
