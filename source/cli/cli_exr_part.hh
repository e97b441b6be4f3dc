// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"

#include <map>

namespace gnomon::cli {

/** Metadata of a part: the share of the picture's samples that it contains (Engine::sample_share). */
inline constexpr const char *share_metadata = "gnomon:sample_share";
/** "A-B": the first and the last sample that it contains. */
inline constexpr const char *range_metadata = "gnomon:sample_range";

/** A hash of all other bytes of the file. Files of older versions have none. */
inline constexpr const char *checksum_metadata = "gnomon:checksum";

/** An EXR file with a part of a picture, or with the whole. Rows from the top, as in the file. */
struct ExrPart {
  glm::ivec2 whole_size_px{0};
  glm::ivec2 size_px{0};
  /** The upper left pixel of the part, from the upper left of the picture. */
  glm::ivec2 first_px{0};
  /** By name, for example "R". Each has one value for each pixel of the part. */
  std::map<std::string, std::vector<float>> channels;
  Metadata metadata;
};

/** Whether to read pixels. Without them, channels have names only. */
enum class ExrContent { Header, All };

/**
 * \throws std::runtime_error naming \a path if it is no EXR file of 32-bit floats, is cut off, exceeds the picture, or
 * has a checksum that is not its own
 */
[[nodiscard]] ExrPart read_exr_part(const std::filesystem::path &path, ExrContent content = ExrContent::All);
/** Writes the file atomically. \throws std::runtime_error naming \a path if it cannot be written */
void write_exr_part(const std::filesystem::path &path, const ExrPart &part);

/** The value of \a name; empty if there is none. */
[[nodiscard]] std::string metadata_value(const Metadata &metadata, const std::string &name);

}  // namespace gnomon::cli
