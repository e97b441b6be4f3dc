// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace gnomon::cli {

/** Values of a part of an EXR file: pixels times channels. 8K with 32 channels have fewer. */
inline constexpr std::uint64_t exr_value_count_max = std::uint64_t(1) << 30U;

/** Gives the next bytes of a file from its begin on. Throws if there are fewer. */
using ReadBytes = std::function<void(char *bytes, std::size_t size)>;

/** The value of a file's checksum. */
struct StoredChecksum {
  /** Its position in the file, bytes. */
  std::uint64_t position = 0;
  /** Empty: another program or an older version wrote the file. */
  std::string text{};
};

/** Reads the headers of a file of \a file_bytes. \throws std::runtime_error if an attribute is longer than the file */
[[nodiscard]] StoredChecksum scan_headers(const ReadBytes &read, std::uint64_t file_bytes);

/** 16 digits: a hash of all bytes of a file of \a file_bytes but those of \a stored. */
[[nodiscard]] std::string file_checksum(const ReadBytes &read, std::uint64_t file_bytes, const StoredChecksum &stored);

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
  /** \throws std::runtime_error, without the file's name, if the file has a checksum that is not its own */
  void check_content() const;

 private:
  std::filesystem::path path_;
  std::uint64_t file_bytes_;
  StoredChecksum checksum_;
  std::optional<Imf::MultiPartInputFile> file_;
};

/** \throws std::runtime_error for too few and too many pixels. \see check_edges */
[[nodiscard]] glm::ivec2 size_of_window(const Imath::Box2i &window);

/**
 * Writes the rows of \a header's data window, with \a metadata, atomically. \throws std::runtime_error naming \a path
 * if it cannot be written
 */
void write_exr_file(const std::filesystem::path &path, Imf::Header header, const Imf::FrameBuffer &pixels,
                    const Metadata &metadata);

}  // namespace gnomon::cli
