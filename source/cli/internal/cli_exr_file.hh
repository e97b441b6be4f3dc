// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>

#include <cstdint>
#include <istream>
#include <optional>
#include <string>

namespace gnomon::cli {

/** Values of a part of an EXR file: pixels times channels. 8K with 32 channels have fewer. */
inline constexpr std::uint64_t exr_value_count_max = std::uint64_t(1) << 30U;

/** A hash of a file's headers, and its checksum. */
struct HeaderScan {
  /** A hash of all bytes of the headers but the value of the checksum. */
  std::uint64_t hash = 0;
  /** Position of the checksum's value in the file, bytes. */
  std::uint64_t checksum_at = 0;
  /** Hashes of the pixels and of the headers, 16 digits each. Empty: another program or an older version wrote it. */
  std::string checksum{};
};

/** Reads the headers of a file of \a file_bytes. \throws std::runtime_error if an attribute is longer than the file */
[[nodiscard]] HeaderScan scan_headers(std::istream &stream, std::uint64_t file_bytes);

/** An EXR file of a stranger. Its headers were compared with the file's length before OpenEXR read them. */
class ExrInput {
 public:
  /** \throws std::exception, without the file's name, if it is no EXR file, or if an attribute exceeds it */
  explicit ExrInput(const std::filesystem::path &path);

  [[nodiscard]] Imf::MultiPartInputFile &file()
  {
    return *file_;
  }
  /**
   * Call this before an Imf::InputPart or another file is made of \a part, because these allocate rows.
   * \throws std::runtime_error, without the file's name, if it has more values than exr_value_count_max, or more than
   * its compression can store in a file of its length
   */
  void check_memory(int part) const;
  /** \throws std::runtime_error, without the file's name, if the file has a checksum that is not that of its headers */
  void check_headers() const;
  /** The same for all values of its only part, which \a pixels has. */
  void check_pixels(const Imf::FrameBuffer &pixels) const;

 private:
  std::uint64_t file_bytes_;
  HeaderScan scan_;
  std::optional<Imf::MultiPartInputFile> file_;
};

/** \throws std::runtime_error for too few and too many pixels. \see check_edges */
[[nodiscard]] glm::ivec2 size_of_window(const Imath::Box2i &window);

/** 16 digits. \a pixels: 32-bit floats, of which those in \a window are hashed */
[[nodiscard]] std::string pixel_checksum(const Imath::Box2i &window, const Imf::FrameBuffer &pixels);
/** 16 digits. */
[[nodiscard]] std::string header_checksum(const HeaderScan &scan);

/**
 * Writes the rows of \a header's data window, with \a metadata, atomically. \throws std::runtime_error naming \a path
 * if it cannot be written
 */
void write_exr_file(const std::filesystem::path &path, Imf::Header header, const Imf::FrameBuffer &pixels,
                    const Metadata &metadata);

}  // namespace gnomon::cli
